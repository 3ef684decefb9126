"""The command `screwsim`, also as `python -m screwsim`."""

import contextlib
import os
import signal
from typing import Any


def _end(number: int, frame: Any) -> None:
    with contextlib.suppress(OSError):
        os.write(2, b"interrupted\n")
    os._exit(130)


def main() -> None:
    """Be the command; while it is imported, Ctrl-C ends it in one line."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    from screwsim.cli import main as command

    command()


if __name__ == "__main__":
    main()
