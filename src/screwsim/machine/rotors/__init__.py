"""Rotor geometry: from a profile to V(φ), ports and leakage paths, as pure geometry (docs/reference/rotors.md)."""
