"""What counts as a closed cycle, and with which steps and regularisation it is sought."""

from __future__ import annotations

from dataclasses import dataclass, replace

from screwsim.numerics.closings import CLOSINGS
from screwsim.numerics.integrators import Check, check_of
from screwsim.numerics.settings import NumericsSettings

ENOUGH = 0.95  # of the bound on the balances, with which a cycle counts as closed
HISTORIES_FINER = 1e-4  # wanted accuracy from which on steps of waveforms are finer in proportion to it ...
HISTORIES_FINEST = 0.1  # ... down to this factor


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
    """Return what follows from the wanted accuracy (docs/explanation/numerics.md), with given widths."""
    rtol, accuracy = numerics.rtol or 0.3 * numerics.accuracy, numerics.accuracy
    of_histories = 1.0 if numerics.rtol else max(HISTORIES_FINEST, min(1.0, accuracy / HISTORIES_FINER))
    check = check_of(numerics.integrator)
    return Wanted(rtol, 0.2 * accuracy, accuracy, numerics.closing, widths, of_histories, check=check)
