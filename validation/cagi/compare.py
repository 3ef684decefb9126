"""Specific power over flow of a variable-speed air package, and its least efficiency by regulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, pi
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

from screwsim.outputs import Figures
from screwsim.scene import Scene, load, with_values
from screwsim.scene.lines import lines
from screwsim.simulate import simulate_many
from screwsim.study.validation import Comparison, NotRun, Panel, Row, Series, equal, read_table

TITLE = "A variable-speed air package: specific power over flow"
CITATION = (
    "Atlas Copco GA110VSDs-8.6, data sheet in the form of CAGI, 2025, read second-hand; "
    "least efficiency: 10 CFR 431.345, table 1"
)
ABOUT = (
    "The sheet gives power over flow, no geometry and no speeds: compared is the shape of the curve, each point at the "
    "speed that gives its flow. The machine (machine.yaml) takes gaps, shaft leak, friction and ports of one fitted to "
    "another gas and size and is made larger as a whole: its rows are predictions. With the leaks chosen by hand at "
    "the sheet (close.yaml) the rows are calibrated: they show that the model can have the shape, no more. Taken, not "
    "known: a package that loses 0.5 bar at full flow, with the square of the flow (separator element, least-pressure "
    "valve, aftercooler; a usual size, chosen with the sheet at hand), and a fan whose power follows the rest, so that "
    "it falls out of the shape. Estimates say what both mean."
)
RPM, CFM = 2.0 * pi / 60.0, 0.3048**3 / 60.0  # rad/s, m^3/s
SPEEDS = np.geomspace(700.0, 3900.0, 9)  # rpm
LOSS = 0.5e5  # Pa, of the package at full flow
FAN = 5.9 * 745.7  # W, nominal
SHAPE, SIZE = 0.02, 0.10  # tolerances: of what is relative to full flow, and of the specific power itself
K = 1.4  # of air, as ISO 1217 has it
SHAFTS = {"effects.shaft_leakage.area": 9e-6}  # m^2, of the smaller machine
GAPS = {f"effects.{gap}_leakage.gap": 25e-6 for gap in ("tip", "interlobe", "end_face")}  # m, of the smaller machine
NAMES = ("predicted", "leaks chosen by the sheet")
UNIT = 1e3 / (100.0 * CFM)  # J/m^3 of 1 kW/100 cfm
SHAPE_BASIS = "2 %: taken, the sheet gives none; it prints the specific power to 0.3 %"
SIZE_BASIS = "10 %: size, speed, ports and motor are ours; the fan at its nominal power"


@dataclass(frozen=True)
class Curve:
    """A package over its speeds: flow [m³/s] at suction, electrical power [W] without fan, volumetric efficiency."""

    flow: Sequence[float]
    power: Sequence[float]
    filled: Sequence[float]

    def at(self, values: Sequence[float], flow: float) -> float:
        """Return what `values` of the curve are at a flow [m³/s]. Raises NotRun outside it."""
        if not self.flow[0] <= flow <= self.flow[-1]:
            raise NotRun(f"no speed of the sweep gives {flow / CFM:.0f} cfm")
        return float(PchipInterpolator(self.flow, values)(flow))

    def specific(self, flow: float, fan: float = 0.0) -> float:
        """Return electrical power and a fan's [W] over the flow [J/m³]."""
        return (self.at(self.power, flow) + fan) / flow

    def relative(self, flow: float, full: float, fan: float = 0.0) -> float:
        """Return the specific power over that at full flow, the fan [W] at constant speed."""
        return self.specific(flow, fan) / self.specific(full, fan)


def swept(scene_file: Path, full: float, loss: float = LOSS, values: dict[str, float] | None = None) -> Curve:
    """Return the curve of a machine whose package loses `loss` [Pa] at the full flow [m³/s], with the flow's square.

    The loss follows the flow, which is found first at the pressure of the scene and then with the loss that this has.
    """
    scene = with_values(load(scene_file, ["numerics.error=none"]), values or {})
    without = _figures(scene, np.zeros(len(SPEEDS)))
    found = _figures(scene, loss * (_flow(without) / full) ** 2)
    power, filled = ([each[name] for each in found] for name in ("electrical_power", "volumetric_efficiency"))
    return Curve(_flow(found).tolist(), power, filled)


