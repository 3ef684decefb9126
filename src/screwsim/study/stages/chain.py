"""Two scenes in series and what lies between them: what a study varies and solves as it does a scene."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

from screwsim.outputs import STAGES, Figure, Result
from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.fields import Leaf
from screwsim.scene.types import Joint, Tolerance
from screwsim.scene.units import gauge_pressures_over, refused_at
from screwsim.scene.values import convert
from screwsim.study.asked.inputs import ISENTROPIC
from screwsim.study.stages.axes import BETWEEN, STAGE_NAMES, Intercooler, leaf_in_chain
from screwsim.study.stages.needs import absences, lacked

USUAL_FIGURES = ("electrical_cop", "cop", "package_isentropic_efficiency", ISENTROPIC)  # the first that there is


@dataclass(frozen=True)
class StageChain:
    """Two scenes in series. The first one's discharge and the second one's suction line are solved for, not read.

    `uncertain` are tolerances of the intercooler's values, by path, `correlated` groups of inputs of both stages that
    err together, besides those of each scene. `sweep` has the values [SI] of each path that varies
    (`first.operation.speed`), `joints` those that vary together.
    """

    title: str
    first: Scene
    second: Scene
    intercooler: Intercooler
    sweep: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)
    joints: tuple[Joint, ...] = ()
    uncertain: Mapping[str, Tolerance] = field(default_factory=dict)
    correlated: tuple[tuple[str, ...], ...] = ()

    @property
    def by_stage(self) -> dict[str, Scene]:
        """The scene of each stage, by its name, the first one first."""
        return dict(zip(STAGE_NAMES, (self.first, self.second), strict=True))

    @property
    def ambient_pressure(self) -> float | None:
        """Ambient pressure [Pa] over which gauge pressures are read; None where the stages have two of them."""
        of_stages = {scene.operation.ambient_pressure for scene in self.by_stage.values()}
        return of_stages.pop() if len(of_stages) == 1 else None

    @property
    def accuracy(self) -> float:
        """Accuracy that is asked of the figures: that of the less accurate stage."""
        return max(scene.numerics.accuracy for scene in self.by_stage.values())

    @property
    def beside(self) -> tuple[str, ...]:
        """The figures that are told beside the one that a study seeks."""
        return ("intermediate_pressure",)

    @property
    def usual_figure(self) -> str:
        """The figure that is made greatest where none is named: COP, or efficiency, of what is paid for."""
        return next(name for name in USUAL_FIGURES if name in self.figures)

    @property
    def figures(self) -> dict[str, Figure]:
        """The figures of both together that they may call for: capacities, powers and those of a package where due."""
        absent = absences(self.first, self.second)
        return {name: figure for name, figure in STAGES.items() if not lacked(name, absent)}

    def lacks(self, name: str) -> tuple[str, ...]:
        """Return in words what the scenes lack for a figure of both together; empty where they have what it needs."""
        return lacked(name, absences(self.first, self.second))

    def leaf_of(self, path: str) -> Leaf:
        """Return the description of an input; raise UsageError where it cannot vary."""
        with refused_at(path):
            return leaf_in_chain(self, path)

    def read_value(self, path: str, raw: Any) -> Any:
        """Return a value as written in YAML in SI, checked like the field; raise UsageError."""
        leaf, scene = self.leaf_of(path), self.second if path.startswith(STAGE_NAMES[1]) else self.first
        with refused_at(path), gauge_pressures_over(self.ambient_pressure):
            return convert(leaf, raw, scene.folder)

    def with_values(self, values: Mapping[str, Any]) -> Self:
        """Return a chain without a sweep, with other values [SI] at its paths; solving tells what does not fit."""
        own: dict[str, dict[str, Any]] = {part: {} for part in (*STAGE_NAMES, BETWEEN)}
        for name, value in values.items():
            part, _, path = name.partition(".")
            own[part][path] = value
        scenes = ((scene, own[stage]) for stage, scene in self.by_stage.items())
        first, second = (with_values(scene, values) if values else scene for scene, values in scenes)
        between = replace(self.intercooler, **own[BETWEEN])
        return replace(self, first=first, second=second, intercooler=between, sweep={}, joints=())

    def with_accuracy(self, accuracy: float) -> Self | None:
        """Return a chain with this accuracy in both stages, in one its own where that is finer.

        None where one states its tolerance of a step.
        """
        scenes = self.by_stage.values()
        if any(scene.numerics.rtol is not None for scene in scenes):
            return None
        finer = (replace(each.numerics, accuracy=min(each.numerics.accuracy, accuracy)) for each in scenes)
        first, second = (replace(each, numerics=own) for each, own in zip(scenes, finer, strict=True))
        return replace(self, first=first, second=second)

    def value_at(self, path: str) -> Any:
        """Return the value [SI] of an input, None where it is absent."""
        stage, _, own = path.partition(".")
        scenes = self.by_stage
        return value_at(scenes[stage], own) if stage in scenes else getattr(self.intercooler, own, None)

    def faults(self) -> tuple[str, ...]:
        """Return what does not fit together in either stage, its stage before the path."""
        from screwsim.study.stages.solve import chain_faults

        return chain_faults(self)

    def solved(self) -> Result:
        """Return the figures of both stages together."""
        from screwsim.study.stages.solve import run_stages

        return run_stages(self).as_result()
