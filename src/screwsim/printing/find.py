"""Output of `screwsim find`, printed and written."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import error_text, figure_text, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.outputs.customary import with_printed_units
from screwsim.outputs.display import picked
from screwsim.printing.tables import column_heads, print_scene_title, print_table, print_text, print_wrapped
from screwsim.printing.uncertain import by_inputs_line
from screwsim.scene.grid import unit_of
from screwsim.screen import say
from screwsim.study.asked.inputs import shown_range, shown_value, unit_of_change
from screwsim.study.asked.spans import BORDER_MARKS
from screwsim.study.asked.varied import Varied, leaf_of
from screwsim.study.columns import Column, error_column, figure_column, input_column, write_columns
from screwsim.study.seek import VALUE_DIGITS, GoalSeekAnswer, Question
from screwsim.study.seek.answer import Size

MOST_NOTES = 4  # most notes printed
OTHER_FIGURES = (  # for a single answer, shown beside the figures sought
    *("free_air_delivered", "package_input_power", "package_specific_power"),
    *("cooling_capacity", "shaft_power", "electrical_power", "cop", "electrical_cop"),
    *("heating_capacity", "heating_cop", "electrical_heating_cop", "intermediate_pressure"),
    *("isentropic_efficiency", "volumetric_efficiency", "discharge_temperature", "gas_mass_flow"),
)


def find_document(scene: Varied, asked: Question, rows: Sequence[GoalSeekAnswer]) -> dict[str, Any]:
    """Return what `find --json` prints: the question, one row per point of the other axes, counts; in SI units."""
    return {
        "title": scene.title,
        "vary": {span.path: {"from": span.low, "to": span.high, "start": span.start} for span in asked.spans},
        "goals": {goal.figure: goal.value for goal in asked.goals},
        "catalogue": list(asked.sizes) or None,
        "rows": [_row_document(row) for row in rows],
        "solutions": sum(row.solutions for row in rows),
        "failed_solutions": sum(row.failed for row in rows),
    }


def _row_document(row: GoalSeekAnswer) -> dict[str, Any]:
    none = {"performance": {}, "warnings": []}
    return {
        **picked(row, "at", "status", "message", "values", "uncertainties", "figures", "errors", "borders"),
        "uncertainties_by_inputs": {path: spread.as_json() for path, spread in row.by_inputs.items()},
        "size": None if row.size is None else picked(row.size, "value", "figure"),
        **(none if row.result is None else picked(row.result, "performance", "warnings")),
        **picked(row, "solutions", failed_solutions="failed"),
    }


def print_find(scene: Varied, asked: Question, rows: Sequence[GoalSeekAnswer], changed: Sequence[str] = ()) -> None:
    """Print the values for each point of the other axes, the figures there, and remarks."""
    print_scene_title(scene.title, changed)
    for span in asked.spans:
        print_text(f"{span.path}, {shown_range(scene, span.path, span.low, span.high)}")
    wanted = (f"{shown_name(goal.figure)} {figure_text(goal.figure, goal.value)}" for goal in asked.goals)
    print_text(f"for {' and '.join(wanted)}")
    say()
    if len(rows) == 1:
        _print_one(scene, asked, rows[0])
        return
    paths = list(rows[0].at)
    heads = column_heads([*paths, *(span.path for span in asked.spans)])
    due = len(asked.spans) == 1 and any(row.by_inputs for row in rows)
    heads += [
        *(["±"] if len(asked.spans) == 1 else []),
        *(["± by inputs"] if due else []),
        *(["size"] if asked.sizes else []),
    ]
    heads += [*(shown_name(goal.figure) for goal in asked.goals), "simulated"]
    print_table(heads, [_cells(scene, asked, paths, row, due) for row in rows])
    notes = [line for row in rows for line in _notes(scene, paths, row)]
    print_wrapped(notes[:MOST_NOTES])
    if len(notes) > MOST_NOTES:
        say(f"… and {len(notes) - MOST_NOTES} more (all with --json, or in the file of -o)")


def _cells(scene: Varied, asked: Question, paths: Sequence[str], row: GoalSeekAnswer, due: bool) -> list[str]:
    """Return the cells of a row; with `due` that of the uncertainty by the inputs' tolerances."""
    cells = [shown_value(scene, path, row.at[path]) for path in paths]
    ok = row.status == "ok"
    for span in asked.spans:
        shown = shown_value(scene, span.path, row.values[span.path], 5) if row.values else ""
        mark = BORDER_MARKS[row.borders.get(span.path, "")]
        cells.append((shown + mark) if ok else row.status)
        if len(asked.spans) == 1:
            cells.append(_difference_text(scene, span.path, row.uncertainties.get(span.path)) if ok else "")
        if due:
            spread = row.by_inputs.get(span.path)
            cells.append(_difference_text(scene, span.path, None if spread is None else spread.expanded, 2))
    if asked.sizes:
        cells.append("" if row.size is None else shown_value(scene, asked.spans[0].path, row.size.value))
    for goal in asked.goals:
        value = row.size.figure if row.size else row.figures.get(goal.figure)
        cells.append("" if value is None else figure_text(goal.figure, value))
    return [*cells, str(row.solutions)]


def _notes(scene: Varied, paths: Sequence[str], row: GoalSeekAnswer) -> Iterator[str]:
    where = ", ".join(shown_value(scene, path, row.at[path]) for path in paths)
    if row.message:
        yield f"{where}: {row.message}" if where else row.message


