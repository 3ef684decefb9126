"""A cycle: the problem that is to be solved, and what closes it."""
