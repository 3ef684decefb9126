"""What is said of a cycle: why it failed or did not close, what may help, and what of its figures is doubtful."""

from __future__ import annotations

import math

import numpy as np

from screwsim import plausible
from screwsim.effects.base import OilRoom, Stops
from screwsim.estimate import worst
from screwsim.fluid.limits import Limit, Outside
from screwsim.fluid.orifice import outside_fit
from screwsim.model import close as closing
from screwsim.model.pulsation import LOWEST
from screwsim.model.residues import LEAST_OIL
from screwsim.model.slots import R_LOCK, R_OIL_BEFORE
from screwsim.model.stops import MOST_IMPACTS
from screwsim.numerics.integrators import check_of
from screwsim.outputs import Figures
from screwsim.scene.plausible import scene_warnings
from screwsim.solution import Solution

ALL_BUT_LOCKED = 0.9  # share of the oil in a chamber's volume where an integration that stops there shows a lock
LESS = "use more or cooler oil, a wider discharge port, a larger machine.volume.min or smaller leaks"
REMEDIES = {  # of the limits of an equation of state
    Limit.HOT: LESS,
    Limit.PRESSED: LESS,
    Limit.COLD: "use warmer suction gas or oil, or a wider suction port",
    Limit.WET: "use warmer oil or gas, or gas.two_phase: equilibrium",
}

HOT = 1000.0  # [K] beyond what a machine stands
PHASES = 120  # of a pitch at which a plenum's pressure is looked at
RESTLESS = 500  # impacts of a turn that does not settle, above which the reeds are why
UNSETTLED = 0.05  # change of the states in a pitch above which a cycle is far from closed


def refused(solution: Solution) -> str:
    """Return where and why the closed cycle leaves what the gas's equation covers; empty when it does not."""
    gas = solution.parts.gas
    times, dense, _, steps = solution.machinery.last()
    T, rho = (np.ascontiguousarray(dense[:steps, 1, column]) for column in (0, 1))
    i = gas.first_outside(T, rho)
    found = None if i is None else gas.why_outside(float(T[i]), float(rho[i]))
    return "" if i is None or found is None else f"at {math.degrees(times[i + 1]):.2f} deg {_remedied(found)}"


def _remedied(found: Outside) -> str:
    """Return which limit of its gas a state violates, with the remedy."""
    return f"{found.what}; {REMEDIES[found.limit]}"


def beyond_its_mean(solution: Solution) -> str:
    """Return that a plenum's pressure swings beyond its mean, where no M186 holds; empty where none does."""
    machinery, c = solution.machinery, solution.machinery.composition
    for part in solution.parts.pulsations:
        line = solution.parts.number(part.to)
        angles = np.linspace(0.0, solution.parts.geometry.pitch, PHASES, endpoint=False)
        pulses = np.array([machinery.module.line_pulse(line, angle, c.P) for angle in angles])
        if np.min(1.0 + pulses[:, 1] / (1.0 + pulses[:, 0])) < LOWEST:
            return part.swings or f"the pressure of the {part.to} line would swing beyond its mean"
    return ""


def unclosed(solution: Solution, closed: closing.Closed) -> str:
    """Return what may help a cycle that did not close."""
    numerics = solution.scene.numerics
    if solution.machinery.impacts > RESTLESS:
        return f"its turns do not settle, with {_restless(solution)}"
    for part in solution.parts.pulsations:
        if part.shut is not None and part.shut(solution.turn(closed.q)):
            return part.stuck or f"the {part.to} line stays shut and the turns do not settle"
    if check_of(numerics.integrator) or numerics.closing == "histories" or closed.status != "not_closed":
        coupled = "numerics.closing: coupled, or " if closed.how != "coupled" else ""
        return f"try {coupled}a tighter numerics.accuracy"
    if closed.change < UNSETTLED:
        return "no further try closed it either: the accuracy may be too fine (a larger numerics.accuracy)"
    _, dense, _, steps = solution.machinery.last()
    hottest = dense[:steps, 1, 0].max()
    if hottest < HOT:
        return "no further try closed it either: its turns do not settle (smaller leaks, or another speed)"
    return (
        f"no further try closed it either: its turns do not settle, with gas at up to {hottest:.2g} "
        "K; gas that all but cannot get out heats, empties and fills the chambers anew without end (a wider discharge "
        "port, smaller leaks or a lower speed)"
    )


def _restless(solution: Solution) -> str:
    """Return what to do about reeds that hardly come to rest."""
    remedies = dict.fromkeys(part.remedy for _, part in solution.parts.all(Stops) if part.remedy)
    what = "impacts of its reeds in a turn; reeds that lose so little at an impact bounce on and on"
    return f"{solution.machinery.impacts} {what}" + (f" ({'; '.join(remedies)})" if remedies else "")


def failure(solution: Solution, closed: closing.Closed) -> str:
    y = ", ".join(
        f"{name} = {value:.6g}" for name, value in zip(solution.machinery.composition.states, closed.y, strict=False)
    )
    lock = _hydraulic_lock(solution, closed)
    if lock:
        return lock
    if solution.machinery.impacts > MOST_IMPACTS:
        return f"the turn was left at {math.degrees(closed.angle):.2f} deg after {_restless(solution)}"
    reason = solution.parts.gas.why_outside(float(closed.y[0]), float(closed.y[1]))
    if reason is not None:
        return f"the integration stopped at {math.degrees(closed.angle):.2f} deg: {_remedied(reason)}"
    return (
        f"the integration stopped at {math.degrees(closed.angle):.2f} deg ({y}); "
        "check port areas, clearances and pressures, or ask for a tighter numerics.accuracy"
    )


