"""What other tools read: maps of a machine as FMU and as texts, loads of its rotors, spectra of forces and flows."""
