"""The drive between motor and rotors (docs/coupling.md)."""
