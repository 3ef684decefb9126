"""Tables of a sheet over two quantities: one per figure, part load, envelope.

Also the lines and notes that sheets of several kinds share: limits, highest figures, warnings of points.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from screwsim.figures.engineering import shown_name
from screwsim.outputs import Result
from screwsim.outputs.display import picked
from screwsim.scene import Scene
from screwsim.scene.lines import lines
from screwsim.scene.operation import CONDENSING, SPEED
from screwsim.study.datasheet.bearing_lives import lives_document
from screwsim.study.datasheet.bounds import exceeded_bounds, limit_text, limits_document
from screwsim.study.datasheet.columns import GAS_OUT, MIXTURE, NONE, Column
from screwsim.study.datasheet.machine_lines import Lines, limits_in_words
from screwsim.study.datasheet.marks import BLANK, Marks, marks_of
from screwsim.study.datasheet.rated import Axis, Rating
from screwsim.study.datasheet.sheet import Curve, Drawing, Table, warning_lines
from screwsim.study.datasheet.units import Units
from screwsim.study.part_load import GAS, LoadStep, PartLoad

AS_ABOVE = "marks: as above"
TablePlace = tuple[int, int]  # indices on the axes across and down


def shown_at(axis: Axis, value: float, units: Units) -> str:
    """Return a value of an axis in words: a temperature, a speed, or a pressure."""
    if axis.path.endswith("temperature"):
        return units.degrees(value)
    return units.quantity("rad s-1" if axis.path.endswith("speed") else "Pa", value)


def place_of(rated: Rating, i: int, j: int) -> str:
    """Return a point of the table in words."""
    asked = rated.asked
    axes = zip((asked.across, asked.down), (i, j), strict=True)
    first, second = (shown_at(axis, axis.values[k], asked.units) for axis, k in axes)
    unit = second.rpartition(" ")[2]
    return f"{first.removesuffix(f' {unit}')}/{second}" if first.endswith(f" {unit}") else f"{first}, {second}"


def inlet_in_words(scene: Scene, units: Units) -> str:
    """Return pressure and temperature of the suction line."""
    at = lines(scene)
    return f"{units.quantity('Pa', at.p_s)}, {units.degrees(at.T_s)}"


def point_in_words(rated: Rating, columns: Sequence[Column]) -> str:
    """Return the three main figures of a refrigeration machine at its own point; why it has none."""
    if rated.own.status != "ok":
        return rated.own.told
    capacity, power, cop = (column.cell(rated.own.performance) for column in columns[:3])
    cold, unit = (column.unit for column in columns[:2])
    return f"{capacity} {cold} of cooling, {power} {unit} of {power_in_words(columns)}, COP {cop}"


def power_in_words(columns: Sequence[Column]) -> str:
    """Return which power the second of the main columns has: 'shaft power'."""
    return columns[1].title.split(" [")[0].lower()


def main_heads(rated: Rating, columns: Sequence[Column]) -> list[tuple[str, Column]]:
    """Return the heads of the three main columns of a sheet: capacity or flow, power, COP or efficiency."""
    what, best = ("flow", "η_s %") if rated.asked.aim == GAS else ("capacity", "COP")
    first, power = f"{what} {columns[0].unit}", f"{columns[1].title.split()[0].lower()} {columns[1].unit}"
    return list(zip((first, power, best), columns, strict=False))


def tables_of(rated: Rating, columns: Sequence[Column]) -> Iterator[Table]:
    """Yield the table of each column."""
    asked, marks = rated.asked, _marks(rated)
    across = [shown_at(asked.across, value, asked.units).replace(" ", BLANK) for value in asked.across.values]
    down = [shown_at(asked.down, value, asked.units) for value in asked.down.values]
    places = [(i, j) for j in range(len(down)) for i in range(len(across))]
    results = [rated.points.get(place) for place in places]
    signs, note = marks.column(results), marks.note(results, asked.units)
    for k, column in enumerate(columns):
        cells = [_cell(column, result, sign) for result, sign in zip(results, signs, strict=True)]
        rows = [[value, *cells[j * len(across) : (j + 1) * len(across)]] for j, value in enumerate(down)]
        yield Table(column.title, [asked.sides[1], *across], rows, AS_ABOVE if note and k else note)


def _marks(rated: Rating) -> Marks:
    """Return the marks of all points over the table and of part load."""
    loads = (step.result for load in rated.loads for step in load.steps)
    return marks_of(rated.asked.bounds, [*rated.points.values(), *loads])


def _cell(column: Column, result: Result | None, sign: str) -> str:
    """Return the text at one point of a table."""
    if result is None:
        return ""
    return column.cell(result.performance) + sign if result.status == "ok" else NONE


def part_load_table(
    rated: Rating, main: Sequence[Column], more: Sequence[tuple[str, Column]], note: str, there: str = ""
) -> Iterator[Table]:
    """Yield the table of part loads: the three main columns of a sheet, more of them with their heads.

    The best built-in ratio comes with the third of the main columns, whose head is then `there`.
    """
    columns = [*main_heads(rated, main), *more]
    heads = ["control", "load %", "setting", *(head for head, _ in columns)]
    heads += ["best Vi", there] if rated.asked.ratios else []
    rows: list[list[str]] = []
    marks, results = _marks(rated), [step.result for load in rated.loads for step in load.steps]
    signs = iter(marks.column(results))
    for load in rated.loads:
        for k, step in enumerate(load.steps):
            setting = rated.asked.shown(load.control.path, step.setting, 4)
            cells = [column.cell(step.result.performance) for _, column in columns]
            if rated.asked.ratios:
                better = step.best.performance if step.best is not None else {}
                cells += [NONE if step.ratio is None else f"{step.ratio:.2f}", main[2].cell(better)]
            name = load.control.name if k == 0 else ""
            rows.append([name, f"{100.0 * step.load:.0f}{next(signs)}", setting, *cells])
    if rows:
        told = "; ".join(filter(None, [note, marks.note(results, rated.asked.units)]))
        yield Table("Part load at equal loads", heads, rows, told, left=1, across=True)


def envelope_table(rated: Rating, side: str = "") -> Iterator[Table]:
    """Yield the table of the envelope; `side` names the quantity within limits, by default its axis."""
    asked, rows = rated.asked, []
    for each in rated.reach:
        ends, units = (each.low, each.high), asked.units
        hot = asked.down.path == CONDENSING
        shown = (units.degrees(at, ".1f") if hot else units.quantity("Pa", at) for at in ends)
        rows.append([shown_at(asked.across, each.at, units), *shown, *each.ends_in_words(units)])
    if rows:
        heads = (asked.sides[0], "from", "to", "lower end", "upper end")
        yield Table(f"Envelope: {side or asked.axes_in_words[1]} within all limits", heads, rows)


def part_load_note(rated: Rating, load: str, best: str) -> str:
    """Return the note on what a part load is a share of, and what the best built-in volume ratio maximises.

    It names the ratios at which no best one was sought, and why.
    """
    note, ratios = f"load: {load}", rated.asked.ratios
    if not ratios:
        return note
    within = f"{ratios[0]:.3g} … {ratios[-1]:.3g}"
    note = f"{note}; best Vi: machine.built_in_volume_ratio of the best {best} at that load, within {within}"
    missed = {ratio: why for each in rated.loads for step in each.steps for ratio, why in step.missed.items()}
    if not missed:
        return note
    named = ", ".join(f"{ratio:.3g}" for ratio in sorted(missed))
    why = missed[min(missed)].splitlines()[0]
    return f"{note}; not all points were solved at {named}, so a better one may be missed ({why})"


def drawings_over_across(rated: Rating, columns: Sequence[Column]) -> Iterator[Drawing]:
    """Yield a drawing of each column over the axis across, with one curve per value down."""
    asked, units = rated.asked, rated.asked.units
    hot = asked.across.kind == "temperature"
    places = [
        (units.temperature(x) if hot else units.pressure.factor * x, i) for i, x in enumerate(asked.across.values)
    ]
    down = enumerate(asked.down.values)
    rows = [(shown_at(asked.down, value, units), [(x, (i, j)) for x, i in places]) for j, value in down]
    label = f"{asked.axes_in_words[0]} [{units.degree if hot else units.pressure.unit}]"
    for column in columns:
        yield from drawing(rated, column, label, asked.sides[1], rows)


def drawing(
    rated: Rating, column: Column, x_label: str, by: str, rows: Sequence[tuple[str, Sequence[tuple[float, TablePlace]]]]
) -> Iterator[Drawing]:
    """Yield a drawing of a column, with one curve per row (name, [(x, place)]) of two points or more.

    `by` precedes the name of the first curve.
    """
    curves = []
    for name, places in rows:
        known = [(x, rated.points[place]) for x, place in places if place in rated.points]
        good = [(x, column.value(one.performance) or 0.0) for x, one in known if has_figure(one, column)]
        if len(good) > 1:
            x, y = zip(*good, strict=True)
            curves.append(Curve(x, y, name if curves else f"{by} {name}"))
    if curves:
        yield Drawing(column.title, x_label, column.title, curves)


def part_load_drawing(rated: Rating, column: Column, title: str) -> Iterator[Drawing]:
    """Yield a drawing over the load, with one curve per control; nothing where none has two points."""
    curves = []
    for part in (load for load in rated.loads if len(load.curve) > 1):
        there = (step for step in (*part.curve, *part.steps) if has_figure(step.result, column))
        steps = sorted({step.load: step for step in there}.items())
        y = [column.value(step.result.performance) or 0.0 for _, step in steps]
        curves.append(Curve([100.0 * load for load, _ in steps], y, part.control.name))
    if curves:
        yield Drawing(title, "load [%]", title, curves)


def has_figure(result: Result, column: Column) -> bool:
    """Return whether a result has a column's figure."""
    return result.status == "ok" and result.performance.get(column.figure) is not None


