"""Marks of a sheet's points beyond limits: one sign a limit, so that a table says which is exceeded where."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from screwsim.outputs import Result
from screwsim.study.datasheet.bounds import Limit, bound_words, exceeded_bounds
from screwsim.study.datasheet.units import Units

BLANK, SIGNS = "\u00a0", "*†‡§¶#"


@dataclass(frozen=True)
class Marks:
    """The mark of each limit that points of a sheet exceed."""

    of: Mapping[Limit, str]

    def column(self, results: Iterable[Result | None]) -> list[str]:
        """Return the marks of points, all of one width; blank for one without a result."""
        marks = ["".join(self.of[bound] for bound in _exceeded(result, self.of)) for result in results]
        width = max(map(len, marks), default=0)
        return [mark.ljust(width, BLANK) for mark in marks]

    def note(self, results: Iterable[Result | None], units: Units) -> str:
        """Return what the marks of points mean; empty where there are none."""
        there = {bound for result in results for bound in _exceeded(result, self.of)}
        meant = [f"{mark} {bound_words(bound, units)}" for bound, mark in self.of.items() if bound in there]
        return f"beyond a limit: {', '.join(meant)}" if meant else ""


def marks_of(bounds: Iterable[Limit], results: Iterable[Result | None]) -> Marks:
    """Return the marks of the limits that any of the results exceeds, in the order in which they are first exceeded."""
    limits = list(bounds)
    exceeded = list(dict.fromkeys(bound for result in results for bound in _exceeded(result, limits)))
    signs = (SIGNS[i % len(SIGNS)] * (1 + i // len(SIGNS)) for i in range(len(exceeded)))
    return Marks(dict(zip(exceeded, signs, strict=True)))


def _exceeded(result: Result | None, bounds: Iterable[Limit]) -> list[Limit]:
    """Return the limits that a point exceeds; none where it has no result."""
    return exceeded_bounds(result.performance, bounds) if result is not None and result.status == "ok" else []
