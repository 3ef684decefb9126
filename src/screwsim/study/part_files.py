"""One part of a sweep as a file: the table of consecutive cases, written whole or not at all, with checksums.

An archive of few arrays, because each costs as much as thousands of numbers: `about` holds all words as JSON.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.results.atomic import replacing
from screwsim.results.table import FIGURES, TEXTS, Table, Texts

_TRACE = "trace_"
_UNREADABLE = (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile)


def write_part(path: Path, table: Table) -> None:
    """Write a part; raise UsageError, in one line, when the system refuses."""
    about = {
        "effects": table.effects,
        "states": table.states,
        "words": {name: table.texts[name].words for name in TEXTS},
        "ledger": list(table.ledger),
    }
    arrays = {
        "about": np.frombuffer(json.dumps(about).encode(), np.uint8),
        "status": table.status,
        "figures": table.figures,
        "numbers": np.array([table.texts[name].number for name in TEXTS], np.int32),
        "angle": table.angle,
        "ledger": np.array(list(table.ledger.values()), float),
        **{_TRACE + name: trace for name, trace in table.traces.items()},
    }
    with replacing(path) as temporary, temporary.open("wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays)


def read_part(path: Path, traces: bool = True) -> Table:
    """Return the table of a part, with all traces or none."""
    with np.load(path, allow_pickle=False) as stored:
        about, numbers = _about(stored), stored["numbers"]
        ledger = stored["ledger"] if about["ledger"] else ()
        return Table(
            status=stored["status"],
            figures=stored["figures"],
            texts={name: Texts(tuple(about["words"][name]), numbers[i]) for i, name in enumerate(TEXTS)},
            effects=tuple(about["effects"]),
            states=tuple(about["states"]),
            angle=stored["angle"],
            traces={name: stored[_TRACE + name] for name in _traces(stored)} if traces else {},
            ledger=dict(zip(about["ledger"], ledger, strict=True)),
        )


def read_head(path: Path) -> Table:
    """Return a part without its cases: texts, effects, states, angles, and the names of traces and ledger."""
    none = np.empty(0)
    with np.load(path, allow_pickle=False) as stored:
        about = _about(stored)
        return Table(
            status=none,
            figures=none,
            texts={name: Texts(tuple(about["words"][name]), none) for name in TEXTS},
            effects=tuple(about["effects"]),
            states=tuple(about["states"]),
            angle=stored["angle"],
            traces=dict.fromkeys(_traces(stored), none),
            ledger=dict.fromkeys(about["ledger"], none),
        )


def _about(stored: Any) -> dict[str, Any]:
    return json.loads(stored["about"].tobytes())


def _traces(stored: Any) -> list[str]:
    return [name.removeprefix(_TRACE) for name in stored.files if name.startswith(_TRACE)]


def is_whole(path: Path, cases: int) -> bool:
    """Tell whether a part can be read to its end (its checksums included) and holds that many cases."""
    try:
        with zipfile.ZipFile(path) as archive:
            if archive.testzip() is not None:
                return False
        table = read_part(path, traces=False)
    except _UNREADABLE:
        return False
    return len(table) == cases and table.figures.shape == (cases, len(FIGURES))
