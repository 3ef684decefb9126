"""Files that a command is given: their text, or why they have none, and what one is that is no scene."""

from __future__ import annotations

import os
from collections.abc import Collection

HDF5 = b"\x89HDF"
STAGES = "stages"
_FIT = ("parameters", "data", "scene")


class NotText(Exception):
    """Say why a file has no text, and where in it; `results`: it is one of HDF5."""

    def __init__(self, reason: str, line: int = 1, column: int = 1, results: bool = False) -> None:
        super().__init__(reason)
        self.reason, self.line, self.column, self.results = reason, line, column, results


def read_text(name: str | os.PathLike[str]) -> str:
    """Return the text of a file in UTF-8; raise `NotText`."""
    content = b""
    try:
        with open(name, "rb") as stream:
            content = stream.read()
        return content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", "replace")
        line, column = before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1
        raise NotText("it is not UTF-8 text", line, column, content.startswith(HDF5)) from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null character
        raise NotText(getattr(error, "strerror", None) or "its name has a null character") from None


def other_file(keys: Collection[str], name: str, wanted: str = "scene") -> str | None:
    """Return what a file with these keys is in place of a `wanted` one (scene, fit), and what reads it; else None."""
    if STAGES in keys:
        what = "describes two stages, which screwsim run and screwsim explain take"
        return f"{what} (run those on {name}, or name the scene of one stage here)"
    fit = len([key for key in _FIT if key in keys]) >= 2 and not {"machine", "gas", "operation"} & set(keys)
    if wanted == "scene" and fit:
        return f"is a fit, not a scene (run screwsim calibrate {name})"
    if wanted == "fit" and not fit and {"machine", "gas", "operation", "base"} & set(keys):
        return f"is a scene, not a fit (run screwsim run {name}; a fit has scene:, data: and parameters:)"
    return None
