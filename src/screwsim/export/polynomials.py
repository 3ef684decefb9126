"""Ten-coefficient polynomials of a sweep over evaporating and condensing temperature, for tools without tables."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.export.inputs import Input, evenly_spaced_nodes, numeric_inputs, read_inputs, title_on_one_line
from screwsim.export.source import is_results, load_varied, refuse_changes
from screwsim.export.table import refuse_words, temporary_results
from screwsim.fluid.composition import is_blend
from screwsim.inputs.faults import UsageError
from screwsim.results import Results, open_results
from screwsim.results.read import STAGES
from screwsim.results.schema import quantities_along
from screwsim.scene import Scene
from screwsim.scene.grid import joints_of
from screwsim.scene.operation import QUALITY, SUBCOOLING, SUPERHEAT
from screwsim.study.asked.varied import Varied, value_at
from screwsim.study.maps.map_points import axis_name, place_in_words
from screwsim.study.maps.performance_map import (
    FORMULA,
    PerformanceMap,
    conditions,
    followers,
    performance_maps,
    temperature_paths,
)
from screwsim.study.pool.progress import Progress
from screwsim.study.stages.axes import names_of

SATURATION_NODES, OTHER_NODES = 6, 3  # number of values where --over gives ranges
ECONOMIZED = "economizer_mass_flow", "vapour_mass_flow"  # figures of one machine, and of two stages
RATED_TEMPERATURES = {"S": 5.0, "D": 45.0}  # [°C] used where the envelope contains it, else its middle


_VARIES_WITHIN = (
    "{} varies together with a temperature, but the export takes one value of it (vary it on an axis of its own, or "
    "use export en12900)"
)
_WET = "{} is for wet gas, but the export takes a superheat (use export en12900)"


@dataclass(frozen=True, eq=False)
class Polynomials:
    """Maps of figures, one per point of the sweep's other axes; units by figure, and the other conditions [SI]."""

    title: str
    fluid: str
    maps: tuple[PerformanceMap, ...]
    units: dict[str, str]
    conditions: dict[str, float]
    axes: dict[str, str]  # SI units of the other axes
    condensing: str = "bubble"  # to which point the condensing temperature refers: "dew" for a blend (M316)
    follows: tuple[dict[str, Any], ...] = ()  # what varies together with a temperature, and so within a map
    two: bool = False  # of two stages in series, before whose paths their stage stands
    missing: tuple[str, ...] = ()  # what the maps have to do without, in words
    economized: bool = False  # the liquid is cooled behind the condenser, by vapour that the machine draws besides

    def name(self, one: PerformanceMap) -> str:
        """Return what distinguishes a map from the others, as part of a name: 'speed_308.923'."""
        return "_".join(f"{axis_name(path)}_{value:.6g}" for path, value in one.values.items())

    def titled(self, one: PerformanceMap, alone: str) -> str:
        """Return the name of a map and where it is, with units: 'speed_308.923 (operation.speed = 2950 rpm)'."""
        return f"{self.name(one)} ({place_in_words(one.values)})" if one.values else alone

    @property
    def within(self) -> set[str]:
        """The paths that vary within a map."""
        return {each["path"] for each in self.follows}

    def condition(self, one: PerformanceMap, path: str) -> float:
        """Return a condition of a map [SI]: its own value where the sweep varies it; 0 if the scene does not state it.

        Raise UsageError for a path that varies within the map, as it has no single value.
        """
        (path,) = names_of(path, self.two)
        if path in self.within:
            raise UsageError(_VARIES_WITHIN.format(path))
        return float(one.values.get(path, self.conditions.get(path, 0.0)))

    def superheat(self, one: PerformanceMap) -> float:
        """Return the superheat [K] of the suction gas in a map; raise UsageError where that gas is wet."""
        (quality,) = names_of(QUALITY, self.two)
        if quality in {*self.conditions, *one.values, *self.within}:
            raise UsageError(_WET.format(quality))
        return self.condition(one, SUPERHEAT)


def check_conditions(scene: Varied) -> None:
    """Raise UsageError where a sweep gives a map no single superheat or subcooling."""
    two = not isinstance(scene, Scene)
    (quality,) = names_of(QUALITY, two)
    if quality in scene.sweep or value_at(scene, quality) is not None:
        raise UsageError(_WET.format(quality))
    for joint in joints_of(scene):
        for path in (*names_of(SUPERHEAT, two), *names_of(SUBCOOLING, two)):
            if path in joint.paths and set(temperature_paths(two)) & set(joint.paths):
                raise UsageError(_VARIES_WITHIN.format(path))


