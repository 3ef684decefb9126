"""What is said of a cycle: why it failed or did not close, what may help, and what of its figures is doubtful."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from screwsim.build import open_temperatures
from screwsim.cycle.problem import LEAST_OIL, Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.effects.base import InSeparator, OilRoom, Separator, Stops
from screwsim.errors import worst
from screwsim.evaluate import plausible
from screwsim.evaluate.evaluation import Evaluation
from screwsim.evaluate.separator import Circuit
from screwsim.faults import UsageError
from screwsim.fluid.gas import Gas
from screwsim.fluid.limits import Limit, Outside
from screwsim.fluid.orifice import outside_fit
from screwsim.model.impacts import MOST_IMPACTS
from screwsim.model.pulsation import LOWEST
from screwsim.model.slots import R_LOCK, R_OIL_BEFORE
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.integrators import check_of
from screwsim.outputs import Figures
from screwsim.scene.plausible import scene_warnings
from screwsim.scene.types import Found
from screwsim.scene.units import ZERO_CELSIUS

ALL_BUT_LOCKED = 0.9  # share of the oil in a chamber's volume where an integration that stops there shows a lock
LESS = "use more or cooler oil, a wider discharge port, a larger machine.volume.min or smaller leaks"
REMEDIES = {  # of the limits of an equation of state
    Limit.HOT: LESS,
    Limit.PRESSED: LESS,
    Limit.COLD: "use warmer suction gas or oil, or a wider suction port",
    Limit.WET: "use warmer oil or gas, or gas.two_phase: equilibrium",
    Limit.GLIDING: "use warmer oil or gas",
}

CONTRADICTS = 1.0  # [K] by which a stated temperature of the separator may differ from that of its balance
HOT = 1000.0  # [K] beyond what a machine stands
PHASES = 120  # of a pitch at which a plenum's pressure is looked at
RESTLESS = 500  # impacts of a turn that does not settle, above which the reeds are why
LOST = 0.02  # of the shaft power, that goes with what flows back to suction and deserves a word
UNSETTLED = 0.05  # change of the states in a pitch above which a cycle is far from closed


def refused(gas: Gas, life: Trajectory) -> str:
    """Return where and why a closed cycle leaves what the gas's equation covers; empty when it does not."""
    T, rho = life.ends
    i = gas.first_outside(T, rho)
    found = None if i is None else gas.why_outside(float(T[i]), float(rho[i]))
    return "" if i is None or found is None else f"at {math.degrees(life.times[i + 1]):.2f} deg {_remedied(found)}"


def _remedied(found: Outside) -> str:
    """Return which limit of its gas a state violates, with the remedy."""
    return f"{found.what}; {REMEDIES[found.limit]}"


def beyond_its_mean(problem: Problem, life: Trajectory) -> str:
    """Return that a plenum's pressure swings beyond its mean, where no M186 holds; empty where none does."""
    for part in problem.parts.pulsations:
        line = problem.parts.number(part.to)
        angles = np.linspace(0.0, problem.parts.geometry.pitch, PHASES, endpoint=False)
        pulses = np.array([life.module.line_pulse(line, angle, life.composition.P) for angle in angles])
        if np.min(1.0 + pulses[:, 1] / (1.0 + pulses[:, 0])) < LOWEST:
            return part.swings or f"the pressure of the {part.to} line would swing beyond its mean"
    return ""


def open_question(of: Evaluation, closed: bool) -> str:
    """Return what the scene leaves open of a cycle, and what to do; empty where nothing is open."""
    asked = (part.open_question for part in of.problem.parts.pulsations if part.open_question is not None)
    return next(filter(None, (ask(of.turn, closed) for ask in asked)), "")


def unclosed(of: Evaluation, cycle: CycleSolution) -> str:
    """Return what may help a cycle that did not close."""
    problem, numerics = of.problem, of.problem.scene.numerics
    if cycle.impacts > RESTLESS:
        return f"its turns do not settle, with {_restless(problem, cycle)}"
    for part in problem.parts.pulsations:
        if part.shut is not None and part.shut(of.turn):
            return part.stuck or f"the {part.to} line stays shut and the turns do not settle"
    if check_of(numerics.integrator) or numerics.closing == "histories" or cycle.status != "not_closed":
        coupled = "numerics.closing: coupled, or " if cycle.how != "coupled" else ""
        return f"try {coupled}a tighter numerics.accuracy"
    if cycle.change < UNSETTLED:
        return "no further try closed it either: the accuracy may be too fine (a larger numerics.accuracy)"
    hottest = of.life.ends[0].max()
    if hottest < HOT:
        return "no further try closed it either: its turns do not settle (smaller leaks, or another speed)"
    return (
        f"no further try closed it either: its turns do not settle, with gas at up to {hottest:.2g} "
        "K; gas that all but cannot get out heats, empties and fills the chambers anew without end (a wider discharge "
        "port, smaller leaks or a lower speed)"
    )


