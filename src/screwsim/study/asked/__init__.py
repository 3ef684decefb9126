"""What a study is asked, of a scene or of two in series: inputs and their spans, figures, goals and bounds."""
