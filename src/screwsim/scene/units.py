"""Quantities as users write them: '3000 rpm' to 314.159 rad/s, and back.

A regular expression splits number and unit, `float` reads the number, and a table has the usual units; pint is imported
only for other units and is given the unit alone, because it would evaluate an expression (`9**9**9 m`) and misread
`1,5`.
"""

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, lru_cache
from typing import Any

from screwsim.inputs.declare import KINDS, Kind
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import with_article
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.scene.numerals import odd_number, odd_number_text


class Refused(Exception):
    """Reason why a value is refused, with the remedy; the caller adds file, line and path."""


@contextmanager
def refused_at(where: str) -> Iterator[None]:
    """Raise what is refused within as a `UsageError` that tells where."""
    try:
        yield
    except Refused as refusal:
        raise UsageError(f"{where}: {refusal}") from None


NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*", re.DOTALL)
_GAUGE = re.compile(r"(bar|mbar|[kM]?Pa|psi|atm)[ _]?(\(g\)|g|gauge)", re.IGNORECASE)
_ambient: ContextVar[float | None] = ContextVar("ambient", default=None)  # [Pa], over which gauge pressures are read


class Gauge(float):
    """An absolute pressure [Pa] that was written as a gauge pressure; `written` is its original text."""

    written: str = ""


@contextmanager
def gauge_pressures_over(ambient: float | None) -> Iterator[None]:
    """Read gauge pressures relative to an ambient pressure [Pa]; outside this context, or for None, refuse them."""
    token = _ambient.set(ambient)
    try:
        yield
    finally:
        _ambient.reset(token)


# Grammar of units passed to pint: names with a one-digit power, at most one level of brackets, no numbers.
_TERM = r"[A-Za-z][A-Za-z_]*(?:\^-?[1-9](?![0-9]))?"
_GROUP = rf"(?:{_TERM}|\({_TERM}(?:[ /]{_TERM})*\))"
_UNIT = re.compile(rf"{_GROUP}(?:[ /]{_GROUP})*")
_LONGEST_UNIT = 40

_DEGREE = (math.pi / 180.0, 1.0)  # as in math.radians, so that angles written in code compare equal

