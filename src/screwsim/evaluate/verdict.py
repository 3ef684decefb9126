"""The verdict on a cycle: why it failed or did not close, and what may help."""

import math

import numpy as np

from screwsim.build import open_temperatures
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.effects.base import OilRoom, Separator, Stops
from screwsim.evaluate.evaluation import Evaluation
from screwsim.fluid.composition import ENDING, predefined_name
from screwsim.fluid.limits import Limit, Outside
from screwsim.fluid.real_gas import RealGas
from screwsim.machine.kinds import find_machine
from screwsim.machine.settings import TURN
from screwsim.model.impacts import MOST_IMPACTS
from screwsim.model.pulsation import LOWEST
from screwsim.model.slots import R_LOCK, S_RHO, S_T, S_X_OIL
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.integrators import check_of
from screwsim.outputs.variables import NOT_CLOSED

ALL_BUT_LOCKED = 0.9  # share of oil in a chamber's volume above which a stopped integration is a hydraulic lock

LARGEST_DENSITY = 3e4  # [kg/m³], denser than any fluid: a diverged iterate, not a state of the gas
HOT = 1000.0  # [K], more than a machine endures
PHASES = 120  # angles of a pitch at which a plenum's pressure is checked
STANDING_TIME = 86_400.0  # [s] of a turn of the rotors, beyond which a machine practically stands still
MANY_IMPACTS = 500  # impacts per turn above which reeds are blamed for a cycle that does not settle
FAR_FROM_CLOSED = 0.05  # change of the states over a pitch above which a cycle is far from closed


def outside_gas_range(problem: Problem, life: Trajectory) -> str:
    """Return where and why a closed cycle leaves the range of the gas's equation of state; empty where it does not."""
    (T, rho), gas = life.ends, problem.parts.gas
    i = gas.first_outside(T, rho)
    found = None if i is None else gas.why_outside(float(T[i]), float(rho[i]))
    if i is None or found is None:
        return ""
    return f"at {math.degrees(life.times[i + 1]):.2f} deg {_violated_limit(problem, found, life)}"


def _violated_limit(problem: Problem, found: Outside, life: Trajectory) -> str:
    """Return which limit of the gas a state of a life violates, with the remedy.

    If the gas of an expander ends hotter than it came, it was recompressed because the outlet did not let it out.
    """
    hot = found.limit in (Limit.HOT, Limit.PRESSED) and problem.parts.geometry.expands
    if hot and float(life.ends[0][-1]) > problem.lines.T_s:
        return (
            f"{found.what}: gas that does not get out through the outlet is recompressed; use a wider "
            f"machine.suction_port, through which an expander's gas leaves{_dead_volume(problem)}, or a lower speed"
        )
    return f"{found.what}; {remedy_for(found.limit, problem)}"


def remedy_for(limit: Limit, problem: Problem) -> str:
    """Return the remedy, for this machine, for a violated limit of its gas's equation of state."""
    oiled, expands = problem.parts.oil is not None, problem.parts.geometry.expands
    cooler = "cooler gas in the suction line"
    if oiled:
        cooler = "cooler gas or oil" if expands else "more or cooler oil"
    warmer = "warmer oil or gas" if oiled else "warmer gas in the suction line"
    wider = f"a wider discharge port{_dead_volume(problem)}"
    if limit in (Limit.HOT, Limit.PRESSED):
        return f"use {cooler}, or a lower pressure there" if expands else f"use {cooler}, {wider} or smaller leaks"
    if limit is Limit.COLD:
        return f"use warmer suction gas{' or oil' if oiled else ''}, or a wider suction port"
    if limit is Limit.CRITICAL:
        return f"use {wider}, a lower discharge pressure or warmer {'oil' if oiled else 'suction gas'}"
    if limit is Limit.WET:
        return f"use {warmer}, or gas.two_phase: equilibrium"
    blend = predefined_name(f"{problem.scene.gas.name}{ENDING}")  # its phases are followed, a pseudo-pure fluid's not
    return f"use {warmer}, or gas.fluid: {blend} with gas.two_phase: equilibrium" if blend else f"use {warmer}"


def _dead_volume(problem: Problem) -> str:
    """Return the scene's path of the dead volume as a further remedy; empty where a table sets it."""
    dead, _ = find_machine(problem.scene.machine.kind).dead_volume(problem.scene.machine)
    return f", a larger {dead}" if dead else ""


def beyond_its_mean(problem: Problem, life: Trajectory) -> str:
    """Return a message where a plenum's pressure swings by more than its mean, so that M186 fails; else empty."""
    for part in problem.parts.pulsations:
        line = problem.parts.number(part.to)
        angles = np.linspace(0.0, problem.parts.geometry.pitch, PHASES, endpoint=False)
        pulses = life.line_pulses(line, angles)
        if np.min(1.0 + pulses[:, 1] / (1.0 + pulses[:, 0])) < LOWEST:
            return part.swings or f"the pressure of the {part.to} line would swing by more than its mean"
    return ""


def unanswered_question(of: Evaluation, closed: bool) -> str:
    """Return which question about a cycle the scene leaves open, and what to do; empty where there is none."""
    asked = (part.open_question for part in of.problem.parts.pulsations if part.open_question is not None)
    return next(filter(None, (ask(of.turn, closed) for ask in asked)), "")


