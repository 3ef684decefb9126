"""Sobol indices: the share of a figure's variance due to each input, alone and together with others.

Inputs vary independently and uniformly between two values. Sampling and estimates are SALib's (Saltelli's scheme on a
scrambled Sobol sequence, bootstrapped confidence intervals).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.outputs.display import About, Brief, library
from screwsim.results.warning_kinds import kinds_of
from screwsim.scene.grid import too_many
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.inputs import check_fit, usual_efficiency
from screwsim.study.asked.spans import Span
from screwsim.study.asked.varied import Varied, with_values
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import Simulate, absolute_error, simulated_if_valid, simulator
from screwsim.study.pool.workers import WORKER_DIED

CONFIDENCE = 0.95
SAMPLES, ALONE = 256, 32  # base samples for several inputs; for a single one, which causes all of the variance
LARGEST_NOISE_SHARE = 0.01  # share of the variance that may be due to numerical errors


class SobolIndices(NamedTuple):
    """Indices of one path with the half widths of their confidence intervals."""

    path: str
    first: float
    first_confidence: float
    total: float
    total_confidence: float


@dataclass(frozen=True)
class FigureIndices:
    """Influence of the inputs on one figure [SI]; `message` says why there are no indices.

    `noise`: the share of the variance that may be due to the estimated numerical errors.
    """

    figure: str
    mean: float | None = None
    deviation: float | None = None
    noise: float | None = None
    indices: tuple[SobolIndices, ...] = ()
    message: str = ""


@dataclass(frozen=True, repr=False)
class Sensitivity(Brief):
    """Answer of a study: one `FigureIndices` per figure; `failed` of the `solutions` have no figures.

    `warnings` are the kinds of warnings of the solutions: (number of solutions, text of the first).
    """

    ranges: tuple[Span, ...]
    samples: int
    seed: int
    solutions: int
    failed: int
    shares: tuple[FigureIndices, ...]
    message: str = ""
    warnings: tuple[tuple[int, str], ...] = ()

    def _about(self) -> About:
        heading = f"Sobol indices of {counted(len(self.shares), 'figure')} to {counted(len(self.ranges), 'input')}"
        rows = [
            (shares.figure, each.path, *(f"{value:.3f} ± {half:.3f}" for value, half in (each[1:3], each[3:5])))
            for shares in self.shares
            for each in sorted(shares.indices, key=lambda one: -one.total)
        ]
        told = [self.message, *(f"{each.figure}: {each.message}" for each in self.shares if each.message)]
        return About(heading, [each for each in told if each], ("figure", "input", "first order", "total"), rows)

    def to_pandas(self) -> Any:
        """Return a pandas.DataFrame over figures and inputs: both indices, each with half its 95 % interval."""
        rows = [(shares.figure, *each) for shares in self.shares for each in shares.indices]
        columns = ["figure", "input", "first_order", "first_order_confidence", "total", "total_confidence"]
        return library("pandas").DataFrame(rows, columns=columns).set_index(["figure", "input"])


class _Answer(NamedTuple):
    message: str
    values: tuple[float, ...] = ()
    errors: tuple[float, ...] = ()
    lacks: bool = False  # True: the point has a solution, but no value of a figure
    warnings: tuple[str, ...] = ()


def usual_samples(inputs: int) -> int:
    """Return the default number of base samples of a study."""
    return SAMPLES if inputs > 1 else ALONE


def check_samples(inputs: int, samples: int) -> None:
    """Raise UsageError for base samples that Sobol's sequence cannot have, or that take too many points."""
    if samples < 2 or samples & (samples - 1):
        raise UsageError(f"--samples {samples}: is not a power of two (write e.g. 256; Sobol's sequence needs it)")
    what = too_many(samples * (inputs + 2))
    if what:
        raise UsageError(f"--samples {samples}: {what}")


def cost_in_words(inputs: int, samples: int) -> str:
    """Return in a line how many solutions a study takes, and the effect of fewer or more samples."""
    count, many = samples * (inputs + 2), counted(inputs, "input")
    told = f"{count} solutions, {samples} samples × ({many} + 2)"
    if inputs == 1:
        return f"{told}; a single input causes all of the variance, so only mean and deviation are informative"
    return f"{told} (--samples: a quarter of them doubles the interval widths, four times as many halve them)"


