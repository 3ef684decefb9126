"""Rating tables and coefficients after EN 12900 and AHRI 540 as comma-separated text, in SI or inch-pound units."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from screwsim.export.polynomials import MISSING, Polynomials, document, temperature_limits
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.outputs.us_units import BTU, POUND
from screwsim.scene.operation import SUBCOOLING
from screwsim.study.maps.performance_map import COEFFICIENT_NAMES, PerformanceMap
from screwsim.study.stages.axes import names_of

FIGURES = ("cooling_capacity", "shaft_power", "gas_mass_flow")
# included where a result has them; the last two are the vapour of an economizer, and of a tank between two stages
OPTIONAL_FIGURES = ("electrical_power", "heating_capacity", "economizer_mass_flow", "vapour_mass_flow")
_IP = {
    "cooling_capacity": ("Btu/h", 3600.0 / BTU),
    "shaft_power": ("W", 1.0),
    "electrical_power": ("W", 1.0),
    "heating_capacity": ("Btu/h", 3600.0 / BTU),
    **dict.fromkeys(("gas_mass_flow", "economizer_mass_flow", "vapour_mass_flow"), ("lb/h", 3600.0 / POUND)),
}
# of a document: what is in SI units; whose condensing temperatures are others; which points of the sweep are left out;
# what an economizer does
NOTES = ("in_si", "convention", MISSING, "capacity_contains")
ECONOMIZER = (
    "an economizer, or a tank between stages, cools the liquid beyond the subcooling: cooling_capacity contains that, "
    "and is more than gas_mass_flow times the enthalpy difference from there"
)
HEAD_LINE = "table,map,figure,unit"  # of the coefficients' table
RATED_STEPS = 6  # rated temperatures along each axis
FOLLOWED = (("path", "values"), ("of", "at"))
WITH_UNIT = ("oil_supply.ratio", "quality")  # ends of paths of mass ratios


def _condition_lines(found: Polynomials, ip: bool) -> Iterator[str]:
    """Yield the conditions that hold for all maps, with their units; subcooling also where the scene states none."""
    stated = dict(found.conditions)
    (subcooling,) = names_of(SUBCOOLING, found.two)
    if subcooling not in {*stated, *found.axes, *found.within}:
        stated[subcooling] = 0.0
    for path, value in stated.items():
        yield f"{path} = {_shown(path, value, ip)}" + ("" if path in found.conditions else ", as the scene states none")
    for each in found.follows:
        values, at = (", ".join(_shown(each[of], x, ip) for x in each[x_of]) for of, x_of in FOLLOWED)
        si = "" if each["path"].endswith((*WITH_UNIT, "superheat", "subcooling", "temperature")) else " (SI units)"
        yield f"{each['path']} = {values}{si} where {each['of']} = {at}"


def _shown(path: str, value: Any, ip: bool) -> str:
    """Return a condition [SI] in the unit of the table; another number of the scene in SI units."""
    if path.endswith(("superheat", "subcooling")):
        return f"{1.8 * value:.6g} degF" if ip else f"{value:.6g} K"
    if path.endswith("temperature"):
        celsius = value - ZERO_CELSIUS
        return f"{1.8 * celsius + 32.0:.6g} degF" if ip else f"{celsius:.6g} degC"
    return f"{value:.6g} kg/kg" if path.endswith(WITH_UNIT) else f"{value:.6g}"


def other_condensing(found: Polynomials) -> str:
    """Return that the condensing temperatures are not the standards' (`other_convention`); empty where they are."""
    return "" if found.condensing == "dew" else found.maps[0].other_convention(found.fluid)


def _envelope(one: PerformanceMap, ip: bool) -> list[list[float]]:
    """Return the corners (S, D) of a map's envelope, in °C, or in °F for `ip`."""
    return [[1.8 * T + 32.0 if ip else T for T in corner] for corner in one.envelope]


