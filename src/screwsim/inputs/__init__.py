"""Inputs from outside: declarations of fields, files, and faults that say what is wrong with an input."""