def _figures(scene: Scene, losses: np.ndarray) -> list[Figures]:
    """Return the figures at all speeds, the discharge pressure higher by `losses` [Pa]."""
    line, points = lines(scene).p_d, []
    for n, lost in zip(SPEEDS, losses, strict=True):
        values = {"operation.speed": n * RPM, "operation.discharge.pressure": line + float(lost)}
        points.append(with_values(scene, values))
    found = list(simulate_many(points, trace=False))
    for result in found:
        if result.status != "ok":
            raise NotRun(f"{scene.title}: {result.told}")
    return [result.performance for result in found]


def _flow(figures: Sequence[Figures]) -> np.ndarray:
    """Return the flows at suction [m³/s]."""
    return np.array([each.volumetric_efficiency * each.displacement_flow for each in figures])


def isentropic_power(flow: float, suction: float, discharge: float) -> float:
    """Return the power [W] of isentropic compression of a flow at suction [m³/s] between pressures [Pa] (ISO 1217)."""
    return K / (K - 1.0) * suction * flow * ((discharge / suction) ** ((K - 1.0) / K) - 1.0)


def least_efficiency(flow: float, regulation: dict[str, str]) -> float:
    """Return the least package isentropic efficiency at a full-load flow [m³/s] (10 CFR 431.345)."""
    square, linear, constant, d = (float(regulation[name]) for name in ("square", "linear", "constant", "d"))
    L = log(1000.0 * flow)
    regression = square * L**2 + linear * L + constant
    return regression + (1.0 - regression) * d / 100.0


def shape_rows(name: str, curve: Curve, sheet: Curve, kind: str) -> list[Row]:
    """Return the specific power relative to that at full flow, at each lower flow of the sheet."""
    full, rows = sheet.flow[-1], []
    for flow in reversed(sheet.flow[:-1]):
        ours, theirs = (each.relative(flow, full) for each in (curve, sheet))
        quantity = f"{name}: specific power at {flow / CFM:.0f} cfm over that at full flow"
        note = f"{100.0 * (ours / theirs - 1.0):+.1f} %"
        rows.append(equal(quantity, ours, theirs, SHAPE * theirs, kind, basis=SHAPE_BASIS, note=note))
    return rows


def size_row(name: str, curve: Curve, sheet: Curve, kind: str) -> Row:
    """Return the specific package power at full flow, the fan with it."""
    full = sheet.flow[-1]
    ours, theirs = curve.specific(full, FAN) / UNIT, sheet.specific(full) / UNIT
    quantity = f"{name}: specific package power at full flow"
    note = f"{100.0 * (ours / theirs - 1.0):+.1f} %"
    return equal(quantity, ours, theirs, SIZE * theirs, kind, unit="kW/100 cfm", basis=SIZE_BASIS, note=note)


def regulation_row(name: str, curve: Curve, sheet: Curve, pressures: tuple[float, float], least: float) -> Row:
    """Return the package isentropic efficiency at full flow, between what is sold and what is possible."""
    full, (suction, discharge) = sheet.flow[-1], pressures
    ideal = isentropic_power(full, suction, discharge)
    isothermal = suction * full * log(discharge / suction)
    ours, theirs = ideal / (curve.at(curve.power, full) + FAN), ideal / sheet.at(sheet.power, full)
    return Row(
        f"{name}: package isentropic efficiency at full flow",
        100.0 * ours,
        f"at least {100.0 * least:.1f} %",
        "estimate",
        "holds" if least <= ours <= ideal / isothermal else "fails",
        unit="%",
        basis="a plausibility: what may be sold, and no more than isothermal compression without a loss gives, "
        f"{100.0 * ideal / isothermal:.0f} %",
        note=f"ISO 1217, to the package's outlet, with the fan; the sheet's own is {100.0 * theirs:.1f} %; "
        "the regulation holds variable speed to a part-load efficiency, of which full flow is one load",
    )


