"""A closed cycle as it is evaluated: what several readers need is computed once, on first use."""

from collections.abc import Callable
from dataclasses import dataclass

from screwsim.cycle import suction_line
from screwsim.cycle.balances import (
    LEAST_WORK,
    Outflow,
    Residuals,
    flow_past_suction_port,
    outflow_of,
    residuals,
    streams_of,
)
from screwsim.cycle.cycle_figures import CycleFigures, cycle_figures, lazy_pitch
from screwsim.cycle.feedback import LineInflow, image, turn_of
from screwsim.cycle.held_work import missed_work
from screwsim.cycle.pitch import Pitch
from screwsim.cycle.powers import Powers, powers_of
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.suction_line import Stream
from screwsim.effects.base import SUCTION, Plenum, Reading, Turn
from screwsim.evaluate.figures import Read, figures_of
from screwsim.evaluate.package import Package, package_residual
from screwsim.evaluate.separator import Circuit, circuit_of
from screwsim.figures import Performance
from screwsim.fluid.reservoir import Reservoir
from screwsim.model.slots import ENTHALPY, FIRST_OWN, OF_GAS, Q_HEAT, Q_WORK, R_DISCHARGE, R_INJECTED, R_TRAPPED
from screwsim.model.trajectory import Array, Trajectory
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.frozen import fast_init, with_changes
from screwsim.numerics.identity_cache import once
from screwsim.outputs import Figures


@fast_init
@dataclass(frozen=True, eq=False)
class Evaluation:
    """A life of a problem's chambers with its quadratures q, and what else of it is known already.

    `left` are its balance residuals, `unknowns_out` the next values of the feedback unknowns, `into` the flows into
    pulsating lines.
    """

    problem: Problem
    life: Trajectory
    q: Array
    left: Residuals | None = None
    unknowns_out: Array | None = None
    into: LineInflow | None = None

    @once
    def streams(self) -> Array:
        """The sums over the life by category (`cycle.balances.streams_of`)."""
        return streams_of(self.problem.composition, self.q)

    @once
    def outflow(self) -> Outflow | None:
        """The mean outflow to discharge; None where nothing flows out."""
        return outflow_of(self.streams)

    @once
    def fresh_gas(self) -> float:
        """The net gas [kg] that the suction line takes in per life, by the flows through its ports."""
        return suction_line.fresh_gas(self.problem, self.life.R, self.streams)

    @once
    def leak(self) -> Stream:
        """The leak from the discharge to the suction line beside the chambers, per life (M274)."""
        return suction_line.leak(self.problem, self.life.R)

    @property
    def h_d(self) -> float:
        """The enthalpy [J/kg] of the gas in the discharge line."""
        return float(self.life.R[R_DISCHARGE + ENTHALPY])

    @once
    def gas_flow(self) -> float:
        """The net gas flow [kg/s]: from the suction line, without what a bypass returns to it (M163)."""
        if _shut(self.problem, self.known.turn):
            return 0.0
        sucked = self.fresh_gas + flow_past_suction_port(self.problem, self.life)
        return (1.0 - self.problem.suction.returned) * (sucked * self.problem.rate) + 0.0  # turns −0 into 0

    @once
    def drawn(self) -> dict[str, float]:
        """The net gas flow [kg/s] from each own plenum, by its name."""
        own = self.streams[2 * FIRST_OWN :, OF_GAS].reshape(-1, 2)
        flows = [float(into + back) * self.problem.rate for into, back in own]
        return dict(zip(self.problem.parts.plenums, flows, strict=True))

    @once
    def products(self) -> list[tuple[float, Reservoir]]:
        """The net flow [kg/s] and state of each own plenum whose gas is a product (M101)."""
        parts = self.problem.parts
        names = {part.name for _, part in parts.all(Plenum) if part.product}
        return [(self.drawn[name], state) for name, state in parts.plenums.items() if name in names]

    @once
    def turn(self) -> Turn:
        """What effects can read of the life, with the next values of the feedback unknowns."""
        return turn_of(self.problem, self.life, self.q, self.into)

    @property
    def image(self) -> Array:
        """The next values of the feedback unknowns, as a vector."""
        if self.unknowns_out is not None:
            return self.unknowns_out
        return image(self.problem, self.life, self.q, self.turn if self.problem.parts.made else None)

    @once
    def pitch(self) -> Pitch:
        """One pitch of all chambers."""
        return self.lazy_pitch()

    @once
    def lazy_pitch(self) -> Callable[[], Pitch]:
        """The same, computed on call."""
        return lazy_pitch(self.problem, self.life, self.q)

    @once
    def known(self) -> CycleFigures:
        """What a power loss or a reading may use."""
        parts = self.problem.parts
        turn = self.turn if parts.made or parts.all(Reading) else None
        return cycle_figures(self.problem, self.life, self.q, self.lazy_pitch, turn)

    @once
    def powers(self) -> Powers:
        """The powers of gas, oil, losses and shaft."""
        return powers_of(self.problem.parts, self.known)

    @once
    def circuit(self) -> Circuit | str | None:
        """The oil's circuit through separator and cooler; None where nothing needs it, a text where none is found."""
        return circuit_of(self)

    @once
    def read(self) -> Read:
        """The performance figures, and the reasons for those that are None."""
        self.known  # noqa: B018 - first: the steps below use it
        reach_station()
        self.circuit  # noqa: B018
        reach_station()
        return figures_of(self)

    @once
    def package(self) -> Package | None:
        """The difference between a package's assumed losses and those at the flow; None without a package."""
        return package_residual(self.problem, self.figures["gas_mass_flow"])

    @property
    def figures(self) -> Performance:
        """The performance figures."""
        return self.read[0]

    @property
    def complete(self) -> CycleFigures:
        """What a shaft may use of the cycle: the known quantities with the shaft power."""
        return with_changes(self.known, found={"shaft_power": self.powers.shaft})

    @property
    def least(self) -> tuple[float, float]:
        """The power [W] and the work of a cycle [J] below which values are rounding."""
        work = LEAST_WORK * max(float(self.life.R[R_TRAPPED]), 0.0) * self.problem.pv
        return work * self.problem.rate, work


