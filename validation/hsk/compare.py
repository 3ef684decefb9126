"""Ratings of Bitzer's HSK screws over conditions, speed and size, beside new scenes and a machine fitted to three."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from screwsim.outputs import Result
from screwsim.scene import Scene, load, loads, value_at, with_values
from screwsim.simulate import simulate
from screwsim.study.calibration import read_fit
from screwsim.study.validation import (
    Comparison,
    NotRun,
    Panel,
    Row,
    Series,
    ValidationPoint,
    compared,
    equal,
    sibling,
)
from screwsim.template import new_scene, request_of

rated, choices = (sibling(Path(__file__).parents[1] / f"hsk/{name}.py") for name in ("ratings", "choices"))

TITLE = "Bitzer HSK screws on R134a: four sizes, three of them from 25 to 75 Hz"
CITATION = (
    "BITZER Software 7.1.11.4 as kept in bet-lab/TMHP (bitzer_efficiency_pilot, 2026-10-04); HSK8591: "
    "oemof/tespy, the test of its PolynomialCompressor"
)
ABOUT = """\
These are figures of the maker's software, no measurements: mass flow and efficiencies follow from its capacity and
power. Profile, built-in volume ratio, oil and gaps of the machines are not known. 'The curves' are the mean curves of
validation/bitzer, which are the same maker's. How the rows are made:

- 'New' are machines that `screwsim new refrigeration` writes for the displacement. One rule of them was chosen with
  these ratings at hand: clearances are in proportion to the diameter (by tolerances of ISO 286 below 160 mm, λ of the
  three smaller ones was 2 to 5 points lower). Nothing else of them is adjusted.
- The fitted machine is the one of 192 m³/h, fitted to three conditions at 50 Hz (machine.fit.yaml); all other
  conditions and speeds are predicted. Rows 'what was fitted' put its parameters into the other sizes, with leaks in
  proportion to what is written there.
- λ of the source is known to 1.7 %: its displacement is given at 2900 rpm, 2950 rpm are taken at 50 Hz, and an
  induction motor turns up to 3.4 % faster at light load.
- Above 50 Hz the source's voltage stays at 400 V: the field weakens, as that of our motors does (M433), and the slip
  grows, which would raise λ of the source (rows 'with more slip').

What was found:

- By size: new machines of 140 and 192 m³/h leak too much and the one of 535 too little, so that no rule of sizes tells
  the maker's machines apart. Their electrical efficiency is up to 9 points too high at 50 Hz.
- By speed: the three smaller ones lose too much λ the slower they run. What λ of the source loses from 50 to 25 Hz is
  one flow for all three and at all pressure ratios up to 4.2: 7 to 8 m³/h of suction gas (rows 'suction gas lost'). A
  leak grows with the length of its gap and, in kilograms, with the discharge pressure, as ours does. That one flow
  reads as a rule of the maker's software for the series; nothing was fitted to it.
- Fitted at one speed, the model has λ within 4 and the efficiency within 5 points at all speeds. Three differences
  remain: λ of the source falls more over the pressure ratio; it falls again above 60 Hz, where ours still rises (ports
  and passages that throttle more, or slip); so does its efficiency (friction here is a share of the power, whatever the
  speed).

What was tried (rows 'tried'). Only the first is in what new machines are written with:

- Oil seals the shafts by the law of the gaps (M300), as the speeds of an air package call for (validation/cagi). λ
  comes nearer to all machines and curves than with a nozzle fitted to the same curves.
- Tighter shafts or gaps bring λ of 140 and 192 m³/h and of the smaller machines of the curves nearer, but move that of
  535 and of the largest away, and every efficiency of these ratings. More friction or oil mends that here and spoils it
  beside the curves. None is better on the machines that took no part. Gaps of 18 µm at 160 mm would also be tighter
  than any known (MYCOM sets 50 µm at the discharge end).
- Refrigerant that flashes from the oil before suction ends is not what is missing. It would cost λ the same share at
  all speeds; the ratings have room for 3 points of that at 84 and 140 m³/h and for none at 192 (rows 'loss of λ'). A
  kilogram of oil per kilogram of gas brings far more (R134a in one ester oil), and oil that pressure alone drives twice
  as much at half the speed. With a seventh of the oil and clearances times 0.6, λ is hardly nearer than with clearances
  times 0.8 alone, and the efficiency is off by 8 to 15 points.
