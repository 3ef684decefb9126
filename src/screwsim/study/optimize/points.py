"""Operating points over which figures are weighted: from a CSV file, or those of a seasonal figure given by name.

Sources: AHRI 551/591 (SI) and 550/590 for IPLV: weights 0.01, 0.42, 0.45, 0.12. Eurovent certification programme LCP-HP
for ESEER: 3, 33, 41, 23 %. EN 14825 for SEER (space cooling, water at a fixed 7 °C, average climate) and SEPR (process
cooling, water at 7 °C; Regulation (EU) 2016/2281 has the same), whose weights follow from the hours at each outdoor
temperature and the load there. All of them rate a whole chiller; `points_of` converts them for a compressor.
"""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import Row, read_sheet, sheet_or_usage_error
from screwsim.scene import Scene, leaf_of
from screwsim.scene.operation import CONDENSING, EVAPORATING
from screwsim.scene.units import NUMBER, ZERO_CELSIUS, refused_at
from screwsim.scene.values import convert
from screwsim.study.asked.inputs import check_continuous

T_WATER = 7.0  # [°C] of the leaving chilled water, in all of them

# EN 14825: hours a year at each outdoor temperature [°C], from the first on
_COOLING = (17, (205, 227, 225, 225, 216, 215, 218, 197, 178, 158, 137, 109, 88, 63, 39, 31, 24, 17, 13, 9, 4, 3, 1, 0))
_PROCESS = (
    -19,
    (
        *(0.08, 0.41, 0.65, 1.05, 1.74, 2.98, 3.79, 5.69, 8.94, 11.81, 17.29, 20.02, 28.73, 39.71, 56.61, 76.36),
        *(106.07, 153.22, 203.41, 247.98, 282.01, 275.91, 300.61, 310.77, 336.48, 350.48, 363.49, 368.91, 371.63),
        *(377.32, 376.53, 386.42, 389.84, 384.45, 370.45, 344.96, 328.02, 305.36, 261.87, 223.90, 196.31, 163.04),
        *(141.78, 121.93, 104.46, 85.77, 71.54, 56.57, 43.35, 31.02, 20.21, 11.85, 8.17, 3.83, 2.09, 1.21, 0.52, 0.40),
    ),
)
BIN_HOURS: Mapping[str, Mapping[int, float]] = {
    name: {first + number: float(each) for number, each in enumerate(hours)}
    for name, (first, hours) in {"SEER": _COOLING, "SEPR": _PROCESS}.items()
}
LEAST_CONDENSING = 20.0  # [°C] down to which a chiller's control lets condensation fall: an assumption of ours
LEAST_APPROACH = 1.0  # [K] between water or air and refrigerant at full load
SPEED = "operation.speed"
MOST_POINTS = 100  # points per file
_EXAMPLE = "weight, operation.condensing_temperature [degC], load"


class RatingPoint(NamedTuple):
    """One rating point: load over the full one, temperature [°C] of the medium entering the condenser, weight."""

    load: float
    entering: float
    weight: float


class SeasonalStandard(NamedTuple):
    """A seasonal figure: its points; with `energy` weights are shares of the cooling energy, else of the figure."""

    name: str
    source: str
    ratings: tuple[RatingPoint, ...]
    energy: bool


_WEIGHTS = {"IPLV": (0.01, 0.42, 0.45, 0.12), "ESEER": (0.03, 0.33, 0.41, 0.23)}
_QUARTERS = (1.0, 0.75, 0.5, 0.25)
_TABLE = {  # of the points A … D: loads, temperatures [°C] of air, and of water where it cools the condenser
    "IPLV": ("AHRI 551/591", _QUARTERS, (35.0, 27.0, 19.0, 13.0), (30.0, 24.5, 19.0, 19.0)),
    "ESEER": ("Eurovent LCP-HP", _QUARTERS, (35.0, 30.0, 25.0, 20.0), (30.0, 26.0, 22.0, 18.0)),
    "SEER": ("EN 14825, fixed outlet", (1.0, 0.74, 0.47, 0.21), (35.0, 30.0, 25.0, 20.0), (30.0, 26.0, 22.0, 18.0)),
    "SEPR": ("EN 14825, high temperature", (1.0, 0.93, 0.87, 0.8), (35.0, 25.0, 15.0, 5.0), (30.0, 23.0, 16.0, 9.0)),
}


