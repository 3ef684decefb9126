"""Protection of foreign files: an output replaces only a file of its own kind, so that `-o` destroys nothing else."""

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import BadSheet, read_sheet
from screwsim.inputs.textfiles import Unreadable
from screwsim.inputs.workbooks import is_workbook
from screwsim.results.atomic import FOREIGN_FILE, HDF5_SIGNATURE, check_target_kind, has_content, protect_others

PAGE = '<meta name="generator" content="screwsim '  # how our pages identify themselves
PDF = "/Creator (screwsim)"
LONGEST_LINE = 1 << 16  # characters read of a first line


def protect_other_text(texts: Mapping[Path, str]) -> None:
    """Raise UsageError where an existing file does not begin with the first line of the text of its path."""
    for path, text in texts.items():
        protect_others(path, text.splitlines()[0].encode())


def protect_other_heads(path: Path, ours: Callable[[list[str]], bool]) -> None:
    """Raise UsageError where the heads in the first line of a file at `path` are not `ours`."""
    check_target_kind(path)
    heads = first_line(path)
    if heads and not ours(heads):
        raise UsageError(FOREIGN_FILE.format(path))


def first_line(path: Path) -> list[str]:
    """Return the cells of the first line of a table; none where there is no file, or it is empty."""
    if is_workbook(path):
        return _heads_of_workbook(path)
    try:
        with path.open(encoding="utf-8-sig", errors="replace", newline="") as stream:
            line = stream.readline(LONGEST_LINE)
        return (next(csv.reader([line])) or [""]) if line else []
    except (OSError, csv.Error):  # a file that cannot be read cannot be replaced either, which is reported then
        return []


def _heads_of_workbook(path: Path) -> list[str]:
    if not has_content(path):
        return []
    try:
        return list(read_sheet(path).names)
    except (Unreadable, BadSheet):  # not a workbook, or none of ours
        return [""]


def protect_unmarked(path: Path, mark: str) -> None:
    """Raise UsageError where a non-empty file at `path` does not contain the `mark`."""
    text = _text(path)
    if text and mark not in text:
        raise UsageError(FOREIGN_FILE.format(path))


def protect_other_json(path: Path, *keys: str, alone: bool = False, notes: Sequence[str] = ()) -> None:
    """Raise UsageError where a file at `path` is no JSON object with the `keys` (`alone`: and no others but notes)."""
    text = _text(path)
    if not text:
        return
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):  # not JSON
        found = None
    there = set(found).difference(notes) if isinstance(found, dict) else set()
    if not there.issuperset(keys) or (alone and not there.issubset(keys)):
        raise UsageError(FOREIGN_FILE.format(path))


def protect_other_document(path: Path, mark: str, *keys: str, notes: Sequence[str] = ()) -> None:
    """Raise UsageError where a file at `path` is not JSON of the `keys` beside notes, or as text lacks the `mark`."""
    if path.suffix.lower().endswith("json"):
        protect_other_json(path, *keys, alone=True, notes=notes)
    else:
        protect_unmarked(path, mark)


def protect_other_hdf5(path: Path, attribute: str, begins: str = "") -> None:
    """Raise UsageError where a file at `path` is not HDF5 with an attribute whose text begins with `begins`."""
    protect_others(path, HDF5_SIGNATURE)
    if not has_content(path):
        return
    import h5py

    try:
        with h5py.File(path, "r") as file:
            found = file.attrs.get(attribute)
    except OSError:
        found = None
    if found is None or not str(found).startswith(begins):
        raise UsageError(FOREIGN_FILE.format(path))


def _text(path: Path) -> str:
    check_target_kind(path)
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:  # missing, or not readable: if it cannot be replaced either, that is reported then
        return ""
