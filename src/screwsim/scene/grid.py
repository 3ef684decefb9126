"""The grid of a sweep: its dimensions, and its cases, made on demand; the last dimension varies fastest."""

import math
from collections.abc import Container, Iterable, Mapping
from typing import Any, NamedTuple, Protocol, TypeVar

from screwsim.inputs.faults import UsageError
from screwsim.numerics.frozen import with_changes
from screwsim.scene.checks import cross_check
from screwsim.scene.derived_values import with_derived_values
from screwsim.scene.fields import Leaf, effect_keys, sweep_leaf, value_at
from screwsim.scene.types import Joint, Scene
from screwsim.scene.units import gauge_pressures_over, refused_at
from screwsim.scene.values import convert

FLUID = "gas.fluid"
MOST_TRIED = 100  # cases of one fluid tried to find a valid one
MOST_CASES = 10_000_000  # cases of one study; more is taken for a typing error


def too_many(cases: int) -> str:
    """Return why a study cannot have so many cases; '' when it can."""
    if cases <= MOST_CASES:
        return ""
    shown = f"{cases:,}" if cases < 10**15 else f"{cases:.0e}" if cases < 10**300 else "far too many"
    return f"has {shown} cases, more than the {MOST_CASES:,} that one study may have (use fewer values, or split it)"


