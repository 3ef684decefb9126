"""Measured trends of a variable-speed oil-injected screw over speed and oil flow: signs, and saturation."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from pathlib import Path

import numpy as np

from screwsim.outputs import Figures
from screwsim.scene import load
from screwsim.study.validation import Comparison, NotRun, Panel, Row, Series, sibling, solved, trend

TRIED: dict[str, tuple[str, ...]] = sibling(Path(__file__).parent / "physics.py").TRIED

TITLE = "He et al. 2018: trends over speed and oil flow"
CITATION = "He et al., Energies 11 (2018) 1342, abstract: 1000 to 3000 rpm, oil 27 to 50 L/min"
ABOUT = """\
The source's machine is not known to us: an air compressor of common size stands in for it, and only signs are compared.
Gaps and shafts are those of the machine fitted to Bitzer's curves, sealed by the same rule. Saturation means: from 50
to 75 L/min by no more than half a point of efficiency, or per litre a minute by less than half of what 27 to 50 L/min
change. Rows 'tried' change the machine and say why its volumetric efficiency once fell with the oil flow (27, 35, 42
and 50 L/min):

- The oil comes 30 K warmer than the gas and warms it and what leaks back. Oil as cold as the gas turns the sign even
  with dry gaps.
- Against that stands what oil seals: too little in the gaps between chambers alone, whatever the mixture's viscosity;
  enough with a leak past the shafts, which sees the discharge pressure all the time.
