"""Isentropic efficiency of the electrical power of a reciprocating compressor, beside six rated ones."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from CoolProp.CoolProp import PropsSI

from screwsim.outputs import Result
from screwsim.scene import load, with_values
from screwsim.study.validation import Comparison, Panel, Row, Series, compared, equal, read_table, solved

TITLE = "Rated reciprocating compressors on R404A: electrical isentropic efficiency"
CITATION = "EnergyPlus, RefrigerationCompressorCurves.idf: ratings of six semi-hermetic compressors, 60 Hz, R404A"
ABOUT = (
    "The machine is one that `screwsim new reciprocating` writes for -10/40 °C, at 1750 rpm: nothing of it is fitted "
    "to these ratings, and it is none of the six, of which neither bore nor speed is stated. So a difference is that "
    "of another machine as much as one of the model. Its valves are sized by a rule (S36, S37 in "
    "docs/reference/slider-crank.md). It leaves out the passages before and behind the valves, which would lower its "
    "efficiency. Its cylinder wall "
    "stays as warm as at the condition that it was written for. Efficiency is the isentropic work of the rated "
    "capacity over the rated power, with the suction gas at 18.3 °C and liquid at saturation, as the curves are rated. "
    "The curves state no uncertainty."
)
FIGURE, NAME = "electrical_isentropic_efficiency", "reciprocating_r404a"
SUCTION, ZERO = 291.45, 273.15  # [K] suction gas of the ratings
CONDITIONS = ((-17.8, 30.0), (-17.8, 40.0), (-10.0, 30.0), (-10.0, 40.0), (-10.0, 48.9), (-6.7, 48.9), (0.0, 40.0))
WITHIN, BASIS = 5.0, "5 points: taken, the ratings state none; the six lie up to {apart:.1f} points apart"


def efficiencies(table: list[dict[str, str]], evaporating: float, condensing: float) -> dict[str, float]:
    """Return that of the electrical power by the ratings, by model, at saturation temperatures [degC]."""
    x, y = evaporating, condensing
    terms = (1.0, x, x * x, y, y * y, x * y, x**3, y**3, x * x * y, x * y * y)
    values: dict[str, dict[str, float]] = {}
    for each in table:
        watts = sum(float(each[f"c{i}"]) * term for i, term in enumerate(terms))
        values.setdefault(each["model"], {})[each["figure"]] = watts
    low, high = (PropsSI("P", "T", T + ZERO, "Q", 1, "R404A") for T in (evaporating, condensing))
    h, s = (PropsSI(name, "T", SUCTION, "P", low, "R404A") for name in "HS")
    rise = PropsSI("H", "P", high, "S", s, "R404A") - h
    cooling = h - PropsSI("H", "T", condensing + ZERO, "Q", 0, "R404A")
    return {model: each["capacity"] / cooling * rise / each["power"] for model, each in values.items()}


def at(evaporating: float, condensing: float) -> dict[str, float]:
    """Return the paths [SI] of a condition."""
    return {
        "operation.evaporating_temperature": evaporating + ZERO,
        "operation.condensing_temperature": condensing + ZERO,
        "operation.superheat": SUCTION - evaporating - ZERO,
    }


def row(name: str, result: Result, theirs: Mapping[str, float]) -> Row:
    """Return our efficiency beside the mean of theirs."""
    percent = 100.0 * np.array(list(theirs.values()))
    ours, apart = 100.0 * result.performance[FIGURE], float(np.ptp(percent))
    basis, note = BASIS.format(apart=apart), f"the six: {percent.min():.1f} to {percent.max():.1f}"
    mean = float(percent.mean())
    return equal(f"{name}: electrical isentropic", ours, mean, WITHIN, "published", unit="%", basis=basis, note=note)


def compare(here: Path) -> Comparison:
    """Return the efficiencies over the rated conditions, and what they say of the error of the model."""
    table, file = read_table(here / "reciprocating.csv"), here / "machine.yaml"
    scene, rows, points, shown = load(file), [], [], []
    for evaporating, condensing in CONDITIONS:
        values, name = at(evaporating, condensing), f"{evaporating:g}/{condensing:g} °C"
        result, theirs = solved(file, values=values), efficiencies(table, evaporating, condensing)
        rows.append(row(name, result, theirs))
        here_ = with_values(scene, values)
        for model, value in theirs.items():
            points += compared(NAME, f"{name}, {model}", here_, result, {FIGURE: value})
        shown.append((result.performance.pressure_ratio, result.performance[FIGURE], theirs))
    shown.sort(key=lambda each: each[0])
    ratios = [each[0] for each in shown]
    ours = Series("screwsim new reciprocating", ratios, [100.0 * each[1] for each in shown], points=True)
    ends = {"least of the six": min, "best of the six": max}
    others = [
        Series(name, ratios, [100.0 * of(each[2].values()) for each in shown], theirs=True) for name, of in ends.items()
    ]
    panel = Panel("pressure ratio", "electrical isentropic efficiency / %", (ours, *others))
    return Comparison(TITLE, CITATION, ABOUT, rows, (panel,), points)
