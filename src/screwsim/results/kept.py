"""What lies where a command would write stays, unless it is of the kind that is written: no `-o` loses a stranger."""

import json
from collections.abc import Mapping
from pathlib import Path

from screwsim.inputs.faults import UsageError
from screwsim.results.atomic import HDF5, OTHERS, check_target_kind, holds, keep_others

PAGE = '<meta name="generator" content="screwsim '  # what our pages say of themselves
PDF = "/Creator (screwsim)"


def keep_in(folder: Path, begins: Mapping[str, str]) -> None:
    """Raise UsageError where a folder holds a file of one of the names that does not begin as those that are ours."""
    for name, text in begins.items():
        keep_others(folder / name, text.encode())


def keep_other_beginnings(texts: Mapping[Path, str]) -> None:
    """Raise UsageError where a file lies at one of the paths whose first line is not that of the text to come."""
    for path, text in texts.items():
        keep_others(path, text.splitlines()[0].encode())


def keep_without(path: Path, mark: str) -> None:
    """Raise UsageError where a file with something in it lies at `path` whose text has not the `mark`."""
    text = _text(path)
    if text and mark not in text:
        raise UsageError(OTHERS.format(path))


def keep_other_documents(path: Path, *keys: str, alone: bool = False) -> None:
    """Raise UsageError where a file lies at `path` that is no JSON object with the `keys` (`alone`: with no others)."""
    text = _text(path)
    if not text:
        return
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):  # no JSON
        found = None
    there = set(found) if isinstance(found, dict) else set()
    if not there.issuperset(keys) or (alone and not there.issubset(keys)):
        raise UsageError(OTHERS.format(path))


def keep_other_hdf5(path: Path, attribute: str, begins: str = "") -> None:
    """Raise UsageError where a file lies at `path` that is no HDF5 with an attribute whose text begins so."""
    keep_others(path, HDF5)
    if not holds(path):
        return
    import h5py

    try:
        with h5py.File(path, "r") as file:
            found = file.attrs.get(attribute)
    except OSError:
        found = None
    if found is None or not str(found).startswith(begins):
        raise UsageError(OTHERS.format(path))


def _text(path: Path) -> str:
    check_target_kind(path)
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:  # none there, or one that cannot be replaced either, which is told then
        return ""
