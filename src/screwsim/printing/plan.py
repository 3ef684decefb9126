"""Output of `screwsim plan`, printed and written."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import figure_unit
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import BadSheet, read_sheet
from screwsim.inputs.suggestions import counted
from screwsim.inputs.textfiles import Unreadable
from screwsim.outputs.display import picked
from screwsim.printing.tables import print_left_out, print_scene_title, print_table, print_text, print_wrapped
from screwsim.results.atomic import FOREIGN_FILE, check_target_kind, make_folder
from screwsim.results.protection import first_line
from screwsim.results.tables import write_table
from screwsim.scene import Scene
from screwsim.screen import say
from screwsim.study.asked.figure_units import CELSIUS, units_of
from screwsim.study.asked.inputs import in_customary, unit_of_change
from screwsim.study.calibration.columns import UNCERTAINTY_SUFFIX
from screwsim.study.calibration.plan import Plan, point_name
from screwsim.study.uncertainty.spreads import not_included

MOST_DEVIATIONS = 6  # most points for which the table shows the deviations


def plan_document(found: Plan) -> dict[str, Any]:
    """Return what `plan --json` prints, in SI units."""
    paths = [parameter.path for parameter in found.fit.parameters]
    return {
        "title": found.fit.title,
        **picked(found, "status", "message", "values", "candidates"),
        **picked(found, known_by_bounds_alone="even", uncertain_inputs="inputs"),
        "left_out": dict(found.left_out),
        "deviations": dict(zip(paths, found.before, strict=True)) if found.before else {},
        "points": [
            {
                "name": step.point.name,
                "conditions": dict(step.point.values),
                "uncertainties": {name: one.uncertainty for name, one in step.point.measured.items()},
                "gain": step.gain,
                "deviations": dict(zip(paths, step.deviations, strict=True)),
            }
            for step in found.steps
        ],
        **picked(found, without_solution="reasons", nothing_delivered="idle"),
        "without_derivative": dict(found.unsure),
        **picked(found, "solutions", failed_solutions="failed"),
    }


def print_plan(found: Plan) -> None:
    """Print the points in their order, and how well each parameter is known with them."""
    fit = found.fit
    print_scene_title(fit.title or fit.scene.title)
    print_text(f"{counted(len(fit.fitted), 'point')}, {found.candidates} candidates, {found.solutions} solutions")
    print_left_out(found.reasons)
    if not found.steps:
        print_text(f"{found.status}: {found.message}")
        return
    say()
    rows = [[f"{i}", step.point.name, f"{step.gain:.3f}"] for i, step in enumerate(found.steps, 1)]
    print_table(["", "measure next", "gain"], rows, 2)
    say()
    numbers = [*range(1, min(len(found.steps), MOST_DEVIATIONS)), len(found.steps)]
    shown = [found.steps[number - 1] for number in numbers]
    heads = ["standard deviation", "now", *(f"with {number}" for number in numbers), "", "less by"]
    rows = [_row(found, i, [found.before, *(each.deviations for each in shown)]) for i in range(len(fit.parameters))]
    print_table(heads, rows, 1)
    say()
    print_wrapped(_plan_notes(found))


def _row(found: Plan, index: int, deviations: Sequence[Sequence[float]]) -> list[str]:
    parameter = found.fit.parameters[index]
    per, unit = unit_of_change(found.fit.scene, parameter.path, found.values[parameter.path])
    cells = [f"{per * deviation[index]:.3g}" for deviation in deviations]
    less = 1.0 - deviations[-1][index] / deviations[0][index]
    return [found.fit.short_names()[parameter.path], *cells, unit, f"{100.0 * less:.0f} %"]


def _plan_notes(found: Plan) -> Iterator[str]:
    first = found.steps[0].point
    if first.name == point_name(found.fit.scene, first.values):
        absolute = "; pressures are absolute" if any(path.endswith("pressure") for path in first.values) else ""
        yield f"points: {', '.join(first.values)}{absolute}"
    yield "gain: decrease of the logarithm of the volume of possible parameter values"
    if found.even:
        names = found.fit.short_names()
        yield f"constrained so far by their bounds only: {', '.join(names[path] for path in found.even)}"
    if found.idle:
        yield f"not considered because nothing is delivered there: {'; '.join(found.idle)}"
    if found.unsure:
        yield f"warning: not considered, as an input has no derivative there: {'; '.join(found.unsure.values())}"
    if found.inputs:
        yield f"not known exactly, and not determined: {', '.join(found.inputs)}"
    yield from (f"warning: {text}" for text in not_included(found.left_out))


def protect_measured(path: Path) -> None:
    """Raise UsageError where a file at `path` is not a plan, or has measured figures filled in."""
    check_target_kind(path)
    heads = [re.split(r" *[\[(]", head, maxsplit=1)[0] for head in first_line(path)]
    figures = [number for number, head in enumerate(heads) if f"{head}{UNCERTAINTY_SUFFIX}" in heads]
    if heads and not figures:
        raise UsageError(FOREIGN_FILE.format(path))
    if heads:
        try:
            rows = read_sheet(path).rows
        except (Unreadable, BadSheet):
            raise UsageError(FOREIGN_FILE.format(path)) from None
        if any(row.cells[number] for row in rows for number in figures):
            raise UsageError(f"{path}: holds measured figures, which would be overwritten (choose another -o)")


def write_plan(path: Path, found: Plan) -> str:
    """Write the points as the data file of a fit, with the figures still to be measured."""
    make_folder(path.parent)
    scene = found.fit.scene
    conditions = list(dict.fromkeys(name for step in found.steps for name in step.point.values))
    figures = list(dict.fromkeys(name for step in found.steps for name in step.point.measured))
    heads = ["name", *(_head(scene, name, found) for name in conditions)]
    units = {name: _written_unit(found, name) for name in figures}
    for name, (head, unit, _) in units.items():
        heads += [f"{name}{_in_brackets(head)}", f"{name}_uncertainty{_in_brackets(unit)}"]
    rows = []
    for step in found.steps:
        cells: list[Any] = [step.point.name]
        values = (in_customary(scene, name, step.point.values[name])[0] for name in conditions)
        cells += [f"{value:.10g}" if isinstance(value, float) else str(value) for value in values]
        for name in figures:
            one = step.point.measured.get(name)
            cells += ["", "" if one is None else f"{one.uncertainty / units[name][2]:.3g}"]
        rows.append(cells)
    return write_table(path, heads, rows)


def _head(scene: Scene, path: str, found: Plan) -> str:
    value = next(step.point.values[path] for step in found.steps if path in step.point.values)
    return path + _in_brackets(in_customary(scene, path, value)[1].replace("°C", CELSIUS))


def _in_brackets(unit: str) -> str:
    return f" [{unit}]" if unit else ""


def _written_unit(found: Plan, figure: str) -> tuple[str, str, float]:
    """Return the customary unit of a figure and that of its uncertainty, as data of a fit state them, with its factor.

    It is that of the largest value measured so far, or the SI unit where such data do not know it.
    """
    about, known = declared(figure), units_of(figure)
    if about.units == "K":
        return CELSIUS, "K", 1.0
    sizes = [abs(point.measured[figure].value) for point in found.fit.points if figure in point.measured]
    unit = figure_unit(about, max(sizes, default=0.0))[1].replace("³", "^3").replace("²", "^2")
    if unit not in known:
        unit = next(name for name, factor in known.items() if factor == 1.0)
    return unit, unit, known[unit]