def en12900_csv(found: Polynomials, ip: bool = False) -> str:
    """Return the coefficients, then the rated points in the envelope, of each map."""
    other = other_condensing(found)
    degree = "degF" if ip else "degC"
    corners = [", ".join(f"({S:.6g}, {D:.6g})" for S, D in _envelope(one, ip)) for one in found.maps]
    valid = [(found.titled(one, "the map"), ends) for one, ends in zip(found.maps, corners, strict=True)]
    lines = [
        f"# {found.title}: {found.fluid}",
        f"# {document(found)['formula']}",
        f"# S evaporating (dew), D condensing ({found.condensing}) temperature, {degree}",
        *([f"# {other}"] if other else []),
        *(f"# {line}" for line in _condition_lines(found, ip)),
        *([f"# {ECONOMIZER}"] if found.economized else []),
        *(f"# {text}" for text in found.missing),
        *(f"# {name}: valid between the corners (S, D) {ends} {degree}" for name, ends in valid),
        f"{HEAD_LINE}," + ",".join(COEFFICIENT_NAMES) + ",largest_error,left_out_error",
    ]
    for one in found.maps:
        for figure, fit in one.fits.items():
            unit, factor = unit_of(found, figure, ip)
            own = fit.in_fahrenheit(factor) if ip else fit.coefficients
            left = "" if fit.left_out is None else f"{fit.left_out:.3e}"
            numbers = ",".join(f"{c:.12e}" for c in own)
            lines.append(f"coefficients,{found.name(one)},{figure},{unit},{numbers},{fit.largest:.3e},{left}")
    heads = ",".join(f"{figure} [{unit_of(found, figure, ip)[0]}]" for figure in found.units)
    lines += ["", f"table,map,evaporating_{degree},condensing_{degree},{heads}"]
    for one in found.maps:
        lines += [f"rating,{found.name(one)},{row}" for row in _rated_points(found, one, ip)]
    return "\n".join(lines) + "\n"


def unit_of(found: Polynomials, figure: str, ip: bool) -> tuple[str, float]:
    """Return the unit of a figure, and the factor from SI to it."""
    return _IP[figure] if ip and figure in _IP else (found.units[figure].replace("kg s-1", "kg/s"), 1.0)


def _rated_points(found: Polynomials, one: PerformanceMap, ip: bool) -> list[str]:
    """Return the rows of the rated points: a regular grid over the envelope's box, without points outside."""
    (s0, s1), (d0, d1) = temperature_limits(one)
    rows = []
    for S in np.linspace(s0, s1, RATED_STEPS):
        for D in np.linspace(d0, d1, RATED_STEPS):
            if not one.inside(S, D).all():
                continue
            shown = [1.8 * T + 32.0 if ip else T for T in (S, D)]
            values = [float(one.evaluate(name, S, D)) * unit_of(found, name, ip)[1] for name in found.units]
            rows.append(",".join([*(f"{T:.6g}" for T in shown), *(f"{value:.6g}" for value in values)]))
    return rows


def en12900_document(found: Polynomials, ip: bool = False) -> dict[str, Any]:
    """Return the same coefficients as a JSON document."""
    maps = []
    for one in found.maps:
        figures = {}
        for figure, fit in one.fits.items():
            unit, factor = unit_of(found, figure, ip)
            own = fit.in_fahrenheit(factor) if ip else fit.coefficients
            figures[figure] = {
                "unit": unit,
                "coefficients": dict(zip(COEFFICIENT_NAMES, own, strict=True)),
                "largest_error": fit.largest,
                "left_out_error": fit.left_out,
            }
        at = {path: float(value) for path, value in one.values.items()}
        maps.append({"at": at, "figures": figures, "envelope": _envelope(one, ip)})
    said = document(found)
    if ip:
        said |= {key: said[key].replace("degC", "degF") for key in ("S", "D")}
        said["units"] = {figure: unit_of(found, figure, True)[0] for figure in found.units}
    other = other_condensing(found)
    in_si, convention, _, contains = NOTES
    said |= {in_si: ["conditions", "follows", "at"]} | ({contains: ECONOMIZER} if found.economized else {})
    return said | ({convention: other} if other else {}) | {"maps": maps}
