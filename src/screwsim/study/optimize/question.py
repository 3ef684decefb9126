"""The question of an optimisation: paths between two values, figures to optimise, bounds, operating points."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.inputs.arguments import shown
from screwsim.inputs.faults import UsageError
from screwsim.scene import Scene
from screwsim.scene.grid import too_many
from screwsim.study.asked.figures import figure_of, figures_of
from screwsim.study.asked.goals import Bound, read_bounds
from screwsim.study.asked.inputs import check_continuous, usual_efficiency
from screwsim.study.asked.spans import Span, read_spans
from screwsim.study.asked.varied import Varied
from screwsim.study.optimize.points import SINGLE_POINT, OperatingPoints, read_points

EVALUATIONS_PER_PATH = 100  # evaluations per path, where no number is given


class Aim(NamedTuple):
    """A figure that is to be maximised, or minimised."""

    figure: str
    minimum: bool = False

    @property
    def sign(self) -> float:
        """Factor by which the figure becomes a quantity to minimise."""
        return 1.0 if self.minimum else -1.0


@dataclass(frozen=True)
class Question:
    """The whole question; `scene` has no sweep. At most `evaluations` sets of values of the paths are tried."""

    scene: Varied
    spans: tuple[Span, ...]
    aims: tuple[Aim, ...]
    bounds: tuple[Bound, ...] = ()
    points: OperatingPoints = SINGLE_POINT
    evaluations: int = EVALUATIONS_PER_PATH
    seed: int = 1

    def values(self, places: Iterable[float]) -> dict[str, float]:
        """Return the values [SI] at places 0 … 1."""
        return {span.path: span.value(float(place)) for span, place in zip(self.spans, places, strict=True)}

    @property
    def figures(self) -> tuple[str, ...]:
        """Figures that every operating point must have."""
        loads = (self.points.aim.load,) if any(point.load is not None for point in self.points.points) else ()
        named = (*(aim.figure for aim in self.aims), *(bound.figure for bound in self.bounds), *loads)
        return tuple(dict.fromkeys(named))


def question(
    scene: Varied,
    vary: Iterable[str] | Mapping[str, tuple[float, float]],
    maximize: Iterable[str] = (),
    minimize: Iterable[str] = (),
    *,
    subject_to: Iterable[str] | Sequence[Bound] = (),
    over: str | OperatingPoints | None = None,
    evaluations: int | None = None,
    seed: int = 1,
) -> Question:
    """Return the question; raise UsageError, in one line, where it makes no sense.

    `vary` are texts 'PATH=LOW..HIGH', or 'PATH' of an axis of the sweep, or {path: (low, high) [SI]}. With operating
    points it may be empty: the scene itself is rated over them. The default aim is to maximise the usual efficiency, or
    the COP where nothing varies.
    """
    aims = _aims(scene, maximize, minimize)
    varied = vary if isinstance(vary, Mapping) else _listed(vary)
    spans = read_spans(scene, varied, ranged=True) if varied else ()
    if not spans and not over:
        raise UsageError("nothing varies (give one path or more with its range, or points to rate the scene over)")
    bounds = [each if isinstance(each, Bound) else read_bounds(scene, [each])[0] for each in _listed(subject_to)]
    points = _operating_points(scene, over, spans)
    count = (EVALUATIONS_PER_PATH * len(spans) or 1) if evaluations is None else evaluations
    what = "is not a number of evaluations (write 1 or more)" if count < 1 else too_many(count)
    if what:
        raise UsageError(f"--evaluations {count}: {what}")
    aims = aims or (Aim(usual_efficiency(scene) if spans else _usual_cop(scene, points)),)
    return Question(scene, spans, aims, tuple(bounds), points, count if spans else 1, seed)


def _usual_cop(scene: Varied, points: OperatingPoints) -> str:
    """Return the COP over the points, of the motor's power where there is a motor; without a COP the efficiency."""
    named = figures_of(scene) if isinstance(scene, Scene) else ()
    return next((name for name in reversed(points.cops) if name in named), usual_efficiency(scene))


def _aims(scene: Varied, maximize: Iterable[str], minimize: Iterable[str]) -> tuple[Aim, ...]:
    """Return the aims; raise UsageError where a figure is given twice."""
    aims = [Aim(figure_of(scene, name, "--maximize")) for name in _listed(maximize)]
    aims += [Aim(figure_of(scene, name, "--minimize"), True) for name in _listed(minimize)]
    named = [aim.figure for aim in aims]
    if twice := next((name for name in named if named.count(name) > 1), ""):
        raise UsageError(f"--maximize, --minimize: {twice} is given twice as an aim (remove one)")
    return tuple(aims)


def _operating_points(scene: Varied, over: str | OperatingPoints | None, spans: Sequence[Span]) -> OperatingPoints:
    """Return the operating points; raise UsageError where they set what varies, or need loads that there are not."""
    if not isinstance(over, OperatingPoints | str | None):
        raise UsageError(f"over: {shown(over)} is not a text (pass one as for --over)")
    if isinstance(scene, Scene):
        points = over if isinstance(over, OperatingPoints) else read_points(scene, over)
    elif over:
        raise UsageError("over: operating points are those of one machine (leave it out for two stages)")
    else:
        return SINGLE_POINT
    both = {span.path for span in spans} & {path for point in points.points for path in point.values}
    if both:
        what = "is also set by the operating points of --over"
        raise UsageError(f"--vary {min(both)}: {what} (remove it from one of the two)")
    if any(point.load is not None for point in points.points):
        check_continuous(scene, points.by)
        figure_of(scene, points.aim.load, "--over")
    return points


def _listed(given: Iterable[Any]) -> list[Any]:
    found = [given] if isinstance(given, str | Bound) or not isinstance(given, Iterable) else list(given)
    for each in found:
        if not isinstance(each, str | Bound):
            raise UsageError(f"{shown(each)} is neither an aim nor a bound (pass a text, or a list of texts)")
    return found