# SI unit -> {unit: (multiplier, divisor)}; one of the two is 1, so that reading rounds once beside
# `float`: the same quantity in two units may differ in its last bit (0.11 MPa, 1.1 bar).
_TABLE: dict[str, dict[str, tuple[float, float]]] = {
    "m": {"m": (1, 1), "cm": (1, 1e2), "mm": (1, 1e3), "um": (1, 1e6)},
    "m^2": {"m^2": (1, 1), "cm^2": (1, 1e4), "mm^2": (1, 1e6)},
    "m^3": {"m^3": (1, 1), "cm^3": (1, 1e6), "mm^3": (1, 1e9), "l": (1, 1e3), "L": (1, 1e3), "ml": (1, 1e6)},
    "m^3/s": {"m^3/s": (1, 1), "m^3/min": (1, 60), "m^3/h": (1, 3600), "L/s": (1, 1e3), "L/min": (1, 6e4)},
    "Pa": {"Pa": (1, 1), "hPa": (1e2, 1), "kPa": (1e3, 1), "MPa": (1e6, 1), "bar": (1e5, 1), "mbar": (1e2, 1)},
    "K": {"K": (1, 1)},
    "rad/s": {"rad/s": (1, 1), "rpm": (math.pi, 30), "rev/s": (2 * math.pi, 1)},
    "m/s": {"m/s": (1, 1), "cm/s": (1, 1e2), "mm/s": (1, 1e3)},
    "rad": {"rad": (1, 1), "deg": _DEGREE, "degree": _DEGREE, "degrees": _DEGREE},
    "kg/m^3": {"kg/m^3": (1, 1), "g/cm^3": (1e3, 1), "kg/l": (1e3, 1), "kg/L": (1e3, 1)},
    "J/(kg K)": {"J/(kg K)": (1, 1), "kJ/(kg K)": (1e3, 1), "J/(g K)": (1e3, 1)},
    "Pa s": {"Pa s": (1, 1), "mPa s": (1, 1e3), "cP": (1, 1e3)},
    "N": {"N": (1, 1), "kN": (1e3, 1)},
    "kg": {"kg": (1, 1), "g": (1, 1e3), "mg": (1, 1e6)},
    "s": {"s": (1, 1), "ms": (1, 1e3), "us": (1, 1e6)},
    "W": {"W": (1, 1), "kW": (1e3, 1), "MW": (1e6, 1)},
    "N m": {"N m": (1, 1), "kN m": (1e3, 1)},
    "kg m^2": {"kg m^2": (1, 1)},
    "N m/rad": {"N m/rad": (1, 1), "kN m/rad": (1e3, 1)},
    "N m s/rad": {"N m s/rad": (1, 1)},
    "W/(m K)": {"W/(m K)": (1, 1), "mW/(m K)": (1, 1e3)},
    "N/m": {"N/m": (1, 1), "mN/m": (1, 1e3), "kN/m": (1e3, 1), "N/mm": (1e3, 1)},
    "W/(m^2 K)": {"W/(m^2 K)": (1, 1), "kW/(m^2 K)": (1e3, 1)},
    "W/K": {"W/K": (1, 1), "kW/K": (1e3, 1)},
    "kg/mol": {"kg/mol": (1, 1), "g/mol": (1, 1e3), "kg/kmol": (1, 1e3)},
    "1/K": {"1/K": (1, 1), "um/(m K)": (1, 1e6)},
}
_SPELLINGS = {"µ": "u", "μ": "u", "℃": "degC", "ºC": "degC", "°": "deg", "²": "^2", "³": "^3"}
_SPELLINGS |= {"**": "^", "·": " ", "*": " "}
# Other spellings of a unit, without blanks, dots and brackets; those in lower case match any case. They are suggested
# in messages, not read.
_LIKELY_UNITS: dict[str, dict[str, str]] = {
    "Pa": {
        **dict.fromkeys(("bara", "barabs", "baraabs"), "bar"),
        **dict.fromkeys(("psia", "psiabs", "psid"), "psi"),
        **dict.fromkeys(("kpaa", "kpaabs"), "kPa"),
    },
    "rad/s": {
        **dict.fromkeys(("u/min", "upm", "r/min", "rev/min", "revs/min"), "rpm"),
        **dict.fromkeys(("rps", "u/s", "r/s"), "rev/s"),
    },
    "K": {"f": "degF", "c": "degC"},
    "m^3": {"ccm": "cm^3"},
    "m^3/s": {"lpm": "L/min"},
    "Pa s": {"Pas": "Pa s", "mPas": "mPa s"},
    "W": {
        **dict.fromkeys(("ton", "tons", "tr"), "refrigeration_ton"),
        "mbh": "kBtu/h",
        **dict.fromkeys(("btuh", "btu/h", "btu/hr"), "Btu/h"),
        "hp": "hp",
        "ps": "metric_horsepower",
    },
    "rad": {"º": "deg"},
    "J/(kg K)": {"kJ/kgK": "kJ/(kg K)", "J/kgK": "J/(kg K)"},
    "W/(m^2 K)": dict.fromkeys(("W/m2K", "W/m^2K", "W/m²K"), "W/(m^2 K)"),
}
_STANDARD_FLOW = re.compile(r"(mm)?sc[fm][dhms]|[ns](m\^?[3³]|l)/(s|sec|min|h|hr|d)")  # scfm, Nm3/h, in lower case
_ACTUAL_FLOW = {"cfm", "acfm"}  # in lower case: ft^3/min at the state of the flow itself
_KINEMATIC = {"cst", "mm^2/s", "mm2/s", "mm²/s", "m^2/s", "st"}
_TABLE_ONLY = {"rad", "rad/s", "N m/rad", "N m s/rad"}  # pint does not distinguish turns, radians and plain numbers
_CELSIUS = {"degC", "celsius", "Celsius", "C"}  # no temperature is in coulombs


def describe(kind: Kind) -> str:
    """Return a kind with its article: 'a length', 'an area'."""
    return with_article(kind.name.replace("_", " "))


@lru_cache(maxsize=512)
def tidy_unit(unit: str) -> str:
    """Return a unit in the table's spelling: 'W/m²/K' gives 'W/(m^2 K)'."""
    for old, new in _SPELLINGS.items():
        unit = unit.replace(old, new)
    unit = re.sub(r"\s*/\s*", "/", " ".join(unit.split()))
    unit = re.sub(r"\(\s*(.*?)\s*\)", r"(\1)", unit)
    unit = re.sub(r"(?<=[A-Za-z])([23])(?![0-9])", r"^\1", unit)
    unit = re.sub(r"^deg C$", "degC", unit)
    return re.sub(r"^([^/()]+)/([^/()]+)/([^/()]+)$", r"\1/(\2 \3)", unit)


