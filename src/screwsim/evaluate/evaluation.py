"""A closed cycle as it is evaluated: what several readers need is computed once, on first use."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from screwsim.cycle.balances import LEAST_WORK, Residuals, residuals, streams_of
from screwsim.cycle.cycle_figures import (
    CycleFigures,
    cycle_figures,
    lazy_pitch,
    oil_lift,
    power_losses,
    shaft_power,
)
from screwsim.cycle.feedback import LineInflow, image, turn_of
from screwsim.cycle.held_work import missed_work
from screwsim.cycle.pitch import Pitch
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.effects.base import Reading, Turn
from screwsim.evaluate.figures import Read, figures_of
from screwsim.evaluate.separator import Circuit, Package, circuit_of, package_residual
from screwsim.figures import Performance
from screwsim.model.slots import Q_HEAT, Q_WORK, R_INJECTED, R_TRAPPED
from screwsim.model.trajectory import Array, Trajectory
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.frozen import fast_init
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
    def losses(self) -> dict[str, float]:
        """The power losses [W] besides the gas work."""
        return power_losses(self.problem.parts, self.known)

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
        return replace(self.known, shaft_power=shaft_power(self.problem.parts, self.known))

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
    known = replace(of.known, omega=omega, **{name: share * getattr(of.known, name) for name in names})
    lift = oil_lift(of.problem.parts, known) if of.problem.parts.oil is not None else 0.0
    return (shaft_power(of.problem.parts, known) - known.indicated_power) / omega, lift / omega
