"""Uncertainty of a scene's figures due to the tolerances of its inputs, and the inputs that contribute most.

Linear: standard uncertainties times exact derivatives, added within a group of correlated inputs, as the root of the
sum of squares between groups (GUM, law of propagation). The numerical error and the model error, which the validation
that the scene names states (study.validation.discrepancy), are separate, and added to neither.

Source: JCGM 100:2008, Evaluation of measurement data (GUM), section 5; ASME V&V 20-2009.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from screwsim.figures import declaration
from screwsim.figures.engineering import figure_text
from screwsim.outputs.display import About, Brief, library
from screwsim.scene import Scene
from screwsim.scene.types import COVERAGE, Tolerance
from screwsim.study.asked.varied import Varied
from screwsim.study.uncertainty.slopes import Sensitivities


class Tolerances(NamedTuple):
    """Tolerances of inputs by their paths, and the inputs that err together; a scene has both as well."""

    uncertain: Mapping[str, Tolerance]
    correlated: tuple[tuple[str, ...], ...]


def tolerances_of(of: Varied, without: Sequence[str] = ()) -> Tolerances:
    """Return the tolerances of the inputs of a scene, or of two stages, `without` those of some paths."""
    if isinstance(of, Scene):
        uncertain, correlated = of.uncertain, of.correlated
    else:
        from screwsim.study.stages.tolerances import stage_tolerances

        uncertain, correlated = stage_tolerances(of)
    groups = (tuple(path for path in group if path not in without) for group in correlated)
    kept = {path: tolerance for path, tolerance in uncertain.items() if path not in without}
    return Tolerances(kept, tuple(group for group in groups if len(group) > 1))


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
            rows.append((name, "none" if value is None else figure_text(name, value), told, most))
        heading = f"Uncertainty of {len(rows)} figures by {len(self.groups)} inputs"
        notes = [self.message] if self.message else []
        return About(heading, notes, ("figure", "value", "± (95 %)", "most by"), rows)

    def to_pandas(self) -> Any:
        """Return a pandas.DataFrame [SI] over the figures: value, standard uncertainty, half of the 95 % interval."""
        here = self.slopes.result.performance
        about = {name: declaration(name, here) for name in self.spreads}
        rows = [
            (name, here.get(name), "" if (one := about[name]) is None else one.units, each.standard, each.expanded)
            for name, each in self.spreads.items()
        ]
        frame = library("pandas").DataFrame(rows, columns=["figure", "value", "units", "standard", "expanded"])
        return frame.set_index("figure")

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


def not_included(left_out: Mapping[str, str]) -> Iterator[str]:
    """Yield that the tolerance of each input without a derivative has no part in the uncertainties, and why."""
    for path, why in left_out.items():
        yield f"the tolerance of {path} is not included in the uncertainties: {why}"


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
