"""Rating lives of the bearings that a scene names one by one (M480 to M484): at a sheet's own point, and the shortest.

The shortest life is over the sheet's points within its limits, those of part load among them.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from screwsim.effects.parts.bearing_set import AXIAL, ENDS, SET_LIFE
from screwsim.machine.rotors.loads import NAMES
from screwsim.outputs import Result
from screwsim.outputs.customary import HOUR
from screwsim.study.datasheet.sheet import Table
from screwsim.study.datasheet.units import METRIC, Units

DIGITS = 3  # significant digits of a life, of which nothing is known more closely
BEARINGS = tuple(f"{rotor}_{place}" for rotor, place in product(NAMES, (*ENDS, AXIAL)))
LOAD, LIFE = "{}_bearing_equivalent_load", "{}_bearing_life"
LIFE_FIGURES = (*(name.format(each) for each in BEARINGS for name in (LOAD, LIFE)), SET_LIFE)
TITLE, NONE = "Rating lives of the bearings", "–"
LEFT_OUT = (
    "basic rating lives by ISO 281, times a life factor where the scene states one, without film, dirt, preload, "
    "weights, gears and belts; static loads are not checked (docs/how-to/bearings.md)"
)


class Life(NamedTuple):
    """A bearing, or all together: equivalent load [N] and life [s] at the own point; the shortest life, and where."""

    bearing: str
    load: float | None
    life: float | None
    shortest: float | None
    at: str


def lives(points: Sequence[tuple[str, Result]], own_counts: bool = True) -> list[Life]:
    """Return the lives of the bearings over points (name, result), of which the first is the own one.

    Its lives are not among the shortest unless it counts.
    """
    closed = [(name, result.performance) for name, result in points if result.status == "ok"]
    if not points or points[0][1].status != "ok":
        return []
    own, counted, found = closed[0][1], closed if own_counts else closed[1:], []
    for bearing, load, life in (
        *((each, LOAD.format(each), LIFE.format(each)) for each in BEARINGS),
        ("", "", SET_LIFE),
    ):
        if load in own or life in own:
            name = f"{bearing.replace('_', ' ')} bearing" if bearing else "all together"
            known = [(each[life], where) for where, each in counted if each.get(life) is not None]
            shortest, where = min(known, default=(None, ""))
            found.append(Life(name, own.get(load), own.get(life), shortest, where))
    return found


def lives_table(
    points: Sequence[tuple[str, Result]], own_counts: bool = True, title: str = TITLE, units: Units = METRIC
) -> Iterator[Table]:
    """Yield the table of the bearings, if the scene names any; without the shortest lives where there is one point."""
    found, several, (factor, unit) = lives(points, own_counts), len(points) > 1, units.force
    if not any(each.life is not None for each in found):
        return
    heads = ("bearing", f"load {unit}", "life h", *(("shortest h", "at") if several else ()))
    rows, decimals = [], 2 if units.force == METRIC.force else 0
    for each in found:
        load = NONE if each.load is None else f"{factor * each.load:.{decimals}f}"
        row = [each.bearing, load, _hours(each.life)]
        rows.append([*row, _hours(each.shortest), each.at] if several else row)
    yield Table(title, heads, rows, f"load: equivalent, life: at {points[0][0]}; {LEFT_OUT}", left=1, across=several)


def lives_document(points: Sequence[tuple[str, Result]], own_counts: bool = True) -> dict[str, Any]:
    """Return the lives for programs (SI units) under `bearings`; nothing where the scene names none."""
    found: list[Mapping[str, Any]] = [
        {
            "bearing": each.bearing,
            "equivalent_load": each.load,
            "life": each.life,
            "shortest_life": each.shortest,
            "shortest_at": each.at,
        }
        for each in lives(points, own_counts)
    ]
    return {"bearings": found} if found else {}


def _hours(life: float | None) -> str:
    return NONE if life is None else f"{float(f'{life / HOUR:.{DIGITS}g}'):.0f}"
