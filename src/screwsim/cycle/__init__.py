"""A cycle: the problem to be solved, and the methods that close it."""
