"""A suction line that keeps backflow: gas and oil that flow back mix with fresh gas (docs/model.md M270–M274).

Its enthalpy, and with carried oil its oil ratio and dissolved gas, are feedback unknowns of the cycle. Sums are per
life of one chamber, like the streams (`balances.streams_of`).
"""

from collections.abc import Callable
from math import exp
from typing import NamedTuple, Self

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.effects.base import LineLeak, OilSolution, SuctionHeat
from screwsim.fluid.nozzle import flow
from screwsim.inputs.faults import UsageError
from screwsim.model import slots
from screwsim.model.numbers import symbols_of
from screwsim.numerics.roots import brentq

Array = np.ndarray
CLOSE = 1e-13  # relative width of the interval to which the mixture's enthalpy is bracketed
IMBALANCE = 0.01  # relative difference between the line's enthalpy and its inflow's, above which it is not closed
NO_OIL = 1e-12  # oil per gas below which its heat is rounding
REACH = 0.02  # relative distance from the guessed enthalpy that is searched first


class Stream(NamedTuple):
    """Gas [kg], its enthalpy [J], oil [kg], oil mass × temperature [kg K], gas dissolved in the oil [kg]."""

    gas: float = 0.0
    enthalpy: float = 0.0
    oil: float = 0.0
    oil_heat: float = 0.0
    held: float = 0.0

    @property
    def fluid(self) -> float:
        """Free and dissolved gas [kg]."""
        return self.gas + self.held

    def times(self, rate: float) -> Self:
        """Return the stream with all sums multiplied by a factor."""
        return self._make(rate * each for each in self)

    def plus(self, other: Self, share: float = 1.0) -> Self:
        """Return the sum of this stream and a share of another."""
        return self._make(one + share * more for one, more in zip(self, other, strict=True))


_NONE = Stream()


class Mixture(NamedTuple):
    """The mixture that is sucked in: gas enthalpy [J/kg], oil per gas, dissolved gas per gas."""

    enthalpy: float
    oil: float = 0.0
    held: float = 0.0


def values(problem: Problem, R: Array) -> Array:
    """Return the unknowns that the next turn will use."""
    c = problem.composition
    h, oil, held = (float(R[slots.R_SUCTION + cell]) for cell in (slots.ENTHALPY, slots.OIL_RATIO, slots.DISSOLVED))
    return np.array(Mixture(h, oil, oil * held)[: 1 + c.carried + c.dissolves])


def set_values(problem: Problem, R: Array, found: Array) -> None:
    """Set the unknowns for the next turn; an enthalpy that the gas cannot have, during iteration, changes nothing."""
    mixture = Mixture(*found.tolist())
    try:
        port_state = problem.parts.gas.port_state_of_enthalpy(problem.suction.pressure, mixture.enthalpy)
        T = problem.parts.gas.temperature(problem.suction.pressure, mixture.enthalpy)
    except UsageError:
        return
    R[slots.R_SUCTION : slots.R_SUCTION + len(port_state)] = port_state
    if len(found) > 1:
        ratio = max(mixture.oil, 0.0)
        R[slots.R_SUCTION + slots.OIL_RATIO] = ratio
        R[slots.R_SUCTION + slots.OIL_TEMPERATURE] = T + problem.oil_pressure_term(problem.suction.pressure)
        if len(found) > 2 and ratio > 0.0:
            R[slots.R_SUCTION + slots.DISSOLVED] = max(mixture.held, 0.0) / ratio
        R[slots.R_SUCTION + slots.DENSITY] = problem.density_in_flow(float(port_state[slots.DENSITY]), ratio)


def leak(problem: Problem, R: Array) -> Stream:
    """Return the leak from the discharge line that bypasses the chambers, per life of one chamber (M274)."""
    if not problem.parts.all(LineLeak):
        return _NONE
    lines, known = R[: slots.R_DISCHARGE + slots.PORT_STATE].tobytes(), problem.leaked
    found = known.get(lines)
    if found is None:
        found = _leak(problem, R)
        known.clear()
        known[lines] = found
    return found