def document_figures(result: Result, names: Sequence[str]) -> dict[str, Any]:
    """Return the parts of a result that a sheet's document keeps."""
    found = {name: result.performance[name] for name in names if name in result.performance}
    return picked(result, "status", "message", "warnings") | found


def document_of(rated: Rating, names: Sequence[str], own: str) -> dict[str, Any]:
    """Return points, limits, envelope, part load and bearings for programs (SI units).

    `own` is the scene's point in words.
    """
    rated = rated.in_metric
    asked = rated.asked
    first, second = (axis.path.removeprefix("operation.").replace(".", "_") for axis in (asked.across, asked.down))
    points = []
    for (i, j), result in rated.points.items():
        out = exceeded_bounds(result.performance, asked.bounds) if result.status == "ok" else []
        at = {first: asked.across.values[i], second: asked.down.values[j]}
        points.append({**at, **document_figures(result, names), "beyond": [bound.figure for bound in out]})
    every = (rated.own, *rated.points.values(), *(step.result for load in rated.loads for step in load.steps))
    return {
        "own_point": document_figures(rated.own, names),
        "points": points,
        "limits": limits_document(asked.bounds),
        "envelope": [
            {first: each.at, second: [each.low, each.high], "ends": [*each.ends_in_words()]} for each in rated.reach
        ],
        "part_load_of": asked.aim.load,
        "part_load": [_control(load, names) for load in rated.loads],
        **lives_document(*points_within_limits(rated, own)),
        "warnings": list(dict.fromkeys(text for result in every for text in result.warnings)),
    }


