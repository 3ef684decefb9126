"""One part of a sweep as a file: the table of consecutive cases, written whole or not at all, with checksums."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from screwsim.results.atomic import replacing
from screwsim.results.table import FIGURES, TEXTS, Table, Texts

_TRACE, _LEDGER, _WORDS, _NUMBER = "trace_", "ledger_", "words_", "number_"
_UNREADABLE = (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile)


def write_part(path: Path, table: Table) -> None:
    """Write a part; raise UsageError, in one line, when the system refuses."""
    arrays = {
        "status": table.status,
        "figures": table.figures,
        "effects": np.array(table.effects, np.str_),
        "states": np.array(table.states, np.str_),
        "angle": table.angle,
        **{_WORDS + name: np.array(table.texts[name].words, np.str_) for name in TEXTS},
        **{_NUMBER + name: table.texts[name].number for name in TEXTS},
        **{_TRACE + name: trace for name, trace in table.traces.items()},
        **{_LEDGER + name: values for name, values in table.ledger.items()},
    }
    with replacing(path) as temporary, temporary.open("wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays)


def read_part(path: Path, traces: bool = True) -> Table:
    """Return the table of a part, with all traces or none."""
    with np.load(path, allow_pickle=False) as stored:
        names = [name for name in stored.files if traces or not name.startswith(_TRACE)]
        return Table(
            status=stored["status"],
            figures=stored["figures"],
            texts={name: Texts(_strings(stored[_WORDS + name]), stored[_NUMBER + name]) for name in TEXTS},
            effects=_strings(stored["effects"]),
            states=_strings(stored["states"]),
            angle=stored["angle"],
            traces={name.removeprefix(_TRACE): stored[name] for name in names if name.startswith(_TRACE)},
            ledger={name.removeprefix(_LEDGER): stored[name] for name in names if name.startswith(_LEDGER)},
        )


def read_head(path: Path) -> Table:
    """Return a part without its cases: texts, effects, states, angles, and the names of traces and ledger."""
    none = np.empty(0)
    with np.load(path, allow_pickle=False) as stored:
        return Table(
            status=none,
            figures=none,
            texts={name: Texts(_strings(stored[_WORDS + name]), none) for name in TEXTS},
            effects=_strings(stored["effects"]),
            states=_strings(stored["states"]),
            angle=stored["angle"],
            traces={name.removeprefix(_TRACE): none for name in stored.files if name.startswith(_TRACE)},
            ledger={name.removeprefix(_LEDGER): none for name in stored.files if name.startswith(_LEDGER)},
        )


def _strings(array: np.ndarray) -> tuple[str, ...]:
    return tuple(array.tolist())


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