@contextmanager
def swept_results(
    source: str,
    over: Sequence[str] | None,
    overrides: Sequence[str] | None = None,
    without: Sequence[str] | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
    told: Callable[[Varied, tuple[Input, ...]], None] | None = None,
) -> Iterator[Results]:
    """Give the results of a file, or those of a scene after its own sweep or one over ranges (`--over`).

    `told` is called with the scene and what it varies before anything is simulated; the results of a scene bear the
    path of its file.
    """
    if is_results(source):
        refuse_changes(source, {"--over": over, "--set": overrides, "--without": without})
        yield open_results(source)
        return
    scene = load_varied(source, overrides, without)
    temperatures = temperature_paths(not isinstance(scene, Scene))
    if over:
        inputs = read_inputs(scene, over)
        counts = [SATURATION_NODES if one.path in temperatures else OTHER_NODES for one in inputs]
        pairs = zip(inputs, counts, strict=True)
        sweep = {one.path: tuple(map(float, one.at(evenly_spaced_nodes(one, count)))) for one, count in pairs}
        scene = replace(scene, sweep=sweep, joints=())
    missing = [path for path in temperatures if path not in scene.sweep]
    stated = next((path for path in missing if value_at(scene, path) is None), None)
    if stated is not None:
        other = "export csv, modelica and fmu take a map over its pressures or any other input"
        raise UsageError(f"{source}: states no {stated}, over which these polynomials are ({other})")
    if missing:
        evaporating, condensing = temperatures
        raise UsageError(
            f"{source}: is swept over no {' and no '.join(missing)}, which these polynomials need (write e.g. "
            f"--over '{evaporating}=-10 degC..10 degC' --over '{condensing}=30 degC..50 degC')"
        )
    if told is not None:
        told(scene, numeric_inputs(scene))
    with temporary_results(scene, jobs=jobs, progress=progress) as results:
        yield replace(results, path=Path(source))


def polynomials(results: Results, figures: Sequence[str]) -> Polynomials:
    """Return the polynomials of some figures; raise UsageError where there can be none."""
    from ruamel.yaml import YAML

    refuse_words(results, results.axis_list)
    every = performance_maps(results, figures)
    maps = tuple(one for one in every if not one.message)
    axes = {one.path: one.units for one in quantities_along(results.axis_list) if one.path in maps[0].values}
    units = {name: results.figure(name).units for name in maps[0].fits}
    alone = results.stages.get(STAGES[0], results)  # of two stages the first
    fluid = YAML(typ="safe", pure=True).load(alone.scene_yaml)["gas"]["fluid"]
    name, blend = (fluid, is_blend(fluid)) if isinstance(fluid, str) else ("/".join(fluid), True)
    title, point = title_on_one_line(results.attributes["title"]), "dew" if blend else "bubble"
    about = units, conditions(results), axes, point, tuple(followers(results)), bool(results.stages), _missing(every)
    economized = any(each in results.figures for each in ECONOMIZED)
    return Polynomials(title, name, maps, *about, economized=economized)


def _missing(maps: Sequence[PerformanceMap]) -> tuple[str, ...]:
    """Return in words which maps there are none of, and which points of the sweep the others have to do without."""
    found = []
    for one in maps:
        at = f"at {place_in_words(one.values)}: " if one.values else ""
        none = f"no map, {one.message}" if one.message else ""
        found += [f"{at}{text}" for text in (none, one.missing_in_words) if text]
    return tuple(found)


def temperature_limits(one: PerformanceMap) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the lowest and highest value of both temperatures [°C] in the envelope of a map."""
    S, D = zip(*one.envelope, strict=True)
    return (min(S), max(S)), (min(D), max(D))


def rated_temperatures(one: PerformanceMap) -> tuple[float, float]:
    """Return the temperatures [°C] at which a map is normalised: 5/45 if in its envelope, else its middle."""
    if one.inside(RATED_TEMPERATURES["S"], RATED_TEMPERATURES["D"]).all():
        return RATED_TEMPERATURES["S"], RATED_TEMPERATURES["D"]
    points = np.array(one.envelope)
    S, D = points.mean(axis=0)
    return float(round(S, 1)), float(round(D, 1))


def quadratic(
    one: PerformanceMap, figure: Callable[[Any, Any], Any], at: tuple[float, float]
) -> tuple[tuple[float, ...], float]:
    """Return c0 + c1 S + c2 S² + c3 D + c4 D² + c5 S D of a figure over its value at a point, and the largest error.

    It is fitted to the cubic at 11 × 11 points of the envelope's box that lie inside; the error is relative to the
    cubic.
    """
    (s0, s1), (d0, d1) = temperature_limits(one)
    S, D = (x.ravel() for x in np.meshgrid(np.linspace(s0, s1, 11), np.linspace(d0, d1, 11)))
    inside = one.inside(S, D)
    S, D = S[inside], D[inside]
    wanted = np.asarray(figure(S, D)) / float(figure(*at))
    matrix = np.column_stack([np.ones_like(S), S, S**2, D, D**2, S * D])
    found, *_ = np.linalg.lstsq(matrix, wanted, rcond=None)
    return tuple(map(float, found)), float(np.max(np.abs(matrix @ found / wanted - 1.0)))


MISSING = "missing"
DOCUMENT_KEYS = ("title", "fluid", "formula", "S", "D", "units", "conditions", "follows")  # keys of a document


def document(found: Polynomials) -> dict[str, Any]:
    """Return polynomials as a JSON document, without coefficients."""
    return {
        "title": found.title,
        "fluid": found.fluid,
        "formula": FORMULA,
        "S": "evaporating temperature (dew point), degC",
        "D": f"condensing temperature ({found.condensing} point), degC",
        "units": found.units,
        "conditions": found.conditions,
        "follows": found.follows,
        **({MISSING: list(found.missing)} if found.missing else {}),
    }
