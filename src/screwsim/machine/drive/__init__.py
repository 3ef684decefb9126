"""The drive between motor and rotors (docs/reference/coupling.md)."""