def energy_shares(name: str) -> tuple[float, ...]:
    """Return the share of a year's cooling energy that each rating point of SEER or SEPR represents.

    Hours times load at each outdoor temperature, divided linearly between the two neighbouring points; beyond the outer
    points these take all.
    """
    at = _TABLE[name][2][::-1]  # ascending
    shares = [0.0] * len(at)
    for T, hours in BIN_HOURS[name].items():
        upper = next((i for i, each in enumerate(at) if each >= T), len(at) - 1)
        lower = max(upper - 1, 0)
        part = 1.0 if upper == lower else min(max((T - at[lower]) / (at[upper] - at[lower]), 0.0), 1.0)
        cooling = hours * load_at(name, T)
        shares[upper] += part * cooling
        shares[lower] += (1.0 - part) * cooling
    return tuple(share / sum(shares) for share in shares[::-1])


def load_at(name: str, T: float) -> float:
    """Return the part load ratio at an outdoor temperature [°C].

    Space cooling is in proportion to T − 16 °C, beyond 35 °C too; process cooling goes from 0.8 at 5 °C to 1 at 35 °C.
    The loads of the rating points are these, rounded to whole percents.
    """
    if name == "SEER":
        return (T - 16.0) / (35.0 - 16.0)
    return 0.8 + 0.2 * min(max((T - 5.0) / (35.0 - 5.0), 0.0), 1.0)


