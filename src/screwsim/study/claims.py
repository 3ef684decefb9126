"""The claims A1–A7 of Chernov et al. 2015, measured on stored sweeps (docs/explanation/paper.md says what each means).

`python -m screwsim.study.claims FIG1.h5 FIG2.h5` prints the table. A verdict is `holds`, `in part`, `fails` or, for a
number to which the machine was fitted, `calibrated`: that is no evidence.
"""

import sys
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import RPM
from screwsim.results import open_results
from screwsim.screen import say

PAPER_TITLE = "Chernov et al. 2015"  # start of the titles in configs/paper
WIDTH = 80  # of a line of the table
Array = np.ndarray
A5_RATIO, A5_SPEED, A5_EFFICIENCY, A5_TOLERANCE = 3.0, 1000.0, 0.68, 0.005
A6_EFFICIENCY, A6_TOLERANCE = 0.44, 0.02
_AXES = ("oil_supply.ratio", "oil_supply.orifice_diameter")  # of Fig. 1 and of Fig. 2, besides the speed


@dataclass(frozen=True)
class Optimum:
    """Maximum of η over ln d: its place, height and sharpness.

    `curvature` is −d²η/d(ln d)²/η there; `drop` the mean relative loss at a third and at three times the optimal d
    (None where the curve does not reach that far). `interior` is False when the maximum lies at an end.
    """

    ratio: float
    efficiency: float
    curvature: float
    drop: float | None
    interior: bool


def curve_optimum(ratio: Array, efficiency: Array) -> Optimum | None:
    """Return the optimum of one curve, from a parabola in ln d through the points within a factor 1.6 of the best.

    Points that are not finite are left out; None when fewer than five remain.
    """
    x, eta = _over_logarithm(ratio, efficiency)
    if len(x) < 5:
        return None
    best = int(np.argmax(eta))
    if best in (0, len(x) - 1):
        return Optimum(float(np.exp(x[best])), float(eta[best]), 0.0, None, False)
    near = np.abs(x - x[best]) <= np.log(1.6)
    near[best - 1 : best + 2] = True
    a, b, c = np.polyfit(x[near] - x[best], eta[near], 2)
    if a >= 0.0:
        return Optimum(float(np.exp(x[best])), float(eta[best]), 0.0, None, True)
    shift = float(np.clip(-b / (2.0 * a), x[best - 1] - x[best], x[best + 1] - x[best]))
    top = float(a * shift**2 + b * shift + c)
    at = x[best] + shift
    sides = [float(np.interp(at + s, x, eta)) for s in (-np.log(3.0), np.log(3.0)) if x[0] <= at + s <= x[-1]]
    drop = float(np.mean([1.0 - side / top for side in sides])) if len(sides) == 2 else None
    return Optimum(float(np.exp(at)), top, float(-2.0 * a / top), drop, True)


def value_at(ratio: Array, efficiency: Array, d: float) -> float | None:
    """Return η at the oil ratio d, linear in ln d; None outside the curve or without values there."""
    x, eta = _over_logarithm(ratio, efficiency)
    if len(x) < 2 or not x[0] - 1e-9 <= np.log(d) <= x[-1] + 1e-9:
        return None
    return float(np.interp(np.log(d), x, eta))


def _over_logarithm(ratio: Array, efficiency: Array) -> tuple[Array, Array]:
    """Return the finite points of a curve as ascending ln d, and η."""
    good = np.isfinite(efficiency) & (ratio > 0.0)
    order = np.argsort(ratio[good])
    return np.log(ratio[good])[order], efficiency[good][order]


@dataclass(frozen=True)
class Claim:
    """One claim: the paper's statement, how it is measured, the finding and the verdict."""

    name: str
    says: str
    measure: str
    found: str
    verdict: str


@dataclass(frozen=True)
class PumpCurves:
    """Fig. 1: speeds [rpm] from fast to slow, oil ratios, η by (speed, ratio), one optimum per speed."""

    speeds: Array
    ratios: Array
    efficiency: Array
    optima: list[Optimum | None]


@dataclass(frozen=True)
class DisplacementCurve:
    """Fig. 2 for one bore [m] of the orifice: speeds [rpm], with the oil ratio and η at each."""

    bore: float
    speeds: Array
    ratio: Array
    efficiency: Array


def read_pump(path: str) -> PumpCurves:
    """Return the curves of a stored sweep over operation.speed and oil_supply.ratio."""
    data = open_results(path)
    eta = np.array(data.performance["isothermal_efficiency"])
    names = list(data.axes)
    if names.index("operation.speed") > names.index("oil_supply.ratio"):
        eta = eta.T
    speeds, ratios = np.array(data.axes["operation.speed"]) / RPM, np.array(data.axes["oil_supply.ratio"])
    order = np.argsort(-speeds)
    return PumpCurves(speeds[order], ratios, eta[order], [curve_optimum(ratios, row) for row in eta[order]])


