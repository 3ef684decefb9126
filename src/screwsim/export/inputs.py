"""Inputs and outputs of a map: paths with ranges, and figures; with names and units as other tools need them."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from screwsim.build import build_parts
from screwsim.figures import called_for, declared
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figure
from screwsim.outputs.customary import RPM, ZERO_CELSIUS
from screwsim.outputs.display import si_unit
from screwsim.scene import Scene
from screwsim.scene.grid import Swept, joints_of, unit_of
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.inputs import check_continuous
from screwsim.study.asked.spans import read_ranges, read_spans
from screwsim.study.asked.varied import Varied, leaf_of, value_at
from screwsim.study.maps.short_names import short_name
from screwsim.study.stages.axes import STAGE_NAMES, names_of

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_DERIVED: dict[str, dict[str, int]] = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    **{name: {name: 1} for name in BASE},
}
_PART = re.compile(r"([A-Za-z]+)\^?(-?[0-9]+)?")
LOGARITHMIC_FROM = 2.0  # ratio of the ends of a pressure range from which nodes are spaced by its logarithm
FIGURES = (
    "gas_mass_flow",
    "shaft_power",
    "discharge_temperature",
    "separator_temperature",
    "cooling_capacity",
    "heating_capacity",
    "economizer_mass_flow",
    "electrical_power",
)  # with them the heat balance of a plant closes: what leaves for its condenser, and how warm


class Follower(NamedTuple):
    """A path that varies together with an input: its values [SI] at ascending values of the input, linear between."""

    path: str
    at: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Input:
    """One input of a map: its path in the scene, external name, unit and meaning, first and last value [SI].

    Nodes are spaced by the logarithm where `log`. `value` is the scene's: the initial value of the input. What a sweep
    varies together with it `follows` it.
    """

    path: str
    name: str
    units: str
    long_name: str
    low: float
    high: float
    value: float
    log: bool = False
    follows: tuple[Follower, ...] = ()

    def swept(self, x: np.ndarray) -> dict[str, tuple[float, ...]]:
        """Return the values [SI] of its path, and of those that follow it, at values of the input."""
        others = {path: tuple(map(float, np.interp(x, own, values))) for path, own, values in self.follows}
        return {self.path: tuple(map(float, x)), **others}

    def coordinate(self, x: np.ndarray | float) -> np.ndarray:
        """Return the coordinates of values [SI] on the axis of the grid."""
        return np.log(x) if self.log else np.asarray(x, float)

    def at(self, u: np.ndarray | float) -> np.ndarray:
        """Return the values [SI] at coordinates of that axis, limited to the range."""
        return np.clip(np.exp(u) if self.log else np.asarray(u, float), self.low, self.high)


def input_of(path: str, units: str, doc: str, ends: tuple[float, float], value: float) -> Input:
    """Return an input between two values [SI]; pressures over an octave or more are taken by their logarithm.

    Its meaning, of two stages with its stage, is without what it stands instead of, which concerns the author of a
    scene.
    """
    low, high = map(float, ends)
    meaning, stage = doc.partition(" (instead of ")[0], path.partition(".")[0]
    meaning = f"{meaning}, {stage} stage" if stage in STAGE_NAMES else meaning
    log = units == "Pa" and high >= LOGARITHMIC_FROM * low > 0.0
    return Input(path, short_name(path), units, meaning, low, high, value, log)


def read_inputs(
    scene: Varied, over: Sequence[str] | Mapping[str, tuple[float, float]], option: str = "--over"
) -> tuple[Input, ...]:
    """Return the inputs named by `PATH=LOW..HIGH` or {path: (low, high) [SI]}, else those of the scene's sweep.

    Raise UsageError, in which `option` names where they were given.
    """
    if over:
        if isinstance(over, Mapping):
            spans = read_spans(scene, over, ranged=True)
        else:
            spans = read_ranges(scene, tuple(over), option, _example(scene))
        found = _inputs(scene, {each.path: (each.low, each.high) for each in spans})
        check_names(found)
        return found
    axes = _numeric_axes(scene, option)
    for path in axes:
        check_continuous(scene, path)
    together = {} if isinstance(scene, Scene) else _followers(scene, axes)
    follow = {each.path for followers in together.values() for each in followers}
    ends = {path: (min(values), max(values)) for path, values in axes.items() if path not in follow}
    found = _inputs(scene, ends)
    check_names(found)
    return tuple(with_followers(one, together.get(one.path, ())) for one in found)


def numeric_inputs(scene: Varied) -> tuple[Input, ...]:
    """Return each path of a sweep over numbers as an input, those that vary together too; raise UsageError for none."""
    return _inputs(scene, {path: (min(values), max(values)) for path, values in _numeric_axes(scene).items()})


def _numeric_axes(scene: Varied, option: str = "--over") -> dict[str, tuple[float, ...]]:
    """Return the values [SI] of each path that a sweep varies over numbers; raise UsageError where there is none."""
    axes = {
        path: values
        for path, values in scene.sweep.items()
        if len(values) > 1 and all(isinstance(value, int | float) for value in values)
    }
    if not axes:
        raise UsageError(
            "there is nothing to map over: the scene has no sweep over numbers (write e.g. "
            f"{option} '{_example(scene)}', repeated for each further path)"
        )
    return axes


def _followers(scene: Swept, axes: Mapping[str, tuple[float, ...]]) -> dict[str, tuple[Follower, ...]]:
    """Return what varies together with each path that leads others, where its values rise or fall throughout."""
    found = {}
    for joint in joints_of(scene):
        leader, *others = joint.paths
        numbers = {path: axes[path] for path in joint.paths if path in axes}
        if not numbers:
            continue
        together = f"no map: {leader} varies together with {' and '.join(others)}, but"
        words = [path for path in joint.paths if path not in numbers]
        if words:
            remedy = "name ranges with --over, or vary it on an axis of its own"
            raise UsageError(f"{together} {words[0]} has values that are no numbers ({remedy})")
        followers = followers_of(numbers.pop(leader), numbers)
        if followers is None:
            remedy = "name ranges with --over, or vary them on axes of their own"
            raise UsageError(f"{together} neither rises nor falls throughout ({remedy})")
        found[leader] = followers
    return found


def followers_of(leader: Any, others: Mapping[str, Any]) -> tuple[Follower, ...] | None:
    """Return the followers of a path's values [SI], their own by path; None where these neither rise nor fall."""
    steps, order = np.diff(leader), np.argsort(leader)
    if not (np.all(steps > 0.0) or np.all(steps < 0.0)):
        return None
    at, *columns = (tuple(map(float, np.asarray(values)[order])) for values in (leader, *others.values()))
    return tuple(Follower(path, at, values) for path, values in zip(others, columns, strict=True))


