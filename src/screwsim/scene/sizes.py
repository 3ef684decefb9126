"""What must fit into the machine: sizes of a scene compared with those of its rotors or its cylinder.

An impossible size is a fault, an unusual one a warning (`scene.plausible`). Bounds are relative to a dimension of the
machine. Those of impossible sizes leave room for deliberately extreme scenes: ports ten times as wide as the housing
make the pressure follow that of the line, and are allowed.
"""

import math
import os
from collections.abc import Iterator
from itertools import groupby
from typing import Any

from screwsim.effects.base import Effect
from screwsim.inputs.declare import AREA, KINDS
from screwsim.inputs.faults import Fault, UsageError
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import MachineKind, Size, Speed
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.outputs.customary import RPM
from screwsim.scene.fields import value_at
from screwsim.scene.operation import SPEED
from screwsim.scene.types import Scene
from screwsim.scene.units import readable_quantity

_EFFECTS = "effects"
IN_TABLE = "areas are in m^2; is the unit right?"


def _size_ratios(scene: Scene, sizes: tuple[Size, ...]) -> Iterator[tuple[Size, float]]:
    """Yield each of these sizes that the scene states, and its ratio to the machine's reference dimension."""
    for size in sizes:
        value = _size_at(scene, size.path)
        if value is not None:
            yield size, value / size.of(scene.machine)


def _size_at(scene: Scene, path: str) -> float | None:
    """Return a size of the scene [SI], of a table its largest area [m²]; None without it."""
    value = value_at(scene, path)
    if not isinstance(value, str):
        return value
    from screwsim.numerics.spline import read_curve  # here: scenes without tables start faster

    try:
        return float(max(read_curve(value, AREA)[1]))
    except UsageError:  # reported where files are checked
        return None


def _surface_speed(scene: Scene) -> tuple[float, Speed]:
    """Return the surface speed [m/s] of the moving parts, and its bounds."""
    known = kind_of(scene.machine).speed or Speed("moves the machine at", math.inf, math.inf, "")
    return scene.machine.surface_speed(scene.operation.speed), known


def _in_words(scene: Scene, fast: float, known: Speed) -> str:
    """Return in words which part moves at which speed [m/s]."""
    return f"{scene.operation.speed / RPM:.6g} rpm {known.what} {fast:.4g} m/s"


def size_faults(scene: Scene) -> Iterator[Fault]:
    """Yield faults of sizes that do not fit into the machine, and of a speed that no machine withstands."""
    for faults, _ in _section_findings(scene):
        yield from faults
    fast, known = _surface_speed(scene)
    if fast > known.most:
        what = (
            f"{_in_words(scene, fast, known)}, and no machine withstands {known.most:g} m/s (choose a lower speed; "
            f"{known.why})"
        )
        yield Fault(SPEED, what)


def area_fault(scene: Scene, largest: float) -> str | None:
    """Return what is wrong with the largest area [m²] of a table of the machine; None where it is possible."""
    size = kind_of(scene.machine).tables
    if size is None or largest <= size.most * size.of(scene.machine):
        return None
    what = f"its largest area of {largest:.4g} m² is {_times(largest / size.of(scene.machine), size.what)}"
    return f"{what}, which is impossible ({IN_TABLE})"


def size_warnings(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield (path, what) of unusual sizes, and of an unusual speed."""
    for _, doubts in _section_findings(scene):
        yield from doubts
    fast, known = _surface_speed(scene)
    with_oil = None if scene.oil_supply is None else known.with_oil
    usual, when = (known.usual, "usual") if with_oil is None else (with_oil, "usual with oil")
    if fast > usual:
        yield SPEED, f"{_in_words(scene, fast, known)} ({when}: at most {usual:g} m/s)"


_FaultsAndWarnings = tuple[tuple[Fault, ...], tuple[tuple[str, str], ...]]
# by number of a section: machine and section checked last, and result
_last_checked: dict[int, tuple[Any, Any, _FaultsAndWarnings]] = {}


def _section_findings(scene: Scene) -> Iterator[_FaultsAndWarnings]:
    """Yield faults and warnings about the sizes of each section; cases with the same machine and section share them."""
    machine = scene.machine
    kind = kind_of(machine)
    for number, (head, sizes) in enumerate((*_by_section(kind.sizes), (_EFFECTS, ()))):
        part = getattr(scene, head)
        last = _last_checked.get(number)  # read once: threads share it
        if last is None or last[0] is not machine or last[1] is not part:
            asked = sizes or tuple(_effect_sizes(scene, kind))
            told = tuple(_beyond(scene, asked)), tuple(_unusual(scene, asked))
            last = _last_checked[number] = machine, part, told
        yield last[2]


def sizes_of_effect(kind: MachineKind, name: str, effect: Effect) -> Iterator[Size]:
    """Yield the sizes of an effect for which a kind of machine has a scale."""
    for key, scale, most, usual in effect.sizes:
        if scale in kind.scales:
            yield Size(f"{_EFFECTS}.{name}.{key}", *kind.scales[scale], most, usual)


def sizes_of(scene: Scene) -> Iterator[Size]:
    """Yield all bounded sizes of a scene: those of the machine, then those of its effects."""
    kind = kind_of(scene.machine)
    yield from (*kind.sizes, *_effect_sizes(scene, kind))


def _effect_sizes(scene: Scene, kind: MachineKind) -> Iterator[Size]:
    for name, active in scene.effects.items():
        yield from sizes_of_effect(kind, name, active.effect)


@IdentityCache
def _by_section(sizes: tuple[Size, ...]) -> tuple[tuple[str, tuple[Size, ...]], ...]:
    """Return sizes in their order, grouped by the section of a scene that states them."""
    return tuple((head, tuple(each)) for head, each in groupby(sizes, lambda size: size.path.partition(".")[0]))


def _beyond(scene: Scene, sizes: tuple[Size, ...]) -> Iterator[Fault]:
    for size, share in _size_ratios(scene, sizes):
        if share > size.most:
            what = f"{_shown(scene, size.path)} is {_times(share, size.what)}, which is impossible"
            tabled = isinstance(value_at(scene, size.path), str)
            yield Fault(size.path, f"{what} ({IN_TABLE if tabled else size.remedy})")


def _unusual(scene: Scene, sizes: tuple[Size, ...]) -> Iterator[tuple[str, str]]:
    for size, share in _size_ratios(scene, sizes):
        low, high = size.usual
        if not low <= share <= high:
            bound = f"at most {high:g}" if share > high else f"at least {low:g}"
            yield size.path, f"{_shown(scene, size.path)} is {_times(share, size.what)} (usual: {bound})"


def _times(share: float, what: str) -> str:
    """Return a ratio in words: 0.5 of the bore, 3 times the bore."""
    if share > 1.0 and what.startswith("of "):
        return f"{share:.3g} times {what.removeprefix('of ')}"
    return f"{share:.3g} {what}"


def _shown(scene: Scene, path: str) -> str:
    name = value_at(scene, path)
    if isinstance(name, str):
        area = readable_quantity(KINDS["area"], _size_at(scene, path) or 0.0)
        return f"{os.path.relpath(name, scene.folder)!r}: its largest area, {area},"
    kind = "volume" if path.endswith((".max", ".min", ".clearance")) else "area" if path.endswith("area") else "length"
    return readable_quantity(KINDS[kind], value_at(scene, path) or 0.0)