def _restless(problem: Problem, cycle: CycleSolution) -> str:
    """Return what to do about reeds that hardly come to rest."""
    remedies = dict.fromkeys(part.remedy for _, part in problem.parts.all(Stops) if part.remedy)
    what = "impacts of its reeds in a turn; reeds that lose so little at an impact bounce on and on"
    return f"{cycle.impacts} {what}" + (f" ({'; '.join(remedies)})" if remedies else "")


def failure(problem: Problem, cycle: CycleSolution) -> str:
    """Return where and why an integration stopped, and what to do."""
    states = zip(problem.composition.states, cycle.y, strict=False)
    y = ", ".join(f"{name} = {value:.6g}" for name, value in states)
    lock = _hydraulic_lock(problem, cycle)
    if lock:
        return lock
    if cycle.impacts > MOST_IMPACTS:
        return f"the turn was left at {math.degrees(cycle.angle):.2f} deg after {_restless(problem, cycle)}"
    reason = problem.parts.gas.why_outside(float(cycle.y[0]), float(cycle.y[1]))
    if reason is not None:
        return f"the integration stopped at {math.degrees(cycle.angle):.2f} deg: {_remedied(reason)}"
    return (
        f"the integration stopped at {math.degrees(cycle.angle):.2f} deg ({y}); "
        "check port areas, clearances and pressures, or ask for a tighter numerics.accuracy"
    )


def _hydraulic_lock(problem: Problem, cycle: CycleSolution) -> str:
    """Return that and where the oil fills the chamber; empty where it does not, or takes no room (M111)."""
    parts, R, n = problem.parts, cycle.trajectory.R, len(problem.composition.states)
    if not parts.oil_room or parts.oil is None:
        return ""
    angle = cycle.angle
    rho, x = cycle.y[1::n], cycle.y[3::n]
    shares = 1.0 - 1.0 / (1.0 + x * rho / parts.oil.density)
    if R[R_LOCK] > 0.0:
        angle, share = parts.geometry.injection_angle, 1.0
    else:
        fullest = int(np.argmax(np.nan_to_num(shares)))
        angle, share = cycle.angle + fullest * parts.geometry.pitch, float(shares[fullest])
    if not share >= ALL_BUT_LOCKED:
        return ""
    remedies = "".join(f", or {part.remedy}" for _, part in parts.all(OilRoom) if part.remedy)
    return (
        f"hydraulic lock at {math.degrees(angle):.2f} deg: the oil fills the chamber ({share:.1%} of its volume where "
        "the integration stopped); use less oil (a lower oil_supply.ratio or a smaller orifice), open the discharge "
        f"port earlier or wider{remedies}"
    )


def warnings(of: Evaluation) -> Iterator[str]:
    """Yield what of the oil, of effects and of the flow deserves a word."""
    problem, found = of.problem, of.figures
    parts, supply = problem.parts, problem.scene.oil_supply
    if (
        supply is not None
        and supply.kind == "pump"
        and parts.oil_port is None
        and found.oil_ratio
        and found.oil_ratio > (supply.ratio or 0) * (1 + 1e-9) + LEAST_OIL
    ):
        yield (
            f"leaks bring more oil ({of.life.R[R_OIL_BEFORE]:.3g} kg) into the chamber than oil_supply.ratio asks "
            f"for; nothing is injected and the ratio is {found.oil_ratio:.4g}"
        )
    yield from _drowned(of)
    yield from _unfitted_bore(of)
    yield from _lost_to_suction(of)
    yield from _separated(of)
    for active in problem.scene.effects.values():
        yield from active.effect.warnings(found) if active.effect.warnings else ()
    idle = [part.idle for part in parts.pulsations if part.shut is not None]
    if found.gas_mass_flow == 0.0 and idle:
        nothing = "takes nothing in" if parts.plenums else "delivers nothing"
        yield idle[0].format(nothing=nothing) or f"a valve stays shut: the machine {nothing}"
    elif found.gas_mass_flow is not None and found.gas_mass_flow <= 0.0:
        yield (
            "no net gas is delivered; what flows in from the discharge line beyond what flowed out has "
            "operation.discharge.temperature, or where that is not given the temperature of isentropic compression"
        )


def of_circuit(of: Evaluation) -> tuple[str, float]:
    """Return what forbids the oil's circuit of a cycle, or an empty text, and what it leaves open of the shaft power.

    Nothing of a scene without effects.separator.
    """
    circuit = of.circuit
    if circuit is None or not of.problem.parts.all(Separator):
        return "", 0.0
    if isinstance(circuit, str):
        found = any(open_temperatures(of.problem.scene))
        return (f"the oil's temperatures cannot be found: {circuit}" if found else ""), 0.0
    return circuit.parted.why, circuit.open