def read_displacement(path: str) -> list[DisplacementCurve]:
    """Return one curve per bore from a stored sweep over operation.speed and oil_supply.orifice_diameter."""
    data = open_results(path)
    ratio, eta = (np.array(data.performance[name]) for name in ("oil_ratio", "isothermal_efficiency"))
    speeds, bores = np.array(data.axes["operation.speed"]) / RPM, np.array(data.axes["oil_supply.orifice_diameter"])
    if list(data.axes).index("operation.speed") == 0:
        ratio, eta = ratio.T, eta.T
    return [DisplacementCurve(float(bore), speeds, *rows) for bore, *rows in zip(bores, ratio, eta, strict=True)]


def _values(pump: PumpCurves, pick: Callable[[Optimum], float | None]) -> list[float | None]:
    """Return a measure of the optimum at each speed; None where the optimum is not inside the range."""
    return [pick(best) if best is not None and best.interior else None for best in pump.optima]


def _ordered(values: list[float | None], rising: bool) -> bool:
    """Return whether a measure rises (or falls) strictly as speed falls, with an interior optimum at every speed."""
    known = [value for value in values if value is not None]
    if len(known) < len(values):
        return False
    steps = np.diff(known)
    return bool(np.all(steps > 0.0) if rising else np.all(steps < 0.0))


def _list(values: list[float | None], form: str) -> str:
    return ", ".join("none" if value is None else format(value, form) for value in values)


def shape_claims(pump: PumpCurves) -> list[Claim]:
    """Return A1–A4, the shapes of Fig. 1; lists run from the fastest speed to the slowest."""
    top, d = _values(pump, lambda best: best.efficiency), _values(pump, lambda best: best.ratio)
    bend, drop = _values(pump, lambda best: best.curvature), _values(pump, lambda best: best.drop)
    inside = f"maximum inside the range of d, at {'/'.join(f'{speed:.0f}' for speed in pump.speeds)} rpm"
    interior = all(best is not None and best.interior for best in pump.optima)
    sharp = f"{_list(bend, '.3f')}; {_list(drop, '.1%')}"
    measure, sharper = "-d2eta/d(ln d)2/eta; drop at d/3 and 3d", _ordered(bend, True) and _ordered(drop, True)
    lower, higher, rises = _ordered(top, False), _ordered(d, True), "optimal oil ratio rises as speed falls"
    found = (
        ("A1", "every curve has a maximum over d", inside, _list(top, ".1%"), interior),
        ("A2", "slower: lower maxima", "highest efficiency falls with speed", _list(top, ".2%"), lower),
        ("A3", "slower: more pronounced maxima", measure, sharp, sharper),
        ("A4", "slower: maxima at higher d", rises, _list(d, ".2f"), higher),
    )
    return [Claim(a, says, how, what, "holds" if holds else "fails") for a, says, how, what, holds in found]


def pump_point(pump: PumpCurves) -> Claim:
    """Return A5, to which the machine was calibrated."""
    row = int(np.argmin(np.abs(pump.speeds - A5_SPEED)))
    eta = value_at(pump.ratios, pump.efficiency[row], A5_RATIO)
    off = eta is None or abs(eta - A5_EFFICIENCY) > A5_TOLERANCE or abs(pump.speeds[row] - A5_SPEED) > 1.0
    found, verdict = "none" if eta is None else f"{eta:.2%}", "fails" if off else "calibrated"
    return Claim("A5", "pump, 1000 rpm, d = 3: 68 %", "within 0.5 points (fitted)", found, verdict)


def _speed_of_ratio(line: DisplacementCurve, d: float) -> float | None:
    """Return the speed [rpm] at which displacement gives the oil ratio d, interpolated in logarithms."""
    x, speeds = _over_logarithm(line.ratio, np.where(np.isfinite(line.efficiency), line.speeds, np.nan))
    if len(x) < 2 or not x[0] <= np.log(d) <= x[-1]:
        return None
    return float(np.exp(np.interp(np.log(d), x, np.log(speeds))))


def _best_claim(claims: list[Claim]) -> Claim:
    """Return one claim for several bores: the findings for each, and the best verdict."""
    order = ("holds", "calibrated", "in part", "fails")
    verdict = min((claim.verdict for claim in claims), key=order.index)
    return replace(claims[0], found="; ".join(claim.found for claim in claims), verdict=verdict)