def parse_quantity(kind: Kind, text: str) -> float:
    """Return a quantity such as '128 mm' in the SI unit of its kind; raise `Refused` with the remedy."""
    shown = repr(text if len(text) <= 40 else text[:37] + "...")
    wrong = Refused(f"{shown} is not {describe(kind)} (write e.g. '{kind.example}')")
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise _odd_number_fault(kind, text, shown) or wrong
    if not match[2]:
        raise Refused(f"{shown} has no unit (write e.g. '{kind.example}')")
    gauge = _from_gauge(kind, float(match[1]), match[2], text)
    if gauge is not None:
        return gauge
    refuse_traps(kind, match[2], shown)
    number, unit = float(match[1]), tidy_unit(match[2])
    unit = "ft^3/min" if kind.si == "m^3/s" and unit.lower() in _ACTUAL_FLOW else unit
    value = _from_table(kind, number, unit)
    if value is None:
        value = _from_pint(kind, number, unit)
    if value is None:
        raise _odd_number_fault(kind, text, shown) or _likely_unit_fault(kind, match[1], match[2], shown) or wrong
    if not math.isfinite(value):
        raise Refused(f"{shown} is not finite (write e.g. '{kind.example}')")
    return value


def is_gauge(text: str) -> bool:
    """Tell whether a quantity such as '7 bar(g)' is written as a gauge pressure."""
    match = _QUANTITY.fullmatch(text)
    return match is not None and _GAUGE.fullmatch(match[2] or "") is not None


def without_gauge(unit: str) -> str:
    """Return the unit of differences of gauge pressures, bar for bar(g); any other unit as it is."""
    match = _GAUGE.fullmatch(unit)
    return match[1] if match else unit


def _from_gauge(kind: Kind, number: float, unit: str, text: str) -> Gauge | None:
    """Return the absolute pressure [Pa] of a gauge pressure; None for any other, or where gauge pressure is refused."""
    found, ambient = _GAUGE.fullmatch(unit), _ambient.get()
    if kind.name != "pressure" or found is None or ambient is None:
        return None
    value = _from_table(kind, number, found[1])
    if value is None and found[1] in ("psi", "atm"):
        value = _from_pint(kind, number, found[1])
    if value is None or not math.isfinite(value):
        return None
    pressure = Gauge(value + ambient)
    pressure.written = " ".join(text.split())
    return pressure


def _odd_number_fault(kind: Kind, text: str, shown: str) -> Refused | None:
    """Return the fault of a number written in an unsupported way; None for any other text."""
    odd = odd_number(text, customary_unit(kind))
    if odd is not None:
        return Refused(f"{shown} {odd_number_text(odd)}")
    percent = re.search("[%‰]", text)
    return Refused(f"{shown} is a share, not {describe(kind)} (write e.g. '{kind.example}')") if percent else None


def _likely_unit_fault(kind: Kind, number: str, unit: str, shown: str) -> Refused | None:
    """Return the fault of a unit that is spelt otherwise but is unambiguous for this kind; None for any other."""
    if kind.name == "viscosity" and _tight(unit).lower() in _KINEMATIC:
        return Refused(f"{shown} is a kinematic viscosity (multiply it by the density; write e.g. '{kind.example}')")
    known = likely_unit(kind, unit)
    return None if known is None else Refused(f"{shown} is not {describe(kind)} (write '{number} {known}')")


def likely_unit(kind: Kind, unit: str) -> str | None:
    """Return the unit of a kind that is meant by another spelling ('psi' for 'psia'); None where it is not clear."""
    meant, tight = _LIKELY_UNITS.get(kind.si, {}), _tight(unit)
    known = meant.get(tight) or meant.get(tight.lower())
    if known is None:  # in another case; but m and M are milli and mega
        same = [each for each in _TABLE[kind.si] if each.lower() == unit.lower()]
        known = same[0] if len(same) == 1 and (same[0][0] == unit[0] or unit[0] not in "mM") else None
    return known


def _tight(unit: str) -> str:
    return re.sub(r"[\s._()]", "", unit)