- Where the oil comes in moves two points and no sign.
- Friction is as it stood, 5 % and Giuffrida's viscous term. With films and bearings by the laws and clearances of
  validation/cagi, at the stated 30 mPa s, the adiabatic efficiency has its best at 1500 rpm and does not rise to 3000:
  films full of oil as thick as that are too much here."""
RPM, LITRES = 2.0 * pi / 60.0, 1e-3 / 60.0
SPEEDS, FLOWS = (1000.0, 1500.0, 2000.0, 2500.0, 3000.0), (27.0, 35.0, 42.0, 50.0, 62.0, 75.0)
NAMES = ("volumetric_efficiency", "isentropic_efficiency", "specific_power", "discharge_temperature")
SHOWN = {
    "volumetric_efficiency": ("volumetric efficiency", "%", 100.0),
    "isentropic_efficiency": ("adiabatic efficiency", "%", 100.0),
    "specific_power": ("specific power", "kW/(m³/min)", 1.0 / 6e4),
    "discharge_temperature": ("discharge temperature", "K", 1.0),
}
HARDLY = 0.5  # points
FREE = ("effects.hydromechanical.acceleration_factor=0", "effects.oil_pump=off")
FIRST_RATIO = 640.0  # oil ratio times speed [rpm] over oil flow [L/min]: where the search for the ratio begins
RISES = {"volumetric_efficiency": 1.0, "isentropic_efficiency": 1.0, "specific_power": -1.0}


def at(scene_file: Path, speed: float, flow: float, changes: Sequence[str] = ()) -> Figures:
    """Return the figures at a speed [rpm] and an oil flow [L/min]; the oil ratio is what gives that flow."""
    density, ratio = load(scene_file).oil.density, FIRST_RATIO * flow / speed
    for _ in range(12):
        values = {"operation.speed": speed * RPM, "oil_supply.ratio": ratio}
        found = solved(scene_file, changes, values).performance
        miss = flow * LITRES * density / found.oil_mass_flow
        if abs(miss - 1.0) < 1e-4:
            return found
        ratio *= miss
    raise NotRun(f"no oil ratio gives {flow:g} L/min at {speed:g} rpm")


def sign_row(name: str, over: str, values: Sequence[float], sign: float, source: str) -> Row:
    """Return the row of a monotonic trend."""
    text, unit, factor = SHOWN[name]
    holds = bool(np.all(np.sign(np.diff(values)) == sign))
    listed = ", ".join(f"{factor * value:.4g}" for value in values)
    return trend(f"{text} over {over}", f"{course(values)}: {listed} {unit}", source, holds)


def course(values: Sequence[float]) -> str:
    """Return in a word how values go."""
    steps = np.diff(values)
    return "rises" if np.all(steps > 0) else "falls" if np.all(steps < 0) else "rises and falls"


def tried_row(scene_file: Path, name: str, changes: Sequence[str]) -> Row:
    """Return volumetric efficiency over oil flow, and how the adiabatic one goes over speed, of a changed machine."""
    flows = FLOWS[: FLOWS.index(50.0) + 1]
    filled = [at(scene_file, 2000.0, flow, changes).volumetric_efficiency for flow in flows]
    efficient = [at(scene_file, speed, 50.0, changes).isentropic_efficiency for speed in SPEEDS]
    listed = ", ".join(f"{100.0 * value:.2f}" for value in filled)
    ours = f"{course(filled)} over oil: {listed} %; adiabatic over speed: {course(efficient)}"
    return Row(f"tried: {name}", ours, "rises; rises", "estimate", "no verdict")


def saturation_row(name: str, values: Sequence[float], note: str = "") -> Row:
    """Return whether the change per litre above 50 L/min is less than half of that below."""
    below = (values[FLOWS.index(50.0)] - values[0]) / (50.0 - FLOWS[0])
    above = (values[-1] - values[FLOWS.index(50.0)]) / (FLOWS[-1] - 50.0)
    share, change = abs(above / below), SHOWN[name][2] * (values[-1] - values[FLOWS.index(50.0)])
    flat = name.endswith("efficiency") and abs(change) <= HARDLY
    unit = SHOWN[name][1].replace("%", "points")
    found = f"{change:+.2f} {unit}, {share:.0%} of the change per litre below"
    return trend(f"{SHOWN[name][0]} from 50 to 75 L/min", found, "hardly changes", flat or share < 0.5, note=note)


def without_its_power(scene_file: Path) -> str:
    """Return what the adiabatic efficiency does from 50 to 75 L/min where oil is lifted and accelerated for nothing."""
    few, many = (at(scene_file, 2000.0, flow, FREE).isentropic_efficiency for flow in FLOWS[-3::2])
    return f"{100.0 * (many - few):+.2f} points without the power that lifts the oil and brings it to speed"


def compare(here: Path) -> Comparison:
    """Return signs over speed (at 50 L/min) and over oil flow (at 2000 rpm)."""
    file = here / "machine.yaml"
    by_speed = [at(file, speed, 50.0) for speed in SPEEDS]
    by_flow = [at(file, 2000.0, flow) for flow in FLOWS]
    of_speed = {name: [each[name] for each in by_speed] for name in NAMES}
    of_flow = {name: [each[name] for each in by_flow] for name in NAMES}
    rows = [
        sign_row(name, "speed, 1000 to 3000 rpm", of_speed[name], sign, "rises" if sign > 0 else "falls")
        for name, sign in RISES.items()
    ]
    last = FLOWS.index(50.0) + 1
    for name, sign in (("volumetric_efficiency", 1.0), ("isentropic_efficiency", 1.0), ("discharge_temperature", -1.0)):
        over = "oil flow, 27 to 50 L/min"
        rows.append(sign_row(name, over, of_flow[name][:last], sign, "rises" if sign > 0 else "falls"))
    notes = {"isentropic_efficiency": without_its_power(file)}
    rows += [saturation_row(name, of_flow[name], notes.get(name, "")) for name in NAMES if name != "specific_power"]
    rows += [tried_row(file, name, changes) for name, changes in TRIED.items()]
    panels = [
        Panel(label, "efficiency / %", [Series(SHOWN[n][0], x, [100.0 * v for v in data[n]]) for n in NAMES[:2]])
        for label, x, data in (
            ("speed / rpm, at 50 L/min", SPEEDS, of_speed),
            ("oil flow / (L/min), at 2000 rpm", FLOWS, of_flow),
        )
    ]
    return Comparison(TITLE, CITATION, ABOUT, rows, panels)
