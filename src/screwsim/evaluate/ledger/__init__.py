"""The ledger of the shaft power (docs/model.md M50–M59): `total` makes it from a closed cycle."""
