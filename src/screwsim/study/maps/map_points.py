"""A compressor map evaluated at points: values of its polynomials at temperatures inside its envelope."""

import os
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.arguments import NUMBER, as_list, checked_arguments
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import MACHINES
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.results import Results, open_results
from screwsim.results.read import STAGES
from screwsim.scene.fields import Leaf, catalogue_leaves, unknown_key
from screwsim.scene.units import readable_quantity, refused_at
from screwsim.scene.values import convert
from screwsim.study.maps.performance_map import PerformanceMap, performance_maps, temperature_paths
from screwsim.study.maps.short_names import short_name

EXAMPLE = '--at "evaporating_temperature=0 degC, condensing_temperature=40 degC"'
SAME_VALUE = 1e-9  # relative difference within which values of other axes are the same


class MapPoint(NamedTuple):
    """A map at one point: the temperatures [K], the values of its other axes [SI], its figures [SI].

    `by_inputs` is half of their 95 % interval by the tolerances of the inputs [SI], by the map's mean share; empty
    without tolerances. `missing` are the points of the sweep that the map has to do without, in words.
    """

    evaporating_temperature: float
    condensing_temperature: float
    values: Mapping[str, Any]
    figures: Mapping[str, float]
    by_inputs: Mapping[str, float]
    missing: str = ""


@checked_arguments(evaporating_temperature=NUMBER, condensing_temperature=NUMBER)
def evaluate_map(
    results: Results | str | os.PathLike[str],
    evaporating_temperature: float,
    condensing_temperature: float,
    figures: Sequence[str] = (),
    **others: Any,
) -> dict[str, float]:
    """Return figures [SI] of a sweep's map at evaporating and condensing temperature [K].

    If the sweep has other axes, `others` gives their values [SI], or texts with units, by the last word of their paths
    (speed=309.0, speed="2950 rpm"), of two stages in series with the stage in front where both have such an input
    (second_speed=136.0). Raises UsageError outside the envelope, where the polynomial does not hold.
    """
    of = results if isinstance(results, Results) else open_results(results)
    maps = performance_maps(of, tuple(as_list(figures)))
    named = {_axis(of, name): value for name, value in others.items()}
    asked = {path: _value(path, value) if isinstance(value, str) else value for path, value in named.items()}
    return dict(evaluated_at(maps, (evaporating_temperature, condensing_temperature), asked).figures)


def points_at(results: Results, maps: Sequence[PerformanceMap], texts: Sequence[str]) -> list[MapPoint]:
    """Return the map at points written as NAME=VALUE, NAME=VALUE; raise UsageError in one line."""
    found = []
    for text in texts:
        try:
            found.append(evaluated_at(maps, *_read(results, text)))
        except UsageError as fault:
            raise UsageError(f"--at {text}: {fault}") from None
    return found


def evaluated_at(
    maps: Sequence[PerformanceMap], temperatures: tuple[float, float], asked: Mapping[str, Any]
) -> MapPoint:
    """Return the one map selected by values [SI] of its other axes at both temperatures [K]; raise UsageError."""
    T_e, T_c = map(float, temperatures)
    within = [axis_name(path) for path in asked if path not in maps[0].values]
    if within:
        raise UsageError(f"{within[0]} varies together with a temperature in this sweep (leave it out)")
    fitting = [one for one in maps if all(_is_same_value(one.values[path], value) for path, value in asked.items())]
    if len(fitting) != 1:
        raise UsageError(_choose(maps, fitting))
    (one,) = fitting
    if one.message:
        raise UsageError(f"there is no map: {one.message}")
    S, D = T_e - ZERO_CELSIUS, T_c - ZERO_CELSIUS
    if not one.inside(S, D):
        corners = ", ".join(f"({s:g}, {d:g})" for s, d in one.envelope)
        what = f"({S:.6g}, {D:.6g}) °C lies outside the envelope {corners} °C, where the polynomial says nothing"
        raise UsageError(f"{what} (choose a point inside, or a sweep that reaches it)")
    found = {figure: float(one.evaluate(figure, S, D)) for figure in one.fits}
    shares = {figure: fit.by_inputs for figure, fit in one.fits.items() if fit.by_inputs is not None}
    by_inputs = {figure: share * abs(found[figure]) for figure, share in shares.items()}
    return MapPoint(T_e, T_c, one.values, found, by_inputs, one.missing_in_words)