def _print_one(scene: Varied, asked: Question, row: GoalSeekAnswer) -> None:
    """Print one answer, with other figures beside those that were sought."""
    if row.status == "ok":
        for span in asked.spans:
            say(f"{span.path} = {_value(scene, asked, span.path, row)}")
            print_wrapped(_by_inputs(scene, span.path, row))
        if row.size is not None:
            _print_size(scene, asked, row)
        say()
        figures = list(_figures(asked, row))
        width = max(22, *(len(name) for name, _ in figures)) + 2
        for name, text in figures:
            say(f"  {name:<{width}}{text}")
        say()
    print_wrapped(_notes(scene, (), row))
    if row.status == "ok" and row.result is not None:
        print_wrapped(f"warning: {warning}" for warning in row.result.warnings)
    failed = f", {row.failed} of them without the figures" if row.failed else ""
    say(f"{counted(row.solutions, 'point')} simulated{failed}")


def _print_size(scene: Varied, asked: Question, row: GoalSeekAnswer) -> None:
    assert row.size is not None
    path, goal = asked.spans[0].path, asked.goals[0]
    over = f"{100.0 * (row.size.figure / goal.value - 1.0):+.1f} %" if declared(goal.figure).units != "K" else ""
    gives = f"{shown_name(goal.figure)} {figure_text(goal.figure, row.size.figure)}"
    print_text(f"next size of the catalogue: {shown_value(scene, path, row.size.value)}, {gives} {over}".rstrip())


def _value(scene: Varied, asked: Question, path: str, row: GoalSeekAnswer) -> str:
    text, width = shown_value(scene, path, row.values[path], VALUE_DIGITS), row.uncertainties.get(path)
    if row.size is not None and not row.uncertainties:
        return f"{text} ({row.borders.get(path, 'nearest')}: {_why_not_met(asked, row.size)})"
    return f"{text} ± {_difference_text(scene, path, width)}" if width is not None else text


def _by_inputs(scene: Varied, path: str, row: GoalSeekAnswer) -> Iterator[str]:
    """Yield the uncertainty of a value by the tolerances of other inputs, and those that contribute most."""
    if path in row.by_inputs and row.by_inputs[path].standard:
        spread = row.by_inputs[path]
        yield by_inputs_line(_difference_text(scene, path, spread.expanded, 2), spread)


def _why_not_met(asked: Question, size: Size) -> str:
    """Return why no value meets the goal, though a size is beyond it: every size is, or the figure leaps over it."""
    (goal,) = asked.goals
    if size.value > asked.sizes[0]:
        return "no value gives the goal itself"
    return f"every size gives {'more' if size.figure > goal.value else 'less'} than the goal"


def _difference_text(scene: Varied, path: str, width: float | None, digits: int = 1) -> str:
    """Return a difference of a path's values in its customary unit, with so many digits."""
    if width is None:
        return ""
    per, unit = unit_of_change(scene, path, 1.0)  # in the unit of the value, not in µm
    return f"{per * width:.{digits}g} {with_printed_units(unit)}".strip()


def _figures(asked: Question, row: GoalSeekAnswer) -> Iterator[tuple[str, str]]:
    """Yield the figures sought with their errors, then some of the others; for a size, those at that size."""
    performance = {} if row.result is None else row.result.performance
    sought = [goal.figure for goal in asked.goals]
    for name in sought:
        value = row.size.figure if row.size else row.figures[name]
        error = error_text(name, row.figures[name], row.errors[name])
        yield shown_name(name), f"{figure_text(name, value)}, error {error}"
    there = [name for name in OTHER_FIGURES if name not in sought and performance.get(name) is not None]
    # the COP of heating on the shaft power has the heat of a motor in the suction gas for nothing
    less = {"heating_cop"} if "electrical_heating_cop" in there else set[str]()
    for name in there:
        if name not in less:
            yield shown_name(name), figure_text(name, performance[name])


def write_find(path: Path, scene: Varied, asked: Question, rows: Sequence[GoalSeekAnswer]) -> None:
    """Write one row per point of the other axes as CSV or HDF5, in SI units."""
    columns = {axis: input_column(leaf_of(scene, axis), [row.at[axis] for row in rows]) for axis in rows[0].at}
    for span in asked.spans:
        leaf = leaf_of(scene, span.path)
        units = unit_of(leaf)
        columns[span.path] = Column([row.values.get(span.path) for row in rows], units, f"found {leaf.doc}")
        wide = [row.uncertainties.get(span.path) for row in rows]
        columns[f"{span.path}_uncertainty"] = Column(wide, units, "uncertainty from the figures' numerical errors")
        if any(row.by_inputs for row in rows):
            due = [row.by_inputs[span.path].expanded if row.by_inputs else None for row in rows]
            what = "half of the 95 % interval by the tolerances of the scene's other inputs"
            columns[f"{span.path}_by_inputs"] = Column(due, units, what)
    for goal in asked.goals:
        columns[goal.figure] = figure_column(goal.figure, [row.figures.get(goal.figure) for row in rows])
        columns[f"{goal.figure}_error"] = error_column(goal.figure, [row.errors.get(goal.figure) for row in rows])
    if asked.sizes:
        values = [None if row.size is None else row.size.value for row in rows]
        columns["size"] = Column(values, unit_of(leaf_of(scene, asked.spans[0].path)), "next size of the catalogue")
        gives = [None if row.size is None else row.size.figure for row in rows]
        columns["size_figure"] = Column(gives, declared(asked.goals[0].figure).units, "figure at that size")
    columns["solutions"] = Column([row.solutions for row in rows], "1", "number of solutions")
    columns["failed_solutions"] = Column([row.failed for row in rows], "1", "number of solutions without the figures")
    columns["status"] = Column([row.status for row in rows], "", "ok, none (in the ranges), or failed")
    messages = [row.message for row in rows]
    columns["message"] = Column(messages, "", "how close the search came, and why solutions failed")
    write_columns(path, "goal seek", columns)
