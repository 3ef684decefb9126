"""A cylinder on CO2 beside nine rated compressors, below and above the critical pressure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from CoolProp.CoolProp import PropsSI

from screwsim.outputs import Figures
from screwsim.scene import loads
from screwsim.simulate import simulate
from screwsim.study.validation import Comparison, NotRun, Panel, Row, Series, equal, read_table, solved
from screwsim.template import new_scene, request_of

TITLE = "Rated reciprocating compressors on CO2: efficiency, and flow and power over the pressures"
CITATION = "EnergyPlus, RefrigerationCompressorCurves.idf: ratings of nine semi-hermetic compressors of Bitzer, R744"
ABOUT = """\
The cylinder is that of configs/co2/transcritical.yaml with a motor in its suction gas (machine.yaml). Nothing of it is
fitted to these ratings, and it is none of the nine, of which neither bore nor speed nor frequency is stated. So flows
and powers are compared as shares of those at one condition, and a difference is that of another machine as much as one
of the model. How to read the rows:

- Conditions above 20 °C are left out: there the source's cubics cannot follow the enthalpy of the liquid.
- At 75 bar the source's nominal ratings have capacity and power. At higher pressures its cubic of the power alone is
  taken, which its nominal values confirm within 1 %.
- The last row of efficiencies is a machine as `screwsim new reciprocating --fluid CO2` writes it, with friction fitted
  on R134a and R507A (validation/energyplus).

