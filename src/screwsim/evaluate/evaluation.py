"""A closed cycle being read: what several readings ask for is found once, and only where one of them asks."""

from dataclasses import dataclass, replace

from screwsim.cycle.balances import LEAST_WORK, Residuals, residuals, streams_of
from screwsim.cycle.feedback import image, turn_of
from screwsim.cycle.known import CycleFigures, LazyPitch, known_of, oil_lift, power_losses, shaft_power
from screwsim.cycle.pitch import Pitch
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.effects.base import Reading, Turn
from screwsim.evaluate.figures import Read, figures_of
from screwsim.evaluate.separator import Circuit, Package, circuit_of, package_off
from screwsim.figures import Performance
from screwsim.model.exchange import station
from screwsim.model.slots import Q_HEAT, R_INJECTED, R_TRAPPED
from screwsim.model.trajectory import Array, Trajectory
from screwsim.numerics.at_once import at_once
from screwsim.numerics.remembered import once
from screwsim.outputs import Figures


@at_once
@dataclass(frozen=True, eq=False)
class Evaluation:
    """A life of a problem's chambers, and its quadratures q; where closing knows them, what it left open and made."""

    problem: Problem
    life: Trajectory
    q: Array
    left: Residuals | None = None
    made: Array | None = None

    @once
    def streams(self) -> Array:
        """Sums over the life by category (`cycle.balances.streams_of`)."""
        return streams_of(self.problem.composition, self.q)

    @once
    def turn(self) -> Turn:
        """What the life tells of itself, and what it makes of the feedback unknowns."""
        return turn_of(self.problem, self.life, self.q)

    @property
    def image(self) -> Array:
        """What the life makes of the feedback unknowns, as a vector."""
        if self.made is not None:
            return self.made
        return image(self.problem, self.life, self.q, self.turn if self.problem.parts.made else None)

    @once
    def pitch(self) -> Pitch:
        """One pitch of all chambers."""
        return self.lazy_pitch()

    @once
    def lazy_pitch(self) -> LazyPitch:
        """The same, to be called where it is wanted."""
        return LazyPitch(self.problem, self.life, self.q)

    @once
    def known(self) -> CycleFigures:
        """What a power loss or a reading can ask."""
        parts = self.problem.parts
        turn = self.turn if parts.made or parts.all(Reading) else None
        return known_of(self.problem, self.life, self.q, self.lazy_pitch, turn)

    @once
    def losses(self) -> dict[str, float]:
        """The power losses [W] beside the gas work."""
        return power_losses(self.problem.parts, self.known)

    @once
    def circuit(self) -> Circuit | str | None:
        """The oil's circuit through separator and cooler; None where nothing asks for it, a text for why not."""
        parts = self.problem.parts
        lift = oil_lift(parts, self.known) if parts.oil is not None else 0.0
        return circuit_of(self.problem, self.life, self.q, self.losses, lift)

    @once
    def read(self) -> Read:
        """The performance figures, and why some are None."""
        self.known  # noqa: B018 - found first: others come as far
        station()
        circuit = self.circuit
        station()
        return figures_of(self.problem, self.life, self.q, self.known, self.losses, circuit)

    @once
    def package(self) -> Package | None:
        """How far the losses of a package are from those of the flow; None without one."""
        return package_off(self.problem, self.figures["gas_mass_flow"])

    @property
    def figures(self) -> Performance:
        """The performance figures."""
        return self.read[0]

    @property
    def complete(self) -> CycleFigures:
        """What a shaft asks of the cycle: what is known of it, and the shaft power."""
        return replace(self.known, shaft_power=self.figures.shaft_power)

    @property
    def least(self) -> tuple[float, float]:
        """The power [W] and the work of a cycle [J] below which they are rounding."""
        work = LEAST_WORK * max(float(self.life.R[R_TRAPPED]), 0.0) * self.problem.pv
        return work * self.problem.rate, work


def evaluate(problem: Problem, cycle: CycleSolution) -> Evaluation:
    """Return the evaluation of a cycle."""
    return Evaluation(problem, cycle.trajectory, cycle.q, cycle.open, cycle.made)


def balance(of: Evaluation) -> Figures:
    """Return the balances of a closed cycle (contract: balance)."""
    problem, c, oil = of.problem, of.problem.composition, of.problem.parts.oil
    left, residual = of.left or residuals(problem, of.life.R, of.q), None
    T_out = None if c.carried else of.known.oil_discharge_temperature
    if oil is not None and T_out is not None:  # what the oil takes up beyond what it carries to discharge (M40) [W]
        carried = float(of.life.R[R_INJECTED]) * oil.heat_capacity * (T_out - oil.temperature)
        residual = float(-of.q[Q_HEAT] - carried) * problem.rate
    oil_mass, bound = left.oil if c.carried else None, problem.wanted.bound
    return Figures(mass=left.mass, energy=left.energy, oil_mass=oil_mass, oil_residue=residual, bound=bound)


def loss_torque(of: Evaluation, omega: float) -> float:
    """Return the torque of the losses and of the oil's lift at a mean speed [rad/s], from one pitch's q (M213)."""
    share = omega / of.problem.parts.omega
    names = ("tip_speed", "indicated_power", "oil_mass_flow", "oil_volume_flow", "leaked_oil_flow", "drag_power")
    known = replace(of.known, omega=omega, **{name: share * getattr(of.known, name) for name in names})
    return (shaft_power(of.problem.parts, known) - known.indicated_power) / omega
