"""New cylinders for rated reciprocating compressors, and the clearance that two of these call for at 50 Hz.

    python validation/varispeed/new.py

Prints the mean difference of λ of the machines of others.csv over the clearance, each machine counting alike, and where
it is zero: the clearance of src/screwsim/template/reciprocating.py; then the spread of these differences over all
speeds with other damping of the reeds, of the third machine as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import pstdev
from typing import Any

from screwsim.scene import Scene, loads, value_at, with_values
from screwsim.study.validation import NotRun, sibling
from screwsim.template import new_scene, request_of

HERE = Path(__file__).parent
points, shown = (sibling(HERE.parent / name) for name in ("varispeed/points.py", "hsk/compare.py"))

CONDITION = "-10/45 degC, 10 K"
WRITTEN = "efficiency_class: IE3, cooling: suction_gas}"
MOTOR = "efficiency: 0.90, cooling: suction_gas, inverter: {{rated_speed: 1475 rpm, loss: {loss:g} W}}}}"
INVERTER_SHARE = 0.03  # of the rated power, lost in the inverter: assumed, as in machine.yaml
CLEARANCE, SHARE = "machine.clearance", 4.0  # % of the swept volume that is written
SHARES = (2.0, 3.0, 3.5, 4.0, 4.5, 5.0)


def new(model: str, displacement: str) -> Scene:
    """Return the cylinder that `screwsim new` writes for a machine of a displacement [m³/h], on an inverter.

    The number of cylinders is the first digit of the model's name. The motor is as efficient as one for the whole
    machine.
    """
    flow = float(displacement) / int(model[0])
    asked = request_of(fluid=shown.rated.FLUID, displacement=f"{flow:g} m^3/h", speed="1450 rpm", condition=CONDITION)
    text = new_scene("reciprocating", asked)
    if WRITTEN not in text:
        raise NotRun(f"the cylinder of {flow:g} m^3/h has no IE3 motor in the suction gas")
    rated_power = value_at(loads(text), "effects.motor.rated_power")
    return loads(text.replace(WRITTEN, MOTOR.format(loss=INVERTER_SHARE * rated_power)))


def by_model(ratings: Sequence[Any]) -> dict[str, list[Any]]:
    """Return ratings by model."""
    found: dict[str, list[Any]] = {}
    for one in ratings:
        found.setdefault(one.model, []).append(one)
    return found


def others() -> dict[str, list[Any]]:
    """Return the ratings of the other machines by model."""
    return by_model(shown.rated.ratings(HERE, points.POLES, "others.csv"))


def mean_difference(share: float) -> float:
    """Return ours less theirs [points] of λ at 50 Hz for a clearance [%], the mean of each machine's mean."""
    means = []
    for model, ratings in others().items():
        scene = new(model, ratings[0].displacement)
        written = value_at(scene, CLEARANCE)
        full = [one for one in ratings if one.frequency == shown.FULL]
        scene = with_values(scene, {CLEARANCE: written * share / SHARE})
        found = shown.found(scene, full)
        off = [each.ours["volumetric_efficiency"] - each.theirs("volumetric_efficiency") for each in found]
        means.append(100.0 * sum(off) / len(off))
    return sum(means) / len(means)


def spread(model: str, ratings: Sequence[Any], damping: float) -> float:
    """Return the standard deviation [points] of ours less theirs of λ over all ratings of a machine."""
    scene = with_values(new(model, ratings[0].displacement), {"effects.reed_valves.damping_ratio": damping})
    found = shown.found(scene, ratings)
    return 100.0 * pstdev(each.ours["volumetric_efficiency"] - each.theirs("volumetric_efficiency") for each in found)


if __name__ == "__main__":
    for share in SHARES:
        print(f"clearance {share:g} %: λ {mean_difference(share):+.2f} points")
    every = others() | by_model(shown.rated.ratings(HERE, points.POLES))
    for damping in (0.1, 0.2, 0.3):
        told = ", ".join(f"{model} {spread(model, ratings, damping):.1f}" for model, ratings in every.items())
        print(f"damping ratio {damping:g}: spread of λ {told} points")
