"""The best value of one path, searched for."""