def standards() -> dict[str, SeasonalStandard]:
    """Return the seasonal figures by name; `-water`: water-cooled condensers, else air-cooled."""
    found = {}
    for name, (source, loads, air, water) in _TABLE.items():
        energy = name in BIN_HOURS
        weights = energy_shares(name) if energy else _WEIGHTS[name]
        for suffix, entering in (("", air), ("-water", water)):
            ratings = tuple(map(RatingPoint, loads, entering, weights))
            found[name + suffix] = SeasonalStandard(name + suffix, source, ratings, energy)
    return found


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
    figures are averaged.
    """

    name: str
    points: tuple[OperatingPoint, ...]
    energy: bool = False
    by: str = SPEED
    told: tuple[str, ...] = ()  # how a chiller's conditions were converted to the compressor's

    @property
    def single(self) -> bool:
        return not self.name


SINGLE_POINT = OperatingPoints("", (OperatingPoint("", {}),))


def read_points(scene: Scene, named: str | None) -> OperatingPoints:
    """Return the points of a standard or a CSV file by its name; without a name one point, the scene itself."""
    if not named:
        return SINGLE_POINT
    standard = standards().get(named.upper().replace("-WATER", "-water"))
    if standard is not None:
        return points_of(scene, standard)
    if not os.path.exists(named) and not named.lower().endswith(".csv"):
        names = ", ".join(standards())
        raise UsageError(f"--over {named}: is neither a CSV file nor a seasonal figure (known: {names})")
    return _from_file(scene, named)


def points_of(scene: Scene, standard: SeasonalStandard) -> OperatingPoints:
    """Return a standard's points as conditions of the compressor.

    The scene's own temperatures are those of the full load: their differences from the chilled water, and from the
    medium entering the condenser, are taken as proportional to the load, as with surfaces of constant size;
    condensation never falls below `LEAST_CONDENSING`. Superheat and subcooling stay.
    """
    T_e, T_c = scene.operation.evaporating_temperature, scene.operation.condensing_temperature
    if T_e is None or T_c is None:
        what = f"needs {EVAPORATING} and {CONDENSING} in the scene: its temperatures at full load"
        raise UsageError(f"--over {standard.name}: {what} (write them in place of pressures)")
    cold = T_WATER + ZERO_CELSIUS - T_e
    warm = T_c - (standard.ratings[0].entering + ZERO_CELSIUS)
    for what, size, path, remedy in (
        (f"the evaporator below water of {T_WATER:g} °C", cold, EVAPORATING, "lower"),
        (f"the condenser above {standard.ratings[0].entering:g} °C at full load", warm, CONDENSING, "raise"),
    ):
        if size < LEAST_APPROACH:
            raise UsageError(f"--over {standard.name}: leaves {size:.3g} K for {what} ({remedy} {path})")
    points = []
    for name, rating in zip("ABCD", standard.ratings, strict=True):
        condensing = max(rating.entering + warm * rating.load, LEAST_CONDENSING)
        values = {EVAPORATING: T_WATER - cold * rating.load + ZERO_CELSIUS, CONDENSING: condensing + ZERO_CELSIUS}
        points.append(OperatingPoint(name, values, rating.weight, rating.load))
    medium = "water" if standard.name.endswith("-water") else "air"
    told = (
        f"{standard.name} ({standard.source}) as the compressor meets it: water leaves at {T_WATER:g} °C, {cold:.3g} K "
        f"above evaporation, {medium} enters {warm:.3g} K below condensation at full load, both in proportion to the "
        f"load; condensing at {LEAST_CONDENSING:g} °C at least; loads by {SPEED}; no fans, pumps, standby"
    )
    return OperatingPoints(standard.name, tuple(points), standard.energy, SPEED, (told,))


def as_csv(points: OperatingPoints) -> str:
    """Return points as the text of a CSV file that reads back to them."""
    paths = list(points.points[0].values)
    lines = [f"# {line}" for line in points.told]
    weight, load = "energy" if points.energy else "weight", "load" if points.by == SPEED else f"load by {points.by}"
    lines.append(", ".join(["name", weight, load, *(f"{path} [degC]" for path in paths)]))
    for point in points.points:
        temperatures = (f"{round(value - ZERO_CELSIUS, 6):g}" for value in point.values.values())
        lines.append(", ".join([point.name, f"{point.weight:.6g}", f"{point.load:g}", *temperatures]))
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class _Column:
    kind: str  # name, weight, load, path
    path: str = ""
    unit: str = ""


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
    points = tuple(_point(scene, row, columns, f"--over {name} line {row.line}") for row in sheet.rows)
    if not sum(point.weight for point in points) > 0.0:
        raise UsageError(f"--over {name}: all weights are zero (give at least one point a weight)")
    loads = [point.load for point in points if point.load is not None]
    if loads and points[0].load != 1.0:
        raise UsageError(f"--over {name}: its first point does not have load 1 (write full load first)")
    by = next((column.path for column in columns if column.kind == "load"), SPEED)
    if loads:
        check_continuous(scene, by)
    return OperatingPoints(os.path.basename(name), points, "energy" in kinds, by)


def _column(scene: Scene, text: str, where: str) -> _Column:
    match = re.fullmatch(r"(.*?)\s*(?:\[([^\]]*)\])?", text)
    assert match is not None
    name, unit = match[1], (match[2] or "").strip()
    load = re.fullmatch(r"load(?:\s+by\s+(\S+))?", name)
    if load is not None:
        return _Column("load", load[1] or SPEED)
    if name in ("name", "weight", "energy"):
        return _Column(name)
    try:
        leaf = leaf_of(scene, name)
    except UsageError as error:
        raise UsageError(f"{where}: {error} (columns are paths, name, weight or energy, load)") from None
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
    leaf = leaf_of(scene, column.path)
    number = leaf.dimension is None and re.fullmatch(NUMBER, text)
    raw = (int(text) if leaf.kind == "count" and text.isdigit() else float(text)) if number else text
    with refused_at(f"{where}: {column.path}"):
        return convert(leaf, f"{text} {column.unit}" if column.unit else raw, scene.folder)
