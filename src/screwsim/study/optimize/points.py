"""Operating points over which figures are weighted: from a CSV file, or those of a seasonal figure given by name."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import Row, name_and_unit, read_sheet, sheet_or_usage_error
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.scene import Scene, leaf_of
from screwsim.scene.operation import CONDENSING, EVAPORATING, SPEED
from screwsim.scene.units import NUMBER, gauge_pressures_over, refused_at
from screwsim.scene.values import convert_cell
from screwsim.study.asked.inputs import check_continuous
from screwsim.study.optimize.seasons import SeasonalStandard, standards
from screwsim.study.part_load import HEATING, REFRIGERATION, LoadFigures

LEAST_CONDENSING = 20.0  # [°C] down to which a chiller's control lets condensation fall: an assumption of ours
LEAST_APPROACH = 1.0  # [K] between water or air and refrigerant at full load
MOST_POINTS = 100  # points per file
_HEATING = "heating_"  # before the names of columns of loads and energies of heating
_OF_A_FILE = "from a file, work over capacity is interpolated between points, where the standard interpolates the COP"
_EXAMPLE = "weight, operation.condensing_temperature [degC], load"


@dataclass(frozen=True)
class OperatingPoint:
    """One point: values [SI] by scene path, weight, and the load over the first point's, None where none is stated."""

    name: str
    values: Mapping[str, Any]
    weight: float = 1.0
    load: float | None = None


@dataclass(frozen=True)
class OperatingPoints:
    """Points with their way of averaging. Loads are reached by the path `by`.

    With `energy` the weights are shares of the cooling energy, so that an overall COP is cooling over work; else
    figures are averaged. With `heating` loads and energies are those of the heating capacity. `bins` are those of the
    standard.
    """

    name: str
    points: tuple[OperatingPoint, ...]
    energy: bool = False
    by: str = SPEED
    told: tuple[str, ...] = ()  # how the conditions of a chiller or heat pump were converted to the compressor's
    heating: bool = False
    bins: tuple[tuple[float, ...], ...] = ()

    @property
    def aim(self) -> LoadFigures:
        """Figure of which a load is a share, and the one of heat over work."""
        return HEATING if self.heating else REFRIGERATION

    @property
    def cops(self) -> tuple[str, str]:
        """Figures that are heat over work, at the shaft and at the motor."""
        return self.aim.best, f"electrical_{self.aim.best}"

    @property
    def single(self) -> bool:
        return not self.name


SINGLE_POINT = OperatingPoints("", (OperatingPoint("", {}),))


def read_points(scene: Scene, named: str | None) -> OperatingPoints:
    """Return the points of a standard or a CSV file by its name; without a name one point, the scene itself."""
    if not named:
        return SINGLE_POINT
    standard = {name.lower(): each for name, each in standards().items()}.get(named.lower())
    if standard is not None:
        return points_of(scene, standard)
    if not os.path.exists(named) and not named.lower().endswith(".csv"):
        names = ", ".join(standards())
        raise UsageError(f"--over {named}: is neither a CSV file nor a seasonal figure (known: {names})")
    return _from_file(scene, named)


def points_of(scene: Scene, standard: SeasonalStandard) -> OperatingPoints:
    """Return a standard's points as conditions of the compressor.

    The scene's own temperatures are those of the full load: their differences from the medium at either side are taken
    as proportional to the load, as with surfaces of constant size; condensation never falls below `LEAST_CONDENSING`.
    Superheat and subcooling stay.
    """
    T_e, T_c = scene.operation.evaporating_temperature, scene.operation.condensing_temperature
    if T_e is None or T_c is None:
        what = f"needs {EVAPORATING} and {CONDENSING} in the scene: its temperatures at full load"
        raise UsageError(f"--over {standard.name}: {what} (write them in place of pressures)")
    full = standard.ratings[0]
    cold, warm = full.cold + ZERO_CELSIUS - T_e, T_c - (full.warm + ZERO_CELSIUS)
    for what, size, path, remedy in (
        (f"the evaporator below {standard.source_medium} of {full.cold:g} °C", cold, EVAPORATING, "lower"),
        (f"the condenser above {standard.sink_medium} of {full.warm:g} °C", warm, CONDENSING, "raise"),
    ):
        if size < LEAST_APPROACH:
            raise UsageError(f"--over {standard.name}: leaves {size:.3g} K for {what} at full load ({remedy} {path})")
    points = []
    for rating in standard.ratings:
        condensing = max(rating.warm + warm * rating.load, LEAST_CONDENSING)
        values = {EVAPORATING: rating.cold - cold * rating.load + ZERO_CELSIUS, CONDENSING: condensing + ZERO_CELSIUS}
        points.append(OperatingPoint(rating.name, values, rating.weight, rating.load))
    told = (
        f"{standard.name} ({standard.source}) as the compressor meets it: {standard.conditions}, "
        f"{standard.source_medium} {cold:.3g} K above evaporation, {standard.sink_medium} {warm:.3g} K below "
        f"condensation at full load, both in proportion to the load; condensing at {LEAST_CONDENSING:g} °C at least; "
        f"loads {'of heating ' if standard.heating else ''}by {SPEED}; no {standard.without}"
    )
    return OperatingPoints(
        standard.name, tuple(points), standard.energy, SPEED, (told,), standard.heating, standard.bins
    )


