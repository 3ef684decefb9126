"""The points of a sweep of two stages as a sheet: a table, drawings over one axis, all figures as a document."""

from collections.abc import Iterator, Sequence
from typing import Any

from screwsim.figures.engineering import shown_name
from screwsim.outputs.customary import HOUR, MINUTE, with_printed_units
from screwsim.outputs.display import grouped
from screwsim.scene import grid
from screwsim.study.asked.inputs import in_customary
from screwsim.study.datasheet.columns import KW, NONE, PERCENT, Column, decimals_of
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, Table, warning_lines
from screwsim.study.datasheet.stages_air import STAGE_HEADS, is_air_package
from screwsim.study.datasheet.stages_rating import refrigerates
from screwsim.study.datasheet.tables import document_figures
from screwsim.study.stages.axes import leaf_in_chain
from screwsim.study.stages.chain import StageChain
from screwsim.study.stages.store import ChainPoint

MOST_CURVES = 8  # in a drawing
AIR_COLUMNS = (
    Column("free_air_delivered", "m³/min", MINUTE, 2),
    Column("package_input_power", "kW", KW, 1),
    Column("package_specific_power", "kW/ (m³/min)", KW / MINUTE, 2),
)


def points_sheet(chain: StageChain, points: Sequence[ChainPoint], reused: int = 0) -> Sheet:
    """Return the points of a chain's sweep as a sheet; `reused` of them are from an earlier run."""
    names, ok = list(chain.sweep), [point.result.status == "ok" for point in points]
    earlier = f" ({reused} from an earlier run)" if reused else ""
    columns = _columns(chain, points)
    heads = [*(_head(chain, name) for name in names), "status", *(column.title for column in columns)]
    rows = [
        [
            *(_cell(chain, name, point.values[name]) for name in names),
            point.result.status.replace("_", " "),
            *(column.cell(point.result.performance) if good else NONE for column in columns),
        ]
        for point, good in zip(points, ok, strict=True)
    ]
    return Sheet(
        heading=f"Two stages, {len(points)} points over {', '.join(names)}",
        title=with_printed_units(chain.title),
        lines=[("points", f"{len(points)}: {sum(ok)} ok, {len(points) - sum(ok)} without a result{earlier}")],
        tables=[Table("Points", heads, rows, across=True)],
        notes=list(_notes(chain, points)),
        drawings=list(_drawings(chain, points, columns[: 4 if is_air_package(chain) else 3])),
        document=_document(chain, points),
        ok=all(ok),
    )


def _columns(chain: StageChain, points: Sequence[ChainPoint]) -> list[Column]:
    """Return the columns of the table: what the chain is for, then what each stage does."""
    figures = [point.result.performance for point in points if point.result.status == "ok"]

    def decimals(name: str, factor: float) -> int:
        return decimals_of(factor * max((abs(each.get(name) or 0.0) for each in figures), default=1.0))

    motors = any(each.get("electrical_power") is not None for each in figures)
    power = "electrical_power" if motors else "shaft_power"
    word = Column(power, f"{power.split('_')[0]} kW", KW, decimals(power, KW))
    if is_air_package(chain):
        main = [*AIR_COLUMNS]
    elif refrigerates(chain):
        capacity = Column("cooling_capacity", "cooling kW", KW, decimals("cooling_capacity", KW))
        main = [capacity, word, Column("electrical_cop" if motors else "cop", "COP", 1.0, 3)]
    else:
        flow = Column("gas_mass_flow", "flow kg/h", HOUR, decimals("gas_mass_flow", HOUR))
        main = [flow, word, Column("isentropic_efficiency", "η_s %", PERCENT, 2)]
    return [*main, *(column for column in STAGE_HEADS if any(column.figure in each for each in figures))]


def _head(chain: StageChain, name: str) -> str:
    unit = with_printed_units(in_customary(chain, name, 1.0)[1])
    words = name.replace(".operation.", ".").replace(".", " ").replace("_", " ")
    return f"{words} [{unit}]" if unit else words


def _cell(chain: StageChain, name: str, value: Any) -> str:
    number, _ = in_customary(chain, name, value)
    return f"{number:.5g}" if isinstance(number, int | float) else str(number)


