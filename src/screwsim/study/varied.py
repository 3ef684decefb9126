"""What a study varies: a scene, or two of them in series; the functions here take either."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol, TypeVar

from screwsim import scene as scenes
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.fields import Leaf
from screwsim.scene.types import Joint

Kind = TypeVar("Kind", bound="Varied")


class Series(Protocol):
    """Two scenes in series (`study.stages`): their inputs have their stage before the path."""

    @property
    def title(self) -> str: ...

    @property
    def sweep(self) -> Mapping[str, tuple[Any, ...]]: ...

    @property
    def joints(self) -> tuple[Joint, ...]: ...

    @property
    def accuracy(self) -> float:
        """Accuracy asked of the figures: that of the less accurate stage."""
        ...

    @property
    def usual_figure(self) -> str:
        """The figure that is made greatest where none is named."""
        ...

    @property
    def beside(self) -> tuple[str, ...]:
        """Figures that are told beside the one that is sought."""
        ...

    def leaf_of(self, path: str) -> Leaf:
        """Return the description of an input; raise UsageError where it cannot vary."""
        ...

    def read_value(self, path: str, raw: Any) -> Any:
        """Return a value as written in YAML in SI; raise UsageError."""
        ...

    def with_values(self: Kind, values: Mapping[str, Any]) -> Kind:
        """Return the same without a sweep, with other values [SI]."""
        ...

    def with_accuracy(self: Kind, accuracy: float) -> Kind | None:
        """Return the same with another accuracy in both stages; None where one states its tolerance of a step."""
        ...

    def value_at(self, path: str) -> Any:
        """Return the value [SI] of an input, None where it is absent."""
        ...

    def faults(self) -> Sequence[str]:
        """Return what does not fit together in either, its stage before the path."""
        ...

    def solved(self) -> Result:
        """Return the figures of both together."""
        ...


Varied = Scene | Series


def leaf_of(of: Varied, path: str) -> Leaf:
    """Return the description of an input that may vary; raise UsageError."""
    return scenes.leaf_of(of, path) if isinstance(of, Scene) else of.leaf_of(path)


def read_value(of: Varied, path: str, raw: Any) -> Any:
    """Return a value as written in YAML in SI, checked like the field; raise UsageError."""
    return scenes.read_value(of, path, raw) if isinstance(of, Scene) else of.read_value(path, raw)


def with_values(of: Kind, values: Mapping[str, Any]) -> Kind:
    """Return the same with other values [SI] at dotted paths."""
    return scenes.with_values(of, values) if isinstance(of, Scene) else of.with_values(values)


def value_at(of: Varied, path: str) -> Any:
    """Return the value [SI] at a dotted path, None where an optional section or value is absent."""
    return scenes.value_at(of, path) if isinstance(of, Scene) else of.value_at(path)


def case(of: Kind, number: int) -> Kind:
    """Return one case of a sweep, without a sweep."""
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


def solved(of: Series) -> Result:
    """Return the figures of two in series."""
    return of.solved()
