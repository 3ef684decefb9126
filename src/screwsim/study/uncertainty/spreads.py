"""Uncertainty of a scene's figures due to the tolerances of its inputs, and the inputs that contribute most.

Linear: standard uncertainties times exact derivatives, added within a group of correlated inputs, as the root of the
sum of squares between groups (GUM, law of propagation). The numerical error and the model error, which the validation
that the scene names states (study.validation.discrepancy), are separate, and added to neither.

Source: JCGM 100:2008, Evaluation of measurement data (GUM), section 5; ASME V&V 20-2009.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.display import About, Brief
from screwsim.scene import Scene
from screwsim.scene.types import COVERAGE, Tolerance
from screwsim.study.asked.inputs import shown_figure
from screwsim.study.asked.varied import Varied
from screwsim.study.pool.progress import Progress
from screwsim.study.uncertainty.slopes import Sensitivities, numeric_paths, scene_sensitivities


class Tolerances(NamedTuple):
    """Tolerances of inputs by their paths, and the inputs that err together; a scene has both as well."""

    uncertain: Mapping[str, Tolerance]
    correlated: tuple[tuple[str, ...], ...]


def tolerances_of(of: Varied) -> Tolerances:
    """Return the tolerances of a scene's inputs, or of those of two stages, their stage before the path."""
    if isinstance(of, Scene):
        return Tolerances(of.uncertain, of.correlated)
    from screwsim.study.stages.tolerances import stage_tolerances

    return Tolerances(*stage_tolerances(of))


class Contributor(NamedTuple):
    """One input or several correlated ones: their share of the variance, and the change [SI] of the figure.

    `change` is that for the whole tolerance, half of a 95 % interval.
    """

    paths: tuple[str, ...]
    share: float
    change: float


NO_TOLERANCE = "no input has a tolerance (write one after its value, e.g. gap: 27 um ± 5 um)"


@dataclass(frozen=True)
class FigureUncertainty:
    """Uncertainty of one figure [SI]: its standard uncertainty, and the contributing inputs, the largest first."""

    standard: float
    contributors: tuple[Contributor, ...]

    @property
    def expanded(self) -> float:
        """Half of the 95 % interval [SI]."""
        return COVERAGE * self.standard

    def as_json(self, most: int | None = None) -> dict[str, Any]:
        """Return it as documents have it, with all or the `most` largest contributors."""
        contributors = [one._asdict() | {"paths": list(one.paths)} for one in self.contributors[:most]]
        return {"standard": self.standard, "expanded": self.expanded, "contributors": contributors}


class FigureSample(NamedTuple):
    """A sample of one figure: mean, standard deviation; what is wrong with the linear estimate, '' for nothing."""

    mean: float
    standard: float
    wrong: str


@dataclass(frozen=True, repr=False)
class Uncertainty(Brief):
    """Uncertainties of a scene's figures. `left_out` are inputs without a derivative, and why."""

    spreads: Mapping[str, FigureUncertainty]
    slopes: Sensitivities
    groups: tuple[tuple[str, ...], ...] = ()  # correlated inputs, one or more per group
    left_out: Mapping[str, str] = field(default_factory=dict)
    sampled: Mapping[str, FigureSample] = field(default_factory=dict)
    samples: int = 0
    message: str = ""  # why there is no sample, or only a part of it

    def _about(self) -> About:
        rows, here = [], self.slopes.result.performance
        for name, spread in self.spreads.items():
            value = here.get(name)
            told = "–" if not value else f"{100.0 * spread.expanded / abs(value):.2g} %"
            most = ", ".join(spread.contributors[0].paths) if spread.contributors else ""
            rows.append((name, "none" if value is None else shown_figure(name, value), told, most))
        heading = f"Uncertainty of {len(rows)} figures by {len(self.groups)} inputs"
        notes = [self.message] if self.message else []
        return About(heading, notes, ("figure", "value", "± (95 %)", "most by"), rows)

    def as_json(self, most: int | None = None) -> dict[str, Any]:
        """Return what `run --json` prints under `uncertainty`, with all or the `most` largest contributors."""
        figures = {name: spread.as_json(most) for name, spread in self.spreads.items()}
        return {
            "coverage_factor": COVERAGE,
            "groups": [list(group) for group in self.groups],
            "figures": figures,
            "method": dict(self.slopes.method),
            "left_out": dict(self.left_out),
        }


def scene_uncertainty(
    scene: Scene,
    *,
    result: Result | None = None,
    jobs: int | None = 1,
    progress: Progress | bool | None = None,
) -> Uncertainty:
    """Return the uncertainty of the figures of one machine; the arguments are those of `point.uncertainty`."""
    if not scene.uncertain:
        raise UsageError(NO_TOLERANCE)
    numbers, why = numeric_paths(scene)
    paths = [path for path in scene.uncertain if path in numbers]
    if not paths:
        names = ", ".join(scene.uncertain)
        raise UsageError(f"all inputs with a tolerance follow from others here: {names} (write tolerances of those)")
    found = scene_sensitivities(scene, paths, jobs=jobs, progress=progress, result=result, fine=False)
    spreads = spreads_of(scene, found.values, found.derivatives)
    why = {**why, **found.left_out}
    left_out = {path: why.get(path, "it is not stated") for path in scene.uncertain if path not in found.values}
    return Uncertainty(spreads, found, groups_of(scene), left_out if found.derivatives else {})


def spreads_of(
    scene: Scene | Tolerances, values: Mapping[str, float], derivatives: Mapping[str, Mapping[str, float]]
) -> dict[str, FigureUncertainty]:
    """Return the uncertainties of figures from their derivatives [SI] by the uncertain inputs at `values` [SI].

    A figure that lacks the derivative by one of these has none.
    """
    there, groups = scene.uncertain.keys() & values.keys(), groups_of(scene)
    complete = {name: slopes for name, slopes in derivatives.items() if there and there <= slopes.keys()}
    return {name: _figure_uncertainty(scene, values, slopes, groups) for name, slopes in complete.items()}


def groups_of(scene: Scene | Tolerances) -> tuple[tuple[str, ...], ...]:
    """Return the groups of inputs with a tolerance, correlated ones together, in the order of the scene."""
    group_of = {path: group for group in scene.correlated for path in group}
    return tuple(dict.fromkeys(group_of.get(path, (path,)) for path in scene.uncertain))


def _figure_uncertainty(
    scene: Scene | Tolerances,
    values: Mapping[str, float],
    slopes: Mapping[str, float],
    groups: Sequence[tuple[str, ...]],
) -> FigureUncertainty:
    """Return the uncertainty of a figure with these derivatives by path."""
    changes = {}
    for group in groups:
        there = tuple(path for path in group if path in values)
        if there:
            changes[there] = sum(slopes[path] * scene.uncertain[path].standard_at(values[path]) for path in there)
    variance = sum(change * change for change in changes.values())
    ranked = sorted(changes.items(), key=lambda item: -abs(item[1]))
    shares = (Contributor(paths, by * by / variance if variance else 0.0, COVERAGE * by) for paths, by in ranked if by)
    return FigureUncertainty(float(variance**0.5), tuple(shares))
