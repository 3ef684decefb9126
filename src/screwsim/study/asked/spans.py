"""Paths that a study varies between two values: as given, or bounded by the scene and the schema; and what lies beyond.

A best value at the end of its range may be bettered beyond it, unless nothing can be simulated there.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from screwsim.inputs.arguments import ends_of as ordered_ends
from screwsim.inputs.declare import UNBOUNDED
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import kind_of
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.operation import SPEED
from screwsim.scene.sizes import sizes_of
from screwsim.scene.values import text_of
from screwsim.study.asked.inputs import check_continuous, ends_of, read_text, refuse_empty_range
from screwsim.study.asked.varied import Varied, leaf_of, read_value, value_at

LOGARITHMIC_FROM = 4.0  # ratio of the ends from which on a search uses the logarithm
RANGE_FACTOR = 20.0  # without a range: the largest factor above and below the scene's value
STEP_BEYOND = 0.01  # of the range, beyond its end
OIL_FLOWS = "oil_supply.ratio", "oil_supply.flow", "oil_supply.orifice_diameter", "oil_supply.orifice_count"
LOWER, UPPER = "lower border", "upper border"
BORDER_MARKS = {"": "", LOWER: " <", UPPER: " >"}  # behind a value in tables


def value_between(low: float, high: float, place: float, logarithmic: bool) -> float:
    """Return the value [SI] at a place between two values, 0 … 1; by their logarithms if `logarithmic`."""
    return low * (high / low) ** place if logarithmic else low + (high - low) * place


def place_between(low: float, high: float, value: float, logarithmic: bool) -> float:
    """Return the place of a value [SI] between two others, 0 … 1."""
    return math.log(value / low) / math.log(high / low) if logarithmic else (value - low) / (high - low)


@dataclass(frozen=True)
class Span:
    """A path that varies between two values [SI]; `start`: the scene's value, None where it is not between them."""

    path: str
    low: float
    high: float
    start: float | None = None

    @property
    def logarithmic(self) -> bool:
        return self.low > 0.0 and self.high / self.low >= LOGARITHMIC_FROM

    def value(self, place: float) -> float:
        """Return the value [SI] at a place 0 … 1; at an end exactly the end."""
        if place <= 0.0 or place >= 1.0:
            return self.low if place <= 0.0 else self.high
        return value_between(self.low, self.high, place, self.logarithmic)

    def place(self, value: float) -> float:
        """Return the place 0 … 1 of a value [SI]."""
        return place_between(self.low, self.high, min(max(value, self.low), self.high), self.logarithmic)

    def slope(self, place: float) -> float:
        """Return the derivative of the value [SI] by the place."""
        if self.logarithmic:
            return self.value(place) * math.log(self.high / self.low)
        return self.high - self.low

    @property
    def first(self) -> float:
        """Place from which a search starts: that of the scene's value, the middle where it has none."""
        return 0.5 if self.start is None else self.place(self.start)

    def beyond(self, border: str) -> float:
        """Return the value [SI] that lies a hundredth of the range beyond one of its borders."""
        end, step = (self.high, STEP_BEYOND) if border == UPPER else (self.low, -STEP_BEYOND)
        if self.logarithmic:
            return float(end * (self.high / self.low) ** step)
        return float(end + step * (self.high - self.low))


def refusal_beyond(scene: Varied, span: Span, border: str, solved: Callable[[float], Result]) -> str:
    """Return why there is no solution beyond a border of a range; '' where there is one.

    `solved` simulates the value [SI] there; it is called only where the path may have it.
    """
    leaf, value = leaf_of(scene, span.path), span.beyond(border)
    try:
        read_value(scene, span.path, value if leaf.dimension is None else text_of(leaf, value))
    except UsageError as refused:
        return str(refused)
    result = solved(value)
    return "" if result.status == "ok" else result.told


def idle_note(path: str) -> str:
    """Return that a best value is one by chance."""
    return f"{path} has hardly any effect: equally good values were found over all of its range"


def border_note(path: str, border: str, beyond: str, remedy: str = "") -> str:
    """Return what a best value at a border of its range means: nothing lies beyond, or the range is to be widened.

    The least oil is set by lubrication, which is not modelled: no range finds it.
    """
    if beyond:
        return f"at the {border} of the range, beyond which there is no solution: {beyond}"
    oil = border == LOWER and path.endswith(OIL_FLOWS)
    least = ", down to the oil that the maker requires: lubrication is not modelled" if oil else ""
    return f"at the {border} of the range; a better value may lie beyond, so widen it{remedy}{least}"


