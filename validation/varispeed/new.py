"""New cylinders for rated reciprocating compressors, and what two of these call for: their reeds and their clearance.

    python validation/varispeed/new.py

Prints the mean difference of λ of the machines of others.csv at 50 Hz over the clearance, each machine counting alike:
where it is zero lies the clearance of src/screwsim/template/reciprocating.py. Then the spread of these differences over
all speeds, by natural frequency and damping of the reeds: where their mean over both machines is small and hardly
changes any more lie those of src/screwsim/template/valves.py. The third machine, 4CE-6.F1, has no part in either.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from statistics import pstdev
from typing import Any

from screwsim.scene import Scene, loads, value_at, with_values
from screwsim.study.validation import NotRun, sibling
from screwsim.template import new_scene, request_of, valves

HERE = Path(__file__).parent
points, shown = (sibling(HERE.parent / name) for name in ("varispeed/points.py", "hsk/compare.py"))

CONDITION = "-10/45 degC, 10 K"
WRITTEN = "efficiency_class: IE3, cooling: suction_gas}"
FULL_FIELD = 2566.5  # rpm at 87 Hz, as in machine.yaml
MOTOR = (
    "efficiency: 0.90, cooling: suction_gas, "
    "inverter: {{rated_speed: 1475 rpm, full_field_speed: {full:g} rpm, loss: {loss:g} W}}}}"
)
INVERTER_SHARE = 0.03  # of the rated power, lost in the inverter: assumed, as in machine.yaml
CLEARANCE, SHARE = "machine.clearance", 4.24  # % of the swept volume that is written
SHARES = (2.0, 3.0, 3.5, 4.0, SHARE, 4.5, 5.0)
FREQUENCIES, DAMPING_RATIOS = (6.5, 8.0, 10.0, 12.0, 14.0), (0.1, 0.2, 0.25, 0.3)


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
    return loads(text.replace(WRITTEN, MOTOR.format(full=FULL_FIELD, loss=INVERTER_SHARE * rated_power)))


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


@contextmanager
def reeds(frequencies: float, damping_ratio: float) -> Iterator[None]:
    """Let new cylinders have reeds of a natural frequency over that of the shaft, and of a damping ratio."""
    written = valves.FREQUENCIES, valves.DAMPING_RATIO
    valves.FREQUENCIES, valves.DAMPING_RATIO = frequencies, damping_ratio
    try:
        yield
    finally:
        valves.FREQUENCIES, valves.DAMPING_RATIO = written


def differences(ratings: Sequence[Any], figure: str = "volumetric_efficiency") -> list[float]:
    """Return ours less theirs [points] of a figure at all ratings of a machine."""
    found = shown.found(new(ratings[0].model, ratings[0].displacement), ratings)
    return [100.0 * (each.ours[figure] - each.theirs(figure)) for each in found]


def every() -> dict[str, list[Any]]:
    """Return the ratings of all three machines by model."""
    return others() | by_model(shown.rated.ratings(HERE, points.POLES))


def spreads(by_machine: Mapping[str, Sequence[Any]]) -> dict[str, float]:
    """Return the standard deviation [points] of ours less theirs of λ over all ratings of each machine."""
    return {model: pstdev(differences(ratings)) for model, ratings in by_machine.items()}


if __name__ == "__main__":
    for share in SHARES:
        print(f"clearance {share:g} %: λ {mean_difference(share):+.2f} points")
    for frequencies, damping_ratio in product(FREQUENCIES, DAMPING_RATIOS):
        with reeds(frequencies, damping_ratio):
            found = spreads(every())
        both = sum(found[model] for model in others()) / len(others())
        told = ", ".join(f"{model} {value:.1f}" for model, value in found.items())
        print(f"reeds of {frequencies:g} n, damping ratio {damping_ratio:g}: spread of λ {both:.2f} points ({told})")