def _leak(problem: Problem, R: Array) -> Stream:
    """Return the same, computed."""
    leaks = [part for _, part in problem.parts.all(LineLeak)]
    suction, discharge = (R[at : at + slots.CHOKED + 1].tolist() for at in (slots.R_SUCTION, slots.R_DISCHARGE))
    port_state = R[slots.R_DISCHARGE : slots.R_DISCHARGE + slots.PORT_STATE].tolist()
    flux = max(0.0, float(flow(1.0, *_nozzle(suction), *_nozzle(discharge), 0.0)))
    gas = flux * sum(part.area * _flux_share(problem, part, port_state, flux) for part in leaks) / problem.rate
    oil = gas * port_state[slots.OIL_RATIO] if problem.composition.carried else 0.0
    held = oil * port_state[slots.DISSOLVED] if problem.parts.dissolves else 0.0
    return Stream(gas, gas * port_state[slots.ENTHALPY], oil, oil * port_state[slots.OIL_TEMPERATURE], held)


def _flux_share(problem: Problem, part: LineLeak, port_state: list[float], flux: float) -> float:
    """Return the share of the nozzle's flux [kg/(m² s)] that passes with the oil of a port state (M300)."""
    if part.resistance is None or flux == 0.0:
        return 1.0
    ratio = max(port_state[slots.OIL_RATIO], 0.0) if problem.composition.carried else 0.0
    known = {**symbols_of(problem.parts), **part.values, **part.resistance.values}
    known |= {"flux": flux, "oil_ratio": ratio, "density": port_state[slots.DENSITY]}
    share = part.resistance.share
    return float(share(*(known[name] for name in share.arguments)))


def _nozzle(port_state: list[float]) -> tuple[float, ...]:
    """Return the arguments of a nozzle from a port state: p, ρ, 1/k, drop and ψ² at choking."""
    p, rho, _h, *rest = port_state
    return p, rho, *rest


def backflow(problem: Problem, R: Array, streams: Array) -> Stream:
    """Return what flows to the suction line from the chambers and through leaks that bypass them."""
    return Stream(*(-streams[slots.SUCTION_OUT]).tolist()).plus(leak(problem, R))


def fresh_gas(problem: Problem, R: Array, streams: Array) -> float:
    """Return the net gas [kg] that the line takes in per life: what is sucked less what came back."""
    if not problem.parts.suction_line:
        return float(streams[slots.SUCTION_IN, slots.OF_GAS] + streams[slots.SUCTION_OUT, slots.OF_GAS])
    return Stream(*streams[slots.SUCTION_IN].tolist()).fluid - backflow(problem, R, streams).fluid


def suction_heat(problem: Problem, power: float) -> float:
    """Return the heat flow [W] into the fresh gas on its way to the line, at a shaft power [W] (M275)."""
    return sum(part.power(power, problem.parts.omega) for _, part in problem.parts.all(SuctionHeat))


def image(problem: Problem, R: Array, streams: Array, h_d: float, heat: float) -> Array:
    """Return the next values of the line's unknowns after a life; h_d [J/kg] is the enthalpy of the discharge line.

    `heat` [J] is what the fresh gas takes up before the line (M275). Where more flows back than is sucked, the
    excess leaves through the line with the mixture's composition: the mixture is a continuous function of the flows
    (as M27).
    """
    before = values(problem, R)
    try:
        found = _mixture(problem, R, streams, h_d, heat)
    except UsageError:
        return before
    return before if found is None else np.array(found[: len(before)])


def _mixture(problem: Problem, R: Array, streams: Array, h_d: float, heat: float) -> Mixture | None:
    """Return the line's mixture after a life, None where nothing flows; raise UsageError where none can exist.

    Where nothing is sucked it is that of what comes back, as in the limit of next to nothing.
    """
    sucked, returned = Stream(*streams[slots.SUCTION_IN].tolist()).fluid, backflow(problem, R, streams)
    if not (sucked > 0.0 or returned.fluid > 0.0):
        return None
    share = min(1.0, sucked / returned.fluid) if returned.fluid > 0.0 < sucked else 1.0
    own = max(0.0, sucked - returned.fluid)
    warmed = own * problem.suction.port_state(h_d)[slots.ENTHALPY] + (heat if own > 0.0 else 0.0)
    return mixed(problem, Stream(own, warmed).plus(returned, share), float(R[slots.R_SUCTION + slots.ENTHALPY]))