def _hydraulic_lock(solution: Solution, closed: closing.Closed) -> str:
    """Return that and where the oil fills the chamber; empty where it does not, or takes no room (M111)."""
    parts, R, n = solution.parts, solution.machinery.R, solution.machinery.n
    if not parts.oil_room or parts.oil is None:
        return ""
    angle = closed.angle
    rho, x = closed.y[1::n], closed.y[3::n]
    shares = 1.0 - 1.0 / (1.0 + x * rho / parts.oil.density)
    if R[R_LOCK] > 0.0:
        angle, share = parts.geometry.injection_angle, 1.0
    else:
        fullest = int(np.argmax(np.nan_to_num(shares)))
        angle, share = closed.angle + fullest * parts.geometry.pitch, float(shares[fullest])
    if not share >= ALL_BUT_LOCKED:
        return ""
    remedies = "".join(f", or {part.remedy}" for _, part in parts.all(OilRoom) if part.remedy)
    return (
        f"hydraulic lock at {math.degrees(angle):.2f} deg: the oil fills the chamber ({share:.1%} of its volume where "
        "the integration stopped); use less oil (a lower oil_supply.ratio or a smaller orifice), open the discharge "
        f"port earlier or wider{remedies}"
    )


def warnings(solution: Solution, found: Figures) -> tuple[str, ...]:
    R, supply = solution.machinery.R, solution.scene.oil_supply
    told = []
    if (
        supply is not None
        and supply.kind == "pump"
        and solution.parts.oil_port is None
        and found.oil_ratio
        and found.oil_ratio > (supply.ratio or 0) * (1 + 1e-9) + LEAST_OIL
    ):
        told.append(
            f"leaks bring more oil ({float(R[R_OIL_BEFORE]):.3g} kg) into the chamber than oil_supply.ratio asks for; "
            f"nothing is injected and the ratio is {found.oil_ratio:.4g}"
        )
    told += _drowned(solution, found)
    told += _unfitted_bore(solution, found)
    asked = (active.effect.warnings for active in solution.scene.effects.values() if active.effect.warnings)
    told += [words for warn in asked for words in warn(found)]
    idle = [part.idle for part in solution.parts.pulsations if part.shut is not None]
    if found.gas_mass_flow == 0.0 and idle:
        nothing = "takes nothing in" if solution.parts.plenums else "delivers nothing"
        told.append(idle[0].format(nothing=nothing) or f"a valve stays shut: the machine {nothing}")
    elif found.gas_mass_flow is not None and found.gas_mass_flow <= 0.0:
        told.append(
            "no net gas is delivered; what flows in from the discharge line beyond what flowed out has "
            "operation.discharge.temperature, or where that is not given the temperature of isentropic compression"
        )
    return tuple(told)


def doubts(solution: Solution, found: Figures, error: Figures) -> tuple[str, ...]:
    """Return what of the scene, and of the figures of its cycle, can be and hardly is."""
    scene, parts = solution.scene, solution.parts
    told = plausible.Told(scene, parts, solution.lines, found, error)
    return (*scene_warnings(scene), *plausible.shut_ways(scene, parts), *plausible.doubts(told))


def _drowned(solution: Solution, found: Figures) -> list[str]:
    """Return a warning where the oil of a chamber is more than its volume holds when the discharge port opens.

    An expander's chamber has that volume when its inlet closes.
    """
    oil, geometry = solution.parts.oil, solution.parts.geometry
    opens = geometry.discharge_opens
    if oil is None or opens is None or not found.oil_ratio or not found.trapped_mass or solution.parts.oil_room:
        return []
    c = solution.machinery.composition
    share = found.oil_ratio * found.trapped_mass / oil.density / solution.machinery.module.volume_at(opens, c.P, c.TAB)
    if share < 1.0:
        return []
    when = "inlet closes" if geometry.expands else "discharge port opens"
    return [
        f"the oil would fill {share:.0%} of the chamber when the {when}; oil takes no room in this model "
        "(lower oil_supply.ratio, or take the result as a limit)"
    ]


def _unfitted_bore(solution: Solution, found: Figures) -> list[str]:
    """Return a warning where the bore that lets the oil in lies outside what the formula of its flow was fitted to."""
    oil, port = solution.parts.oil, solution.parts.oil_port
    if oil is None or "diameter" not in oil.supply:
        return []
    bore, source = oil.supply, oil.supply["separator_pressure"]
    before = source - (0.0 if port is None else port.loss(source))
    drop = max(before - (found.injection_pressure or 0.0), 0.0)
    reynolds = bore["diameter"] * math.sqrt(2.0 * drop * bore["density"]) / bore["viscosity"]
    why = outside_fit(bore["length"] / bore["diameter"], reynolds)
    return [f"the formula of the oil's flow is stretched beyond its range: {why}"] if why else []


def inaccurate(wanted: float, error: Figures) -> tuple[str, ...]:
    """Return a warning when the estimated error of a figure stayed above the wanted accuracy, or when there is none."""
    if error and all(size is None for size in error.values()):
        return ("the errors could not be estimated: the finer solution did not reach its end",)
    name, size = worst(error)
    if size <= wanted:
        return ()
    return (f"the estimated error of {name}, {size:.2g}, is above the wanted accuracy {wanted:.2g}",)