def _is_same_value(own: Any, asked: Any) -> bool:
    """Return whether a map's value is the requested one."""
    if isinstance(own, str) or isinstance(asked, str):
        return own == asked
    return bool(np.isclose(float(own), float(asked), rtol=SAME_VALUE, atol=0.0))


def _choose(maps: Sequence[PerformanceMap], fitting: Sequence[PerformanceMap]) -> str:
    """Return the message that no map has the requested values, or that several do, with the maps available."""
    paths = list(maps[0].values)
    which = f"there are maps at {'; '.join(place_in_words(one.values) for one in maps)}"
    if fitting:
        names = " and ".join(map(axis_name, paths))
        return f"there are {len(fitting)} maps of it (state {names} as well, e.g. {_stated(fitting[0])}; {which})"
    return f"there is no map for it ({which})"


def _stated(one: PerformanceMap) -> str:
    """Return the values of a map's other axes as they are asked for: 'position=0'."""
    return ", ".join(f"{axis_name(path)}={_shown_value(path, value)}" for path, value in one.values.items())


def place_in_words(values: Mapping[str, Any]) -> str:
    """Return values [SI] of a map's other axes with their units: 'operation.speed = 2950 rpm'."""
    return ", ".join(f"{path} = {_shown_value(path, value)}" for path, value in values.items())


def _shown_value(path: str, value: Any) -> str:
    """Return a value [SI] of a path in its customary unit; a temperature in degC."""
    leaf = _leaf(path)
    if isinstance(value, str) or leaf is None or leaf.dimension is None:
        return value if isinstance(value, str) else f"{float(value):.10g}"
    if leaf.dimension.name == "temperature":
        return f"{float(value) - ZERO_CELSIUS:.10g} degC"
    return readable_quantity(leaf.dimension, float(value))


def axis_name(path: str) -> str:
    """Return the last word of a path; of two stages the short name, as both may have that word."""
    return short_name(path) if path.startswith(STAGES) else path.rpartition(".")[2]


def _axis(results: Results, name: str) -> str:
    """Return the path of an axis given in full, by its short name or its last word.

    Raise UsageError with the available axes.
    """
    paths = list(results.varied)
    same = [path for path in paths if name in (path, short_name(path))]
    same = same or [path for path in paths if name == path.rpartition(".")[2]]
    if len(same) == 1:
        return same[0]
    if same:
        raise UsageError(f"{name} is short for {' and for '.join(same)} (write the one that is meant in full)")
    options = paths if "." in name else [axis_name(path) for path in paths]
    one_of = f"one of {', '.join(options)}"
    raise UsageError(f"{name} {unknown_key(name, options, one_of)}")


def _read(results: Results, text: str) -> tuple[tuple[float, float], dict[str, Any]]:
    """Return both temperatures [K] of a text NAME=VALUE, NAME=VALUE, and its other values [SI]; raise UsageError."""
    asked: dict[str, Any] = {}
    for part in text.split(","):
        name, equals, value = (each.strip() for each in part.partition("="))
        if not (equals and name and value):
            raise UsageError(f"is not NAME=VALUE, NAME=VALUE (write e.g. {EXAMPLE})")
        path = _axis(results, name)
        if path in asked:
            raise UsageError(f"{name} is given twice (remove one)")
        asked[path] = _value(path, value)
    both = temperature_paths(bool(results.stages))
    missing = [path for path in both if path not in asked]
    if missing:
        raise UsageError(f"does not state {missing[0].rpartition('.')[2]} (write e.g. {EXAMPLE})")
    T_e, T_c = (asked.pop(path) for path in both)
    return (T_e, T_c), asked


def _value(path: str, text: str) -> Any:
    """Return a value [SI] of an axis; a text where it is no number."""
    leaf = _leaf(path)
    try:
        with refused_at(path):
            return convert(leaf, text) if leaf is not None and leaf.dimension is not None else float(text)
    except ValueError:
        return text  # a word, such as a fluid


def _leaf(path: str) -> Leaf | None:
    """Return the input at a path, of two stages with its stage before it; None for an effect of a user's own."""
    known = _known_leaves()
    of, _, inner = path.partition(".")
    if of in STAGES:
        return known.get(inner)
    from screwsim.study.stages.axes import BETWEEN, LEAVES

    return LEAVES.get(inner) if of == BETWEEN else known.get(path)


@cache
def _known_leaves() -> dict[str, Leaf]:
    """Return {path: input} of the machines of every kind, with every effect."""
    return {path: leaf for kind in MACHINES for path, leaf in catalogue_leaves(kind).items()}