def _separated(of: Evaluation) -> Iterator[str]:
    """Yield what of the separator hardly is so: a thermostat that is idle, a temperature that its balance denies."""
    circuit = of.circuit
    if not isinstance(circuit, Circuit):
        return
    if circuit.parted.told:
        yield circuit.parted.told
    every = (active.parameters for active in of.problem.scene.effects.values())
    stated = next((one.separator_temperature for one in every if isinstance(one, InSeparator)), None)
    found, T = circuit.outflow, circuit.parted.T_separator
    if stated is None or isinstance(stated, Found) or abs(stated - T) <= CONTRADICTS:
        return
    try:
        needed = found.heat_of(stated) + found.oil_capacity * (stated - found.T_supply)
    except UsageError:  # no gas there
        return
    needed -= found.energy + found.heating + found.friction
    what = f"{1e-3 * abs(needed):.4g} kW of {'heating' if needed > 0.0 else 'cooling'}"
    yield (
        f"the separator's balance closes at {_celsius(T)}, not at the stated {_celsius(stated)}: it would need {what} "
        "(name effects.separator, which finds the temperature)"
    )


def _celsius(T: float) -> str:
    return f"{T - ZERO_CELSIUS:.1f} degC"


def doubts(problem: Problem, found: Figures, error: Figures) -> tuple[str, ...]:
    """Return what of the scene, and of the figures of its cycle, can be and hardly is."""
    scene, parts = problem.scene, problem.parts
    told = plausible.Told(scene, parts, problem.lines, found, error)
    return (*scene_warnings(scene), *plausible.shut_ways(scene, parts), *plausible.doubts(told))


def _lost_to_suction(of: Evaluation) -> Iterator[str]:
    """Yield a warning where a good part of the shaft power leaves to the suction line, and is not followed there."""
    parts, power, out = of.problem.parts, of.figures.shaft_power, of.streams[1]
    delivers = power > 0.0 and (of.figures.gas_mass_flow or 0.0) > 0.0
    if parts.suction_line or parts.geometry.expands or not of.problem.composition.carried or not delivers:
        return
    assert parts.oil is not None  # carried
    T_s = of.problem.lines.T_s + of.problem.pressed(of.problem.lines.p_s)
    heat = -float(out[1] - of.problem.inlet.enthalpy * out[0])
    heat -= parts.oil.heat_capacity * float(out[3] - T_s * out[2])
    heat *= of.problem.rate
    if abs(heat) > LOST * power:
        brings = "warms" if heat > 0.0 else "cools"
        yield (
            f"{1e-3 * abs(heat):.3g} kW, {abs(heat) / power:.0%} of the shaft power, goes with gas and oil that flow "
            f"back into the suction line, and is not counted where it {brings} what is sucked in (name "
            "effects.suction_line, which lets it come back)"
        )


def _drowned(of: Evaluation) -> Iterator[str]:
    """Yield a warning where the oil of a chamber is more than its volume holds when the discharge port opens.

    An expander's chamber has that volume when its inlet closes.
    """
    parts, found = of.problem.parts, of.figures
    oil, geometry = parts.oil, parts.geometry
    opens = geometry.discharge_opens
    if oil is None or opens is None or not found.oil_ratio or not found.trapped_mass or parts.oil_room:
        return
    share = found.oil_ratio * found.trapped_mass / oil.density / of.life.volume(opens)
    if not share < 1.0:
        when = "inlet closes" if geometry.expands else "discharge port opens"
        what = f"the oil would fill {share:.0%} of the chamber when the {when}; oil takes no room in this model"
        yield f"{what} (lower oil_supply.ratio, or take the result as a limit)"


def _unfitted_bore(of: Evaluation) -> Iterator[str]:
    """Yield a warning where the bore that lets the oil in lies outside what the formula of its flow was fitted to."""
    oil, port = of.problem.parts.oil, of.problem.parts.oil_port
    if oil is None or "diameter" not in oil.supply:
        return
    bore, source = oil.supply, oil.supply["separator_pressure"]
    before = source - (0.0 if port is None else port.loss(source))
    drop = max(before - (of.figures.injection_pressure or 0.0), 0.0)
    reynolds = bore["diameter"] * math.sqrt(2.0 * drop * bore["density"]) / bore["viscosity"]
    why = outside_fit(bore["length"] / bore["diameter"], reynolds)
    if why:
        yield f"the formula of the oil's flow is stretched beyond its range: {why}"


def inaccurate(wanted: float, error: Figures) -> tuple[str, ...]:
    """Return a warning when the estimated error of a figure stayed above the wanted accuracy, or when there is none."""
    if error and all(size is None for size in error.values()):
        return ("the errors could not be estimated: the finer solution did not reach its end",)
    name, size = worst(error)
    if size <= wanted:
        return ()
    return (f"the estimated error of {name}, {size:.2g}, is above the wanted accuracy {wanted:.2g}",)
