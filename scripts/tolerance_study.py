"""Compare the kinematic tolerance study of a slider-crank with its source, and draw its figures.

Run: .venv/bin/python scripts/tolerance_study.py [FOLDER]   (default: results/tolerance)

Printed values: validation/slider_crank. Equations and findings: docs/reference/slider-crank.md.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from screwsim.machine.slider_crank import tolerance
from screwsim.machine.slider_crank.tolerance import FUNCTIONS, Links, deviation, plane, tabulated
from screwsim.report.slider_crank import draw_tolerance
from screwsim.study.validation import read_table

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "validation" / "slider_crank"
TURN = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
NOMINAL = tolerance.links_of(mean_speed=4.4, turns=12.0, ratio=4.5, offset=0.015)
ROUNDED = Links(0.092, 0.413, 0.015)


class Printed(NamedTuple):
    """The source's table: angles over π as printed and in rad, values [m/rad], half of their last digit."""

    names: list[str]
    angles: np.ndarray
    values: np.ndarray
    half: np.ndarray


def printed_table() -> Printed:
    """Return the printed table of the transfer function."""
    table = read_table(DATA / "transfer_function.csv")
    names = [row["angle_over_pi"] for row in table]
    shares = [float(a) / float(b or 1) for a, _, b in (name.partition("/") for name in names)]
    half = [0.5 * 10.0 ** -len(row["value"].partition(".")[2]) for row in table]
    return Printed(names, np.pi * np.array(shares), np.array([float(row["value"]) for row in table]), np.array(half))


def functions(table: Printed) -> None:
    """Print the three functions at the table's angles, and how many values agree to the printed digits."""
    print("Transfer function [m/rad] at the 32 angles of the source")
    print(f"{'angle/pi':>9} {'printed':>11}" + "".join(f"{name:>12}" for name in FUNCTIONS))
    found = {name: function(table.angles, NOMINAL) for name, function in FUNCTIONS.items()}
    for i, name in enumerate(table.names):
        print(f"{name:>9} {table.values[i]:>11.7g}" + "".join(f"{found[each][i]:>12.7f}" for each in FUNCTIONS))
    for links, text in ((NOMINAL, "r = 4.4/48 m, l = 4.5 r"), (ROUNDED, "r = 0.092 m, l = 0.413 m")):
        agree = [int(np.sum(np.abs(f(table.angles, links) - table.values) <= table.half)) for f in FUNCTIONS.values()]
        print(f"agree to the printed digits, {text}: ", dict(zip(FUNCTIONS, agree, strict=True)))


def deviations(table: Printed) -> None:
    """Compare the ten printed standard deviations and the limit with ours."""
    printed = read_table(DATA / "deviations.csv")
    alpha = table.angles
    print("\nStandard deviations [mm/rad] and their difference from the printed ones")
    print("rounded: function behind the table against the printed, rounded values; exact: against itself; right: dx/da")
    print(f"{'crank':>6} {'rod':>5} {'printed':>9} {'rounded':>9} {'':>7} {'exact':>9} {'':>7} {'right':>9} {'':>7}")
    for row in printed[:-1]:
        changes = [1.0 + 0.01 * float(row[key]) for key in ("crank_percent", "rod_percent")]
        changed, theirs = NOMINAL.scaled(*changes), float(row["deviation"])
        rounded = deviation(tabulated, alpha, NOMINAL, changed, table.values)
        ours = (rounded, *(deviation(each, alpha, NOMINAL, changed) for each in (tabulated, FUNCTIONS["right"])))
        cells = "".join(f" {1e3 * x:>9.6f} {100 * (x / theirs - 1):>+6.1f}%" for x in ours)
        print(f"{row['crank_percent']:>5}% {row['rod_percent']:>4}% {1e3 * theirs:>9.6f}{cells}")
    theirs = float(printed[-1]["deviation"])
    print(f"limit of the source (5 %): {1e3 * theirs:.6f}")
    for sign in (1.05, 0.95):
        ours = tolerance.spread(sign * tabulated(alpha, NOMINAL) - table.values)
        print(f"  {sign} times the function behind the table: {1e3 * ours:.6f} ({100 * (ours / theirs - 1):+.2f} %)")
    for name, function in FUNCTIONS.items():
        print(f"  5 % plane of `{name}`: {1e3 * plane(function, alpha, NOMINAL):.6f}")


def grades() -> None:
    """Print the effect of 1 % errors and of accuracy grades on the law of motion, over a whole revolution."""
    print("\nError of the law as a share of the law (equal standard deviations over a whole turn)")
    print(f"{'function':>10} {'crank +1%':>10} {'rod +1%':>9} {'rod/crank':>10} {'largest on the square':>22}")
    for name, function in FUNCTIONS.items():
        whole = plane(function, TURN, NOMINAL, 1.0)
        one = [deviation(function, TURN, NOMINAL, NOMINAL.scaled(*s)) / whole for s in ((1.01, 1.0), (1.0, 1.01))]
        top = np.max(tolerance.surface(function, TURN, NOMINAL, np.linspace(-0.05, 0.05, 21))) / whole
        print(f"{name:>10} {100 * one[0]:>9.4f}% {100 * one[1]:>8.4f}% {one[1] / one[0]:>10.3f} {100 * top:>21.3f}%")
    print("\nISO 286 grades, tolerances symmetric about the nominal lengths, worst corner, dx/da")
    print(f"{'crank':>6} {'rod':>5} {'crank width':>12} {'rod width':>10} {'error of the law':>17} {'dead centre':>16}")
    for pair in ((15, 16), *((number, number) for number in tolerance.GRADES)):
        g = tolerance.grade(FUNCTIONS["right"], TURN, NOMINAL, *pair)
        print(
            f"  IT{g.crank:<3} IT{g.rod:<3} {1e3 * g.crank_width:>9.3f} mm {1e3 * g.rod_width:>7.3f} mm "
            f"{100 * g.error:>16.4f}% {1e3 * g.head:>12.3f} mm"
        )
    for name in ("right", "tabulated"):
        found = {
            share: tolerance.coarsest(FUNCTIONS[name], TURN, NOMINAL, share) for share in (0.05, 0.01, 0.005, 0.001)
        }
        text = ", ".join(f"{100 * share:g} %: {'none' if g is None else f'IT{g.crank}'}" for share, g in found.items())
        print(f"coarsest grade of both links, `{name}`, for a law within {text}")


def main() -> None:
    """Print the study and draw its figures."""
    table = printed_table()
    functions(table)
    deviations(table)
    grades()
    folder = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "results" / "tolerance")
    for path in draw_tolerance(table.angles, NOMINAL, (table.angles, table.values), folder):
        print(path, file=sys.stderr)


if __name__ == "__main__":
    main()
