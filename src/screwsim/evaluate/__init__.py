"""What a cycle tells: figures, balances, ledger, traces, and what is said of it."""
