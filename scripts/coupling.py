"""Compare the rubber-cord coupling with its source, and draw its figures.

Run: .venv/bin/python scripts/coupling.py [FOLDER]   (default: results/coupling)

Printed values: validation/rubber_cord_coupling. Equations and findings: docs/reference/coupling.md.
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

from screwsim.machine.drive.rubber_cord_coupling import (
    RubberCordCoupling,
    counted_crossings,
    crossings,
    pull,
    torque_band,
)
from screwsim.report.drive import CordLean, draw_coupling
from screwsim.study.validation import read_table

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "validation" / "rubber_cord_coupling"
DRAWN = RubberCordCoupling(cords=60, lean_plus=math.radians(36.0), lean_minus=math.radians(36.0))
COUPLING = RubberCordCoupling()
CORD_STEP = 0.1 / 94  # [m], 94 cords per 10 cm


def read_leans() -> dict[str, CordLean]:
    """Return the measured leans by direction [rad]."""
    found = {}
    for row in read_table(DATA / "lean.csv"):
        mean, below, above = (float(row[name]) for name in ("mean_deg", "below_deg", "above_deg"))
        found[row["direction"]] = CordLean(*(math.radians(x) for x in (mean, mean - below, mean + above)))
    return found


def geometry(printed: dict[str, float]) -> None:
    """Print the geometry of the cords beside the source's."""
    sizes = (DRAWN.lean_plus, DRAWN.cords, DRAWN.inner_radius, DRAWN.outer_radius)
    found = crossings(*sizes)
    ours = {
        "psi_max": math.degrees(found.reach),
        "psi_max_over_pitch": found.ratio,
        "crossings_without_shift": counted_crossings(*sizes, 0.0),
        "crossings_with_half_a_pitch": counted_crossings(*sizes, 0.5 * DRAWN.pitch),
        "pitch": math.degrees(COUPLING.pitch),
    }
    for name, value in ours.items():
        print(f"{name:>28} ours {value:<9.6g} printed {printed[name]:g}")
    fit = math.degrees(math.acos(COUPLING.cords * CORD_STEP / (2.0 * math.pi * COUPLING.inner_radius)))
    other = 2.0 * math.pi * COUPLING.inner_radius * math.cos(COUPLING.lean_plus) / CORD_STEP
    print(f"N = {COUPLING.cords} is 94 cords on 10 cm at a lean of {fit:.2f} deg; at 30.8 deg N would be {other:.0f}")


def torques(printed: dict[str, float], leans: dict[str, CordLean]) -> None:
    """Print twist, stiffness and cord strain under the nominal and the largest torque, and the band."""
    nominal, largest = printed["nominal_torque"], printed["largest_torque"]
    print(f"\ntwo discs, nominal torque {nominal:g} N m; tests: less than {printed['twist_below']} deg")
    heads = f"{'lean':>9} {'twist':>8} {'dM/dTheta':>13} {'strain':>7} {'cord force':>11}"
    print(f"{heads}   at {largest:g} N m: twist, strain")
    for lean in leans.values():
        each = replace(COUPLING, lean_plus=lean.mean, lean_minus=lean.mean)
        theta, far = each.twist(nominal), each.twist(largest)
        eps = each.largest_strain(theta)
        force = pull(eps, each.cord_stiffness, each.cord_stiffening)
        print(
            f"{math.degrees(lean.mean):>5.1f} deg {math.degrees(theta):>5.3f} deg {1e-3 * each.stiffness(theta):>6.1f} "
            f"kN m/rad {100 * eps:>5.2f} % {force:>9.2f} N   "
            f"{math.degrees(far):.3f} deg, {100 * each.largest_strain(far):.2f} %"
        )
    every = leans["all"]
    for degrees in (1.0, 1.5):
        found = torque_band(COUPLING, math.radians(degrees), every.low, every.high)
        print(f"at {degrees} deg, lean {math.degrees(every.low):.1f} to {math.degrees(every.high):.1f} deg: ", end="")
        print(f"{found.least:.0f} to {found.largest:.0f} N m, evenly scattered {found.mean:.0f} N m")
    both = replace(COUPLING, lean_plus=leans["plus"].mean, lean_minus=leans["minus"].mean)
    ways = [math.degrees(both.twist(sign * nominal)) for sign in (1.0, -1.0)]
    print(f"each direction with its own lean: {ways[0]:.3f} deg and {ways[1]:.3f} deg")


def main() -> None:
    """Print the coupling and draw its figures."""
    printed = {row["name"]: float(row["value"]) for row in read_table(DATA / "printed.csv")}
    leans = read_leans()
    geometry(printed)
    torques(printed, leans)
    folder = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "results" / "coupling")
    for path in draw_coupling(COUPLING, DRAWN, tuple(leans.values()), printed["nominal_torque"], folder):
        print(path, file=sys.stderr)


if __name__ == "__main__":
    main()
