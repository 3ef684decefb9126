"""Values with a tolerance: `27 um ± 5 um`, `3 ± 10 %`, `50 um ×/÷ 2`, and which of their errors are fully correlated.

A tolerance is half of the interval in which the value lies in 95 of 100 cases, a coverage factor of 2, unless another
stands behind it: `27 um ± 2.5 um (k=1)` is the same as `27 um ± 5 um`. With ± the value is normally distributed, its
standard uncertainty half the tolerance; with ×/÷ its logarithm is. In ASCII the signs are +/- and */.
A column of measured points holds standard uncertainties unless a coverage factor stands behind them.

Source: JCGM 100:2008 (GUM), sections 2.3.5 and 2.3.6.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import Any, NamedTuple

from screwsim.effects import catalogue
from screwsim.inputs.declare import KINDS
from screwsim.inputs.suggestions import did_you_mean
from screwsim.scene.fields import FIXED, Leaf, effect_keys, leaf_paths, leaves_of, value_at
from screwsim.scene.model_errors import BLOCK, MODEL
from screwsim.scene.types import COVERAGE, Scene, Tolerance
from screwsim.scene.units import NUMBER, Refused, format_quantity, is_gauge, parse_quantity, without_gauge
from screwsim.scene.values import limits_text, shown, text_of, within
from screwsim.scene.yaml_tree import LocatedFaults, Node, Position, join, locate

LARGEST_COVERAGE = 10.0  # nobody states more standard uncertainties than these
COVERAGE_FACTOR = re.compile(rf"\s*\(\s*k\s*=\s*({NUMBER})\s*\)\s*$")
CORRELATED_KEY = "correlated"
CERTAIN_SECTIONS = ("numerics.", "output.")  # only the machine and its operation are uncertain
KEYS_WITHOUT_TOLERANCE = ("title", "base", "sweep", "output", BLOCK)  # keys under which no value has a tolerance
_SIGNS = {"±": False, "+/-": False, "+-": False, "×/÷": True, "x/÷": True, "*/": True, "x/": True}
_SIGN = re.compile("|".join(map(re.escape, _SIGNS)))
_SHARE = re.compile(rf"({NUMBER})\s*%")
_BARE = re.compile(NUMBER)
_UNIT = re.compile(rf"\s*{NUMBER}\s*(.*)", re.DOTALL)
_EXAMPLE = "write e.g. '27 um ± 5 um', '3 ± 10 %' or '50 um ×/÷ 2'"


class WrittenTolerance(NamedTuple):
    """A tolerance as written: the text of the value before it, whether it is a factor, its own text, and its place."""

    value: str
    factor: bool
    text: str
    place: Position


def split_tolerances(root: Node, path: str = "") -> tuple[Node, dict[str, WrittenTolerance]]:
    """Return a tree with the tolerances removed from its values, and the tolerances by path."""
    match = tolerance_sign(root.value) if path and isinstance(root.value, str) else None
    if match is not None:
        value, factor, text = root.value[: match.start()].strip(), _SIGNS[match[0]], root.value[match.end() :].strip()
        written = WrittenTolerance(value, factor, text, root.place)
        return replace(root, value=_nominal(value, text, factor)), {path: written}
    if not isinstance(root.value, dict):
        return root, {}
    content: dict[str, Node] = {}
    every: dict[str, WrittenTolerance] = {}
    for name, child in root.value.items():
        without = not path and name in KEYS_WITHOUT_TOLERANCE
        content[name], found = (child, {}) if without else split_tolerances(child, join(path, name))
        every |= found
    return (replace(root, value=content) if every else root), every


def tolerance_sign(text: str) -> re.Match[str] | None:
    """Return the first sign of a tolerance after a digit; None where there is none."""
    number = re.search("[0-9.]", text)
    return _SIGN.search(text, number.end()) if number else None


def _nominal(value: str, text: str, factor: bool) -> Any:
    """Return a value without its tolerance; one without a unit takes the tolerance's unit, or is a plain number."""
    if not _BARE.fullmatch(value):
        return value
    match = None if factor else _UNIT.fullmatch(COVERAGE_FACTOR.sub("", text))
    unit = match[1].strip() if match else ""
    return f"{value} {unit}" if unit and unit != "%" else float(value)