def refuse_traps(kind: Kind, unit: str, shown: str) -> None:
    """Refuse ambiguous units: Hz, MBtu/h, scfm, icfm, degC for a difference; gauge pressures where not allowed."""
    if kind.si == "Pa" and _GAUGE.fullmatch(unit):
        if kind.name == "pressure_difference":
            raise Refused(f"{shown} is a gauge pressure, not a difference (write e.g. '{kind.example}')")
        raise Refused(f"{shown} is a gauge pressure (write the absolute pressure, e.g. '{kind.example}')")
    if kind.name == "pressure" and _tight(unit).lower() == "psid":
        raise Refused(f"{shown} is a difference, not an absolute pressure (write e.g. '{kind.example}')")
    if kind.name == "speed" and unit.lower() in ("hz", "khz", "1/s", "s^-1", "1/min", "min^-1"):
        raise Refused(f"{shown} is ambiguous: turns or radians (write rpm, rev/s or rad/s, e.g. '{kind.example}')")
    if kind.si == "m^3/s" and _STANDARD_FLOW.fullmatch(_tight(unit).lower()):
        raise Refused(
            f"{shown} counts gas at a standard state (write the flow at its own state, e.g. '{kind.example}')"
        )
    if kind.si == "m^3/s" and _tight(unit).lower() == "icfm":
        raise Refused(f"{shown} counts gas at a compressor's inlet (write acfm, where that is the state of this flow)")
    if kind.si == "W" and unit.lower().startswith("mmbtu"):
        raise Refused(f"{shown} is in a million Btu (write 1000 kBtu/h for each MMBtu/h, or e.g. '{kind.example}')")
    if kind.si == "W" and unit.lower().startswith("mbtu"):
        raise Refused(f"{shown} is ambiguous: a thousand or a million Btu (write kBtu/h or kW, e.g. '{kind.example}')")
    if kind.name == "temperature" and unit.startswith("delta_"):
        raise Refused(f"{shown} is a difference, not a temperature (write e.g. '{kind.example}' or '12 degC')")
    if kind.name == "temperature_difference" and _has_zero(kind, tidy_unit(unit)):
        raise not_a_difference(shown)


def not_a_difference(shown: str) -> Refused:
    """Return the refusal of a difference or tolerance of temperature in a unit with a zero of its own."""
    return Refused(f"{shown} is a temperature, not a difference (write K or delta_degF, e.g. '10 K')")


def _from_table(kind: Kind, number: float, unit: str) -> float | None:
    if kind.name == "temperature" and unit in _CELSIUS:
        return number + ZERO_CELSIUS
    factor = _TABLE[kind.si].get(unit)
    return None if factor is None else number * factor[0] / factor[1]


@cache
def _registry() -> Any:
    import pint  # takes 0.3 s, and usual scenes never need it

    return pint.UnitRegistry()


def _has_zero(kind: Kind, unit: str) -> bool:
    """Tell whether a unit of temperature has a zero of its own, as degC, degF and pint's other names of them have."""
    return unit in _CELSIUS or (unit not in _TABLE[kind.si] and _from_pint(kind, 0.0, unit) not in (None, 0.0))


def _from_pint(kind: Kind, number: float, unit: str) -> float | None:
    if kind.si in _TABLE_ONLY or len(unit) > _LONGEST_UNIT or not _UNIT.fullmatch(unit):
        return None
    import pint

    try:
        if "radian" in str(_registry().get_root_units(unit)[1]):  # pint takes 6.28 cm^3/turn for a cm^3
            return None
        return float(_registry().Quantity(number, unit).to(kind.si).magnitude)
    except (pint.PintError, AttributeError, TypeError, ValueError, ArithmeticError):
        return None


def customary_unit(kind: Kind) -> str:
    """Return the unit in which a kind is shown: that of its example."""
    return kind.example.partition(" ")[2]


def to_customary(kind: Kind, value: float) -> float:
    """Return an SI value in its customary unit, as a bare number."""
    multiplier, divisor = _TABLE[kind.si][customary_unit(kind)]
    return value * divisor / multiplier


def format_quantity(kind: Kind, value: float) -> str:
    """Return an SI value in its customary unit, such that reading the text gives the same float again."""
    unit = customary_unit(kind)
    number = to_customary(kind, value)
    for digits in (12, 15, 16, 17):
        text = f"{number:.{digits}g}"
        if _from_table(kind, float(text), unit) == value:
            return f"{text} {unit}"
    for near in (math.nextafter(number, math.inf), math.nextafter(number, -math.inf)):
        if _from_table(kind, near, unit) == value:
            return f"{near!r} {unit}"
    return f"{value!r} {kind.si}"


def readable_quantity(kind: Kind, value: float) -> str:
    """Return an SI value in its customary unit for people to read, with ten digits."""
    return f"{to_customary(kind, value):.10g} {customary_unit(kind)}"


# A declared example must be readable; a new kind without a row in the table fails here, not in a user's scene.
assert all(customary_unit(kind) in _TABLE[kind.si] for kind in KINDS.values())
