"""The model of a scene: its parts composed into one module of text, and that module with its arrays, ready to run."""
