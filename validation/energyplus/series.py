"""Series of rated reciprocating compressors on several fluids (fluids.csv), and new cylinders for their conditions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from CoolProp.CoolProp import PropsSI

from screwsim.outputs import Figures
from screwsim.scene import Scene, loads, with_values
from screwsim.simulate import simulate
from screwsim.study.validation import NotRun, Row, equal, read_table
from screwsim.template import new_scene, request_of

FIGURE = "electrical_isentropic_efficiency"
SUCTION, ZERO = 291.45, 273.15  # [K] suction gas of the ratings
CONDITIONS = ((-17.8, 30.0), (-17.8, 40.0), (-10.0, 30.0), (-10.0, 40.0), (-10.0, 48.9), (-6.7, 48.9), (0.0, 40.0))
WRITTEN, MOTOR = "efficiency_class: IE3", "efficiency: 0.90"  # of a cylinder; of the whole machine: IE3 at 6 kW
FITTED = "06D"  # series to which friction is fitted
ALONE = "Copelametic"  # series with a machine as large as the new cylinder, whose motor stays as it is written
FRICTION = ("effects.mechanical.fraction", "effects.mechanical.mean_effective_pressure")
TRIED = ((0.12, 0.0), (0.2, 0.0), (0.135, 0.28e5), (0.1, 0.4e5))  # as it was; more of that; as written; less share
FALLS = (("06D", "R507A"), ("06E", "R507A"), ("Discus", "R404A"))  # series on R134a, and the other fluid
WITHIN, CHANGE = 5.0, 2.0  # points, taken: of single machines; of what they change
Ratings = Sequence[Mapping[str, str]]


class Series(NamedTuple):
    """Rated machines of one series on one fluid."""

    fluid: str
    name: str

    @property
    def told(self) -> str:
        """What a row is named by."""
        return f"{self.fluid}, {self.name}"


class Rated(NamedTuple):
    """Both efficiencies [%] and the condition [degC]: ours, and those of each rated machine."""

    condition: tuple[float, float]
    figures: Figures
    theirs: Sequence[float]

    @property
    def difference(self) -> float:
        """Ours less the mean of theirs [points]."""
        return 100.0 * self.figures[FIGURE] - float(np.mean(self.theirs))


def efficiencies(table: Ratings, evaporating: float, condensing: float, fluid: str = "R404A") -> dict[str, float]:
    """Return that of the electrical power by the ratings, by model, at saturation temperatures [degC]."""
    x, y = evaporating, condensing
    terms = (1.0, x, x * x, y, y * y, x * y, x**3, y**3, x * x * y, x * y * y)
    values: dict[str, dict[str, float]] = {}
    for each in table:
        watts = sum(float(each[f"c{i}"]) * term for i, term in enumerate(terms))
        values.setdefault(each["model"], {})[each["figure"]] = watts
    low, high = (PropsSI("P", "T", T + ZERO, "Q", 1, fluid) for T in (evaporating, condensing))
    h, s = (PropsSI(name, "T", SUCTION, "P", low, fluid) for name in "HS")
    rise = PropsSI("H", "P", high, "S", s, fluid) - h
    cooling = h - PropsSI("H", "T", condensing + ZERO, "Q", 0, fluid)
    return {model: each["capacity"] / cooling * rise / each["power"] for model, each in values.items()}


def at(evaporating: float, condensing: float) -> dict[str, float]:
    """Return the paths [SI] of a condition."""
    return {
        "operation.evaporating_temperature": evaporating + ZERO,
        "operation.condensing_temperature": condensing + ZERO,
        "operation.superheat": SUCTION - evaporating - ZERO,
    }


def series_of(here: Path) -> dict[Series, Ratings]:
    """Return the rows of fluids.csv by series and fluid."""
    found: dict[Series, list[Mapping[str, str]]] = {}
    for row in read_table(here / "fluids.csv"):
        found.setdefault(Series(row["fluid"], row["series"]), []).append(row)
    return found


def new(series: Series) -> Scene:
    """Return a cylinder of 10 m³/h at 60 Hz as `screwsim new` writes it for -10/40 degC, but for its motor.

    That is as efficient as one for a whole machine of some cylinders, but where the series has one as small.
    """
    asked = request_of(fluid=series.fluid, displacement="10 m^3/h", speed="1750 rpm", condition="-10/40 degC, 28.3 K")
    text = new_scene("reciprocating", asked)
    if WRITTEN not in text:
        raise NotRun(f"the cylinder on {series.fluid} has no IE3 motor")
    return loads(text if series.name == ALONE else text.replace(WRITTEN, MOTOR))


def beside(series: Series, table: Ratings, friction: Sequence[float] | None = None) -> list[Rated]:
    """Return a new cylinder beside the ratings of a series at all conditions; with other friction where it is given."""
    scene, found = new(series), []
    if friction is not None:
        scene = with_values(scene, dict(zip(FRICTION, friction, strict=True)))
    for condition in CONDITIONS:
        result = simulate(with_values(scene, at(*condition)), trace=False)
        if result.status != "ok":
            raise NotRun(f"{series.told}, {condition}: {result.told}")
        theirs = [100.0 * each for each in efficiencies(table, *condition, series.fluid).values()]
        found.append(Rated(condition, result.performance, theirs))
    return found


def body(series: Series, model: str) -> str:
    """Return what of a model's name is the same on all fluids: those of Discus end in motor and oil."""
    return model[:4] if series.name == "Discus" else model


