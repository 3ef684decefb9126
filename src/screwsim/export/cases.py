"""All cases of a results file as a table, a row each: varied paths, status, figures; in SI, metric or US units."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from ruamel.yaml import YAML

from screwsim.export.case_units import CUBIC_FOOT, FAHRENHEIT, METRIC, PSI, SI, US, as_figure, converted
from screwsim.figures.engineering import shown_name
from screwsim.fluid.composition import own_blend
from screwsim.fluid.constants import gas_constant
from screwsim.outputs import PERFORMANCE, Figure
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.results import Results
from screwsim.results.atomic import make_folder, write_csv
from screwsim.results.protection import protect_other_heads
from screwsim.results.read import STAGES

Array = np.ndarray
FLOW, DISPLACED, LAMBDA = "gas_mass_flow", "displacement_flow", "volumetric_efficiency"
HUMIDITY = "humidity_ratio"
STANDARD = {METRIC: (ZERO_CELSIUS, 101325.0), US: (ZERO_CELSIUS + (60.0 - 32.0) / FAHRENHEIT, 14.696 * PSI)}  # K, Pa


class CaseColumn(NamedTuple):
    """A column of the table: its name, its unit, and its values, numbers or texts."""

    name: str
    unit: str
    values: Array


def case_columns(results: Results, units: str) -> list[CaseColumn]:
    """Return the columns of all cases, in the order of the sweep; figures without any value are left out."""
    found = [_varied(results, path, units) for path in results.varied]
    found.append(CaseColumn("status", "", results.status.ravel()))
    for name in results.figures:
        values = results.performance[name].ravel()
        found.append(_column(shown_name(name) if units != SI else name, results.figure(name), values, units))
    found += _volume_flows(results, units)
    for name, texts in (("message", results.messages), ("warnings", results.warnings)):
        if any(texts.ravel()):
            found.append(CaseColumn(name, "", np.array([text.replace("\n", "; ") for text in texts.ravel()])))
    return found


def _varied(results: Results, path: str, units: str) -> CaseColumn:
    number, values = results.varied[path]
    outer = results.axis_list[number]
    axis = next(each for each in (outer.joined or (outer,)) if each.path == path)
    along = results.along(path).ravel()
    if values.dtype.kind not in "fiu":
        return CaseColumn(path, "", along)
    return _column(path, as_figure(axis, units), along, units)


def _column(name: str, figure: Figure, values: Array, units: str) -> CaseColumn:
    """Return the values [SI] of a figure in the units of the table."""
    return CaseColumn(name, *converted(figure, values, units))


def _volume_flows(results: Results, units: str) -> Iterator[CaseColumn]:
    """Yield the flow at suction conditions, and that of the ideal gas at standard conditions, for metric and US units.

    The latter only where all cases have one gas. Of two stages both are those of the first, which draws the gas.
    """
    results = results.stages.get(STAGES[0], results)
    if units == SI or not {FLOW, DISPLACED, LAMBDA} <= set(results.figures):
        return
    drawn = (results.performance[LAMBDA] * results.performance[DISPLACED]).ravel()
    name, factor = ("acfm", 60.0 / CUBIC_FOOT) if units == US else ("m3/h", 3600.0)
    yield CaseColumn("inlet flow", name, factor * drawn)
    if any(path.startswith("gas.") for path in results.varied):
        return
    T, p = STANDARD[units]
    fluid = _fluid(YAML(typ="safe", pure=True).load(results.scene_yaml)["gas"])
    wet = results.performance[HUMIDITY] if HUMIDITY in results.figures else 0.0
    flow = (results.performance[FLOW] / (1.0 + wet)).ravel() * gas_constant(fluid) * T / p  # [m³/s], without the water
    name, factor = ("MMSCFD", 86400e-6 / CUBIC_FOOT) if units == US else ("Nm3/h", 3600.0)
    yield CaseColumn("standard flow", name, factor * flow)


def _fluid(gas: Mapping[str, Any]) -> str:
    """Return the name of the fluid of a scene's gas, or of its components and fractions."""
    if isinstance(gas["fluid"], str):
        return gas["fluid"]
    by_mole = gas.get("mole_fractions") is not None
    return own_blend(gas["fluid"], gas["mole_fractions" if by_mole else "mass_fractions"], by_mole)


def protect_other_cases(path: Path) -> None:
    """Raise UsageError where the file at `path` is not such a table, as measured data: it would be lost."""
    protect_other_heads(path, _are_ours)


def _are_ours(heads: Sequence[str]) -> bool:
    """Tell whether a head line is of such a table: dotted paths, the status, a figure with its unit or messages."""
    if "status" not in heads:
        return False
    at = heads.index("status")
    named = {each for name in PERFORMANCE for each in (name, shown_name(name))}
    figures = (head.partition(" [") for head in heads[at + 1 :])
    told = any(name == "message" or (unit and name in named) for name, _, unit in figures)
    return told and all("." in head for head in heads[:at])


def write_cases(path: Path, columns: Sequence[CaseColumn]) -> str:
    """Write columns as CSV with their units in the first line; return the path."""
    make_folder(path.parent)
    heads = (f"{each.name} [{each.unit}]" if each.unit else each.name for each in columns)
    rows = zip(*(each.values.tolist() for each in columns), strict=True)
    return write_csv(path, heads, ([_cell(value) for value in row] for row in rows))


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.8g}"
    return value
