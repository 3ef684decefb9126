"""A map for EnergyPlus: curves of a Refrigeration:Compressor, and normalised ones, as IDF or epJSON."""

import re
from collections.abc import Container
from functools import partial
from typing import Any

from screwsim.export.polynomials import Polynomials, quadratic, rated_temperatures, temperature_limits
from screwsim.scene.operation import SUBCOOLING
from screwsim.study.maps.performance_map import TERMS

CAPACITY, POWERS = "cooling_capacity", ("electrical_power", "shaft_power")  # the motor's power where there is one
BICUBIC = ((0, 0), (1, 0), (2, 0), (0, 1), (0, 2), (1, 1), (3, 0), (0, 3), (2, 1), (1, 2))  # its order of terms
_CUBIC_KEYS = ("1_constant", "2_x", "3_x_2", "4_y", "5_y_2", "6_x_y", "7_x_3", "8_y_3", "9_x_2_y", "10_x_y_2")
_KEYS = tuple(f"coefficient{key}" for key in _CUBIC_KEYS)
CLASSES = ("Curve:Bicubic", "Curve:Biquadratic", "Refrigeration:Compressor")
WRITTEN_MARK = "; written by screwsim"
OMITTED_BEFORE = {  # fields of IDF between ours, which are empty and take their defaults
    "rated_subcooling": ("rated_return_gas_temperature", "rated_liquid_temperature"),
    "input_unit_type_for_x": ("minimum_curve_output", "maximum_curve_output"),
}
FURTHER_COOLED = (  # Engineering Reference, Compressor Energy Use
    "The economizer cools the liquid behind the condenser further: the capacity contains that, no field states it,",
    "and rated_subcooling is that behind the condenser. EnergyPlus scales the capacity by the enthalpy difference of",
    "evaporation from there, actual over rated: give its condenser this subcooling, and its system no subcooler.",
    "Its refrigerant flow, capacity over that difference, is then larger than that of the evaporator.",
)
VERSION = "24.1"  # EnergyPlus version whose input data dictionary has these names

Objects = dict[str, dict[str, dict[str, Any]]]  # {class: {name: {field: value}}}


def energyplus_objects(found: Polynomials, name: str) -> Objects:
    """Return the objects by class: for each map a compressor with two bicubic curves, and two biquadratic curves.

    The biquadratic curves are capacity, and power over capacity, relative to those at a rated point: CAPFT and EIRFT of
    a chiller as functions of saturation temperatures.
    """
    objects: Objects = {name: {} for name in CLASSES}
    for one in found.maps:
        own = re.sub(r"[^\w.-]+", "_", f"{name} {found.name(one)}".strip())
        (s0, s1), (d0, d1) = temperature_limits(one)
        ends = {"minimum_value_of_x": s0, "maximum_value_of_x": s1, "minimum_value_of_y": d0, "maximum_value_of_y": d1}
        units = {"input_unit_type_for_x": "Temperature", "input_unit_type_for_y": "Temperature"}
        for figure, word in ((power_of(one.fits), "power"), (CAPACITY, "capacity")):
            by_term = dict(zip(TERMS, one.fits[figure].coefficients, strict=True))
            values = {key: by_term[term] for key, term in zip(_KEYS, BICUBIC, strict=True)}
            objects["Curve:Bicubic"][f"{own} {word}"] = values | ends | units
        at = rated_temperatures(one)
        for word, (coefficients, _) in normalised(one, at).items():
            values = dict(zip(_KEYS[:6], coefficients, strict=True))
            objects["Curve:Biquadratic"][f"{own} {word}"] = values | ends | units
        objects["Refrigeration:Compressor"][own] = {
            "refrigeration_compressor_power_curve_name": f"{own} power",
            "refrigeration_compressor_capacity_curve_name": f"{own} capacity",
            "rated_superheat": found.superheat(one),
            "rated_subcooling": found.condition(one, SUBCOOLING),
        }
    return objects


def power_of(figures: Container[str]) -> str:
    """Return the name of the power that a compressor draws: at its motor if known, else at its shaft."""
    return next(name for name in POWERS if name in figures or name == POWERS[-1])


def normalised(one: Any, at: tuple[float, float]) -> dict[str, tuple[tuple[float, ...], float]]:
    """Return coefficients of capacity, and of power over capacity, relative to those at a point, and largest errors.

    The errors are relative, with respect to the cubics.
    """
    capacity, power = partial(one.evaluate, CAPACITY), partial(one.evaluate, power_of(one.fits))
    ratio = quadratic(one, lambda S, D: power(S, D) / capacity(S, D), at)
    return {"CAPFT": quadratic(one, capacity, at), "EIRFT": ratio}


def epjson(objects: Objects) -> dict[str, Any]:
    """Return the objects as a document of epJSON."""
    return {"Version": {"Version 1": {"version_identifier": VERSION}}, **objects}


def idf(objects: Objects, notes: list[str]) -> str:
    """Return the objects as IDF text, with notes before them as comments."""
    lines = [f"! {note}" for note in notes] + ["", "Version,", f"    {VERSION};"]
    for kind, named in objects.items():
        for name, fields in named.items():
            rows = [("Name", name)]
            for field, value in fields.items():
                rows += [*((each, "") for each in OMITTED_BEFORE.get(field, ())), (field, value)]
            lines += ["", f"{kind},"]
            for i, (field, value) in enumerate(rows):
                end = ";" if i == len(rows) - 1 else ","
                text = value if isinstance(value, str) else f"{value:.12g}"
                lines.append(f"    {text}{end}".ljust(44) + f"  !- {field}")
    return "\n".join(lines) + "\n"


def notes(found: Polynomials) -> list[str]:
    """Return the notes before the objects: what they are, their range of validity, their errors."""
    lines = [f"{found.title}: {found.fluid}{WRITTEN_MARK}"]
    y = f"saturated discharge temperature ({found.condensing})"
    lines.append(f"x: saturated suction temperature (dew), y: {y}, deg C; W")
    lines += FURTHER_COOLED if found.economized else ()
    for one in found.maps:
        errors = ", ".join(f"{figure.replace('_', ' ')} {100 * fit.largest:.2g} %" for figure, fit in one.fits.items())
        over = "/".join(f"{T:g}" for T in rated_temperatures(one))
        lines.append(f"{found.titled(one, 'map')}: largest errors of the cubics: {errors}")
        off = " and ".join(f"{100 * error:.2g} %" for _, error in normalised(one, rated_temperatures(one)).values())
        relative = f"capacity, power per capacity relative to those at {over} deg C"
        lines.append(f"CAPFT, EIRFT: {relative}; off by {off} at most")
    return lines