def read_tolerances(
    given: Mapping[str, WrittenTolerance], root: Node, scene: Scene, problems: LocatedFaults
) -> tuple[dict[str, Tolerance], tuple[tuple[str, ...], ...]]:
    """Return the tolerances `given` in a scene's tree by path, and the groups that err together.

    Faults are added at their places.
    """
    leaves, found = leaves_of(scene), {}
    for path, each in given.items():
        leaf = leaves.get(path)
        with problems.at(each.place, path):
            if leaf is None or (leaf.dimension is None and leaf.kind != "number"):
                raise Refused("has a tolerance, which only quantities and numbers may have (write the value alone)")
            if path.startswith(CERTAIN_SECTIONS):
                raise Refused("has a tolerance, which only values that describe the machine and its operation may have")
            if path in FIXED:
                raise Refused("has a tolerance, but gauge pressures were read relative to it (write theirs instead)")
            value = float(value_at(scene, path))
            tolerance = _tolerance(leaf, each, value)
            _check_ends(leaf, tolerance, value, "its")
            found[path] = tolerance
            _check_sweep(leaf, found[path], scene.sweep.get(path, ()))
    return found, _correlated_groups(root, set(given), scene, problems)


def _tolerance(leaf: Leaf, given: WrittenTolerance, value: float) -> Tolerance:
    """Return a tolerance at two standard uncertainties, by whatever coverage factor it is written."""
    text, factor = split_coverage(given.text, COVERAGE)
    given, wider = given._replace(text=text), COVERAGE / factor
    if given.factor:
        written = _factor(leaf, given, value)
        return replace(written, size=written.size**wider)
    written = _half_interval(leaf, given, value)
    percent = None if written.percent is None else wider * written.percent
    return replace(written, size=wider * written.size, percent=percent)


def _check_ends(leaf: Leaf, tolerance: Tolerance, value: float, whose: str) -> None:
    """Raise Refused where the interval around a value exceeds the limits of the input."""
    for end in tolerance.ends(value):
        if not within(leaf, end):
            reach = f"{whose} 95 % interval reaches {text_of(leaf, float(f'{end:.4g}'))}, which is out of range"
            raise Refused(f"{reach} (it must be {limits_text(leaf)}; write a smaller one, or a factor such as ×/÷ 1.5)")


def _check_sweep(leaf: Leaf, tolerance: Tolerance, values: Sequence[Any]) -> None:
    """Raise Refused where the tolerance is impossible at a value of the sweep, to which it applies too."""
    for value in values:
        own = tolerance.around(float(value))
        if not own.size > 0.0 or (tolerance.factor and value <= 0.0):
            raise Refused(
                f"has a tolerance that is 0 at the value {text_of(leaf, value)} of the sweep (write ± with a unit)"
            )
        _check_ends(leaf, own, float(value), f"at {text_of(leaf, value)} of the sweep its")


def _factor(leaf: Leaf, given: WrittenTolerance, value: float) -> Tolerance:
    if not _BARE.fullmatch(given.text) or not float(given.text) > 1.0 or not math.isfinite(float(given.text)):
        raise Refused(f"the tolerance {shown(given.text)} is not a factor above 1 (write e.g. ×/÷ 2)")
    if value <= 0.0 or leaf.kind in ("temperature", "angle") or is_gauge(given.value):
        raise Refused("a factor is only for quantities that are positive by nature, such as lengths (write ±)")
    return Tolerance(float(given.text), factor=True)


def _half_interval(leaf: Leaf, given: WrittenTolerance, value: float) -> Tolerance:
    """Return a tolerance written with ±."""
    text, share = given.text, _SHARE.fullmatch(given.text)
    if share is not None:
        if leaf.kind == "temperature":
            raise Refused(f"the tolerance {shown(text)} is a share of a temperature (write it in kelvin, e.g. ± 2 K)")
        if is_gauge(given.value):
            raise Refused(f"the tolerance {shown(text)} is a share of a gauge pressure (write its size, as ± 0.1 bar)")
        half = 0.01 * float(share[1]) * abs(value)
    elif leaf.dimension is None:
        if not _BARE.fullmatch(text):
            raise Refused(f"the tolerance {shown(text)} is not a number ({_EXAMPLE})")
        half = float(text)
    else:
        match = _UNIT.fullmatch(given.value)
        unit = without_gauge(match[1].strip()) if match else ""
        kind = KINDS.get(f"{leaf.kind}_difference", leaf.dimension)
        bare = _BARE.fullmatch(text) is not None
        try:
            half = parse_quantity(kind, f"{text} {unit}" if bare else text)
        except Refused as refusal:
            raise Refused(f"the tolerance {refusal}") from None
    if not half > 0.0:
        raise Refused(f"the tolerance {shown(text)} is {'negative' if half < 0.0 else 'zero'} (write its size)")
    return Tolerance(half, percent=None if share is None else float(share[1]))


