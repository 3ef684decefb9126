"""Texts of others on a terminal: what would steer it is shown, not sent.

Scenes, results files and names of files may hold control characters: sequences that move the cursor, recolour or
rename the window, or turn the direction of writing.
"""

import re
import sys

# C0 and C1 controls but tab and line feed, DEL, marks of direction, breaks of line that are none of ours, surrogates
_STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")


def say(text: object = "", *, err: bool = False) -> None:
    """Print a text on stdout, or on stderr, with nothing in it that steers a terminal."""
    print(printable(str(text)), file=sys.stderr if err else sys.stdout)


def printable(text: str) -> str:
    """Return a text whose control characters, marks of direction and lone surrogates are written out (\\x1b)."""
    return _STEERING.sub(_written_out, text)


def json_safe(text: str) -> str:
    """Return a JSON text in which what steers a terminal stands as an escape of JSON; it means the same."""
    return _STEERING.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def _written_out(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
