"""Exports to other tools: maps of a machine as FMU and as text, loads of its rotors, spectra of forces and flows."""