def _correlated_groups(
    root: Node, known: Set[str], scene: Scene, problems: LocatedFaults
) -> tuple[tuple[str, ...], ...]:
    """Return the groups of paths that err together, without paths of effects that the scene does not name.

    A value without a tolerance that is stated over the group (by an override, or in a scene over its base) replaces the
    one that erred with others: it is not in the group any more.
    """
    block = root.value.get(BLOCK)
    if block is None or block.value is None:
        return ()
    if not isinstance(block.value, dict) or not set(block.value) <= {CORRELATED_KEY, MODEL}:
        what = f"does not list correlated groups (write {CORRELATED_KEY}: [[PATH, PATH], …], or {MODEL}: NAME)"
        problems.add(block.place, BLOCK, what)
        return ()
    listed = block.value.get(CORRELATED_KEY)
    if listed is None or listed.value is None:
        return ()
    groups: list[tuple[str, ...]] = []
    for group in listed.value if isinstance(listed.value, list) else [listed]:
        if isinstance(group.value, list) and len(group.value) > 1:
            groups.append(_correlated_group(root, group.value, groups, known, scene, problems))
        else:
            told = "one path" if isinstance(group.value, list) and group.value else shown(group.value)
            what = f"{told} is not a group of paths (write [[PATH, PATH], …])"
            problems.add(group.place, f"{BLOCK}.{CORRELATED_KEY}", what)
    return tuple(group for group in groups if len(group) > 1)


def _correlated_group(
    root: Node,
    nodes: Sequence[Node],
    others: Sequence[Sequence[str]],
    known: Set[str],
    scene: Scene,
    problems: LocatedFaults,
) -> tuple[str, ...]:
    """Return the paths of one group; `others` are the groups before it, `known` the paths with a tolerance."""
    names: list[str] = []
    for node in nodes:
        path = node.value
        if _is_left_out(path, scene):
            continue
        if not isinstance(path, str):
            numeric = isinstance(path, int | float)
            why = "; a group is fully correlated and has no coefficient" if numeric else ""
            fault = f"is not a path{why} (write [[PATH, PATH], …])"
        elif path in names:
            fault = "is listed twice (name it once)"
        elif any(path in group for group in others):
            fault = "is in two groups (name it in one)"
        elif path not in known and _is_stated_over(root, node):
            continue
        elif path not in known:
            fault = f"has no tolerance in this scene{did_you_mean(path, known)} (write it there, or leave it out)"
        else:
            fault = ""
        if fault:
            problems.add(node.place, f"{BLOCK}.{CORRELATED_KEY}", f"{shown(path)} {fault}")
        if isinstance(path, str):
            names.append(path)
    return tuple(names)


def _is_stated_over(root: Node, named: Node) -> bool:
    """Tell whether the value of a path is stated in a place that takes precedence over the one that names the path."""
    value, stated = locate(root, named.value)
    return stated and not isinstance(value.value, dict) and value.place.is_over(named.place)


def _is_left_out(path: Any, scene: Scene) -> bool:
    """Tell whether a path is a parameter of a known effect that the scene does not name."""
    if not isinstance(path, str) or not path.startswith("effects."):
        return False
    every = catalogue()
    name, _ = effect_keys(path, every)
    if name not in every or name in scene.effects:
        return False
    return path in leaf_paths({name: every[name].parameters}, scene.machine.kind)


def tolerance_text(leaf: Leaf, tolerance: Tolerance) -> str:
    """Return a tolerance as YAML text, to follow its value."""
    if tolerance.factor:
        return f" ×/÷ {tolerance.size!r}"
    if tolerance.percent is not None:
        return f" ± {tolerance.percent!r} %"
    kind = KINDS.get(f"{leaf.kind}_difference", leaf.dimension)
    return f" ± {tolerance.size!r}" if kind is None else f" ± {format_quantity(kind, tolerance.size)}"


def together_text(scene: Scene) -> Iterator[str]:
    """Yield the YAML lines of the groups that err together and of the validation that gives the model's error."""
    parts = []
    if scene.correlated:
        groups = (f"[{', '.join(group)}]" for group in scene.correlated)
        parts.append(f"{CORRELATED_KEY}: [{', '.join(groups)}]")
    if scene.model_error:
        parts.append(f"{MODEL}: {scene.model_error}")
    if parts:
        yield f"{BLOCK}: {{{', '.join(parts)}}}"


def split_coverage(text: str, otherwise: float) -> tuple[str, float]:
    """Return a text without the coverage factor at its end, and that factor, `otherwise` where none is written.

    `otherwise` is 2 behind a ± or ×/÷, 1 in a column of measured points, which holds standard uncertainties. Raise
    `Refused` for a factor that is none.
    """
    match = COVERAGE_FACTOR.search(text)
    if match is None:
        return text, otherwise
    factor = float(match[1])
    if not 0.0 < factor <= LARGEST_COVERAGE:
        raise Refused(
            f"k={match[1]} is not a coverage factor (write k=1 for a standard uncertainty, k=2 for half of a 95 % "
            f"interval)"
        )
    return text[: match.start()], factor