def read_spans(
    scene: Varied,
    vary: Iterable[str] | Mapping[str, tuple[float, float] | None],
    *,
    ranged: bool,
    sizes: Sequence[float] = (),
) -> tuple[Span, ...]:
    """Return the spans of the texts of --vary, PATH=LOW..HIGH or PATH alone; raise UsageError in one line.

    Without a stated range it is that of `sizes` (a catalogue), of the sweep's axis, or of the schema, which does
    not count with `ranged`. Of a mapping they are those of paths between two values [SI] each, where None stands for
    the range of the schema.
    """
    if isinstance(vary, Mapping):
        return tuple(_span_between(scene, path, ends, ranged) for path, ends in vary.items())
    default = partial(_default_range, scene, ranged, sizes)
    return read_ranges(scene, vary, "--vary", "operation.speed=1000 rpm..4500 rpm", default)


def _span_between(scene: Varied, path: str, ends: tuple[float, float] | None, ranged: bool) -> Span:
    check_continuous(scene, path)
    if ends is None and not ranged:
        ends = schema_range(scene, path) if isinstance(scene, Scene) else None
        if ends is None:
            raise UsageError(f"{path}: has no range (give two values [SI], the lower one first)")
    return span_of(scene, path, *ordered_ends(path, ends))


def read_ranges(
    scene: Varied,
    texts: Iterable[str],
    option: str = "--path",
    example: str = "machine.rotor_diameter=120 mm..136 mm",
    default: Callable[[str], tuple[float, float]] | None = None,
) -> tuple[Span, ...]:
    """Return the spans of the texts PATH=LOW..HIGH of an option; raise UsageError in one line.

    `default` gives the range [SI] of a text that is a path alone.
    """
    found: dict[str, Span] = {}
    for text in texts:
        path, equals, ends = (part.strip() for part in text.partition("="))
        if path in found:
            raise UsageError(f"{option} {path}: is given twice (remove one)")
        stated = f"{option} {text}: is not PATH=LOW..HIGH (write e.g. {option} '{example}')"
        if not path:
            raise UsageError(stated)
        check_continuous(scene, path)
        both = ends_of(ends)
        if both is not None:
            low, high = (read_text(scene, path, end) for end in both)
        elif default is not None and not equals:
            low, high = default(path)
        else:
            raise UsageError(stated)
        refuse_empty_range(scene, path, low, high, f"{option} {path}")
        found[path] = span_of(scene, path, low, high)
    if not found:
        raise UsageError(f"nothing varies (write one or more {option} PATH=LOW..HIGH)")
    return tuple(found.values())


def span_of(scene: Varied, path: str, low: float, high: float) -> Span:
    """Return a path's span between two values [SI], with the scene's own value where that lies between them."""
    start = value_at(scene, path)
    inside = isinstance(start, int | float) and low <= start <= high
    return Span(path, low, high, float(start) if inside else None)


def _default_range(scene: Varied, ranged: bool, sizes: Sequence[float], path: str) -> tuple[float, float]:
    """Return the range [SI] of a path for which none is stated."""
    axis = sizes or scene.sweep.get(path, ())
    if len(axis) > 1:
        return min(axis), max(axis)
    bounds = schema_range(scene, path) if isinstance(scene, Scene) and not ranged else None
    if bounds is None:
        raise UsageError(f"--vary {path}: has no range (write {path}=LOW..HIGH, or an axis of it under sweep:)")
    return bounds


def schema_range(scene: Scene, path: str) -> tuple[float, float] | None:
    """Return the usual range [SI] of a path, within a factor `RANGE_FACTOR` of its own value; None without a value.

    It is bounded by the field's limits, the values hardly met in practice, and for sizes and the speed by those of
    usual machines. A value of zero, around which no factor leads anywhere, has the range of the field's limits, if it
    has both and any value between them is met in practice.
    """
    leaf, value = leaf_of(scene, path), value_at(scene, path)
    if value == 0 and not isinstance(value, bool) and {"ge", "le"} <= leaf.limits.keys() and leaf.hardly == UNBOUNDED:
        return leaf.limits["ge"], leaf.limits["le"]
    if not isinstance(value, int | float) or isinstance(value, bool) or value == 0:
        return None
    near = sorted((value / RANGE_FACTOR, value * RANGE_FACTOR))
    if leaf.kind == "temperature":  # its zero is far from any use
        near = [value - 60.0, value + 60.0]
    lows = [leaf.limits.get("gt"), leaf.limits.get("ge"), leaf.hardly[0], near[0]]
    highs = [leaf.limits.get("lt"), leaf.limits.get("le"), leaf.hardly[1], near[1]]
    kind = kind_of(scene.machine)
    for size in (each for each in sizes_of(scene) if each.path == path):
        lows.append(size.usual[0] * size.of(scene.machine))
        highs.append(size.usual[1] * size.of(scene.machine))
    if path == SPEED and kind.speed is not None:
        highs.append(kind.speed.usual / scene.machine.surface_speed(1.0))
    low, high = max(each for each in lows if each is not None), min(each for each in highs if each is not None)
    return min(low, float(value)), max(high, float(value))
