"""Output of `screwsim map`, printed and written."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from screwsim.figures.engineering import engineering, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.inputs.workbooks import TABLES
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.printing import write_json
from screwsim.printing.tables import print_scene_title, print_table, print_text
from screwsim.results import Results
from screwsim.results.atomic import make_folder
from screwsim.results.fluid_name import fluid_name
from screwsim.results.group import OWN
from screwsim.results.left_out import left_out_words, parts_left_out
from screwsim.results.protection import protect_other_json
from screwsim.results.warning_kinds import warning_kinds
from screwsim.screen import say
from screwsim.study.columns import Column, protect_other_columns, write_columns
from screwsim.study.maps.map_points import MapPoint, place_in_words
from screwsim.study.maps.performance_map import (
    COEFFICIENT_NAMES,
    ELECTRICAL,
    FORMULA,
    SHAFT,
    PerformanceMap,
    conditions,
    followers,
)

BY_INPUTS = ("by tolerances", "by_inputs")


def map_document(results: Results, maps: Sequence[PerformanceMap]) -> dict[str, Any]:
    """Return what `map --json` prints: the formula, the conditions, one map per point of the other axes."""
    figures = next(each.fits for each in maps if each.fits)
    others = _other_conventions(results, maps)
    return {
        "file": str(results.path),
        "title": results.attributes["title"],
        "formula": FORMULA,
        "S": "evaporating temperature, degC",
        "D": "condensing temperature, degC",
        **({"convention": "; ".join(others)} if others else {}),
        "units": {figure: results.figure(figure).units for figure in figures},
        "conditions": conditions(results),
        "follows": followers(results),
        "maps": [asdict(each) for each in maps],
        "warnings": [{"cases": kind.cases, "warning": kind.text} for kind in warning_kinds(results)],
    }


def _other_conventions(results: Results, maps: Sequence[PerformanceMap]) -> list[str]:
    """Return, once each, that condensing temperatures of the maps are not those of EN 12900 and AHRI 540."""
    fluid = fluid_name(results)
    return list(dict.fromkeys(filter(None, (one.other_convention(fluid) for one in maps if one.envelope))))


def print_maps(results: Results, maps: Sequence[PerformanceMap]) -> None:
    """Print the coefficients of each map with errors and envelope."""
    print_scene_title(results.attributes["title"])
    print_text(FORMULA)
    print_text("S evaporating, D condensing temperature in °C; X in the unit of its column")
    for other in _other_conventions(results, maps):
        print_text(other)
    print_text("left-out error: the largest error at a point of the fit to all others")
    if any(ELECTRICAL in each.fits for each in maps) and not any(SHAFT in each.fits for each in maps):
        print_text("power: electrical power (--figure shaft_power for the power at the shaft)")
    if any(map(_by_inputs_known, maps)):
        _print_by_inputs(results, "by tolerances")
    for each in maps:
        say()
        if each.values:
            print_text(place_in_words(each.values))
        _print_map(results, each)
    _print_warnings(results)


def _by_inputs_known(one: PerformanceMap) -> bool:
    return any(fit.by_inputs is not None for fit in one.fits.values())


def _print_by_inputs(results: Results, label: str) -> None:
    """Print what a label of intervals by tolerances means, and what they lack."""
    lost = left_out_words(_labels_left_out(results))
    without = f"; {lost} at some points, so too small there" if lost else ""
    print_text(f"{label}: half of the 95 % interval by the inputs' tolerances, mean over the points{without}")


def _labels_left_out(results: Results) -> list[str]:
    """Return the inputs that have no derivative at some point of the sweep."""
    lost = parts_left_out(results)
    if not lost.any():  # nor any inputs
        return []
    labels = results.contributions[OWN["contributions"]].tolist()
    return [label for place, label in enumerate(labels) if lost[..., place].any()]


def _print_warnings(results: Results) -> None:
    """Print the warnings of points of the sweep."""
    for kind in warning_kinds(results):
        print_text(f"warning in {counted(kind.cases, 'point')} of the sweep: {kind.text}")


def _units(results: Results, path: str) -> str:
    return next((axis.units for axis in results.axis_list if axis.path == path and axis.units != "1"), "")


def _print_map(results: Results, one: PerformanceMap) -> None:
    if one.message:
        print_text(f"no map: {one.message}")
        _print_missing(one.missing_in_words)
        return
    fits = one.fits.values()
    rows = [[name, *(f"{fit.coefficients[i]:.9e}" for fit in fits)] for i, name in enumerate(COEFFICIENT_NAMES)]
    for label, name in (("largest error", "largest"), ("rms error", "rms"), ("left-out error", "left_out"), BY_INPUTS):
        found = [getattr(fit, name) for fit in fits]
        if name != BY_INPUTS[1] or _by_inputs_known(one):
            rows.append([label, *("" if value is None else f"{100.0 * value:.2g} %" for value in found)])
    heads = ["", *(f"{shown_name(figure)} [{results.figure(figure).units}]" for figure in one.fits)]
    print_table(heads, rows, 1)
    corners = ", ".join(f"({S:g}, {D:g})" for S, D in one.envelope)
    print_text(f"{one.points} points; condition of the fit {one.condition:.2g}")
    _print_missing(one.missing_in_words)
    print_text(f"envelope (S, D): {corners} °C; the map is not valid outside it")


def _print_missing(told: str) -> None:
    """Print which points of the sweep a map does without, if any."""
    if told:
        print_text(told)


def points_document(results: Results, points: Sequence[MapPoint]) -> dict[str, Any]:
    """Return what `map --at … --json` prints: the figures at each point, in SI units."""
    return {
        "file": str(results.path),
        "title": results.attributes["title"],
        "units": {figure: results.figure(figure).units for figure in points[0].figures},
        "points": [point._asdict() for point in points],
    }


def print_points(results: Results, points: Sequence[MapPoint]) -> None:
    """Print the figures of the map at each point, in customary units."""
    print_scene_title(results.attributes["title"])
    if any(point.by_inputs for point in points):
        _print_by_inputs(results, "±")
    for point in points:
        temperatures = (point.evaporating_temperature, point.condensing_temperature)
        at = " / ".join(f"{round(T - ZERO_CELSIUS, 6):g}" for T in temperatures)
        others = place_in_words(point.values)
        say()
        print_text(f"evaporating / condensing temperature {at} °C{', ' if others else ''}{others}")
        rows = [
            (shown_name(name), *engineering(results.figure(name), value), _share(point, name))
            for name, value in point.figures.items()
        ]
        say("\n".join(f"{name:<28}{number:>12}  {unit}{share}" for name, number, unit, share in rows))
    for missing in dict.fromkeys(point.missing for point in points):
        _print_missing(missing)
    _print_warnings(results)


def _share(point: MapPoint, figure: str) -> str:
    """Return half of a figure's interval by tolerances, relative to the figure, as printed behind it."""
    half, value = point.by_inputs.get(figure), abs(point.figures[figure])
    return "" if half is None or value == 0.0 else f"  ± {100.0 * half / value:.2g} %"