def unclosed(of: Evaluation, cycle: CycleSolution) -> str:
    """Return what may help a cycle that did not close."""
    problem, numerics = of.problem, of.problem.scene.numerics
    if cycle.impacts > MANY_IMPACTS:
        return f"its turns do not settle, with {_impacts_remedy(problem, cycle)}"
    for part in problem.parts.pulsations:
        if part.shut is not None and part.shut(of.turn):
            return part.stuck or f"the {part.to} line stays shut and the turns do not settle"
    if check_of(numerics.integrator) or not problem.criteria.fallbacks or cycle.status != NOT_CLOSED:
        instead = way_of(cycle).instead
        return f"try {f'{instead}, or ' if instead else ''}a tighter numerics.accuracy"
    if cycle.change < FAR_FROM_CLOSED:
        return "no fallback closed it either: the wanted accuracy may be too fine (choose a larger numerics.accuracy)"
    hottest = of.life.ends[0].max()
    if hottest < HOT:
        return "no fallback closed it either: its turns do not settle (choose smaller leaks, or another speed)"
    return (
        f"no fallback closed it either: its turns do not settle, with gas at up to {hottest:.2g} K; gas that can "
        "hardly get out heats up, and the chambers empty and refill endlessly (choose a wider discharge port, "
        "smaller leaks or a lower speed)"
    )


def _impacts_remedy(problem: Problem, cycle: CycleSolution) -> str:
    """Return what to do about reeds that hardly come to rest."""
    remedies = dict.fromkeys(part.remedy for _, part in problem.parts.all(Stops) if part.remedy)
    what = "impacts of its reeds in one turn; reeds that lose so little at an impact keep bouncing"
    return f"{cycle.impacts} {what}" + (f" ({'; '.join(remedies)})" if remedies else "")


def failure(problem: Problem, cycle: CycleSolution) -> str:
    """Return where and why an integration stopped, and what to do."""
    turn = TURN / problem.parts.omega
    if turn > STANDING_TIME:
        return (
            f"the integration stopped at {math.degrees(cycle.angle):.2f} deg: the machine almost stands still: a turn "
            f"takes {turn / STANDING_TIME:.3g} days, and its gas comes to rest long before that (choose a higher "
            "operation.speed)"
        )
    states = zip(problem.composition.states, cycle.y, strict=False)
    y = ", ".join(f"{name} = {value:.6g}" for name, value in states)
    lock = _hydraulic_lock(problem, cycle)
    if lock:
        return lock
    if cycle.impacts > MOST_IMPACTS:
        return f"the turn was given up at {math.degrees(cycle.angle):.2f} deg after {_impacts_remedy(problem, cycle)}"
    n, gas = len(problem.composition.states), problem.parts.gas
    for i, (T, rho) in enumerate(zip(cycle.y[S_T::n], cycle.y[S_RHO::n], strict=True)):  # each of all chambers
        reason = gas.why_outside(float(T), float(rho))
        if reason is not None:
            angle = cycle.angle + i * problem.parts.geometry.pitch
            why = _violated_limit(problem, reason, cycle.trajectory)
            return f"the integration stopped at {math.degrees(angle):.2f} deg: {why}"
        if isinstance(gas, RealGas) and (near := gas.at_critical_point(float(T), float(rho))):
            where = "at the inlet" if problem.parts.geometry.expands else "in the suction line"
            what = f"beside which its two phases are not followed (choose another temperature or pressure {where})"
            return f"the integration stopped at {math.degrees(cycle.angle):.2f} deg, at {near}, {what}"
    elsewhere = outside_gas_range(problem, cycle.trajectory)
    if elsewhere:  # a chamber that such gas reaches through a leak
        return f"the integration stopped at {math.degrees(cycle.angle):.2f} deg; in its last turn {elsewhere}"
    densest = float(np.max(cycle.y[S_RHO::n]))
    if densest > LARGEST_DENSITY:
        pulsates = ", wider openings between plenum and line" if problem.parts.pulsations else ""
        return (
            f"no closed cycle was found: the last attempt diverged, to a density of {densest:.1e} kg/m3; the openings "
            f"may be too small for what the machine displaces (choose a lower speed, wider ports{pulsates})"
        )
    return (
        f"the integration stopped at {math.degrees(cycle.angle):.2f} deg ({y}); "
        "check port areas, clearances and pressures, or ask for a tighter numerics.accuracy"
    )


def _hydraulic_lock(problem: Problem, cycle: CycleSolution) -> str:
    """Return a message on a hydraulic lock and its angle; empty where oil fills no chamber or takes no room (M111)."""
    parts, R, n = problem.parts, cycle.trajectory.R, len(problem.composition.states)
    if not parts.oil_room or parts.oil is None:
        return ""
    rho, x = cycle.y[S_RHO::n], cycle.y[S_X_OIL::n]
    shares = 1.0 - 1.0 / parts.volume_over_gas(rho, x)
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


def circuit_verdict(of: Evaluation) -> tuple[str, float]:
    """Return why the oil's circuit of a cycle is impossible (empty: it is not), and its residual over the shaft power.

    The residual is 0 without effects.separator.
    """
    circuit = of.circuit
    if circuit is None or not of.problem.parts.all(Separator):
        return "", 0.0
    if isinstance(circuit, str):
        found = any(open_temperatures(of.problem.scene))
        return (f"the temperatures of the oil cannot be found: {circuit}" if found else ""), 0.0
    return circuit.parted.why, circuit.open
