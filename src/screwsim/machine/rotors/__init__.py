"""Rotor geometry: from a profile to V(φ), ports and leakage paths, as pure geometry (docs/rotors.md)."""
