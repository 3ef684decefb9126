"""Measured solubilities of R134a in oils: read from a file of the user's, which is no part of this checkout.

The points are of published papers. SorpPropLib (github.com/carlesRT/sorpproplib_JSON) has collected them in
python_wrapper/sorpproplib/data/JSON/experimental_data/abs/R-134a.csv, without a licence, so they are not copied here.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Container, Iterable
from pathlib import Path
from typing import NamedTuple

from screwsim.fluid.constants import limits
from screwsim.study.validation import NotRun

FILE = "SCREWSIM_SOLUBILITY_POINTS"  # environment variable that names the file
PLAIN = ("oil", "source", "T_K", "p_Pa", "loading_as_stored")  # columns of a file with a row for each point
COLLECTED = ("sorbent-subtype", "literature", "temperatures", "pressures", "loadings")  # the same of SorpPropLib's file
REMEDY = f"take that of SorpPropLib, or one with the columns {', '.join(PLAIN)}"


class Point(NamedTuple):
    """Temperature [K], pressure [Pa] and the stored loading, whose kind `compare.py` settles."""

    T: float
    p: float
    loading: float


Points = dict[tuple[str, str], list[Point]]  # by the first author's name and the oil's


def named() -> Path | None:
    """Return the file of the points that the environment names; None without one."""
    name = os.environ.get(FILE, "")
    return Path(name) if name else None


def read(path: Path, wanted: Container[tuple[str, str]] | None = None) -> Points:
    """Return the points of a file by source and oil. Raises NotRun for a file that does not hold them.

    Values are checked of `wanted` sources and oils, of all without it: other rows may hold what is no oil with R134a.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise NotRun(f"{FILE}={path}: cannot be read ({error}; {REMEDY})") from None
    rows = csv.DictReader(text.splitlines(), delimiter=";" if ";" in text.partition("\n")[0] else ",")
    columns = next((each for each in (PLAIN, COLLECTED) if set(each) <= set(rows.fieldnames or ())), None)
    if columns is None:
        raise NotRun(f"{FILE}={path}:1: has not the columns of measured points ({REMEDY})")
    found: Points = {}
    for line, row in enumerate(rows, 2):
        oil, source, *numbers = (row[name] or "" for name in columns)
        if numbers[0].startswith("in "):
            continue  # units, in SorpPropLib's file
        try:
            name, new = (source.partition(",")[0], oil), _points(numbers)
            if wanted is None or name in wanted:
                _check(new)
            found.setdefault(name, []).extend(new)
        except ValueError as error:
            raise NotRun(f"{FILE}={path}:{line}: holds no points ({error}; {REMEDY})") from None
    return found


def _points(numbers: Iterable[str]) -> list[Point]:
    columns = ([float(each) for each in column.split(",")] for column in numbers)
    return [Point(*values) for values in zip(*columns, strict=True)]


def _check(points: Iterable[Point]) -> None:
    """Raise ValueError, with the remedy, for what is no point of R134a in an oil."""
    known = limits("R134a")
    assert known is not None
    for point in points:
        if not known.T_triple < point.T < known.T_critical:
            ends = f"{known.T_triple:.6g} to {known.T_critical:.6g} K, where R134a has a saturation pressure"
            raise ValueError(f"temperature {point.T:g} K is not within {ends}: write kelvins, not °C")
        if not 0.0 < point.p < known.p_critical:
            most = f"below {known.p_critical:.4g} Pa, its critical pressure"
            raise ValueError(f"pressure {point.p:g} Pa is not above 0 and {most}: write pascals, leave out pure oil")
        if not 0.0 < point.loading < 1.0:
            what = f"loading {point.loading:g} is not between 0 and 1"
            raise ValueError(f"{what}: write the mole fraction of R134a, not per cent; leave out what is pure")
