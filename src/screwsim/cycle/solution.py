"""The criteria for a closed cycle, the cycle as closing left it, and the start of the next one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

from screwsim.cycle.linear_pitch import Tangents
from screwsim.model.slots import Q_WORK, R_TRAPPED
from screwsim.model.trajectory import Array, Trajectory
from screwsim.numerics.frozen import fast_init
from screwsim.numerics.integrators import Check, check_of
from screwsim.numerics.settings import CLOSINGS, NumericsSettings
from screwsim.outputs.variables import FAILED, OK

if TYPE_CHECKING:
    from screwsim.cycle.balances import Residuals
    from screwsim.cycle.newton import SlowestMode

CLOSED_SHARE = 0.95  # share of the bound on the balances within which a cycle counts as closed
HISTORIES_REFINED = 1e-4  # wanted accuracy below which steps of waveform relaxation are refined in proportion to it ...
HISTORIES_LEAST = 0.1  # ... down to this factor


@fast_init
@dataclass(frozen=True, eq=False)
class CycleSolution:
    """The outcome of closing: one chamber's life, its quadratures `q`, and why iteration stopped.

    `y` are the states to continue from: of the chamber at 0° (waveform relaxation) or of all chambers
    (simultaneous), in the way that closed the cycle. `angle` [rad] is where a failed integration stopped, `change`
    the last relative change.
    """

    status: str  # one of outputs.variables.STATUSES
    trajectory: Trajectory
    q: Array
    y: Array
    turns: float
    how: str
    rtol: float
    angle: float = 0.0
    change: float = 0.0
    needed: str = ""  # the fallback that was needed; empty where the first way closed
    growth: float = 0.0  # of a small change over a pitch, above 1 where the cycle is unstable; 0: not computed
    first_gap: float = 1.0  # change over the first turn: the error of the guess
    residual: float = 0.0  # of waveform relaxation: the larger residual of mass and energy, over their bound
    impacts: int = 0  # impact events of the last turn, where something moves between seat and stop
    speed_curve: Array | None = None  # last speed over the angle as the drive gave it (model.speed)
    tangents: Tangents | None = None  # the linearisation of the last Newton correction, where one was made
    contraction: float = 1.0  # of waveform relaxation: last known ratio of a turn's change to that of the turn before
    open: Residuals | None = None  # balance residuals of the last turn, where known and not corrected since
    unknowns_out: Array | None = None  # the feedback unknowns that the last turn gave, under the same condition
    left: float = 0.0  # change still to come by Newton's correction, where that closed the cycle
    missed: float = 1.0  # relative error of the corrections' predictions, seen by the turn after; 1: not known
    lasting: SlowestMode | None = None  # slowest-decaying change of the unknowns, where Newton's corrections gave it
    abandoned_cycle: CycleSolution | None = None  # the unclosed cycle of the way that was given up before this one

    @property
    def closed(self) -> bool:
        """Whether the cycle is closed."""
        return self.status == OK

    @property
    def failed(self) -> bool:
        """Whether an integration stopped before its end."""
        return self.status == FAILED

    @property
    def seen(self) -> tuple[float, float]:
        """Trapped mass [kg] and work [J]."""
        return float(self.trajectory.R[R_TRAPPED]), float(self.q[Q_WORK])


class Expectation(NamedTuple):
    """What is expected of a guess: `seen`, trapped mass [kg] and work [J], and `gap`, the change over the first turn.

    `share` is the factor on the wanted tolerance of a step with which the balances should close, `contraction` the
    recent ratio of a turn's change to that of the one before, `missed` the relative error of corrections by the
    tangents that come with the guess (1: not known).
    """

    seen: tuple[float, float]
    gap: float
    share: float = 1.0
    contraction: float = 1.0
    missed: float = 1.0


class CorrectedState(NamedTuple):
    """Where finer lives and a correction have moved a closed cycle: the state at 0°, trapped mass [kg] and work [J]."""

    y: Array
    seen: tuple[float, float]


NO_EXPECTATION = Expectation((0.0, 0.0), 1.0)


class Start(NamedTuple):
    """What closing starts with, besides the guessed history already installed: the state at 0°, and its `Expectation`.

    `tangents` are the linearisation about a nearby cycle, where there is one.
    """

    y: Array
    expected: Expectation = NO_EXPECTATION
    tangents: Tangents | None = None


@dataclass(frozen=True)
class ClosingCriteria:
    """The closing criteria: `tolerance` on changes of mass and work, `bound` on the balances, `rtol` of a step.

    Waveform relaxation multiplies `rtol` by `histories_factor`; `widths` [Pa] are those of the regularisation, in the
    order of `Composition.widths`. `ahead` is the share of the bound within which a cycle may close on a prediction
    that little change is still to come, without a further turn. With a `check`, that method closes the cycle again
    after ours has.
    """

    rtol: float
    tolerance: float
    bound: float
    closing: str
    widths: tuple[float, ...]
    histories_factor: float = 1.0
    ahead: float = CLOSED_SHARE
    check: Check | None = None

    @property
    def fallbacks(self) -> bool:
        """Whether fallbacks are tried where none of the wanted ways closes the cycle."""
        return CLOSINGS[self.closing].fallbacks

    def tighter(self, factor: float) -> ClosingCriteria:
        """Return the same criteria with tolerances and regularisation widths multiplied by a factor."""
        widths = tuple(factor * width for width in self.widths)
        return replace(self, rtol=factor * self.rtol, tolerance=factor * self.tolerance, widths=widths)


def closing_criteria(numerics: NumericsSettings, widths: tuple[float, ...]) -> ClosingCriteria:
    """Return the closing criteria for the wanted accuracy (docs/explanation/errors.md), with given widths [Pa]."""
    rtol, accuracy = numerics.rtol or 0.3 * numerics.accuracy, numerics.accuracy
    of_histories = 1.0 if numerics.rtol else max(HISTORIES_LEAST, min(1.0, accuracy / HISTORIES_REFINED))
    check = check_of(numerics.integrator)
    return ClosingCriteria(rtol, 0.2 * accuracy, accuracy, numerics.closing, widths, of_histories, check=check)
