"""Whether the wanted accuracy is kept: the true error of a scene's figures, from a much more accurate solution.

`drawn` draws scenes around a given one, of its structure (so that nothing is compiled anew), with other numbers: speed,
pressures, gaps, ports, oil, dead volume, and the wanted accuracy itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from screwsim.evaluate.cautions import inaccurate
from screwsim.figures.errors import relative_errors, worst
from screwsim.outputs import Figures, Result
from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.checks import cross_check
from screwsim.simulate import simulate
from screwsim.study.accuracy.solving import WorkLimit, method_of, solve
from screwsim.study.pool.parallel import WarmSimulation

RPM = 2.0 * math.pi / 60.0
FINER = 2e-2, 5e-3, 1e-3  # accuracies of finer solutions over the wanted one: tried until two agree
KNOWN = 0.1  # of the wanted accuracy: largest difference of these two at which the true error is known
RADAU_FINER = 1e-3  # accuracy of the independent reference over the wanted one
FINEST, COARSEST = 1e-9, 1e-8  # limits of that accuracy
RADAU = 1e-10  # tolerance of its steps
WIDTH = 1e-2  # of its accuracy: regularisation, practically none
LIMIT = 120.0  # [s] for it
ACCURACIES = 1e-5, 1e-2  # drawn evenly in logarithms
TRIES = 200  # draws until one is valid
ANOTHER = "another cycle"  # status of a reference that reached another one: the machine has several
APART = 10.0  # wanted accuracies: distance from which on two cycles may be different ones
Reference = Callable[[Scene, float | None], tuple[str, Figures]]
JUDGED = 0.05  # of the wanted accuracy: estimates of smaller errors do not matter


class Kept(NamedTuple):
    """One scene: wanted accuracy, estimated and true error, and the figure of the latter."""

    status: str
    wanted: float
    estimated: float
    true: float
    figure: str
    reference: str  # 'coupled' | 'scipy-radau'
    evaluations: int
    warned: bool
    changes: dict[str, Any]

    @property
    def ratio(self) -> float:
        """True error over the wanted accuracy."""
        return self.true / self.wanted


# path: (lowest, highest) [SI], drawn evenly in logarithms
_ABSOLUTE = {
    "operation.speed": (200.0 * RPM, 8000.0 * RPM),
    "machine.suction_port.area": (20e-4, 200e-4),
    "machine.discharge_port.area": (10e-4, 120e-4),
    "effects.tip_leakage.gap": (5e-6, 100e-6),
    "effects.interlobe_leakage.gap": (5e-6, 100e-6),
    "effects.end_face_leakage.gap": (5e-6, 100e-6),
    "effects.blow_hole.area": (1e-6, 40e-6),
    "effects.oil_heat.droplet_radius": (5e-6, 500e-6),
    "oil_supply.ratio": (0.1, 8.0),
}
_ANGLES = {"machine.discharge_port.opens": (590.0, 690.0), "machine.discharge_port.phi_C": (610.0, 700.0)}
RATIOS = 1.5, 12.0  # of pressures
SUPERHEAT = 5.0, 30.0  # [K], where the scene states one


def drawn(scene: Scene, random: np.random.Generator) -> tuple[Scene, dict[str, Any]]:
    """Return a scene of the same structure with other numbers [SI], and these numbers."""
    for _ in range(TRIES):
        changes = _changes(scene, random)
        found = with_values(scene, changes)
        if not cross_check(found):
            return found, changes
    raise ValueError("no scene that makes sense was drawn: its ranges do not fit this one")


def _changes(scene: Scene, random: np.random.Generator) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    for path, (low, high) in _ABSOLUTE.items():
        name = path.split(".")[1]
        if path.startswith("effects.") and name not in scene.effects:
            continue
        if path.startswith("oil_supply.") and scene.oil_supply is None:
            continue
        changes[path] = _log_uniform(random, low, high)
    for path, (low, high) in _ANGLES.items():
        changes[path] = math.radians(random.uniform(low, high))
    suction = value_at(scene, "operation.suction.pressure")
    if suction is not None:
        changes["operation.discharge.pressure"] = suction * _log_uniform(random, *RATIOS)
    else:
        changes["operation.superheat"] = random.uniform(*SUPERHEAT)
    changes["numerics.accuracy"] = _log_uniform(random, *ACCURACIES)
    return changes


def _log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(random.uniform(math.log(low), math.log(high))))


def reference(scene: Scene, radau: float | None = None) -> tuple[str, Figures]:
    """Return status and figures of the reference: by scipy's Radau where its step tolerance is given."""
    return _by_coupling(scene) if radau is None else _by_radau(scene, radau)


def true_error(
    scene: Scene, result: Result, radau: float | None = None, asked: Reference = reference
) -> tuple[str, str, float]:
    """Return status of the reference, the figure that differs most from it and by how much, NaN without one.

    Finer solutions from a cold start may reach another cycle of a machine that has two, as gaps that pass oil or gas
    cause it: where they lie far away, solutions from the scene's own cycle are used, and the status is `ANOTHER` where
    they stay on it.
    """
    status, better = asked(scene, radau)
    if status != "ok":
        return status, "", math.nan
    figure, error = worst(relative_errors(result.performance, better))
    if radau is None and error > APART * scene.numerics.accuracy:
        own = WarmSimulation()
        own(scene)
        stayed, better = _by_coupling(scene, own)
        near = worst(relative_errors(result.performance, better)) if stayed == "ok" else (figure, error)
        if near[1] < error / APART:
            return ANOTHER, *near
    return status, figure, error