def evaluate(problem: Problem, cycle: CycleSolution) -> Evaluation:
    """Return the evaluation of a cycle."""
    return evaluate_life(problem, cycle.trajectory, cycle.q, cycle.open, cycle.unknowns_out)


def evaluate_life(
    problem: Problem, life: Trajectory, q: Array, left: Residuals | None = None, unknowns_out: Array | None = None
) -> Evaluation:
    """Return the evaluation of a life; the work of a cylinder with what its long steps misread (`cycle.held_work`).

    Several chambers have more breakpoints, and shorter steps.
    """
    missed = missed_work(problem, life) if problem.composition.chambers == 1 else 0.0
    if missed:
        q = q.copy()
        q[Q_WORK] += missed
    return Evaluation(problem, life, q, left, unknowns_out)


def _shut(problem: Problem, turn: Turn | None) -> bool:
    """Return whether a check valve stays shut, so that nothing comes in from the suction line but rounding.

    A shut discharge line has that effect where the gas has no other way out.
    """
    lines = [part for part in problem.parts.pulsations if part.to == SUCTION or not problem.parts.plenums]
    return turn is not None and any(part.shut is not None and part.shut(turn) for part in lines)


def balance(of: Evaluation) -> Figures:
    """Return the balances of a closed cycle (contract: balance)."""
    problem, c, oil = of.problem, of.problem.composition, of.problem.parts.oil
    left, residual = of.left or residuals(problem, of.life.R, of.q), None
    T_out = None if c.carried else of.known.oil_discharge_temperature
    if oil is not None and T_out is not None:  # heat to the oil beyond what it carries to discharge (M40) [W]
        carried = float(of.life.R[R_INJECTED]) * oil.heat_capacity * (T_out - oil.temperature)
        residual = float(-of.q[Q_HEAT] - carried) * problem.rate
    oil_mass, bound = left.oil if c.carried else None, problem.criteria.bound
    return Figures(mass=left.mass, energy=left.energy, oil_mass=oil_mass, oil_residue=residual, bound=bound)


def loss_torque(of: Evaluation, omega: float) -> tuple[float, float]:
    """Return the torque of losses and oil lift, and that of the lift alone [N m], at a mean speed [rad/s] (M213).

    They follow from one pitch's quadratures.
    """
    share = omega / of.problem.parts.omega
    names = ("tip_speed", "indicated_power", "oil_mass_flow", "oil_volume_flow", "leaked_oil_flow", "drag_power")
    known = with_changes(of.known, omega=omega, **{name: share * getattr(of.known, name) for name in names})
    powers = powers_of(of.problem.parts, known)
    return (powers.shaft - known.indicated_power) / omega, powers.lift / omega
