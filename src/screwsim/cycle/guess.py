"""Initial guesses of a cycle: from nearby cycles, or suction, polytropic compression and discharge."""

import numpy as np

from screwsim.cycle.continuation import Course
from screwsim.cycle.feedback import set_lines, set_unknowns, unknowns
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import Start
from screwsim.effects.base import OilSolution
from screwsim.fluid.gas import Gas
from screwsim.model import leases, speed
from screwsim.model.parts import Parts
from screwsim.model.run import Machinery
from screwsim.model.slots import PRESSURE, S_T, S_X_OIL
from screwsim.model.turn_scheduler import reach_station

Array = np.ndarray
TRACE = 1e-7  # oil per gas in a first guess where no oil is supplied


def lease_for(problem: Problem) -> Machinery:
    """Return a compiled machinery on loan for a problem; give it back when done (`leases`)."""
    machinery = leases.lease(problem.composition)
    machinery.warm_up(lambda: compile_start(problem, machinery))
    return machinery


def install_first_guess(problem: Problem, machinery: Machinery, oil: float = 1.0) -> Array:
    """Set the lines and install a first guess; return the state at 0°. `oil` scales the guessed oil ratio."""
    _reset(problem, machinery)
    parts, lines, suction, c = problem.parts, problem.lines, problem.suction, machinery.composition
    port_state = suction.port_state(problem.h_isentropic) if suction.changed else suction.line
    y = first_guess(parts, machinery, port_state[PRESSURE], suction.temperature(port_state, lines.T_s), lines.p_d)
    if c.carried and oil != 1.0:
        # of the state, and along the last history
        times, dense, quads, steps = machinery.lives.last()
        states = dense[:steps, :, : machinery.n].copy()
        states[:, :, S_X_OIL] *= oil
        y[S_X_OIL] *= oil
        machinery.install(times[: steps + 1].copy(), states, quads[:steps].copy())
    set_lines(problem, machinery, float(y[S_T]), float(y[S_X_OIL]) if c.carried else 0.0)
    return y


def install_continued_guess(problem: Problem, machinery: Machinery, course: Course) -> Start | None:
    """Set the lines and a guess from the course of preceding cycles, and return the start; None where there is none."""
    _reset(problem, machinery)
    reach_station()
    guess = course.guess(machinery, problem.parameters)
    reach_station()
    if guess is None:
        return None
    (start, unknowns_out), count = guess, len(problem.entries)
    set_lines(problem, machinery, float(start.y[S_T]), 0.0, float(unknowns_out[0]))
    set_unknowns(problem, machinery, unknowns_out[:count])
    speed.restore_curve(machinery.composition, unknowns_out[count:])
    return start


def compile_start(problem: Problem, machinery: Machinery) -> Array:
    """Do what `install_first_guess` does, and set the unknowns once, so that everything these need is compiled."""
    y = install_first_guess(problem, machinery)
    set_unknowns(problem, machinery, unknowns(problem, machinery))
    return y


def _reset(problem: Problem, machinery: Machinery) -> None:
    """Reset the machinery and its numbers to those of the problem."""
    machinery.reset()
    machinery.composition.P[:] = problem.composition.P


def first_guess(parts: Parts, machinery: Machinery, p_s: float, T_s: float, p_d: float) -> Array:
    """Install a guessed history and return the state to start from at 0°.

    The polytropic exponent is that of gas and oil at one temperature, n = 1 + R/(c_v + d c_oil).
    """
    gas, oil, geometry, composition = parts.gas, parts.oil, parts.geometry, machinery.composition
    heated = "T_oil" in composition.states
    d = (oil.supply.get("ratio", 3.0) if oil is not None else 0.0) if heated else 0.0
    n = 1.0 + (gas.c_p - gas.c_v) / (gas.c_v + d * (oil.heat_capacity if oil is not None else 0.0))
    grid = np.linspace(0.0, geometry.life, 97)
    V = np.empty(len(grid))
    machinery.module.trace__volumes(grid, composition.P, composition.TAB, V)
    closes = geometry.injection_angle if not geometry.expands else geometry.inlet_closes or geometry.injection_angle
    closed = grid > closes
    V_closed = machinery.module.volume_at(closes, composition.P, composition.TAB)
    ratio = np.where(closed, (V_closed / V) ** n, 1.0)
    if geometry.expands:  # what is left is pushed out at p_d
        ratio[grid > geometry.injection_angle] = 0.0
    low, high = min(1.0, p_d / p_s), max(1.0, p_d / p_s)
    p = p_s * np.clip(ratio, low, high)
    T = T_s * (p / p_s) ** ((n - 1.0) / n)
    T, rho = _vapour(gas, p, T)
    columns = [T, rho]
    if heated and oil is not None:
        columns.append(np.where(closed, np.maximum(T, oil.temperature), oil.temperature))
    if composition.carried:
        columns.append(np.full(len(grid), max(d, 1e-3) if d > 0.0 else TRACE))
    if isinstance(parts.oil_content, OilSolution):
        columns.append(np.full(len(grid), parts.oil_content.supply))
    columns += [np.full(len(grid), start) for start in composition.starts]
    states = np.column_stack(columns)
    dense = np.zeros((len(grid) - 1, 4, len(columns)))
    dense[:, 0], dense[:, 1] = states[:-1], states[1:]
    machinery.install(grid, dense, np.zeros((len(grid) - 1, machinery.nq)))
    return states[-1].copy()


def _vapour(gas: Gas, p: Array, T: Array) -> tuple[Array, Array]:
    """Return temperatures, raised to saturation where below it, and densities; repeated states are computed once."""
    known: dict[tuple[float, float], tuple[float, float]] = {}
    states = list(zip(p.tolist(), T.tolist(), strict=True))
    for state in states:
        if state not in known:
            T_vapour = gas.nearest_vapour(*state)
            known[state] = T_vapour, gas.density(state[0], T_vapour)
    found = np.array([known[state] for state in states])
    return found[:, 0], found[:, 1]
