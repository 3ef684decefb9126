"""Effect of length errors of a slider-crank on a compressor: Monte Carlo over tolerances through the cycle.

Source: ISO 286-1 grades (S10), lengths drawn as in S31; docs/reference/slider-crank.md.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from screwsim.inputs.faults import UsageError
from screwsim.machine.slider_crank.cylinder import SliderCrank
from screwsim.machine.slider_crank.tolerance import GRADES, Grade, Links, grade, right, tolerance
from screwsim.scene import Scene, with_values
from screwsim.scene.grid import too_many
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import Simulate, simulator
from screwsim.study.pool.workers import WORKER_DIED

FIGURES = ("gas_mass_flow", "cooling_capacity", "volumetric_efficiency", "shaft_power", "isentropic_efficiency")
LEAST_SIZE = 1e-3  # [m], smallest size of ISO 286 tolerances: a smaller offset has that of this size
CRANK_ANGLES = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)


class FigureScatter(NamedTuple):
    """One figure [SI] over the machines drawn, and the share of its variance due to each length (r²)."""

    figure: str
    nominal: float
    mean: float
    deviation: float
    low: float
    high: float
    shares: dict[str, float]


@dataclass(frozen=True)
class ToleranceStudy:
    """The links, their kinematic table by grades, and the machines drawn: shift of the dead centre [m], figures [SI].

    `widths` are those of the tolerances [m]; `hits` counts machines whose piston would hit the head, `failed` those
    without a solution.
    """

    grades: dict[str, int]
    widths: dict[str, float]
    links: Links
    table: tuple[Grade, ...]
    seed: int
    count: int
    hits: int
    failed: int
    message: str
    shifts: np.ndarray
    values: dict[str, np.ndarray]
    spreads: tuple[FigureScatter, ...]

    @property
    def chance_share(self) -> float:
        """The r² that a length without influence exceeds in one study of twenty, by Student's t."""
        freedom = len(self.shifts) - 2
        return float((t := stdtrit(freedom, 0.975)) ** 2 / (freedom + t**2)) if freedom > 0 else 1.0


class _MachineFigures(NamedTuple):
    message: str
    values: tuple[float, ...] = ()
    hits: bool = False  # the piston hits the head


def widths_of(machine: SliderCrank, grades: dict[str, int]) -> dict[str, float]:
    """Return the widths of the tolerances [m] of the lengths that have a grade. Raises UsageError."""
    return {name: tolerance(max(abs(getattr(machine, name)), LEAST_SIZE), number) for name, number in grades.items()}


def drawn_lengths(machine: SliderCrank, widths: dict[str, float], count: int, seed: int) -> dict[str, np.ndarray]:
    """Return lengths [m], uniform over their tolerances, which are symmetric about the nominal ones (S31)."""
    random = np.random.default_rng(seed)
    return {name: getattr(machine, name) + width * (random.random(count) - 0.5) for name, width in widths.items()}


def with_lengths(scene: Scene, lengths: dict[str, float]) -> tuple[Scene, float]:
    """Return the scene with other lengths, and the shift of its top dead centre towards the head [m] (S31).

    The head stays in place: the shift reduces the clearance, which is negative where the piston would hit the head.
    """
    machine = scene.machine
    assert isinstance(machine, SliderCrank)
    other = with_values(scene, {f"machine.{name}": value for name, value in lengths.items()})
    assert isinstance(other.machine, SliderCrank)
    shift = _top_position(other.machine) - _top_position(machine)
    clearance = other.machine.piston_area * (machine.clearance / machine.piston_area - shift)
    return with_values(other, {"machine.clearance": clearance}), shift


def _top_position(machine: SliderCrank) -> float:
    """Return the position of the piston at the top dead centre [m] (S4)."""
    return math.sqrt((machine.rod_length + machine.crank_radius) ** 2 - machine.offset**2)


def tolerances(
    scene: Scene,
    grades: dict[str, int],
    *,
    count: int,
    seed: int = 1,
    jobs: int | None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> ToleranceStudy:
    """Return the study of a scene's mechanism; `grades` are those of the lengths that vary. Raises UsageError."""
    machine = scene.machine
    if not isinstance(machine, SliderCrank):
        raise UsageError(f"machine.kind is {machine.kind}: there is no crank (name a scene of a slider_crank)")
    if count < 2:
        raise UsageError(f"--count {count}: is too small for a spread (write e.g. 64)")
    if too_many(count):
        raise UsageError(f"--count {count}: {too_many(count)}")
    widths = widths_of(machine, grades)
    simulate = simulate or simulator()
    nominal = simulate(scene)  # before the fork: workers inherit the compiled code
    if nominal.status != "ok":
        raise UsageError(f"the nominal machine: {nominal.told}")
    figures = tuple(name for name in FIGURES if nominal.performance.get(name) is not None)
    lengths = drawn_lengths(machine, widths, count, seed)
    answers = parallel_map(
        partial(_figures_of_machine, scene, lengths, figures, simulate),
        count,
        died=lambda number: _MachineFigures(WORKER_DIED),
        jobs=jobs,
        failed=lambda answer: bool(answer.message),
        progress=progress,
    )
    good = [i for i, answer in enumerate(answers) if not (answer.message or answer.hits)]
    bad = [answer.message for answer in answers if answer.message]
    values = {name: np.array([answers[i].values[k] for i in good]) for k, name in enumerate(figures)}
    of_good = {name: drawn[good] for name, drawn in lengths.items()}
    known = [(name, float(nominal.performance[name])) for name in figures if good]
    links = Links(machine.crank_radius, machine.rod_length, machine.offset)
    return ToleranceStudy(
        grades,
        widths,
        links,
        table=tuple(grade(right, CRANK_ANGLES, links, number, number) for number in GRADES),
        seed=seed,
        count=count,
        hits=sum(answer.hits for answer in answers),
        failed=len(bad),
        message=bad[0] if bad else "",
        shifts=np.array([with_lengths(scene, _lengths_of(lengths, i))[1] for i in range(count)])[good],
        values=values,
        spreads=tuple(_figure_scatter(name, value, values[name], of_good) for name, value in known),
    )


def _lengths_of(lengths: dict[str, np.ndarray], number: int) -> dict[str, float]:
    return {name: float(values[number]) for name, values in lengths.items()}


def _figures_of_machine(
    scene: Scene, lengths: dict[str, np.ndarray], figures: tuple[str, ...], simulate: Simulate, number: int
) -> _MachineFigures:
    """Return the figures of one machine."""
    other, _ = with_lengths(scene, _lengths_of(lengths, number))
    assert isinstance(other.machine, SliderCrank)
    if other.machine.clearance <= 0.0:
        return _MachineFigures("", hits=True)
    result = simulate(other)
    if result.status != "ok" or result.lacks(figures):
        return _MachineFigures(result.told if result.status != "ok" else result.lacks(figures)[0])
    return _MachineFigures("", tuple(float(result.performance[name]) for name in figures))


def _figure_scatter(figure: str, nominal: float, values: np.ndarray, lengths: dict[str, np.ndarray]) -> FigureScatter:
    shares = {}
    for name, length in lengths.items():
        varies = len(values) > 1 and values.std() > 0.0 and length.std() > 0.0
        shares[name] = float(np.corrcoef(length, values)[0, 1] ** 2) if varies else 0.0
    ends = float(values.min()), float(values.max())
    return FigureScatter(figure, nominal, float(values.mean()), float(values.std()), *ends, shares)