def fall(low: Series, high: Series, every: Mapping[Series, Ratings]) -> Row:
    """Return how much less efficient bodies that are rated on two fluids are on the first one, ours and theirs."""
    bodies, ours = [], []
    for series in (low, high):
        ours.append(np.array([100.0 * each.figures[FIGURE] for each in beside(series, every[series])]))
        found: dict[str, list[float]] = {}
        for condition in CONDITIONS:
            for model, value in efficiencies(every[series], *condition, series.fluid).items():
                found.setdefault(body(series, model), []).append(100.0 * value)
        bodies.append(found)
    both = sorted(set(bodies[0]) & set(bodies[1]))
    each_body = [float(np.mean(np.subtract(bodies[0][name], bodies[1][name]))) for name in both]
    quantity = f"{low.told} less {high.fluid}, {len(both)} bodies rated on both: electrical η_s"
    single = f"single bodies {min(each_body):+.1f} to {max(each_body):+.1f}: {', '.join(both)}"
    note = f"mean of {len(CONDITIONS)} points; {single}"
    own, theirs = float(np.mean(ours[0] - ours[1])), float(np.mean(each_body))
    kind = "calibrated" if low.name == FITTED else "published"
    return equal(quantity, own, theirs, CHANGE, kind, unit="points", basis="2 points, taken", note=note)


def rows(here: Path) -> Iterator[Row]:
    """Yield by series the largest difference of new cylinders from the mean of the ratings, then other friction."""
    every = series_of(here)
    rated_before = {Series("R404A", "Discus"): read_table(here / "reciprocating.csv")}
    for name, fluid in FALLS:
        yield fall(Series("R134a", name), Series(fluid, name), every | rated_before)
    for series, table in every.items():
        found = beside(series, table)
        off = [each.difference for each in found]
        means = [float(np.mean(each.theirs)) for each in found]
        apart = max(float(np.ptp(each.theirs)) for each in found)
        quantity = (
            f"{series.told}, mean of {len(found[0].theirs)}: electrical η_s, largest difference of {len(off)} points"
        )
        note = (
            f"mean {np.mean(off):+.1f}, from {min(off):+.1f} to {max(off):+.1f}; theirs {min(means):.1f} to "
            f"{max(means):.1f} %, up to {apart:.1f} points apart"
        )
        kind = "calibrated" if series.name == FITTED else "published"
        yield equal(quantity, max(off, key=abs), 0.0, WITHIN, kind, unit="points", basis="5 points, taken", note=note)
    for friction in TRIED:
        parts = []
        for series, table in every.items():
            off = [each.difference for each in beside(series, table, friction)]
            parts.append(f"{series.told}: {np.mean(off):+.1f}/{np.sqrt(np.mean(np.square(off))):.1f}")
        share, pressure = 100.0 * friction[0], 1e-5 * friction[1]
        name = f"tried: friction of {share:g} % of the indicated power and {pressure:g} bar: mean/rms of η_s in points"
        yield Row(name, "; ".join(parts), None, "estimate", "no verdict")