- Refrigerant that flashes in closed chambers leaves λ as it is and takes 3 points of the efficiency, as more friction
  would: nearer to the machines of 84 and 535 m³/h, farther from the others and from the curves. Uncooled oil is then
  hotter than 97 °C, where its solubility is not known, at a fifth of these ratings.
- Gas and oil that pass the blow-holes at one speed (M192) bring λ of 140 and 192 m³/h and of the curves nearer by up to
  a point. The specific power of an air package at part load then falls 5 % short, unless the end faces are as far from
  the housing as a maker sets them (validation/cagi). Fitted again with both (validation/bitzer/ends.fit.yaml), the
  machine is as near to these ratings and to the curves as the one that is written; small air packages, too efficient
  already, go farther away (validation/templates).
- Friction by films and bearings (the laws of validation/cagi) with such end faces needs no fitted share and is as near
  to the curves. Above 50 Hz its efficiency falls; that of the ratings of 140 and 192 m³/h hardly falls or falls, too.
  Below 50 Hz it falls less than theirs. With end faces as far as the tips it is 4 to 5 points off.
- The same friction, with oil that holds refrigerant, thinner (M199) and flashing, is nearer to three of the four sizes
  than the share and 2 points farther from the curves; from 50 to 25 Hz it falls less than the share. What R134a
  dissolves is known of one ester and below 97 °C alone."""
FIGURES = {"volumetric_efficiency": "λ", "electrical_isentropic_efficiency": "electrical η_s"}
NEW = {"volumetric_efficiency": 0.04, "electrical_isentropic_efficiency": 0.06}
FIT = {"volumetric_efficiency": rated.LAMBDA, "electrical_isentropic_efficiency": rated.ETA}
CHANGE = 0.02  # of the change with the speed
AT, SHOWN = "-5/40", "0/40"  # °C: of the change with the speed; of the figure
FULL, SLOW = 50.0, 25.0  # Hz
LAMBDA = "volumetric_efficiency"
TAKEN = dict.fromkeys(FIGURES, "taken, as for new scenes (validation/templates)")
ASKED = {
    "volumetric_efficiency": "the source's speed is known to 1.7 %",
    "electrical_isentropic_efficiency": "taken, as in validation/bitzer",
}
WRITTEN = "cooling: suction_gas}"
INVERTER = "cooling: suction_gas, inverter: {rated_speed: 2950 rpm, loss: 0 W, harmonic_loss: 0}}"
SHAFT = "effects.shaft_leakage.area"
GAPS = choices.GAPS
PORTS = tuple(f"effects.{name}.flow_coefficient" for name in ("suction_port", "discharge_port"))
ALONE = ("machine.built_in_volume_ratio", "effects.mechanical.fraction")
UNITS = {"gap": (1e6, "µm"), "area": (1e6, "mm²"), "clearance": (1e6, "cm³"), "wall_temperature": (1.0, "K")}


class Found(NamedTuple):
    """A rating, the scene at its conditions and its result."""

    rating: rated.Rating
    scene: Scene
    result: Result

    @property
    def ours(self) -> Mapping[str, float]:
        """Both figures of ours."""
        return {name: float(self.result.performance[name]) for name in FIGURES}

    def theirs(self, figure: str) -> float:
        """Return the figure of the source."""
        return float(getattr(self.rating, figure))


def new(displacement: str, overrides: Sequence[str] = ()) -> Scene:
    """Return the machine that `screwsim new` writes for a displacement [m³/h], its motor on an inverter."""
    text = new_scene("refrigeration", request_of(displacement=f"{displacement} m^3/h", speed=f"{rated.RATED:g} rpm"))
    if WRITTEN not in text:
        raise NotRun(f"the scene for {displacement} m^3/h has no motor in the suction gas")
    return loads(text.replace(WRITTEN, INVERTER), overrides=overrides)


def found(scene: Scene, ratings: Sequence[rated.Rating]) -> list[Found]:
    """Return both figures at every rating; raise `NotRun` where one has no solution."""
    results = []
    for one in ratings:
        here = with_values(scene, dict(one.values))
        result = simulate(here, trace=False)
        if result.status != "ok":
            raise NotRun(f"{one.model}, {one.name} °C, {one.frequency:g} Hz: {result.told}")
        results.append(Found(one, here, result))
    return results


def deviations(machine: str, found: Sequence[Found], fitted: Sequence[str] = ()) -> Iterator[ValidationPoint]:
    """Yield both figures at each rating for the model error; λ of the source is as uncertain as its speed."""
    for each in found:
        one, theirs = each.rating, {figure: each.theirs(figure) for figure in FIGURES}
        to_fit = one.frequency == FULL and one.name in fitted
        stated = {"volumetric_efficiency": 0.5 * rated.LAMBDA * theirs["volumetric_efficiency"]}
        name = f"{one.model}, {one.name} °C, {one.frequency:g} Hz"
        yield from compared(machine, name, each.scene, each.result, theirs, stated=stated, fitted=to_fit)


def resized(here: Path, displacement: str) -> Scene:
    """Return a new machine with its leaks and ports as fitted: gaps as large to those written, shafts to their square.

    Past the shafts leaks a nozzle, as in the fitted machine.
    """
    fit, written = load(here / "fitted" / "scene.yaml"), load(here / "machine.yaml")
    own = new(displacement)
    scale = value_at(own, GAPS[0]) / value_at(written, GAPS[0])
    nozzle = choices.as_nozzle(value_at(fit, SHAFT) * scale**2)
    values = {path: value_at(fit, path) for path in (*ALONE, *PORTS)}
    values |= {path: value_at(own, path) * value_at(fit, path) / value_at(written, path) for path in GAPS}
    return with_values(new(displacement, nozzle), values)


def farthest(
    name: str,
    points: Sequence[Found],
    within: Mapping[str, float],
    basis: Mapping[str, str],
    fitted: Sequence[str] = (),
) -> Iterator[Row]:
    """Yield the largest difference of each figure over some points; `fitted` figures are no evidence."""
    for figure, text in FIGURES.items():
        off = [100.0 * (each.ours[figure] - each.theirs(figure)) for each in points]
        theirs = [100.0 * each.theirs(figure) for each in points]
        spread = f"mean {sum(off) / len(off):+.1f}, from {min(off):+.1f} to {max(off):+.1f}"
        note = f"{spread}; theirs {min(theirs):.1f} to {max(theirs):.1f} %"
        quantity, limit = f"{name}: {text}, largest difference of {len(off)} points", 100.0 * within[figure]
        ours, why = max(off, key=abs), basis[figure]
        kind = "calibrated" if figure in fitted else "published"
        yield equal(quantity, ours, 0.0, limit, kind, unit="points", basis=why, note=note)


def changes(name: str, points: Sequence[Found], condition: str = AT) -> Iterator[Row]:
    """Yield by how much each figure changes from 50 Hz to either end of the speed, at one condition."""
    at = {each.rating.frequency: each for each in points if each.rating.name == condition}
    for frequency in (min(at), max(at)):
        for figure, text in FIGURES.items():
            here, full = at[frequency], at[FULL]
            ours = 100.0 * (here.ours[figure] - full.ours[figure])
            theirs = 100.0 * (here.theirs(figure) - full.theirs(figure))
            limit = 100.0 * CHANGE
            quantity = f"{name}, {condition} °C: {text} at {frequency:g} Hz less that at {FULL:g}"
            yield equal(quantity, ours, theirs, limit, "published", unit="points", basis="2 points, taken")


def weakened(name: str, points: Sequence[Found], condition: str = AT) -> Row:
    """Return how λ changes from 50 Hz to the highest frequency if the slip grows with its square there.

    The voltage of the source stays the same above 50 Hz, so that the motor's field weakens as the frequency grows.
    """
    at = {each.rating.frequency: each for each in points if each.rating.name == condition}
    fast, full, high = at[max(at)], at[FULL], max(at) / FULL
    slip = rated.SYNCHRONOUS - rated.NOMINAL
    slower = (rated.SYNCHRONOUS - slip * high) / (rated.SYNCHRONOUS - slip)
    ours, theirs = (
        100.0 * (some[0] - some[1])
        for some in (
            (fast.ours[LAMBDA], full.ours[LAMBDA]),
            (fast.theirs(LAMBDA) / slower, full.theirs(LAMBDA)),
        )
    )
    what = f"{name}, {condition} °C: λ at {max(at):g} Hz less that at {FULL:g}, the source's with more slip"
    note = f"400 V from 50 Hz on: {slip:g} rpm of slip at 50 Hz, {slip * high**2:.0f} at {max(at):g}"
    return Row(what, ours, theirs, "estimate", "no verdict", "points", note=note)


def split(slow: float, full: float) -> str:
    """Return a and b [points] of 1 - λ = a + b (50 Hz/f), from λ at 25 and at 50 Hz."""
    return f"{100.0 * (1.0 - 2.0 * full + slow):.1f} + {100.0 * (full - slow):.1f} points"


def losses(name: str, points: Sequence[Found], condition: str = AT) -> Row:
    """Return what λ loses at any speed, and what in proportion to the time of a turn, at one condition."""
    at = {each.rating.frequency: each for each in points if each.rating.name == condition}
    slow, full = at[SLOW], at[FULL]
    ours = split(slow.ours[LAMBDA], full.ours[LAMBDA])
    theirs = split(slow.theirs(LAMBDA), full.theirs(LAMBDA))
    what = f"{name}, {condition} °C: loss of λ at any speed + loss over 50 Hz/f"
    return Row(what, ours, theirs, "estimate", "no verdict", note="from λ at 25 and 50 Hz")


def lost_flow(slow: float, full: float, displacement: str) -> float:
    """Return the flow of suction gas [m³/h] lost at any speed of a machine of a displacement [m³/h]: b of `split`."""
    return (full - slow) * float(displacement) * rated.NOMINAL / rated.RATED


def lost_flows(name: str, points: Sequence[Found]) -> Row:
    """Return that flow over all conditions that are rated at 25 and at 50 Hz."""
    by_condition: dict[str, dict[float, Found]] = {}
    for each in points:
        by_condition.setdefault(each.rating.name, {})[each.rating.frequency] = each
    pairs = [(at[SLOW], at[FULL]) for at in by_condition.values() if SLOW in at and FULL in at]
    flow = pairs[0][0].rating.displacement
    ours = [lost_flow(slow.ours[LAMBDA], full.ours[LAMBDA], flow) for slow, full in pairs]
    theirs = [lost_flow(slow.theirs(LAMBDA), full.theirs(LAMBDA), flow) for slow, full in pairs]
    told = [f"{min(some):.1f} to {max(some):.1f} m³/h" for some in (ours, theirs)]
    ratios = [slow.rating.ratio for slow, _ in pairs]
    note = f"from λ at 25 and 50 Hz; {len(pairs)} conditions, pressure ratios of {min(ratios):.1f} to {max(ratios):.1f}"
    return Row(f"{name}: suction gas lost at any speed", *told, "estimate", "no verdict", note=note)


def fit_rows(here: Path, points: Sequence[Found], fitted: Sequence[str], condition: str = AT) -> Iterator[Row]:
    """Yield the points of the fit, what it predicts elsewhere at 50 Hz, below and above, and its parameters."""
    mine = [each for each in points if each.rating.frequency == FULL]
    for each in mine:
        if each.rating.name not in fitted:
            continue
        for figure, text in FIGURES.items():
            ours, theirs = 100.0 * each.ours[figure], 100.0 * each.theirs(figure)
            quantity = f"fitted machine, {each.rating.name} °C, {FULL:g} Hz: {text}"
            note, limit = f"fitted; {ours - theirs:+.1f} points", 100.0 * FIT[figure]
            yield equal(quantity, ours, theirs, limit, "calibrated", unit="%", basis=ASKED[figure], note=note)
    others = [each for each in mine if each.rating.name not in fitted]
    yield from farthest(f"fitted machine, predicted, {FULL:g} Hz", others, FIT, ASKED)
    for slow in (True, False):
        own = [each for each in points if each.rating.frequency != FULL and (each.rating.frequency < FULL) is slow]
        at = [each.rating.frequency for each in own]
        yield from farthest(f"fitted machine, predicted, {min(at):g} to {max(at):g} Hz", own, FIT, ASKED)
    yield from changes("fitted machine, predicted", points, condition)
    yield from parameters(here)


def parameters(here: Path) -> Iterator[Row]:
    """Yield the parameters of the stored fit with their standard errors."""
    told = json.loads((here / "fitted" / "fit.json").read_text(encoding="utf-8"))["parameters"]
    for parameter in read_fit(here / "machine.fit.yaml").parameters:
        each, (factor, unit) = told[parameter.path], UNITS.get(parameter.path.rpartition(".")[2], (1.0, ""))
        value, error = factor * each["value"], each["standard_error_scaled"]
        uncertainty = None if error is None else factor * error
        why, note = "± standard error of the fit", f"bounds {factor * each['from']:.4g} … {factor * each['to']:.4g}"
        yield Row(parameter.path, value, None, "calibrated", "no verdict", unit, uncertainty, why, note)


def compare(here: Path) -> Comparison:
    """Return new machines of four sizes, the fitted one, and what its parameters make of the other sizes."""
    by_model: dict[str, list[rated.Rating]] = {}
    for one in rated.ratings(here):
        by_model.setdefault(one.model, []).append(one)
    rows, sizes, before, written = [], [], [], []
    for model, ratings in by_model.items():
        flow = ratings[0].displacement
        scene, full = new(flow), [one for one in ratings if one.frequency == FULL]
        points = found(scene, ratings)
        written += deviations("screw_r134a", points)
        name = f"new, {flow} m³/h ({model})"
        rows += farthest(f"{name}, {FULL:g} Hz", [e for e in points if e.rating.frequency == FULL], NEW, TAKEN)
        if any(one.frequency == SLOW for one in ratings):
            rows += changes(name, points)
            rows += [weakened(name, points), losses(name, points), lost_flows(name, points)]
        if model == rated.FITTED_MODEL:
            before = points
        else:
            name = f"what was fitted, at {flow} m³/h ({model}), {FULL:g} Hz"
            sizes += farthest(name, found(resized(here, flow), full), FIT, ASKED)
    predicted = found(load(here / "fitted" / "scene.yaml"), by_model[rated.FITTED_MODEL])
    return Comparison(
        TITLE,
        CITATION,
        ABOUT,
        [*rows, *fit_rows(here, predicted, rated.FITTED), *sizes, *choices.rows(here, new, by_model, FULL)],
        tuple(panels(before, predicted, rated.FITTED_MODEL)),
        [*deviations("hsk", predicted, rated.FITTED), *written],
    )


def panels(before: Sequence[Found], predicted: Sequence[Found], name: str, condition: str = SHOWN) -> Iterator[Panel]:
    """Yield both figures over the frequency at one condition, and over the pressure ratio at 50 Hz."""
    for figure, text in FIGURES.items():
        kept = [[each for each in some if each.rating.name == condition] for some in (before, predicted)]
        yield _panel(f"frequency / Hz, {condition} °C", f"{text} / %", figure, kept, _frequency, name)
        kept = [[each for each in some if each.rating.frequency == FULL] for some in (before, predicted)]
        yield _panel(f"pressure ratio, {FULL:g} Hz", f"{text} / %", figure, kept, _ratio, name, points=True)


def _frequency(each: Found) -> float:
    return each.rating.frequency


def _ratio(each: Found) -> float:
    return each.rating.ratio


def _panel(
    x_label: str,
    y_label: str,
    figure: str,
    kept: Sequence[Sequence[Found]],
    x: Callable[[Found], float],
    name: str,
    *,
    points: bool = False,
) -> Panel:
    before, predicted = (sorted(each, key=x) for each in kept)
    at, theirs = [x(each) for each in predicted], [100.0 * each.theirs(figure) for each in predicted]
    written = [100.0 * each.ours[figure] for each in before]
    own = [100.0 * each.ours[figure] for each in predicted]
    return Panel(
        x_label,
        y_label,
        (
            Series(f"new, {predicted[0].rating.displacement} m³/h", [x(e) for e in before], written, points=points),
            Series("fitted to three at 50 Hz", at, own, points=points),
            Series(name, at, theirs, theirs=True, error=100.0 * FIT[figure]),
        ),
    )
