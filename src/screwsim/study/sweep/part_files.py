"""One part of a sweep as a file: the table of consecutive cases, written completely or not at all, with checksums.

The archive has few arrays, because each costs as much as thousands of numbers: `about` holds all texts as JSON.
"""

import json
import zipfile
import zlib
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.figures import scale_of
from screwsim.inputs.textfiles import irregular_kind
from screwsim.outputs import STATUSES, Figure, names_of
from screwsim.results.atomic import replacing
from screwsim.results.table import MAPPING_FIELDS, TEXT_NAMES, CaseTexts, Table, columns_of

_UNREADABLE = (OSError, EOFError, LookupError, ValueError, TypeError, AttributeError, NotImplementedError)
_UNREADABLE += (MemoryError, RecursionError, RuntimeError, zipfile.BadZipFile, zlib.error)  # raised by numpy, zipfile


def write_part(path: Path, table: Table) -> None:
    """Write a part; raise UsageError, in one line, when the system refuses."""
    about = {
        "effects": table.effects,
        "states": table.states,
        "words": {name: table.texts[name].words for name in TEXT_NAMES},
        "inputs": table.inputs,
        "by": dict(table.numbers),
        "about": [asdict(each) for each in table.about],
        **{part: list(getattr(table, part)) for part in MAPPING_FIELDS},
    }
    arrays = {
        "about": np.frombuffer(json.dumps(about).encode(), np.uint8),
        "status": table.status,
        "figures": table.figures,
        "numbers": np.array([table.texts[name].number for name in TEXT_NAMES], np.int32),
        "angle": table.angle,
        **{part: np.array(list(getattr(table, part).values()), float) for part in MAPPING_FIELDS},
    }
    with replacing(path) as temporary, temporary.open("wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays)


def read_part(path: Path, traces: bool = True, cases: bool = True) -> Table:
    """Return the table of a part, with all traces or none.

    Without `cases` it has texts, effects, states, angles, and the names of traces and ledger entries.
    """
    none = np.empty(0)
    with np.load(path, allow_pickle=False) as stored:
        about = json.loads(stored["about"].tobytes())
        numbers = stored["numbers"] if cases else [none] * len(TEXT_NAMES)

        def by_name(part: str) -> dict[str, np.ndarray]:
            rows = stored[part] if cases and about[part] else [none] * len(about[part])
            return dict(zip(about[part], rows, strict=True))

        return Table(
            status=stored["status"] if cases else none,
            figures=stored["figures"] if cases else none,
            texts={name: CaseTexts(tuple(about["words"][name]), numbers[i]) for i, name in enumerate(TEXT_NAMES)},
            effects=tuple(about["effects"]),
            states=tuple(about["states"]),
            angle=stored["angle"],
            about=_figures(about),
            inputs=tuple(about["inputs"]),
            numbers=dict(about["by"]),
            **{part: by_name(part) for part in MAPPING_FIELDS if traces or part != "traces"},
        )


def _figures(about: Any) -> tuple[Figure, ...]:
    """Return the figures described in a part; raise TypeError where one is not valid."""
    more = ({name: tuple(each.get(name, ())) for name in ("needs", "curve", "square_of")} for each in about["about"])
    more = (lists | {"scale": scale_of(each["scale"])} for lists, each in zip(more, about["about"], strict=True))
    found = tuple(Figure(**each | typed) for each, typed in zip(about["about"], more, strict=True))
    texts = (text for each in found for text in (each.name, each.units, each.long_name, *each.needs))
    if not all(isinstance(text, str) for text in texts):
        raise TypeError("a part file has a figure without a name")
    return found


def is_whole(path: Path, cases: int) -> bool:
    """Return whether a part can be read to its end (checksums included) and holds that many cases."""
    if irregular_kind(path):
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            packed = any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist())
            if packed or archive.testzip() is not None:  # a compressed archive is not ours, and its size has no bound
                return False
        return _is_sound(read_part(path), cases)
    except _UNREADABLE:
        return False


def _is_sound(table: Table, cases: int) -> bool:
    """Return whether the contents of a part are consistent."""
    texts = [(words.number, len(words.words)) for words in table.texts.values()]
    numbers = (table.status, -1, len(STATUSES)), *((number, 0, count) for number, count in texts)
    shapes = (table.angle.shape, (), (len(table.inputs),), (len(table.numbers),))  # of a row
    pairs = zip(MAPPING_FIELDS, shapes, strict=True)
    mapped = [(name, values, shape) for part, shape in pairs for name, values in getattr(table, part).items()]
    names = (*table.effects, *table.states, *table.inputs, *table.numbers, *table.numbers.values())
    return (
        table.figures.shape == (cases, len(columns_of(names_of(table.about))))
        and all(_in_range(values, cases, first, stop) for values, first, stop in numbers)
        and all(isinstance(word, str) for words in table.texts.values() for word in words.words)
        and all(isinstance(name, str) for name in (*names, *(name for name, *_ in mapped)))
        and table.angle.ndim == 1
        and all(values.shape == (cases, *shape) for _, values, shape in mapped)
        and all(real.dtype.kind == "f" for real in (table.figures, table.angle, *(values for _, values, _ in mapped)))
    )


def _in_range(values: np.ndarray, cases: int, first: int, stop: int) -> bool:
    whole = values.shape == (cases,) and values.dtype.kind in "iu"
    return whole and bool(np.all((values >= first) & (values < stop)))
