"""Power of a new machine with a slide valve at part load, beside the curves of 24 screw chillers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from screwsim.scene import loads
from screwsim.study.part_load import controls, part_load
from screwsim.study.validation import NotRun, Row, read_table
from screwsim.template import new_scene, request_of

CONTROL = "slide valve"
LOADS = (0.75, 0.5, 0.25)


def chillers(here: Path, load: float) -> list[float]:
    """Return the power over that at full load of each chiller that goes down to a load."""
    rows = [[float(row[name]) for name in ("least", "c0", "c1", "c2")] for row in read_table(here / "chillers.csv")]
    return [c_0 + load * (c_1 + load * c_2) for least, c_0, c_1, c_2 in rows if least <= load]


def slides(here: Path) -> Iterator[Row]:
    """Return the power of a new machine at each load over that at full load."""
    scene = loads(new_scene("refrigeration", request_of(slide=True)))
    control = next(each for each in controls(scene) if each.name == CONTROL)
    full, *steps = part_load(scene, control, loads=LOADS).steps
    found = dict(zip(LOADS, steps, strict=False))
    for load in LOADS:
        if load not in found:
            raise NotRun(f"new refrigeration --slide: its slide does not reach {100.0 * load:g} % of its load")
        step, every = found[load], chillers(here, load)
        share = step.result.performance.electrical_power / full.result.performance.electrical_power
        yield Row(
            f"refrigeration --slide, R134a, 0/40 °C, {100.0 * load:g} % load: electrical power over that at full load",
            100.0 * share * load / step.load,
            f"{100.0 * min(every):.0f} to {100.0 * max(every):.0f} %",
            "published",
            "no verdict",
            "%",
            note=f"{len(every)} chillers at held temperatures of their water, so that saturation pressures come closer",
        )
