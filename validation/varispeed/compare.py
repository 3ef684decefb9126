"""Ratings of Bitzer's 4CE-6.F1 from 25 to 87 Hz beside a new cylinder, one with its motor's heat, and a fitted one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from screwsim.scene import load
from screwsim.study.validation import Comparison, Row, sibling

points, shown, written = (
    sibling(Path(__file__).parents[1] / name) for name in ("varispeed/points.py", "hsk/compare.py", "varispeed/new.py")
)

TITLE = "A semi-hermetic reciprocating compressor on R134a from 25 to 87 Hz"
CITATION = "BITZER Software 7.1.11.4, as kept in bet-lab/TMHP (bitzer_efficiency_pilot, 2026-10-04)"
ABOUT = (
    "These are figures of the maker's software, no measurements, and called tentative there: mass flow and "
    "efficiencies follow from its capacity and power. 'New' are cylinders as `screwsim new reciprocating` writes them; "
    "their power holds an inverter's loss of 3 %, assumed, as the source's is that at the inverter's inlet. Their "
    "clearance of 4 % is fitted to λ of two machines at 50 Hz (others.csv, new.py; it was 2 %, assumed, and λ 10 "
    "points too high); the machine of 32.5 m³/h had no part in it. Then clearance, wall, rings and friction of that "
    "one are fitted to three conditions at 50 Hz (machine.fit.yaml), and the other conditions and all other speeds "
    "predicted. λ of the source is known to 1.7 %, for its motor's slip is not stated. What it shows: a new cylinder "
    "fills as these machines do, and takes less power; on R404A and CO2 its efficiency is that of the rated ones "
    "within 2 and 3 points (validation/energyplus, validation/co2), so that friction was left as it is. The fit puts "
    "the power into losses of a quarter of the indicated power; so fitted, the machine has the electrical efficiency "
    "within 4 points at all speeds. λ it has but where the discharge reed closes late: at the highest pressure ratio a "
    "quarter of the gas flows back at 40 Hz and an eighth at 87 Hz, none at 25 and 50 Hz, and of such a course the "
    "source shows nothing. The new cylinders do the same at single speeds (up to 16 points of λ). A reed of one mass, "
    "hardly damped (ζ = 0.1, assumed), is too sharp at speeds for which it was not sized. With ζ = 0.2 the differences "
    "of λ over all ratings spread by 2.3, 4.2 and 3.0 instead of 3.3, 5.2 and 3.6 points (machines of 13.4, 18.1 and "
    "32.5 m³/h; new.py prints it): late closings move to other speeds, but stay, so that what is "
    "missing is rather a reed of more than one mass, or gas that cushions it; ζ stays as assumed."
)
MODEL, CONDITION = "4CE-6.F1", "-10/45"
LAMBDA = "volumetric_efficiency"
WITHIN = dict.fromkeys(shown.FIGURES, 0.05)
TAKEN = dict.fromkeys(shown.FIGURES, "taken, as in validation/energyplus")


def fitted_to() -> Iterator[Row]:
    """Yield new cylinders of the machines to whose λ at 50 Hz the clearance is fitted, then at the other speeds."""
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
            yield from shown.farthest(f"{name}, {min(at):g} to {max(at):g} Hz", some, WITHIN, TAKEN)


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
    deviations = [*shown.deviations("reciprocating_r134a", predicted, points.FITTED)]
    panels = tuple(shown.panels(before, predicted, MODEL, CONDITION))
    return Comparison(TITLE, CITATION, ABOUT, rows, panels, deviations)