def protect_other_maps(path: Path) -> None:
    """Raise UsageError where a file at `path` is not a map, as it would be lost."""
    if path.suffix.lower() in TABLES:
        protect_other_columns(path, "compressor map", "figure", "units", "largest_error", "rms_error")
        return
    protect_other_json(path, "file", "formula", "maps")


def write_maps(path: Path, results: Results, maps: Sequence[PerformanceMap]) -> None:
    """Write the maps as JSON, like `map --json`, or as a table with one row per figure."""
    if path.suffix.lower() in TABLES:
        rows = [(one, figure, fit) for one in maps for figure, fit in one.fits.items()]
        columns = {
            path: Column([one.values[path] for one, _, _ in rows], _units(results, path), path)
            for path in maps[0].values
        }
        columns["figure"] = Column([figure for _, figure, _ in rows], "", "figure")
        columns["units"] = Column([results.figure(figure).units for _, figure, _ in rows], "", "its unit")
        for number, name in enumerate(COEFFICIENT_NAMES):
            columns[name] = Column([fit.coefficients[number] for _, _, fit in rows], "1", name)
        for name in ("largest", "rms", "left_out"):
            columns[f"{name}_error"] = Column([getattr(fit, name) for _, _, fit in rows], "1", f"{name} relative error")
        if any(map(_by_inputs_known, maps)):
            told = "relative half of the 95 % interval by the inputs' tolerances, mean over the points"
            columns[BY_INPUTS[1]] = Column([fit.by_inputs for _, _, fit in rows], "1", told)
        write_columns(path, "compressor map", columns)
        return
    make_folder(path.parent)
    write_json(map_document(results, maps), path)