def _where(chain: StageChain, point: ChainPoint) -> str:
    parts = []
    for name, value in point.values.items():
        unit = with_printed_units(in_customary(chain, name, value)[1])
        parts.append(f"{name} {_cell(chain, name, value)} {unit}".rstrip())
    return ", ".join(parts)


def _notes(chain: StageChain, points: Sequence[ChainPoint]) -> Iterator[str]:
    """Yield failures and warnings, those of the same kind once, at their first point."""
    named = [(_where(chain, point), point.result) for point in points]
    yield from warning_lines([(where, [one.told]) for where, one in named if one.status != "ok"], len(points))
    yield from warning_lines([(where, one.warnings) for where, one in named if one.status == "ok"], len(points))
    along = _along(chain)
    count = len(_curves(points, along)) if along else 0
    if count > MOST_CURVES and any(point.result.status == "ok" for point in points):
        yield f"pages and PDFs draw {MOST_CURVES} of {count} curves (the table has all points)"


def _drawings(chain: StageChain, points: Sequence[ChainPoint], columns: Sequence[Column]) -> Iterator[Drawing]:
    """Yield a drawing of each column over the longest axis of numbers, a curve per value of the others."""
    along = _along(chain)
    if not along:
        return
    path, curves = along[0], [*_curves(points, along).items()][:MOST_CURVES]
    for column in columns:
        found = [_curve(chain, path, column, beside, each) for beside, each in curves]
        drawn = [curve for curve in found if len(curve.x) > 1]
        if drawn:
            title = _title(column)
            yield Drawing(title, _head(chain, path), title, drawn)


def _along(chain: StageChain) -> tuple[str, ...]:
    """Return the paths of the longest axis of numbers; none where there is no such axis, or points are a sample."""
    longest = sorted(grid.dimensions(chain), key=lambda each: -each.size)
    if any(each.joint and each.joint.sample for each in longest):
        return ()
    return next((each.paths for each in longest if isinstance(chain.sweep[each.paths[0]][0], int | float)), ())


def _curves(points: Sequence[ChainPoint], along: Sequence[str]) -> dict[tuple[tuple[str, Any], ...], list[ChainPoint]]:
    """Return the points of each curve by the values of the other paths."""
    return grouped((tuple(each for each in point.values.items() if each[0] not in along), point) for point in points)


def _title(column: Column) -> str:
    """Return the name of a column's figure with its unit, the last word of its head."""
    unit, name = column.title.replace("/ (", "/(").split(" ")[-1], shown_name(column.figure)
    name = f"{name[0].upper()}{name[1:]}"
    return name if unit == "COP" else f"{name} [{unit}]"


def _curve(
    chain: StageChain, path: str, column: Column, beside: Sequence[tuple[str, Any]], points: Sequence[ChainPoint]
) -> Curve:
    good = [point for point in points if point.result.status == "ok" and point.result.performance.get(column.figure)]
    pairs = sorted(
        (float(in_customary(chain, path, point.values[path])[0]), column.value(point.result.performance) or 0.0)
        for point in good
    )
    name = ", ".join(f"{_head(chain, one)} {_cell(chain, one, value)}" for one, value in beside)
    return Curve([x for x, _ in pairs], [y for _, y in pairs], name)


def _document(chain: StageChain, points: Sequence[ChainPoint]) -> dict[str, Any]:
    """Return values and figures [SI] of all points for programs, with the estimated error of each figure."""
    kinds = {name: leaf_in_chain(chain, name).dimension for name in chain.sweep}
    return {
        "kind": "two_stage_points",
        "title": chain.title,
        "axes": {name: None if kind is None else kind.name for name, kind in kinds.items()},
        "cases": len(points),
        "ok": sum(point.result.status == "ok" for point in points),
        "points": [_point(point) for point in points],
    }


def _point(point: ChainPoint) -> dict[str, Any]:
    result = point.result
    errors = {f"{name}_error": error for name, error in result.error.items() if error is not None}
    spread = {f"{name}_uncertainty": each["expanded"] for name, each in result.uncertainty.get("figures", {}).items()}
    found = document_figures(result, list(result.performance))
    return {**point.values, **found, **errors, **spread, "notes": dict(result.notes)}
