"""Simulators that take no time, for fits, and the files of a fit."""

import math
from pathlib import Path

from result_fakes import SCENE

from screwsim.outputs import Figures, Result
from screwsim.scene import Scene

GAP, CAPACITY = "effects.tip_leakage.gap", "oil.heat_capacity"
FIT = """\
title: two unknowns
scene: machine.yaml
data: points.csv
parameters:
  effects.tip_leakage.gap: {from: 10 um, to: 100 um}
  oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K), start: 1.5 kJ/(kg K)}
starts: 3
"""
HEAD = "name,use,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n"
POINTS = f"""\
# made up
{HEAD}a,fit,1000,3.1,0.1
b,fit,2000,5.2,0.1
c,fit,3000,6.8,0.2
d,check,4000,9,0.1
"""
ONE_START = """\
scene: machine.yaml
data: points.csv
parameters:
  effects.tip_leakage.gap: {from: 10 um, to: 100 um}
  oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K)}
starts: 1
"""
DEGENERATE = """\
parameters:
  effects.tip_leakage.gap: {from: 10 um, to: 100 um, spacing: log}
  oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K), spacing: log}
"""


def write_fit(folder: Path, fit: str = FIT, points: str = POINTS, scene: str = SCENE) -> Path:
    """Write the three files of a fit and return the path of the first."""
    for name, text in (("machine.yaml", scene), ("points.csv", points), ("small.fit.yaml", fit)):
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "small.fit.yaml"


def coordinates(scene: Scene) -> tuple[float, float, float]:
    """Return gap [10 µm], heat capacity [kJ/(kg K)] and speed [1000 rpm]."""
    gap = scene.effects["tip_leakage"].parameters.gap * 1e5
    return gap, scene.oil.heat_capacity / 1e3, scene.operation.speed * 30.0 / math.pi / 1e3


def plane(scene: Scene) -> Result:
    """Return a shaft power [W] that is linear in both unknowns: gap + capacity · speed, in kW."""
    gap, capacity, speed = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * (gap + capacity * speed)))


def product(scene: Scene) -> Result:
    """Return a power in which the unknowns enter as their product alone."""
    gap, capacity, speed = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * gap * capacity * speed))


def torn(scene: Scene) -> Result:
    """Fail above a gap of 50 µm and at 3000 rpm and more."""
    gap, _, speed = coordinates(scene)
    if gap > 5.0 or speed > 2.5:
        return Result("failed", message="pressure left the range (choose a smaller gap)")
    return plane(scene)


def hopeless(scene: Scene) -> Result:
    """Fail always."""
    return Result("failed", message="pressure left the range")


class Stopped:
    """Be interrupted at the fortieth solution."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, scene: Scene) -> Result:
        self.count += 1
        if self.count == 40:
            raise KeyboardInterrupt
        return plane(scene)
