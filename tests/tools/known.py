"""Results of another method for a fixed scene: kept in `tests/stored`, computed again by scripts/test --all.

Another method takes long, and its results change only with the equations. A test that uses `known` gets the stored
numbers where scripts/test runs without --all. Anywhere else they are computed again and must agree with the stored
ones: the reference of the code under test is then never older than the last complete run. Where the equations or the
question have changed, SCREWSIM_KNOWN=write python -m pytest -n0 FILE stores what the tests of a file need (first remove
the subject's file, where nothing else writes it).
"""

import hashlib
import json
import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).parents[1] / "stored"
HOW = "SCREWSIM_KNOWN"  # 'stored': used as they are; 'write': computed and stored; else computed and compared
LETTERS = 16  # characters of a digest
DIGITS = 12  # of a stored number
NOTHING = 1e-9  # numbers below it count as zero

Numbers = Mapping[str, Any]  # numbers of figures, or texts


def known(
    subject: str, what: str, asked: str, find: Callable[[], Numbers], within: float | Callable[[Numbers], list[str]]
) -> dict[str, Any]:
    """Return the result of `find` for the question `asked`, a text with everything that determines it.

    It is kept in the file of a `subject`. Numbers computed again may differ from the stored ones by `within` of
    themselves; or it tells which stored ones are too far from what was found. `what` is for readers of the file.
    """
    file = FOLDER / f"{subject}.json"
    rows = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    of = hashlib.sha256(f"{what}\n{asked}".encode()).hexdigest()[:LETTERS]
    row, how = rows.get(of), os.environ.get(HOW)
    if how == "write":
        found = {key: _short(value) for key, value in find().items()}
        rows[of] = {"what": what, "found": found}
        FOLDER.mkdir(exist_ok=True)
        file.write_text(json.dumps(rows, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        return found
    if row is None:
        pytest.fail(
            f"{file.name} does not have {what} of what is asked: {HOW}=write python -m pytest -n0 FILE stores it"
        )
    stored: dict[str, Any] = row["found"]
    if how == "stored":
        return stored
    found = {key: _short(value) for key, value in find().items()}
    if callable(within):
        far = within(stored)
    else:
        far = [key for key in {**found, **stored} if not _alike(found.get(key), stored.get(key), within)]
    assert not far, f"{file.name}, {what}: {', '.join(f'{key} {found.get(key)}, not {stored.get(key)}' for key in far)}"
    return found


def _short(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def _alike(one: Any, other: Any, within: float) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=within, abs_tol=NOTHING)
    return bool(one == other)
