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
    """Be the command; while it is imported, Ctrl-C or SIGTERM ends it in one line."""
    for number, usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGTERM, signal.SIG_DFL)):
        if signal.getsignal(number) is usual:
            signal.signal(number, _end)
    from screwsim.cli import main as command

    command()


if __name__ == "__main__":
    main()
