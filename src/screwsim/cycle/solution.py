"""What counts as a closed cycle and how it is sought; a cycle as closing left it, and what is hoped of one before."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

from screwsim.cycle.linear_pitch import Tangents
from screwsim.model.slots import Q_WORK, R_TRAPPED
from screwsim.model.trajectory import Array, Trajectory
from screwsim.numerics.at_once import at_once
from screwsim.numerics.integrators import Check, check_of
from screwsim.numerics.settings import CLOSINGS, NumericsSettings
from screwsim.outputs.variables import FAILED, OK

if TYPE_CHECKING:
    from screwsim.cycle.balances import Residuals
    from screwsim.cycle.newton import Lasting

ENOUGH = 0.95  # of the bound on the balances, with which a cycle counts as closed
HISTORIES_FINER = 1e-4  # wanted accuracy from which on steps of waveforms are finer in proportion to it ...
HISTORIES_FINEST = 0.1  # ... down to this factor


@at_once
@dataclass(frozen=True, eq=False)
class CycleSolution:
    """The outcome of closing: one chamber's life and its quadratures, how far it got, why it stopped.

    `y` are the states from which it goes on: of the chamber at 0°, or of all chambers, as it was closed.
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
    needed: str = ""  # the fallback that it took; empty where the first way closed
    growth: float = 0.0  # of a small change over a pitch, above 1 where pitches lead away from the cycle; 0: not asked
    first_gap: float = 1.0  # what the first turn changed: how far the guess was off
    residual: float = 0.0  # of waveforms: the larger residual of mass and energy over their bound
    impacts: int = 0  # of the last turn, where something moves between seat and stop
    speed_curve: Array | None = None  # of the speed that the drive made last (model.speed)
    tangents: Tangents | None = None  # of Newton's correction, where one was made
    contraction: float = 1.0  # of waveforms: change of a turn over that of the one before, as it was seen last
    open: Residuals | None = None  # what the last turn left open, where that is known and nothing corrected it
    made: Array | None = None  # the same of what it made of the feedback unknowns
    left: float = 0.0  # what Newton's correction tells to be still to come, where that closed the cycle
    missed: float = 1.0  # share of what corrections foretold by which the turn after them went elsewhere; 1: not known
    lasting: Lasting | None = None  # what lasts longest of a change of the unknowns, where Newton's corrections told
    left_at: CycleSolution | None = None  # where another way was left, unclosed, before this one closed the cycle

    @property
    def closed(self) -> bool:
        """Is the cycle closed?"""
        return self.status == OK

    @property
    def failed(self) -> bool:
        """Did an integration stop?"""
        return self.status == FAILED

    @property
    def seen(self) -> tuple[float, float]:
        """Trapped mass [kg] and work [J]."""
        return float(self.trajectory.R[R_TRAPPED]), float(self.q[Q_WORK])


class Hope(NamedTuple):
    """What is hoped of a guess: its trapped mass [kg] and work [J], and what the first turn will change.

    `share` is that of the wanted tolerance of a step with which the balances will close, `contraction` what turns left
    of a change lately, `missed` what corrections by the tangents that come with it did not lead to (1: not known).
    """

    seen: tuple[float, float]
    gap: float
    share: float = 1.0
    contraction: float = 1.0
    missed: float = 1.0


class Led(NamedTuple):
    """Where lives and a correction have led from a closed cycle: the state at 0°, trapped mass [kg] and work [J]."""

    y: Array
    seen: tuple[float, float]


NO_HOPE = Hope((0.0, 0.0), 1.0)


class Start(NamedTuple):
    """What closing begins with beside the guess that is installed as the last history: the state at 0°, and its hope.

    `tangents` are those by which a cycle nearby was corrected.
    """

    y: Array
    hope: Hope = NO_HOPE
    tangents: Tangents | None = None


@dataclass(frozen=True)
class Wanted:
    """What counts as closed: `tolerance` on changes of mass and work, `bound` on the balances, `rtol` of a step.

    Steps of waveforms have `of_histories` times that `rtol`; `widths` [Pa] are those of the regularisation, in the
    order of `Composition.widths`. `ahead` is the share of the bound with which a cycle may close while little is
    still to come, before a turn shows it. With a `check` its method closes the cycle once ours has.
    """

    rtol: float
    tolerance: float
    bound: float
    closing: str
    widths: tuple[float, ...]
    of_histories: float = 1.0
    ahead: float = ENOUGH
    check: Check | None = None

    @property
    def fallbacks(self) -> bool:
        """Whether further tries follow where the ways of its closing close no cycle."""
        return CLOSINGS[self.closing].fallbacks

    def tighter(self, factor: float) -> Wanted:
        """Return the same with tolerances and regularisation times a factor."""
        widths = tuple(factor * width for width in self.widths)
        return replace(self, rtol=factor * self.rtol, tolerance=factor * self.tolerance, widths=widths)


def wanted_of(numerics: NumericsSettings, widths: tuple[float, ...]) -> Wanted:
    """Return what follows from the wanted accuracy (docs/explanation/errors.md), with given widths."""
    rtol, accuracy = numerics.rtol or 0.3 * numerics.accuracy, numerics.accuracy
    of_histories = 1.0 if numerics.rtol else max(HISTORIES_FINEST, min(1.0, accuracy / HISTORIES_FINER))
    check = check_of(numerics.integrator)
    return Wanted(rtol, 0.2 * accuracy, accuracy, numerics.closing, widths, of_histories, check=check)
