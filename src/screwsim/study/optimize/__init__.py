"""Optimisation: the values of paths at which figures are best, over operating points, within bounds."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from screwsim.figures.engineering import figure_text
from screwsim.inputs.arguments import TEXTS, as_list, checked_arguments, whole
from screwsim.outputs import Result
from screwsim.outputs.display import About, Brief
from screwsim.results.atomic import make_folder
from screwsim.scene import SceneLike, without_sweep
from screwsim.study.asked.goals import Bound
from screwsim.study.asked.inputs import check_fit, shown_value
from screwsim.study.asked.spans import LOWER, UPPER, read_spans, refusal_beyond
from screwsim.study.asked.varied import Varied, with_text, with_values
from screwsim.study.best.search import Maximum
from screwsim.study.optimize.evaluate import SimulatedPoint, simulated
from screwsim.study.optimize.points import OperatingPoints
from screwsim.study.optimize.question import Aim, Question, question
from screwsim.study.optimize.record import Record
from screwsim.study.optimize.solve import front_of, search
from screwsim.study.optimize.store import held_parts, write
from screwsim.study.pool.parallel import BatchWorkers, WarmSimulation
from screwsim.study.pool.progress import Progress, progress_of
from screwsim.study.pool.solving import Simulate, simulator
from screwsim.study.pool.tally import Place, Tally
from screwsim.study.pool.workers import cores
from screwsim.study.seek import rounded
from screwsim.study.stages import scene_or_stages
from screwsim.study.uncertainty.point import figures_by_inputs
from screwsim.study.uncertainty.spreads import FigureUncertainty

__all__ = ["Aim", "EquallyGoodRange", "Optimum", "Question", "optimize", "question", "run_question", "spans_of"]

END_DISTANCE = 2e-4  # of a range: distance from its end that counts as at the end
INSENSITIVE_SHARE = 0.9  # of a range over which the aim is equally good: the path does not matter ...
LARGEST_HOLE = 0.5  # ... unless such a share of it is without an equally good value


@dataclass(frozen=True)
class EquallyGoodRange:
    """How far a path [SI] may go with the aim equally good within its error, as far as evaluated.

    `border` is the end at which the best lies, `beyond` why there is no solution beyond that end, or next to a best
    inside the range of a single path; `idle` where the aim is equally good over the whole range.
    """

    low: float
    high: float
    border: str = ""
    idle: bool = False
    beyond: str = ""


@dataclass(frozen=True, repr=False)
class Optimum(Brief):
    """The answer, all in SI units; `status` none: no evaluation has results within the bounds.

    The rows of `places` (0 … 1 between the bounds), `aims`, `errors` (numerical, of the aims, absolute) and `excess`
    (over the bounds) are the evaluations; NaN where one failed. `front` holds the rows that no other dominates, sorted
    by the first aim; with one aim it is the best alone, to which `values`, `reach`, `points` and `scene` belong.
    `others` are further local optima (value, aim) of one path. `by_inputs` are the uncertainties of the best's aim and
    bounded figures at its one operating point by the tolerances of the scene's other inputs.
    """

    asked: Question
    status: str  # ok | none
    places: np.ndarray
    aims: np.ndarray
    errors: np.ndarray
    excess: np.ndarray
    front: np.ndarray
    failed: int
    outside: int  # evaluations with results that break a bound
    reasons: Mapping[str, int]
    message: str = ""
    reused: int = 0
    reach: Mapping[str, EquallyGoodRange] = field(default_factory=dict)
    others: tuple[tuple[float, float], ...] = ()
    points: tuple[SimulatedPoint, ...] = ()
    scene: Varied | None = None
    by_inputs: Mapping[str, FigureUncertainty] = field(default_factory=dict)
    warnings: Mapping[int, tuple[str, ...]] = field(default_factory=dict)  # of evaluations on the front that warn

    @property
    def values(self) -> dict[str, float]:
        """Values [SI] of the best evaluation, or of the first of the front."""
        return self.values_at(int(self.front[0])) if len(self.front) else {}

    def values_at(self, row: int) -> dict[str, float]:
        """Return the values [SI] of an evaluation."""
        return self.asked.values(self.places[row])

    def _about(self) -> About:
        scene, aims = self.asked.scene, self.asked.aims
        asked = ", ".join(f"{'least' if aim.minimum else 'greatest'} {aim.figure}" for aim in aims)
        rows = []
        for row in map(int, self.front):
            figures = [figure_text(aim.figure, float(self.aims[row, i])) for i, aim in enumerate(aims)]
            rows.append([*figures, *(shown_value(scene, path, at) for path, at in self.values_at(row).items())])
        counts = f"{len(self.places)} evaluations, {self.failed} failed, {self.outside} outside the bounds"
        due = "uncertain by the tolerances of inputs, too (.by_inputs)" if self.by_inputs else ""
        notes = [text for text in (counts, self.message, due) if text]
        columns = [*(aim.figure for aim in aims), *(span.path for span in self.asked.spans)]
        return About(f"Optimum: {self.status}, {asked}", notes, columns, rows)

    @property
    def cut_short(self) -> bool:
        """Whether the search for the best of one aim used all evaluations that it was allowed."""
        return len(self.asked.aims) == 1 and bool(self.asked.spans) and len(self.places) >= self.asked.evaluations

    def scene_at(self, row: int) -> Varied:
        """Return the scene of an evaluation, or its two stages."""
        scene = self.asked.scene
        return with_text(with_values(scene, rounded(scene, self.values_at(row))))


@checked_arguments(
    vary=TEXTS, maximize=TEXTS, minimize=TEXTS, evaluations=whole(1, "no number of evaluations (pass 1 or more)")
)
def optimize(
    scene: SceneLike,
    vary: Iterable[str] | Mapping[str, tuple[float, float]] = (),
    maximize: Iterable[str] = (),
    minimize: Iterable[str] = (),
    *,
    subject_to: Iterable[str] | Sequence[Bound] = (),
    over: str | OperatingPoints | None = None,
    evaluations: int | None = None,
    seed: int = 1,
    output: str | Path | None = None,
    jobs: int | None = None,
    restart: bool = False,
    simulate: Simulate | None = None,
    progress: Progress | bool | None = None,
) -> Optimum:
    """Return the best values of paths for one aim, or the front of several (a scene's sweep is left aside).

        found = screwsim.optimize("x.yaml", ["oil_supply.ratio=0.3..3", "operation.speed=1000 rpm..5000 rpm"],
                                  maximize=["isentropic_efficiency", "cooling_capacity"])
        found.values_at(found.front[0]), found.aims[found.front]

    With `over` nothing need vary: `screwsim.optimize("x.yaml", over="SCOP-55")` rates the scene itself over the points.

    The scene is what `load` returns, the path of a file (also of two stages, without `over`), YAML text, or a dict
    laid out as the file is. Paths, aims and limits are written as in `question`. `progress`: True shows a bar or a
    line on stderr, None a bar in a notebook, False nothing. With `output` all evaluations are kept in an HDF5 file (of
    two stages a table, .csv or .h5), and an interrupted run of the same question repeats none of them (unless
    `restart`).
    """
    given = scene_or_stages(scene)
    base = with_text(without_sweep(given))
    spans = vary if isinstance(vary, Mapping) else spans_of(given, vary)
    more = {"subject_to": subject_to, "over": over, "evaluations": evaluations, "seed": seed}
    asked = question(base, spans, maximize, minimize, **more)
    bar = progress_of("optimize", progress)
    return run_question(asked, output, jobs=jobs, restart=restart, simulate=simulate, progress=bar)


def spans_of(scene: Varied, vary: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Return the ranges [SI] of texts 'PATH=LOW..HIGH', or 'PATH' of an axis of the scene's sweep."""
    texts = as_list(vary)
    return {span.path: (span.low, span.high) for span in read_spans(scene, texts, ranged=True)} if texts else {}


def run_question(
    asked: Question,
    output: str | Path | None = None,
    *,
    jobs: int | None,
    restart: bool = False,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> Optimum:
    """Return the answer to a question."""
    begin = asked.values([span.first for span in asked.spans])
    check_fit(with_values(asked.scene, asked.points.points[0].values), begin, ", ".join(begin))
    if simulate is None:
        simulator(with_values(asked.scene, begin))  # compiled before the fork
    progress, jobs = progress or Progress(), jobs or cores()
    target = None if output is None else Path(output)
    if target is not None:
        make_folder(target.parent)
    with nullcontext() if target is None else held_parts(target, asked, restart) as parts:
        tally = Tally(progress, Place.BESIDE if jobs > 1 else Place.HERE)
        try:
            with BatchWorkers(jobs, tally.tick) as crew:
                record = Record(asked, crew, parts, simulate, tally)
                top = search(record)
        finally:
            tally.stop()
        found = _optimum_of(record, top, simulate or WarmSimulation())
        if target is not None:
            write(target, record, _feasible(record), found.front)
    return found


def _feasible(record: Record) -> np.ndarray:
    """Return which evaluations have results within the bounds."""
    aims, _, excess = record.columns()
    return np.asarray(np.all(np.isfinite(aims), axis=1) & np.all(excess <= 0.0, axis=1))


def _optimum_of(record: Record, top: Maximum | None, simulate: Simulate) -> Optimum:
    """Return the answer from all evaluations."""
    asked, (aims, errors, excess) = record.asked, record.columns()
    feasible, solved = _feasible(record), np.asarray(np.all(np.isfinite(aims), axis=1))
    signs = np.array([aim.sign for aim in asked.aims])
    front = front_of(np.where(feasible[:, None], signs * aims, math.nan))
    found = Optimum(
        asked,
        "ok" if len(front) else "none",
        record.places,
        aims,
        errors,
        excess,
        front,
        int(np.count_nonzero(~solved)),
        int(np.count_nonzero(solved & ~feasible)),
        dict(record.reasons.most_common()),
        "" if len(front) else _why_none(record, solved, excess),
        record.reused,
        warnings={row: record.warned[row] for row in front.tolist() if row in record.warned},
    )
    if len(asked.aims) > 1 or not len(front):
        return found
    best = int(front[0])
    points = tuple(simulated(asked, rounded(asked.scene, found.values), simulate))
    lower = () if top is None else top.others
    others = tuple((asked.spans[0].value(each.x), float(signs[0] * -each.y)) for each in lower)
    ranges = (_equally_good_range(found, feasible, i, best, top, simulate) for i in range(len(asked.spans)))
    reach = {span.path: one for span, one in zip(asked.spans, ranges, strict=True)}
    scene = found.scene_at(best)
    found = replace(found, reach=reach, others=others, points=points, scene=scene)
    if not asked.points.single:
        return found
    by_inputs, message = figures_by_inputs(scene, points[0].result, asked.figures, list(found.values))
    return replace(found, by_inputs=by_inputs, message=message)


def _why_none(record: Record, solved: np.ndarray, excess: np.ndarray) -> str:
    """Return why no evaluation is feasible."""
    if not solved.any():
        reason, count = record.reasons.most_common(1)[0]
        if len(record) == 1:
            return f"the evaluation {reason}"
        return f"all {len(record)} evaluations failed, {count} of them with: {reason}"
    least = np.nanmin(excess[solved], axis=0)
    bounds = zip(record.asked.bounds, least, strict=True)
    bound, off = max(bounds, key=lambda pair: pair[1] / max(abs(pair[0].value), 1e-12))
    came = figure_text(bound.figure, bound.value + (off if bound.sign == "<" else -off))
    asked = f"{bound.figure}{bound.sign}{figure_text(bound.figure, bound.value)}"
    nearest = f"{asked} was required, and the nearest is {came}"
    remedy = "widen the ranges, or the bound" if record.asked.spans else "widen the bound, or vary a path"
    return f"no evaluation is within the bounds: {nearest} ({remedy})"


def _beside(found: Optimum, best: int, solved: Callable[[float], Result]) -> str:
    """Return why the solution next to the best value of a single path failed; empty where none did."""
    (span, *others), off = found.asked.spans, np.abs(found.places[:, 0] - found.places[best, 0])
    near = np.flatnonzero(np.isnan(found.aims[:, 0]) & (off <= END_DISTANCE))
    if others or not len(near):
        return ""
    result = solved(span.value(float(found.places[near[np.argmin(off[near])], 0])))
    return "" if result.status == "ok" else result.told


def _equally_good_range(
    found: Optimum, feasible: np.ndarray, column: int, best: int, top: Maximum | None, simulate: Simulate
) -> EquallyGoodRange:
    """Return how far a path may go within the error of the best; for a single path from the parabola at its top."""
    asked, span, place = found.asked, found.asked.spans[column], float(found.places[best, column])

    def solved(value: float) -> Result:
        points = simulated(asked, {**found.values, span.path: value}, simulate)
        bad = next((point for point in points if point.result.status != "ok"), None)
        if bad is None:
            return points[0].result
        at = f"at {bad.point.name}: " if bad.point.name else ""
        return replace(bad.result, message=f"{at}{bad.result.message}")

    worse = asked.aims[0].sign * (found.aims[:, 0] - found.aims[best, 0])
    good = np.sort(found.places[feasible & (worse <= found.errors[best, 0] + found.errors[:, 0]), column])
    low, high = float(good[0]), float(good[-1])
    if high - low > INSENSITIVE_SHARE and float(np.diff(good).max()) < LARGEST_HOLE:  # the best place is one by chance
        return EquallyGoodRange(span.value(low), span.value(high), idle=True)
    border = LOWER if place < END_DISTANCE else UPPER if place > 1.0 - END_DISTANCE else ""
    beyond = refusal_beyond(asked.scene, span, border, solved) if border else _beside(found, best, solved)
    if top is not None and not asked.bounds:
        low, high = top.low, top.high
    return EquallyGoodRange(span.value(low), span.value(high), border, beyond=beyond)