def sensitivity(
    scene: Varied,
    ranges: Sequence[Span],
    figures: Sequence[str] = (),
    *,
    samples: int | None = None,
    seed: int = 1,
    jobs: int | None = None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> Sensitivity:
    """Return the indices of figures to inputs, from samples · (inputs + 2) solutions.

    The default figures are `usual_efficiency` and the gas mass flow.
    """
    samples = usual_samples(len(ranges)) if samples is None else samples
    named = tuple(figures) or (usual_efficiency(scene), "gas_mass_flow")
    figures = tuple(dict.fromkeys(figure_of(scene, figure) for figure in named))
    check_samples(len(ranges), samples)
    bounds = [[each.low, each.high] for each in ranges]
    problem = {"num_vars": len(ranges), "names": [each.path for each in ranges], "bounds": bounds}  # in SALib's form
    points = _sampled_points(problem, samples, seed)
    middle = {each.path: 0.5 * (each.low + each.high) for each in ranges}
    check_fit(scene, middle, "in the middle of the ranges")
    simulate = simulate or simulator(with_values(scene, middle))
    call, dead = partial(_answer, scene, problem["names"], points, figures, simulate), _Answer(WORKER_DIED)
    count = {"failed": lambda one: bool(one.message), "progress": progress}
    answers = parallel_map(call, len(points), died=lambda number: dead, jobs=jobs, **count)
    head = (tuple(ranges), samples, seed, len(points))
    bad = [answer for answer in answers if answer.message]
    if bad:
        remedies = ["every point is needed: narrow the ranges"] if len(bad) < len(points) else []  # else none helps
        remedies += ["choose another --figure"] if bad[0].lacks else []
        remedy = f" ({', or '.join(remedies)})" if remedies else ""
        return Sensitivity(*head, len(bad), (), f"{len(bad)} of {len(points)} solutions: {bad[0].message}{remedy}")
    values, errors = (np.array([getattr(answer, name) for answer in answers]) for name in ("values", "errors"))
    shares = (_shares(figure, problem, values[:, i], errors[:, i], seed) for i, figure in enumerate(figures))
    return Sensitivity(*head, 0, tuple(shares), warnings=kinds_of(answer.warnings for answer in answers))


def _answer(
    scene: Varied, paths: list[str], points: np.ndarray, figures: tuple[str, ...], simulate: Simulate, number: int
) -> _Answer:
    """Return the figures of one point with their absolute errors."""
    at = with_values(scene, dict(zip(paths, map(float, points[number]), strict=True)))
    result = simulated_if_valid(at, simulate)
    if result.status != "ok":
        return _Answer(result.told)
    if lacks := result.lacks(figures):
        return _Answer(lacks[0], lacks=True)
    values = tuple(float(result.performance[figure]) for figure in figures)
    errors = tuple(absolute_error(result, figure, scene) for figure in figures)
    return _Answer("", values, errors, warnings=result.warnings)


def _sampled_points(problem: dict[str, Any], samples: int, seed: int) -> np.ndarray:
    """Return the points [SI], a row each."""
    try:
        from SALib.sample import sobol
    except ImportError:
        raise UsageError("SALib is not installed (install it with: pip install 'screwsim[sensitivity]')") from None
    return sobol.sample(problem, samples, calc_second_order=False, seed=seed)


def _shares(figure: str, problem: dict[str, Any], values: np.ndarray, errors: np.ndarray, seed: int) -> FigureIndices:
    """Return the indices of one figure; none where it does not vary beyond its numerical errors."""
    from SALib.analyze import sobol

    mean, deviation = float(values.mean()), float(values.std())
    noise = float(np.mean(errors**2))
    if deviation <= max(float(np.sqrt(noise)), 1e-12 * abs(mean)):
        return FigureIndices(figure, mean, deviation, None, (), "does not vary beyond its numerical error")
    found = sobol.analyze(problem, values, calc_second_order=False, conf_level=CONFIDENCE, seed=seed)
    columns = (np.asarray(found[name], float).tolist() for name in ("S1", "S1_conf", "ST", "ST_conf"))
    rows = zip(problem["names"], *columns, strict=True)
    return FigureIndices(figure, mean, deviation, noise / deviation**2, tuple(SobolIndices(*row) for row in rows))