def estimate_rows(here: Path, curves: dict[str, Curve], sheet: Curve) -> list[Row]:
    """Return what is taken and not known, by what it does at the lowest flow."""
    low, full = sheet.flow[0], sheet.flow[-1]
    file, own, theirs = here / "machine.yaml", curves["predicted"], sheet.relative(low, full)
    shafts, all_leaks = (swept(file, full, values=each) for each in (SHAFTS, {**SHAFTS, **GAPS}))
    grown = "what the rule of scale decides; at full flow"
    told = (
        ("predicted, a fan at constant speed", own.relative(low, full, FAN), "its control is not given"),
        ("predicted, a package that loses nothing", swept(file, full, 0.0).relative(low, full), "0 bar, not 0.5 bar"),
        (
            "predicted, shaft leak of the smaller machine",
            shafts.relative(low, full),
            f"9 mm², not 20.25 mm²: {grown} {shafts.specific(full, FAN) / UNIT:.1f} kW/100 cfm",
        ),
        (
            "predicted, shaft leak and gaps of the smaller machine",
            all_leaks.relative(low, full),
            f"25 µm as well, not 37.5 µm: {grown} {all_leaks.specific(full, FAN) / UNIT:.1f} kW/100 cfm",
        ),
        (f"{NAMES[1]}, gaps dry", curves["dry"].relative(low, full), "gaps as nozzles without oil (M12)"),
    )
    rows = [
        Row(
            f"{name}: specific power at {low / CFM:.0f} cfm over that at full flow",
            ours,
            theirs,
            "estimate",
            "no verdict",
            note=f"{100.0 * (ours / theirs - 1.0):+.1f} %; {note}",
        )
        for name, ours, note in told
    ]
    for name, key in zip(NAMES, ("predicted", "close"), strict=True):
        filled = 100.0 * curves[key].at(curves[key].filled, low)
        quantity = f"{name}: volumetric efficiency at {low / CFM:.0f} cfm"
        rows.append(Row(quantity, filled, None, "estimate", "no verdict", unit="%"))
    return rows


def read_sheet(here: Path) -> Curve:
    """Return the sheet as a curve, from its lowest flow on."""
    table = read_table(here / "sheet.csv")[::-1]
    flow, power = ([float(row[name]) for row in table] for name in ("flow_acfm", "power_kW"))
    return Curve([CFM * each for each in flow], [1e3 * each for each in power], [float("nan")] * len(flow))


def compare(here: Path) -> Comparison:
    """Return the shape of the curve, its size, and the plausibility of its efficiency."""
    sheet = read_sheet(here)
    full = sheet.flow[-1]
    curves = {
        name: swept(here / file, full)
        for name, file in (("predicted", "machine.yaml"), ("close", "close.yaml"), ("dry", "dry.yaml"))
    }
    between = lines(load(here / "machine.yaml"))
    pressures = between.p_s, between.p_d
    least = least_efficiency(full, read_table(here / "regulation.csv")[0])
    rows: list[Row] = []
    for name, key, kind in ((NAMES[0], "predicted", "published"), (NAMES[1], "close", "calibrated")):
        rows += shape_rows(name, curves[key], sheet, kind)
        rows.append(size_row(name, curves[key], sheet, kind))
        rows.append(regulation_row(name, curves[key], sheet, pressures, least))
    rows += estimate_rows(here, curves, sheet)
    grid = np.linspace(sheet.flow[0], full, 41)
    share = (grid / full).tolist()
    drawn = [
        Series(name, share, [curves[key].relative(flow, full) for flow in grid])
        for name, key in ((NAMES[0], "predicted"), (NAMES[1], "close"), ("the same, gaps dry", "dry"))
    ]
    marks = [sheet.relative(flow, full) for flow in sheet.flow]
    theirs = Series("data sheet", [flow / full for flow in sheet.flow], marks, theirs=True, error=SHAPE)
    panel = Panel("flow over full flow", "specific power over that at full flow", (*drawn, theirs))
    return Comparison(TITLE, CITATION, ABOUT, rows, (panel,))