def displaced_point(line: DisplacementCurve) -> Claim:
    """Return A6 for one bore: efficiency and speed where displacement gives d = 3, and the point at 1000 rpm."""
    speed, eta = _speed_of_ratio(line, A5_RATIO), value_at(line.ratio, line.efficiency, A5_RATIO)
    at_1000 = value_at(line.speeds, line.efficiency, A5_SPEED)
    d_1000 = value_at(line.speeds, line.ratio, A5_SPEED)
    found = f"bore {1e3 * line.bore:.3g} mm: "
    found += "d = 3 is not reached" if speed is None or eta is None else f"{eta:.1%} at {speed:.0f} rpm, where d = 3"
    if at_1000 is not None and d_1000 is not None:
        found += f", {at_1000:.1%} at 1000 rpm, where d = {d_1000:.2f}"
    close = eta is not None and speed is not None and abs(eta - A6_EFFICIENCY) <= A6_TOLERANCE
    measure = "within 2 points at the speed that gives d = 3 (bore fitted)"
    return Claim("A6", "displacement, d = 3: 44 %", measure, found, "calibrated" if close else "fails")


def displaced_optimum(pump: PumpCurves, line: DisplacementCurve) -> Claim:
    """Return A7 for one bore: an optimum must exist, at a higher d than the pump's, and below the pump's best."""
    says = "displacement has an optimum, at rather high d, and is less economical than the pump"
    measure = "maximum within the pump's speeds; its d above the pump's optimum there; efficiency below the pump's best"
    best, bore = curve_optimum(line.ratio, line.efficiency), f"bore {1e3 * line.bore:.3g} mm: "
    speed = None if best is None or not best.interior else _speed_of_ratio(line, best.ratio)
    optima = [(s, o) for s, o in zip(pump.speeds, pump.optima, strict=True) if o is not None and o.interior]
    if best is None or speed is None or len(optima) < 2:
        return Claim("A7", says, measure, bore + "no maximum inside the range", "fails")
    x = np.log([s for s, _ in optima])[::-1]
    d_pump = float(np.exp(np.interp(np.log(speed), x, np.log([o.ratio for _, o in optima])[::-1])))
    eta_pump = float(np.interp(np.log(speed), x, [o.efficiency for _, o in optima][::-1]))
    found = f"{bore}maximum {best.efficiency:.2%} at d = {best.ratio:.2f} ({speed:.0f} rpm), "
    inside = speed <= float(np.max(pump.speeds)) * (1.0 + 1e-9)
    found += f"pump {'there' if inside else 'at its fastest'} {eta_pump:.2%} at d = {d_pump:.2f}"
    holds = inside and best.ratio > d_pump and best.efficiency < eta_pump
    return Claim("A7", says, measure, found, "holds" if holds else "in part")


def claims(fig1: str, fig2: str) -> list[Claim]:
    """Return A1–A7 from the stored sweeps of Fig. 1 and Fig. 2."""
    pump, lines = read_pump(fig1), read_displacement(fig2)
    point = _best_claim([displaced_point(line) for line in lines])
    shape = _best_claim([displaced_optimum(pump, line) for line in lines])
    return [*shape_claims(pump), pump_point(pump), point, shape]


def claims_of(path: str, other: str | None = None) -> list[Claim]:
    """Return the claims that can be checked on a stored sweep of the paper; none for any other file.

    The sweep of Fig. 1 gives A1–A5, that of Fig. 2 A6, both together, in either order, all seven.
    """
    files = [path] if other is None else [path, other]
    pumps, bores = ([file for file in files if _is_figure(file, axis)] for axis in _AXES)
    if pumps and bores:
        return claims(pumps[0], bores[0])
    if other is not None:
        raise UsageError(f"{other}: --with joins the paper's two sweeps, and these are not both (leave it out)")
    if pumps:
        pump = read_pump(pumps[0])
        return [*shape_claims(pump), pump_point(pump)]
    return [_best_claim([displaced_point(line) for line in read_displacement(bores[0])])] if bores else []


def _is_figure(path: str, axis: str) -> bool:
    """Return whether a file is the paper's sweep over the speed and that axis, by its title and axes."""
    data = open_results(path)
    return str(data.attributes["title"]).startswith(PAPER_TITLE) and set(data.axes) == {"operation.speed", axis}


def table(found: list[Claim]) -> str:
    """Return the claims as text, wrapped to the width of a screen: what each says, its measure, what is found."""
    rows = (
        row
        for claim in found
        for row in (
            (f"{claim.name}  {claim.verdict:<10}  ", claim.says),
            ("    measure: ", claim.measure),
            ("    found:   ", claim.found),
        )
    )
    return "\n".join(
        textwrap.fill(words, WIDTH, initial_indent=head, subsequent_indent=" " * len(head)) for head, words in rows
    )


def main(arguments: Sequence[str]) -> int:
    """Print the claims of two files; return the exit code."""
    try:
        if len(arguments) != len(_AXES):
            raise UsageError("claims needs two files: the sweep of Fig. 1, then that of Fig. 2")
        for name, axis in zip(arguments, _AXES, strict=True):
            if not _is_figure(name, axis):
                raise UsageError(f"{name}: is not the paper's sweep over {axis} (give that of Fig. 1, then of Fig. 2)")
        say(table(claims(*arguments)))
    except UsageError as error:
        say(error, err=True)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