class Swept(Protocol):
    """What has a sweep: a scene, or two of them in series."""

    @property
    def sweep(self) -> Mapping[str, tuple[Any, ...]]:
        """The values [SI] of each path that varies."""
        ...

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The paths that vary together."""
        ...


HasSweep = TypeVar("HasSweep", bound=Swept)


class Dimension(NamedTuple):
    """One dimension of a grid; `name` is its path, or the name of the joint whose paths vary together."""

    name: str
    paths: tuple[str, ...]
    size: int
    joint: Joint | None = None


def dimensions(scene: Swept) -> tuple[Dimension, ...]:
    """Return the dimensions of the grid in the order of the file."""
    joints = {joint.paths[0]: joint for joint in joints_of(scene)}
    inner = {path for joint in joints.values() for path in joint.paths[1:]}
    found = []
    for path, values in scene.sweep.items():
        joint = joints.get(path)
        if joint is not None:
            found.append(Dimension(joint.name, joint.paths, len(values), joint))
        elif path not in inner:
            found.append(Dimension(path, (path,), len(values)))
    return tuple(found)


def joints_of(scene: Swept) -> tuple[Joint, ...]:
    """Return the joints whose paths the sweep still varies; a joint that has lost a path becomes a zipped one."""
    found = []
    for joint in scene.joints:
        paths = tuple(path for path in joint.paths if path in scene.sweep)
        if paths:
            found.append(joint if paths == joint.paths else with_changes(joint, paths=paths, sample=None))
    return tuple(found)


def with_sweep_over(scene: HasSweep, paths: Iterable[str]) -> HasSweep:
    """Return a scene, or two in series, with the sweep reduced to the given paths."""
    kept = set(paths)
    sweep = {path: values for path, values in scene.sweep.items() if path in kept}
    cut = with_changes(scene, sweep=sweep)
    return with_changes(cut, joints=joints_of(cut))


def without_sweep(scene: HasSweep) -> HasSweep:
    """Return a scene, or two in series, without the sweep."""
    return with_changes(scene, sweep={}, joints=())


def without_axes(scene: HasSweep, paths: Container[str]) -> HasSweep:
    """Return a scene, or two in series, with the axes of its sweep other than the given paths."""
    return with_sweep_over(scene, [path for path in scene.sweep if path not in paths])


def case_count(scene: Swept) -> int:
    """Return the number of cases: the product of the dimensions, 1 without a sweep."""
    return math.prod(dimension.size for dimension in dimensions(scene))


def case_values(scene: Swept, index: int) -> dict[str, Any]:
    """Return {dotted path: value in SI} of one case."""
    if not 0 <= index < case_count(scene):
        raise IndexError(f"case {index} of {case_count(scene)}")
    return dict(zip(scene.sweep, values_of(scene, range(index, index + 1))[0], strict=True))


def values_of(scene: Swept, cases: range) -> list[tuple[Any, ...]]:
    """Return the values in SI of consecutive cases, each a tuple in the order of the sweep's paths."""
    columns: dict[str, list[Any]] = {}
    below = case_count(scene)
    for dimension in dimensions(scene):
        below //= dimension.size
        for path in dimension.paths:
            values = scene.sweep[path]
            columns[path] = [values[index // below % dimension.size] for index in cases]
    return list(zip(*(columns[path] for path in scene.sweep), strict=True)) if columns else [() for _ in cases]


def case(scene: Scene, index: int) -> Scene:
    """Return one case of the grid, as a scene without a sweep and without its text (`scene_text` creates it)."""
    return with_values(with_changes(without_sweep(scene), text=""), case_values(scene, index))


def with_values(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with other values [SI] at dotted paths, neither checked nor written as text.

    The sections that contain them must exist. `cross_check` tells whether the values fit together.
    """
    if FLUID in values:  # an axis states the fluid completely, with the composition of a blend
        scene = with_changes(scene, gas=with_changes(scene.gas, mass_fractions=None, mole_fractions=None))
    for path, value in values.items():
        scene = _with_value(scene, path, value)
    scene = with_derived_values(scene, values)
    return with_changes(scene, text="") if scene.text else scene


def _with_value(scene: Scene, path: str, value: Any) -> Scene:
    if not path.startswith("effects."):
        return _replaced(scene, path.split("."), value)
    name, keys = effect_keys(path, scene.effects)
    active = scene.effects[name]
    other = with_changes(active, parameters=_replaced(active.parameters, keys, value))
    return with_changes(scene, effects={**scene.effects, name: other})


def _replaced(part: Any, names: list[str], value: Any) -> Any:
    name, *rest = names
    return with_changes(part, **{name: _replaced(getattr(part, name), rest, value) if rest else value})


def first_by_fluid(scene: Scene) -> list[tuple[str, Scene]]:
    """Return each fluid of a sweep over fluids with its first case that passes `cross_check`.

    A fluid with no such case among its first `MOST_TRIED` is left out.
    """
    found = []
    for fluid in dict.fromkeys(scene.sweep.get(FLUID, ())):
        together = next((joint.paths for joint in joints_of(scene) if FLUID in joint.paths), (FLUID,))
        kept = [place for place, each in enumerate(scene.sweep[FLUID]) if each == fluid]
        sweep = {
            path: tuple(values[place] for place in kept) if path in together else values
            for path, values in scene.sweep.items()
        }
        own = with_changes(scene, sweep=sweep)
        cases = (case(own, index) for index in range(min(case_count(own), MOST_TRIED)))
        first = next((one for one in cases if not cross_check(one)), None)
        found += [] if first is None else [(fluid, first)]
    return found


def leaf_of(scene: Scene, path: str, before: str = "", fixed: tuple[str, ...] = ()) -> Leaf:
    """Return the description of an input of this scene that may be varied; raise `UsageError` with the nearest path.

    `before` and `fixed` are as in `sweep_leaf`.
    """
    with refused_at(path):
        parameters = {name: type(active.parameters) for name, active in scene.effects.items()}
        leaf = sweep_leaf(path, parameters, scene.machine.kind, before, fixed)
    parent = path.rpartition(".")[0]
    if parent.removeprefix("effects.") not in scene.effects and value_at(scene, parent) is None:
        raise UsageError(f"{path}: the section {before}{parent} is not in this scene (write it first)")
    return leaf


def read_value(scene: Scene, path: str, raw: Any) -> Any:
    """Return a value as written in YAML ('1000 rpm', 3) in SI, checked like the field; raise `UsageError`."""
    with refused_at(path), gauge_pressures_over(scene.operation.ambient_pressure):
        return convert(leaf_of(scene, path), raw, scene.folder)


def unit_of(leaf: Leaf) -> str:
    """Return the SI unit of an input: '1' for numbers, '' for words (choices, fluids)."""
    return leaf.dimension.si if leaf.dimension else "" if leaf.kind in ("choice", "fluid") else "1"