def _by_coupling(scene: Scene, simulated: Callable[[Scene], Result] | None = None) -> tuple[str, Figures]:
    """Return status and figures of the finer of two much finer solutions by coupled chambers, which have to agree."""
    accuracy, before = scene.numerics.accuracy, None
    for share in FINER:
        finer = replace(scene.numerics, accuracy=share * accuracy, closing="coupled", error="none")
        asked = replace(scene, numerics=finer)
        found = simulated(asked) if simulated else simulate(asked, trace=False)
        if found.status != "ok":
            return found.status, Figures()
        if before is not None and worst(relative_errors(before, found.performance))[1] <= KNOWN * accuracy:
            return "ok", found.performance
        before = found.performance
    return "differs from others", Figures()


def _by_radau(scene: Scene, rtol: float) -> tuple[str, Figures]:
    """Return status and figures of coupled chambers under scipy's Radau, with hardly any regularisation.

    It is a thousand times finer than wanted, within `FINEST` and `COARSEST`.
    """
    accuracy = scene.numerics.accuracy
    fine = min(max(RADAU_FINER * accuracy, FINEST), COARSEST)
    # the balances of scipy's methods are as good as their steps, not kept to rounding
    how = method_of(fine, "scipy-radau", rtol=rtol, regularised=WIDTH * fine, bound=0.1 * accuracy)
    try:
        found = solve(scene, how, LIMIT)
    except WorkLimit as error:
        return str(error), Figures()
    return found.cycle.status, found.evaluation.figures if found.cycle.status != "failed" else Figures()


def kept(scene: Scene, changes: dict[str, Any], radau: float | None = None, asked: Reference = reference) -> Kept:
    """Return how a scene's figures compare with its reference: Radau where its step tolerance is given."""
    result, wanted = simulate(scene, trace=False), scene.numerics.accuracy
    status, name, true = result.status, "", math.nan
    if status == "ok":
        known, name, true = true_error(scene, result, radau, asked)
        status = "ok" if known in ("ok", ANOTHER) else f"reference {known}"
    kind = "coupled" if radau is None else "scipy-radau"
    estimated, evaluations = worst(Figures(result.error))[1], int(result.numerics.rhs_evaluations)
    return Kept(status, wanted, estimated, true, name, kind, evaluations, warns(result, wanted), changes)


def warns(result: Result, wanted: float) -> bool:
    """Return whether a result warns that its errors exceed the wanted accuracy, or that none could be estimated."""
    return bool(inaccurate(wanted, Figures(result.error)))


def estimates_over_errors(found: list[Kept]) -> list[float]:
    """Return estimated over true errors of ok scenes whose true error exceeds `JUDGED` of the wanted accuracy."""
    solved = [each for each in found if each.status == "ok"]
    return [each.estimated / each.true for each in solved if each.true > JUDGED * each.wanted and each.estimated > 0.0]


def shares_within_or_warned(found: list[Kept], most: float) -> float:
    """Return the share of scenes whose true error is within `most` times the wanted accuracy, or that warn of it."""
    return float(np.mean([each.warned or each.ratio <= most for each in found]))


def account(found: list[Kept]) -> str:
    """Return a summary of a sample, in lines."""
    solved = [each for each in found if each.status == "ok"]
    ratios = np.array([each.ratio for each in solved])
    lines = [f"{len(found)} scenes, {len(solved)} ok"]
    if len(ratios):
        share = float(np.mean(ratios <= 1.0))
        lines.append(
            f"true error within the wanted accuracy in {share:.1%}, within three times in {np.mean(ratios <= 3.0):.1%}"
        )
        within, three = (shares_within_or_warned(solved, most) for most in (1.0, 3.0))
        lines.append(f"or a warning says that it need not be: in {within:.1%}, in {three:.1%}")
        lines.append(f"wanted over true error: median {1.0 / np.median(ratios):.3g}, least {1.0 / ratios.max():.3g}")
    judged = estimates_over_errors(solved)
    if judged:
        low, middle, high = np.quantile(judged, (0.05, 0.5, 0.95))
        lines.append(
            f"estimated over true error, where that is above {JUDGED:g} of the wanted: median {middle:.2g}, 5 % below "
            f"{low:.2g}, 5 % above {high:.2g}"
        )
    for each in sorted(solved, key=lambda one: -one.ratio)[:10]:
        if each.ratio > 1.0:
            lines.append(
                f"  not kept: {each.figure} {each.true:.2g}, wanted {each.wanted:.2g}, estimated {each.estimated:.2g}"
                f"{', warned' if each.warned else ''}"
            )
    for status in sorted({each.status for each in found} - {"ok"}):
        lines.append(f"{sum(each.status == status for each in found)} {status.replace('_', ' ')}")
    return "\n".join(lines)
