"""A random scene of which laws are asked, its result, and the pairs of results that a law ties together."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import CoolProp.CoolProp as coolprop
import numpy as np
import yaml
from true_error import warns

from screwsim.figures import Performance
from screwsim.outputs import Result
from screwsim.scene import Scene, loads, scene_text, value_at
from screwsim.scene.load import changed_scene
from screwsim.simulate import simulate


class NotAsked(Exception):
    """The scene says nothing about the law."""


class Lost(NotAsked):
    """A scene that is ok has a twin that is not."""


class Pair(NamedTuple):
    """Two results of which the second should equal the first, or how far a law is broken that is none of equality."""

    what: str
    expected: Result
    found: Result
    only: Collection[str] = ()  # figures of which the law speaks; empty: all that both have
    without: Collection[str] = ()  # figures of which it does not
    slack: float = 0.0  # relative difference that the law allows beside the errors
    broken: float | None = None  # over what may be


@dataclass
class Case:
    """A random scene, and the random numbers for its pairs."""

    scene: Scene
    random: np.random.Generator

    @cached_property
    def _result(self) -> Result:
        return simulate(self.scene, trace="ledger")

    @property
    def result(self) -> Result:
        """The result of the scene; raises NotAsked for one that does not claim its accuracy."""
        return believed(self._result, self.scene)

    def believe(self) -> None:
        """Raise NotAsked where the result does not claim its accuracy."""
        believed(self._result, self.scene)

    def changed(self, values: Mapping[str, Any], without: Iterable[str] = ()) -> Scene:
        """Return the scene with other values, read as in a file; raise SceneError where that makes no sense."""
        return changed_scene(self.scene, values, without)

    def value(self, path: str) -> Any:
        """Return the value [SI] at a path; None where there is none."""
        try:
            return value_at(self.scene, path)
        except (KeyError, AttributeError):
            return None


def believed(found: Result, scene: Scene) -> Result:
    """Return a result that claims its accuracy; raise NotAsked for any other."""
    if found.status != "ok" or warns(found, scene.numerics.accuracy):
        raise NotAsked(found.status)
    return found


def twin(scene: Scene) -> Result:
    """Return the result of a scene tied to one that is ok; raise Lost where it is not, NotAsked where it warns."""
    return believed_twin(simulate(scene, trace=False), scene)


def believed_twin(found: Result, scene: Scene) -> Result:
    """Return a result tied to one that is ok; raise Lost or NotAsked as `twin` does."""
    if found.status != "ok":
        raise Lost(f"{found.status}: {found.message}")
    return believed(found, scene)


def exponent(scene: Scene, found: Result) -> float:
    """Return k of the ideal gas of a scene and its result: as stated, or cp/(cp - R) at the suction temperature."""
    if scene.gas.isentropic_exponent is not None:
        return float(scene.gas.isentropic_exponent)
    fluid = scene.gas.fluid
    heat = coolprop.PropsSI("CP0MOLAR", "T", found.performance.suction_temperature, "P", 1e3, fluid)
    return float(heat / (heat - coolprop.PropsSI("GAS_CONSTANT", fluid)))


def tree_of(scene: Scene) -> dict[str, Any]:
    """Return a scene as the tree of its text."""
    found: dict[str, Any] = yaml.safe_load(scene_text(scene))
    return found


def read(tree: Mapping[str, Any], scene: Scene) -> Scene:
    """Return the scene of a tree, whose files are those of another scene."""
    return loads(yaml.safe_dump(dict(tree), sort_keys=False), folder=scene.folder)


def scaled(found: Result, factors: Mapping[str, float]) -> Result:
    """Return a result whose figures are multiplied by factors, all others left as they are."""
    about = found.performance.about
    values = {name: x if x is None else x * factors.get(name, 1.0) for name, x in found.performance.items()}
    return replace(found, performance=Performance(values, about))


Law = Callable[[Case], Iterator[Pair]]
LAWS: dict[str, Law] = {}


def law(asked: Law) -> Law:
    """Add a law under its name."""
    LAWS[asked.__name__] = asked
    return asked
