"""Let `python -m screwsim` be the command."""

from screwsim.cli import main

main()