def _control(each: PartLoad, names: Sequence[str]) -> dict[str, Any]:
    steps = [
        {"load": step.load, "setting": step.setting, **document_figures(step.result, names), **_best_ratio(step, names)}
        for step in each.steps
    ]
    about = {"control": each.control.name, "path": each.control.path, "least_load": each.least, "message": each.why}
    return {**about, "loads": steps}


def _best_ratio(step: LoadStep, names: Sequence[str]) -> dict[str, Any]:
    """Return the built-in volume ratio of the best COP at a part load, and the figures there."""
    missed = {"missed_volume_ratios": {f"{ratio:g}": why for ratio, why in step.missed.items()}} if step.missed else {}
    if step.best is None:
        return missed
    return {"best_volume_ratio": {"ratio": step.ratio, **document_figures(step.best, names)}, **missed}


def limit_lines(rated: Rating, figures: Sequence[str]) -> Lines:
    """Yield the limits, and the highest values of figures over the table."""
    units = rated.asked.units
    yield from limits_in_words(rated.asked.bounds, units)
    highest = [f"{_named(rated, name)} {_highest(rated, name)}" for name in figures if _highest(rated, name)]
    if highest:
        yield "highest", f"over the table: {', '.join(highest)}"


def _named(rated: Rating, figure: str) -> str:
    """Return a figure's name; the temperature of the gas is that of the gas alone beside that of the mixture."""
    alone = figure == GAS_OUT and _highest(rated, MIXTURE)
    return f"{shown_name(figure)} of the gas alone" if alone else shown_name(figure)


def control_line(rated: Rating) -> Lines:
    """Yield the controls of the capacity."""
    yield "control", ", ".join(control.name for control in rated.asked.controls) or "none that the scene names"


def _highest(rated: Rating, figure: str) -> str:
    every = [(result.performance.get(figure), at) for at, result in rated.points.items() if result.status == "ok"]
    known = [(value, at) for value, at in every if value is not None]
    if not known:
        return ""
    value, (i, j) = max(known)
    return f"{limit_text(figure, value, rated.asked.units)} at {place_of(rated, i, j)}"


def points_within_limits(rated: Rating, own: str) -> tuple[list[tuple[str, Result]], bool]:
    """Return the results of the own point, and of those of table and part load within all limits, with their names.

    Second: whether the own point is within them, too.
    """
    points = [(own, rated.own), *_named_points(rated)]
    within = [not exceeded_bounds(one.performance, rated.asked.bounds) for _, one in points]
    return [points[0], *(each for each, inside in zip(points[1:], within[1:], strict=True) if inside)], within[0]


def _named_points(rated: Rating) -> Iterator[tuple[str, Result]]:
    """Yield the results over the table, and of part load below full load."""
    yield from ((place_of(rated, i, j), result) for (i, j), result in rated.points.items())
    for each in rated.loads:
        yield from ((f"{each.control.name} at {100.0 * step.load:.0f} %", step.result) for step in each.steps[1:])


def notes_of(rated: Rating, own: str, meant: str) -> Iterator[str]:
    """Yield failures and warnings of points, each once with its place; `own` is the scene's point in words."""
    every = [(own, rated.own), *_named_points(rated)]
    failed = [(where, [result.told]) for where, result in every if result.status != "ok"]
    yield from warning_lines(failed, len(every))
    for each in rated.loads:
        if each.why:
            yield f"{each.control.name}: no part load below {100.0 * each.least:.0f} %: {each.why}"
    warned = [(where, result.warnings) for where, result in every if result.status == "ok"]
    yield from warning_lines(warned, len(every))
    if SPEED in {control.path for control in rated.asked.controls} and not rated.asked.inverts:
        yield "part load by speed excludes inverter losses (effects.motor.inverter)"
    yield meant
