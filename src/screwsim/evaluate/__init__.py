"""What follows from a closed cycle: figures, balances, ledger, traces, warnings and verdict."""
