"""What a study varies: a scene, or two of them in series; the functions here take either."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, Union

from screwsim import scene as scenes
from screwsim.scene import Scene
from screwsim.scene.fields import Leaf

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain

Kind = TypeVar("Kind", bound="Varied")
Varied: TypeAlias = Union[Scene, "StageChain"]


def leaf_of(of: Varied, path: str) -> Leaf:
    """Return the description of an input that may vary; raise UsageError."""
    return scenes.leaf_of(of, path) if isinstance(of, Scene) else of.leaf_of(path)


def read_value(of: Varied, path: str, raw: Any) -> Any:
    """Return a value as written in YAML in SI, checked like the field; raise UsageError."""
    return scenes.read_value(of, path, raw) if isinstance(of, Scene) else of.read_value(path, raw)


def with_values(of: Kind, values: Mapping[str, Any]) -> Kind:
    """Return the same with other values [SI] at dotted paths."""
    # pyrefly: ignore[bad-return] - of the kind that was given
    return scenes.with_values(of, values) if isinstance(of, Scene) else of.with_values(values)


def value_at(of: Varied, path: str) -> Any:
    """Return the value [SI] at a dotted path, None where an optional section or value is absent."""
    return scenes.value_at(of, path) if isinstance(of, Scene) else of.value_at(path)


def with_text(of: Kind) -> Kind:
    """Return a scene with the text that it is written as; two stages have none."""
    return replace(of, text=scenes.scene_text(of)) if isinstance(of, Scene) else of


def case(of: Kind, number: int) -> Kind:
    """Return one case of a sweep, without a sweep."""
    # pyrefly: ignore[bad-return]
    return scenes.case(of, number) if isinstance(of, Scene) else of.with_values(scenes.case_values(of, number))


def faults_of(of: Varied) -> Sequence[Any]:
    """Return what does not fit together; of two in series what shows before they are solved."""
    return scenes.cross_check(of) if isinstance(of, Scene) else of.faults()


def accuracy_of(of: Varied) -> float:
    """Return the accuracy that is asked of the figures."""
    return of.numerics.accuracy if isinstance(of, Scene) else of.accuracy


def with_accuracy(of: Kind, accuracy: float) -> Kind | None:
    """Return the same with another accuracy; None where the tolerance of a step is stated instead."""
    if not isinstance(of, Scene):
        return of.with_accuracy(accuracy)
    if of.numerics.rtol is not None:
        return None
    return replace(of, numerics=replace(of.numerics, accuracy=accuracy))
