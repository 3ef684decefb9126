"""What another method finds of a scene that stays as it is: kept in `tests/stored`, found anew by scripts/test --all.

Another method takes long, and what it finds changes with the equations alone. A test that names what it wants gets the
stored numbers where scripts/test runs without --all. Anywhere else they are found anew and have to be the stored ones:
what the code under test is held against is then never older than the last complete run. Where the equations, or what is
asked, have changed: SCREWSIM_KNOWN=write python -m pytest -n0 FILE stores what the tests of a file ask for
(first remove the subject's file, where nothing else writes it).
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
HOW = "SCREWSIM_KNOWN"  # 'stored': taken as they are; 'write': found and stored; else found and compared
LETTERS = 16  # of a digest
DIGITS = 12  # of a number that is stored
NOTHING = 1e-9  # so small a number is zero

Numbers = Mapping[str, Any]  # of figures, or texts


def known(subject: str, what: str, asked: str, find: Callable[[], Numbers], within: float) -> dict[str, Any]:
    """Return what `find` finds of what is `asked`, a text of all that decides on it, from the file of a subject.

    Numbers found anew may differ from the stored ones by `within` of themselves. `what` is for readers of the file.
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
    far = [key for key in {**found, **stored} if not _alike(found.get(key), stored.get(key), within)]
    assert not far, f"{file.name}, {what}: {', '.join(f'{key} {found.get(key)}, not {stored.get(key)}' for key in far)}"
    return found


def _short(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def _alike(one: Any, other: Any, within: float) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=within, abs_tol=NOTHING)
    return bool(one == other)
