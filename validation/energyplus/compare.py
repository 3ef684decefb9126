"""Isentropic efficiency of the electrical power of reciprocating compressors, beside rated ones on four fluids."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from screwsim.outputs import Result
from screwsim.scene import load, with_values
from screwsim.study.validation import Comparison, Panel, Row, Series, compared, equal, read_table, sibling, solved

series = sibling(Path(__file__).parents[1] / "energyplus/series.py")

TITLE = "Rated reciprocating compressors: electrical isentropic efficiency on four fluids"
CITATION = (
    "EnergyPlus, RefrigerationCompressorCurves.idf: ratings of semi-hermetic compressors of two makers, R404A (six), "
    "R134a, R22 and R507A"
)
ABOUT = """\
The machines are cylinders that `screwsim new reciprocating` writes for -10/40 °C, of 10 m³/h at 1750 rpm, with a motor
as efficient as one of the whole machine (0.90); that beside the series Copelametic, of one machine of 10 m³/h, has its
own. How to read the rows:

- None of them is a machine that was rated, of which neither bore nor speed is stated. A difference is that of another
  machine as much as one of the model.
- Efficiency is the isentropic work of the rated capacity over the rated power, with the suction gas at 18.3 °C and
  liquid at saturation, as the curves are rated. The curves state no uncertainty, and single ones (06E) run against all
  others near the ends of their range.
- Friction is fitted to the series 06D on R134a and R507A (friction.py): 13.5 % of the indicated power and a mean
  effective pressure of 0.28 bar. All other series, R404A, R22, and those of validation/varispeed and validation/co2,
  which are another maker's, judge that. It had been 12 % of the indicated power, whatever the pressures.
- Valves are sized by a rule (S36, S37 in docs/reference/slider-crank.md). The passages before and behind the valves are
  left out: what they lose is in the friction. The cylinder's wall stays as warm as at the condition that it was written
  for.

What was found:

- Bodies that are rated on two fluids are 4 to 7 points less efficient on R134a, at half the mean effective pressure of
  R404A or R507A (rows 'less'). A loss that stays explains most of that; a larger share of the power alone leaves 3
  points between the fluids (rows 'tried'). The motor does not: in these series each fluid has its own size of it.
- That 06E, and the small machine of Copelametic, take more power is not explained."""
FIGURE, NAME = series.FIGURE, "reciprocating_r404a"
CONDITIONS = series.CONDITIONS
WITHIN, BASIS = series.WITHIN, "5 points: taken, the ratings state none; the six lie up to {apart:.1f} points apart"


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
        values, name = series.at(evaporating, condensing), f"{evaporating:g}/{condensing:g} °C"
        result, theirs = solved(file, values=values), series.efficiencies(table, evaporating, condensing)
        rows.append(row(f"R404A, {name}", result, theirs))
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
    return Comparison(TITLE, CITATION, ABOUT, [*rows, *series.rows(here)], (panel,), points)