def with_followers(one: Input, followers: tuple[Follower, ...]) -> Input:
    """Return an input with those that follow it, which its meaning tells."""
    if not followers:
        return one
    told = " and ".join(each.path for each in followers)
    return replace(one, follows=followers, long_name=f"{one.long_name}, with {told} as in the sweep")


def _example(scene: Varied) -> str:
    return f"{names_of('operation.speed', not isinstance(scene, Scene))[0]}=1500 rpm..4500 rpm"


def _inputs(scene: Varied, ends: Mapping[str, tuple[float, float]]) -> tuple[Input, ...]:
    found = []
    for path, (low, high) in ends.items():
        leaf, own = leaf_of(scene, path), value_at(scene, path)
        value = float(own) if isinstance(own, int | float) and low <= own <= high else 0.5 * (low + high)
        found.append(input_of(path, unit_of(leaf), leaf.doc, (low, high), value))
    return tuple(found)


def read_outputs(scene: Varied, figures: Sequence[str] = (), option: str = "--figure") -> tuple[Figure, ...]:
    """Return the named outputs, else the usual ones that the scene calls for; raise UsageError with `option`."""
    here = called_for(scene, build_parts(scene)) if isinstance(scene, Scene) else scene.figures
    names = [figure_of(scene, text, option) for text in figures] or [name for name in FIGURES if name in here]
    return tuple(here.get(name) or declared(name) for name in dict.fromkeys(names))


def check_names(inputs: Sequence[Input], outputs: Sequence[Figure] = ()) -> None:
    """Raise UsageError where two variables of a map share an external name, as readers could not distinguish them."""
    paths: dict[str, str] = {}
    for one in inputs:
        if one.name in paths:
            what = f"{paths[one.name]} and {one.path} would both be called {one.name} in the export"
            raise UsageError(f"no map: {what} (vary one of them)")
        paths[one.name] = one.path
    for output in outputs:
        if output.name in paths:
            what = f"is the name of an input of this map, {paths[output.name]}"
            raise UsageError(f"no map: figure {output.name} {what} (name other figures with --figure)")


def title_on_one_line(text: str) -> str:
    """Return a title on one line, as in a comment."""
    return " ".join(text.split())


def evenly_spaced_nodes(one: Input, count: int) -> np.ndarray:
    """Return `count` evenly spaced nodes on the axis of an input."""
    low, high = one.coordinate(one.low), one.coordinate(one.high)
    return np.linspace(float(low), float(high), count)


class Display(NamedTuple):
    """A customary unit: the value in it is `factor` times that in SI, plus `offset`."""

    name: str
    factor: float
    offset: float = 0.0


DISPLAYS = {
    "K": (Display("degC", 1.0, -ZERO_CELSIUS),),
    "Pa": (Display("bar", 1e-5),),
    "W": (Display("kW", 1e-3),),
    "rad/s": (Display("rpm", 1.0 / RPM),),
}


def plain(units: str) -> str:
    """Return a unit as people write it: 'kg s-1' gives kg/s, plain numbers '1'."""
    return units if "/" in units else si_unit(units) or "1"


def unit_after_number(units: str) -> str:
    """Return a unit as it follows a number: with a blank before it; empty for plain numbers."""
    text = plain(units)
    return "" if text == "1" else f" {text}"


def followers_text(inputs: Sequence[Input]) -> str:
    """Return, in SI, what varies together with inputs: '; with speed 100, 200: first.x 1, 3'; empty where nothing."""
    lists = (
        (one.name, each.path, *(", ".join(f"{x:.6g}" for x in column) for column in each[1:]))
        for one in inputs
        for each in one.follows
    )
    return "".join(f"; with {name} {at}: {path} {values}" for name, path, at, values in lists)


def range_text(one: Input) -> str:
    """Return the range of an input in SI: '263.15 … 283.15 K'."""
    return f"{one.low:.6g} … {one.high:.6g}{unit_after_number(one.units)}"


def exponents(units: str) -> dict[str, int]:
    """Return the exponents of base units in a unit such as 'kg s-1' or 'J/(kg K)'; empty for '1'.

    Raise ValueError for a unit that is not composed of SI units.
    """
    above, _, below = units.partition("/")
    found: dict[str, int] = {}
    for text, sign in ((above, 1), (below, -1)):
        for name, power in _PART.findall(text):
            if name not in _DERIVED:
                raise ValueError(f"{units}: {name} is not an SI unit")
            for base, exponent in _DERIVED[name].items():
                found[base] = found.get(base, 0) + sign * exponent * int(power or 1)
    return {name: power for name, power in found.items() if power}