def imbalance(problem: Problem, R: Array, streams: Array, h_d: float, heat: float) -> str:
    """Return why a closed cycle's suction line does not match its inflow; empty where it does.

    During iteration a mixture that the gas cannot form leaves the line unchanged; in a closed cycle it is an error.
    """
    try:
        found = _mixture(problem, R, streams, h_d, heat)
        if found is None:
            return ""
        problem.parts.gas.port_state_of_enthalpy(problem.suction.pressure, found.enthalpy)
    except UsageError as wrong:
        return f"gas and oil that flow back would make an impossible mixture in the suction line: {wrong}"
    shift = problem.enthalpy_shift
    off = abs((found.enthalpy + shift) / (float(R[slots.R_SUCTION + slots.ENTHALPY]) + shift) - 1.0)
    why = f"the suction line does not settle: the enthalpy of its gas is {off:.1%} off that of what enters it"
    return "" if off <= IMBALANCE else why


def mixed(problem: Problem, total: Stream, guess: float) -> Mixture:
    """Return the equilibrium mixture at intake pressure: one temperature, and gas dissolved in the oil (M271, M272).

    The total enthalpy grows with that of the gas, which is sought from a guess [J/kg].
    """
    if not total.oil > NO_OIL * max(total.gas, 0.0):
        return Mixture(*(each / total.gas for each in (total.enthalpy, max(total.oil, 0.0), total.held)))
    parts, p = problem.parts, problem.suction.pressure
    gas, oil, content = parts.gas, parts.oil, parts.oil_content
    assert oil is not None  # the stream has oil
    solution = content if isinstance(content, OilSolution) else None
    pressed = problem.oil_pressure_term(p)
    wanted = total.enthalpy + oil.heat_capacity * total.oil_heat
    wanted += solution.enthalpy * total.held if solution else 0.0

    def held_at(T: float) -> float:
        """Return the equilibrium gas dissolved in a kilogram of oil [kg] (M232)."""
        if solution is None:
            return 0.0
        s = gas.entropy(p, T) - (gas.enthalpy(p, T) - solution.enthalpy) / T  # equal chemical potential in both phases
        return min(held_of(solution, s), total.fluid / total.oil)

    def excess(h: float) -> float:
        """Return the total enthalpy [J] beyond that of the stream."""
        T = gas.temperature(p, h)
        held = held_at(T) * total.oil
        dissolved = solution.enthalpy * held if solution else 0.0
        return (total.fluid - held) * h + total.oil * oil.heat_capacity * (T + pressed) + dissolved - wanted

    h = _root(excess, guess, problem.enthalpy_shift)
    held = held_at(gas.temperature(p, h)) * total.oil
    left = max(total.fluid - held, 1e-12 * total.oil)
    return Mixture(h, total.oil / left, held / left)


def held_of(solution: OilSolution, entropy: float) -> float:
    """Return the dissolved gas [kg per kg of oil] at its entropy [J/(kg K)], which falls as more is dissolved."""
    return exp(float(np.interp(-entropy, -np.asarray(solution.entropy), np.asarray(solution.log_held))))


def _root(excess: Callable[[float], float], guess: float, shift: float) -> float:
    """Return the zero of an increasing function, bracketed outwards from a guess; guess + shift is positive."""
    low = high = guess
    size = guess + shift
    at, reach = excess(guess), REACH * size
    grows = at < 0.0
    while (at < 0.0) == grows and at != 0.0:
        if reach > size:
            remedy = "choose smaller leaks, a higher speed or a lower pressure ratio"
            raise UsageError(f"no temperature of the gas gives it their heat ({remedy})")
        low, high = (high, guess + reach) if grows else (max(guess - reach, CLOSE * size - shift), low)
        at, reach = excess(high if grows else low), 2.0 * reach
    return brentq(excess, low, high, CLOSE * size, CLOSE) if low < high else guess