What was found: the cylinder's efficiency lies in or below the range of the nine at the lower pressure ratios. Its
volumetric efficiency falls less with the pressure ratio than theirs: they have more clearance, leaks or heat of the
suction gas than it assumes."""
FLUID, ZERO, SUPERHEAT = "CO2", 273.15, 10.0
CONDITIONS = tuple((x, y) for x in (-20.0, -10.0, -5.0) for y in (10.0, 15.0, 20.0))  # °C
REFERENCE = (-5.0, 15.0)  # °C: flows and powers are relative to theirs
HOT = tuple((x, p) for x in (-10.0, -5.0) for p in (75e5, 90e5, 100e5))  # °C and Pa
NOMINAL, BEHIND = (-5.0, 75e5), 25.0  # °C and Pa; °C behind the gas cooler
WITHIN, SHARE = 5.0, 0.05
ENDS = (("least", min), ("most", max))
NEW = (-10.0, 15.0)  # °C


class Curves(NamedTuple):
    """The cubics of one compressor by figure and range, and its nominal capacity and power [W] at 75 bar."""

    cubics: Mapping[tuple[str, str], Sequence[float]]
    capacity: float
    power: float

    def at(self, figure: str, reach: str, x: float, y: float) -> float:
        """Return a figure [W] at a suction temperature [degC] and a discharge temperature [degC] or pressure [Pa]."""
        terms = (1.0, x, x * x, y, y * y, x * y, x**3, y**3, x * x * y, x * y * y)
        return sum(c * term for c, term in zip(self.cubics[figure, reach], terms, strict=True))


class Gas(NamedTuple):
    """State of the suction gas, and what an isentropic compression to a pressure takes."""

    enthalpy: float  # [J/kg]
    density: float  # [kg/m³]
    rise: float  # [J/kg]


def compressors(here: Path) -> dict[str, Curves]:
    """Return the rated compressors by their model."""
    cubics: dict[str, dict[tuple[str, str], list[float]]] = {}
    for row in read_table(here / "curves.csv"):
        cubics.setdefault(row["model"], {})[row["figure"], row["range"]] = [float(row[f"c{i}"]) for i in range(10)]
    return {
        row["model"]: Curves(cubics[row["model"]], 1e3 * float(row["capacity_kW"]), 1e3 * float(row["power_kW"]))
        for row in read_table(here / "nominal.csv")
    }


def gas(x: float, high: float) -> Gas:
    """Return the suction gas at a saturation temperature [degC] and its compression to a pressure [Pa]."""
    low, T = PropsSI("P", "T", x + ZERO, "Q", 1, FLUID), x + ZERO + SUPERHEAT
    h, s, rho = (PropsSI(name, "P", low, "T", T, FLUID) for name in "HSD")
    return Gas(h, rho, PropsSI("H", "P", high, "S", s, FLUID) - h)


def rated(one: Curves, x: float, y: float) -> tuple[float, float]:
    """Return electrical isentropic efficiency and volume flow [m³/s] of the suction gas below the critical pressure."""
    suction = gas(x, PropsSI("P", "T", y + ZERO, "Q", 1, FLUID))
    mdot = one.at("capacity", "subcritical", x, y) / (suction.enthalpy - PropsSI("H", "T", y + ZERO, "Q", 0, FLUID))
    return mdot * suction.rise / one.at("power", "subcritical", x, y), mdot / suction.density


def nominal(one: Curves) -> tuple[float, float]:
    """Return the same at 75 bar, from the nominal rating."""
    suction = gas(*NOMINAL)
    mdot = one.capacity / (suction.enthalpy - PropsSI("H", "T", BEHIND + ZERO, "P", NOMINAL[1], FLUID))
    return mdot * suction.rise / one.power, mdot / suction.density


def ours(here: Path, x: float, y: float) -> Figures:
    """Return the figures of the cylinder at saturation temperatures [degC]."""
    values = {"operation.evaporating_temperature": x + ZERO, "operation.condensing_temperature": y + ZERO}
    return solved(here / "machine.yaml", values=values).performance


def hot(here: Path, x: float, pressure: float) -> Figures:
    """Return the figures at a pressure of the gas cooler [Pa]."""
    overrides = [
        f"operation.evaporating_temperature={x:g} degC",
        "operation.condensing_temperature=null",
        "operation.subcooling=null",
        f"operation.gas_cooler={{pressure: {1e-5 * pressure:g} bar, outlet_temperature: {BEHIND:g} degC}}",
    ]
    return solved(here / "machine.yaml", overrides).performance


def written(x: float, y: float) -> Figures:
    """Return the figures of a machine that `screwsim new` writes for saturation temperatures [degC]."""
    condition = f"{x:g}/{y:g} degC, {SUPERHEAT:g} K"
    result = simulate(loads(new_scene("reciprocating", request_of(fluid=FLUID, condition=condition))), trace=False)
    if result.status != "ok":
        raise NotRun(f"new reciprocating on {FLUID}: {result.told}")
    return result.performance


def efficiency_row(name: str, found: Figures, theirs: Sequence[float]) -> Row:
    """Return our electrical isentropic efficiency beside the mean of theirs."""
    percent = 100.0 * np.array(theirs)
    basis = "half the spread of the nine, and 5 points, taken"
    note = f"the nine: {percent.min():.1f} to {percent.max():.1f}"
    within = 0.5 * float(np.ptp(percent)) + WITHIN
    own, mean = 100.0 * found.electrical_isentropic_efficiency, float(percent.mean())
    return equal(f"{name}: electrical η_s", own, mean, within, "published", unit="%", basis=basis, note=note)


def share_row(name: str, found: float, theirs: Sequence[float]) -> Row:
    """Return our ratio to the reference beside the mean of theirs."""
    basis = "5 %, taken: a cubic's own error"
    note = f"the nine: {min(theirs):.3f} to {max(theirs):.3f}"
    mean = float(np.mean(theirs))
    return equal(f"{name}, over that at -5/15 °C", found, mean, SHARE * mean, "published", basis=basis, note=note)


def rows(here: Path, every: Sequence[Curves], found: Mapping[tuple[float, float], Figures]) -> Iterator[Row]:
    """Yield efficiencies, then volumetric efficiencies and powers as shares of those at one condition."""
    at_reference = found[REFERENCE]
    own_flow, own_power = at_reference.volumetric_efficiency, at_reference["electrical_power"]
    flows = [rated(one, *REFERENCE)[1] for one in every]
    powers = [one.at("power", "subcritical", *REFERENCE) for one in every]
    for at, each in found.items():
        yield efficiency_row(f"{at[0]:g}/{at[1]:g} °C", each, [rated(one, *at)[0] for one in every])
    warm = hot(here, *NOMINAL)
    yield efficiency_row(f"{NOMINAL[0]:g} °C, 75 bar", warm, [nominal(one)[0] for one in every])
    yield efficiency_row(f"new, {NEW[0]:g}/{NEW[1]:g} °C", written(*NEW), [rated(one, *NEW)[0] for one in every])
    for at, each in found.items():
        if at != REFERENCE:
            theirs = [rated(one, *at)[1] / flow for one, flow in zip(every, flows, strict=True)]
            yield share_row(f"{at[0]:g}/{at[1]:g} °C: λ", each.volumetric_efficiency / own_flow, theirs)
    theirs = [nominal(one)[1] / flow for one, flow in zip(every, flows, strict=True)]
    yield share_row(f"{NOMINAL[0]:g} °C, 75 bar: λ", warm.volumetric_efficiency / own_flow, theirs)
    for x, p in HOT:
        theirs = [one.at("power", "transcritical", x, p) / power for one, power in zip(every, powers, strict=True)]
        share = hot(here, x, p)["electrical_power"] / own_power
        yield share_row(f"{x:g} °C, {1e-5 * p:g} bar: electrical power", share, theirs)


def compare(here: Path) -> Comparison:
    """Return the cylinder beside the nine compressors, and both figures over the pressure ratio."""
    every = list(compressors(here).values())
    found = {at: ours(here, *at) for at in CONDITIONS}
    ordered = sorted(CONDITIONS, key=lambda at: found[at].pressure_ratio)
    ratios = [found[at].pressure_ratio for at in ordered]
    base = [rated(one, *REFERENCE)[1] for one in every]
    efficiency = [[100.0 * rated(one, *at)[0] for one in every] for at in ordered]
    flow = [[rated(one, *at)[1] / own for one, own in zip(every, base, strict=True)] for at in ordered]
    own_flow = found[REFERENCE].volumetric_efficiency
    own = (
        [100.0 * found[at].electrical_isentropic_efficiency for at in ordered],
        [found[at].volumetric_efficiency / own_flow for at in ordered],
    )
    labels = ("electrical isentropic efficiency / %", "λ over that at -5/15 °C")
    panels = [
        Panel(
            "pressure ratio",
            label,
            (
                Series("cylinder of configs/co2", ratios, mine, points=True),
                *(
                    Series(f"{word} of the nine", ratios, [of(each) for each in theirs], theirs=True)
                    for word, of in ENDS
                ),
            ),
        )
        for label, mine, theirs in zip(labels, own, (efficiency, flow), strict=True)
    ]
    return Comparison(TITLE, CITATION, ABOUT, list(rows(here, every, found)), tuple(panels))