def as_csv(points: OperatingPoints) -> str:
    """Return points as the text of a CSV file that reads back to them."""
    paths = list(points.points[0].values)
    lines = [f"# {line}" for line in (*points.told, *([_OF_A_FILE] if points.bins else []))]
    heating = _HEATING if points.heating else ""
    weight = f"{heating}energy" if points.energy else "weight"
    load = f"{heating}load" if points.by == SPEED else f"{heating}load by {points.by}"
    lines.append(", ".join(["name", weight, load, *(f"{path} [degC]" for path in paths)]))
    for point in points.points:
        temperatures = (f"{round(value - ZERO_CELSIUS, 6):g}" for value in point.values.values())
        lines.append(", ".join([point.name, f"{point.weight:.6g}", f"{point.load:g}", *temperatures]))
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class _Column:
    kind: str  # name, weight, energy, load, path
    path: str = ""
    unit: str = ""
    heating: bool = False  # of a load or energy


def _from_file(scene: Scene, name: str) -> OperatingPoints:
    """Return the points of a CSV file; raise UsageError with the faulty line."""
    with sheet_or_usage_error("name a CSV file in UTF-8", f"--over {name}"):
        sheet = read_sheet(name)
    if not 1 <= len(sheet.rows) <= MOST_POINTS:
        remedy = f"write 1 to {MOST_POINTS}, a line each; {_EXAMPLE}"
        raise UsageError(f"--over {name}: has {len(sheet.rows)} points ({remedy})")
    columns = [_column(scene, text, f"--over {name} line {sheet.head.line}") for text in sheet.head.cells]
    kinds = [column.kind for column in columns]
    if "weight" in kinds and "energy" in kinds:
        raise UsageError(f"--over {name}: has both weight and energy (keep one: each weights the points)")
    if len({column.heating for column in columns if column.kind in ("load", "energy")}) > 1:
        what = "its load and its energy are not both of cooling or of heating"
        raise UsageError(f"--over {name}: {what} (write {_HEATING}load and {_HEATING}energy, or load and energy)")
    points = tuple(_point(scene, row, columns, f"--over {name} line {row.line}") for row in sheet.rows)
    if not sum(point.weight for point in points) > 0.0:
        raise UsageError(f"--over {name}: all weights are zero (give at least one point a weight)")
    loads = [point.load for point in points if point.load is not None]
    if loads and points[0].load != 1.0:
        raise UsageError(f"--over {name}: its first point does not have load 1 (write full load first)")
    by = next((column.path for column in columns if column.kind == "load"), SPEED)
    if loads:
        check_continuous(scene, by)
    heating = any(column.heating for column in columns)
    return OperatingPoints(os.path.basename(name), points, "energy" in kinds, by, heating=heating)


def _column(scene: Scene, text: str, where: str) -> _Column:
    name, unit = name_and_unit(text)
    load = re.fullmatch(rf"({_HEATING})?load(?:\s+by\s+(\S+))?", name)
    if load is not None:
        return _Column("load", load[2] or SPEED, heating=bool(load[1]))
    if name in ("name", "weight", "energy", f"{_HEATING}energy"):
        return _Column(name.removeprefix(_HEATING), heating=name.startswith(_HEATING))
    try:
        leaf = leaf_of(scene, name)
    except UsageError as error:
        raise UsageError(
            f"{where}: {error} (columns are paths, name, weight or energy, load, heating_energy, heating_load)"
        ) from None
    if unit and leaf.dimension is None:
        raise UsageError(f"{where}: {name} has no unit (remove the brackets)")
    return _Column("path", name, unit)


def _point(scene: Scene, row: Row, columns: Sequence[_Column], where: str) -> OperatingPoint:
    values: dict[str, Any] = {}
    found: dict[str, Any] = {"name": f"line {row.line}", "weight": 1.0, "load": None}
    for text, column in zip(row.cells, columns, strict=True):
        if column.kind == "path":
            values[column.path] = _value(scene, text, column, where)
        elif column.kind == "name":
            found["name"] = text or found["name"]
        elif text or column.kind != "load":
            kind = column.kind
            if not re.fullmatch(NUMBER, text) or float(text) < 0.0 or (kind == "load" and not 0.0 < float(text) <= 2.0):
                bounds = "above 0 and at most 2" if kind == "load" else "of at least 0"
                raise UsageError(f"{where}: {kind} {text!r} is not a number {bounds} (write e.g. 0.5)")
            found[kind] = float(text)
    return OperatingPoint(found["name"], values, found.get("energy", found["weight"]), found["load"])


def _value(scene: Scene, text: str, column: _Column, where: str) -> Any:
    with refused_at(f"{where}: {column.path}"), gauge_pressures_over(scene.operation.ambient_pressure):
        return convert_cell(leaf_of(scene, column.path), text, column.unit, scene.folder)
