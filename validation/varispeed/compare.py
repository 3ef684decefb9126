"""Ratings of Bitzer's 4CE-6.F1 from 25 to 87 Hz beside a new cylinder, one with its motor's heat, and a fitted one."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from pathlib import Path

from screwsim.scene import load
from screwsim.study.validation import Comparison, Row, sibling

points, shown, written = (
    sibling(Path(__file__).parents[1] / name) for name in ("varispeed/points.py", "hsk/compare.py", "varispeed/new.py")
)

TITLE = "A semi-hermetic reciprocating compressor on R134a from 25 to 87 Hz"
CITATION = "BITZER Software 7.1.11.4, as kept in bet-lab/TMHP (bitzer_efficiency_pilot, 2026-10-04)"
ABOUT = """\
These are figures of the maker's software, no measurements, and called tentative there: mass flow and efficiencies
follow from its capacity and power. λ of the source is known to 1.7 %, for its motor's slip is not stated; its motor is
taken to keep its field up to 87 Hz, where the range ends. How the rows are made:

- 'New' are cylinders as `screwsim new reciprocating` writes them. Their power holds an inverter's loss of 3 %, assumed,
  as the source's is that at the inverter's inlet.
- Three numbers of new cylinders are fitted to λ of two machines (others.csv, new.py): a clearance of 4.2 % at 50 Hz,
  and at all speeds the natural frequency of the reeds, ten times that of the shaft, with their damping ratio of 0.25.
  The machine of 32.5 m³/h had no part in any of it.
- What these replace: a clearance of 2 %, assumed, with λ 10 points too high; reeds of an example of one speed (6.5
  times, 0.1 assumed), of which single ones closed late, with λ up to 17 points too low at single speeds. Rows 'tried'
  say what either number does.
- The fitted machine: clearance, wall, rings and friction of the machine of 32.5 m³/h are fitted to three conditions at
  50 Hz (machine.fit.yaml), and the other conditions and all other speeds predicted.

What was found:

- A new cylinder fills as these machines do over all speeds, and takes somewhat less power: 2 to 7 points of
  efficiency, as much at all speeds. An inverter that loses more, or warms the suction gas, would have such a share, and
  the source does not tell it.
- Friction has no part in that. It is fitted to other makers' machines (validation/energyplus), with a mean effective
  pressure that stays whatever the pressures and the speed. With 12 % of the indicated power, as it was, the efficiency
  was 8 to 13 points too high here.
- The fit puts the power into losses of a quarter of the indicated power."""
MODEL, CONDITION = "4CE-6.F1", "-10/45"
LAMBDA = "volumetric_efficiency"
WITHIN = dict.fromkeys(shown.FIGURES, 0.05)
TAKEN = dict.fromkeys(shown.FIGURES, "taken, as in validation/energyplus")
TRIED = ((6.5, 0.1), (6.5, 0.2), (6.5, 0.25), (8.0, 0.25), (10.0, 0.1), (10.0, 0.25), (12.0, 0.25))


def fitted_to() -> Iterator[Row]:
    """Yield new cylinders of the machines to whose λ clearance (at 50 Hz) and reeds (at all speeds) are fitted."""
    for model, ratings in written.others().items():
        flow = ratings[0].displacement
        found = shown.found(written.new(model, flow), ratings)
        full = [each for each in found if each.rating.frequency == shown.FULL]
        slow, fast = (
            [
                each
                for each in found
                if each.rating.frequency != shown.FULL and (each.rating.frequency < shown.FULL) is under
            ]
            for under in (True, False)
        )
        name = f"new, {flow} m³/h ({model})"
        yield from shown.farthest(f"{name}, {shown.FULL:g} Hz", full, WITHIN, TAKEN, (LAMBDA,))
        for some in (slow, fast):
            at = [each.rating.frequency for each in some]
            yield from shown.farthest(f"{name}, {min(at):g} to {max(at):g} Hz", some, WITHIN, TAKEN, (LAMBDA,))


def tried() -> Iterator[Row]:
    """Yield what other reeds make of all three new machines: by natural frequency over the shaft's, and damping."""
    for frequencies, damping_ratio in TRIED:
        parts = []
        with written.reeds(frequencies, damping_ratio):
            for ratings in written.every().values():
                off = [written.differences(ratings, figure) for figure in shown.FIGURES]
                rms = "/".join(f"{sqrt(sum(each * each for each in some) / len(some)):.1f}" for some in off)
                parts.append(f"{ratings[0].displacement}: {rms}, λ {min(off[0]):+.1f} to {max(off[0]):+.1f}")
        reeds = f"reeds of {frequencies:g} times the shaft's frequency, damping ratio {damping_ratio:g}"
        name = f"tried: {reeds}: rms of λ/electrical η_s in points, by m³/h"
        yield Row(name, "; ".join(parts), None, "estimate", "no verdict")


def compare(here: Path) -> Comparison:
    """Return the cylinder as written, those that its clearance is fitted to, and one fitted to three conditions."""
    ratings, rows = points.rated.ratings(here, points.POLES), list[Row]()
    before = shown.found(written.new(MODEL, ratings[0].displacement), ratings)
    full = [each for each in before if each.rating.frequency == shown.FULL]
    name = f"new, {ratings[0].displacement} m³/h ({MODEL})"
    rows += shown.farthest(f"{name}, {shown.FULL:g} Hz", full, WITHIN, TAKEN)
    rows += shown.changes(name, before, CONDITION)
    rows += fitted_to()
    predicted = shown.found(load(here / "fitted" / "scene.yaml"), ratings)
    rows += shown.fit_rows(here, predicted, points.FITTED, CONDITION)
    rows += tried()
    deviations = [*shown.deviations("reciprocating_r134a", predicted, points.FITTED)]
    panels = tuple(shown.panels(before, predicted, MODEL, CONDITION))
    return Comparison(TITLE, CITATION, ABOUT, rows, panels, deviations)
