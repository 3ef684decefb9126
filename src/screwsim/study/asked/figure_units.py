"""Units in which people state figures, measured or wanted."""

import math
from collections.abc import Mapping

from screwsim.figures import declared
from screwsim.figures.curves import reading_figure
from screwsim.inputs.declare import KINDS, Kind
from screwsim.outputs import EFFICIENCY
from screwsim.outputs.customary import RPM
from screwsim.outputs.display import si_unit
from screwsim.outputs.us_units import CFM, HORSEPOWER, POUND
from screwsim.scene.units import Refused, likely_unit, not_a_difference, parse_quantity, refuse_traps, tidy_unit
from screwsim.scene.values import shown

# SI unit of a figure -> {unit: factor}; degrees Celsius are handled separately
UNITS = {
    "1": {"": 1.0, "1": 1.0, "%": 0.01},
    "W": {"W": 1.0, "kW": 1e3, "MW": 1e6},
    "K": {"K": 1.0},
    "kelvin": {"K": 1.0},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "bar": 1e5},
    "J": {"J": 1.0, "kJ": 1e3},
    "kg": {"kg": 1.0, "g": 1e-3},
    "kg s-1": {
        "kg/s": 1.0,
        "kg/h": 1.0 / 3600.0,
        "g/s": 1e-3,
        "t/h": 1.0 / 3.6,
        "lb/min": POUND / 60.0,
        "lb/h": POUND / 3600.0,
    },
    "W s m-3": {"W s/m^3": 1.0, "kW/(m^3/min)": 6e4, "hp/(100 cfm)": HORSEPOWER / (100.0 * CFM)},
    "J m-3": {"J/m^3": 1.0, "kJ/m^3": 1e3},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"N m": 1.0},
    "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    "m3": {"m^3": 1.0, "cm^3": 1e-6, "L": 1e-3},
    "m3 s-1": {"m^3/s": 1.0, "m^3/min": 1.0 / 60.0, "m^3/h": 1.0 / 3600.0, "L/min": 1.0 / 60000.0},
    "rad": {"rad": 1.0, "deg": math.pi / 180.0},
    "rad s-1": {"rad/s": 1.0, "rpm": RPM},
    "Hz": {"Hz": 1.0},
    "s": {"s": 1.0, "h": 3600.0},
}
CELSIUS = "degC"
# a number without a unit from this one on is meant in %; no quantity between 0 and 1 has a larger standard deviation
# than 0.5
MOST_EFFICIENCY = {"figure": 1.5, "uncertainty": 0.5}


def units_of(figure: str) -> Mapping[str, float]:
    """Return the factors to SI units of the units in which a figure may be stated."""
    si = declared(figure).units
    return UNITS.get(si, {tidy_unit(si_unit(si)): 1.0, si: 1.0})


def bare_percent(figure: str, number: str, kind: str) -> str:
    """Return that an efficiency written as a number without a unit is meant in %; empty for any other figure.

    `kind`: figure or uncertainty of one.
    """
    if declared(figure).scale != EFFICIENCY or abs(float(number)) < MOST_EFFICIENCY[kind]:
        return ""
    return f"is {100.0 * float(number):g} % (write {number} %, or {float(number) / 100.0:g})"


def percent_are_points(figure: str, in_percent: bool) -> bool:
    """Return whether an uncertainty in % is one in points: of an efficiency, or of a value that is itself in %.

    Of any other figure, also of a COP or a ratio, it is a share of the value.
    """
    return in_percent or declared(figure).scale == EFFICIENCY


def quantity_of(figure: str, kind: str, unit: str) -> Kind | None:
    """Return the dimension of a figure, or of its uncertainty, among those of scenes that know the unit; else None.

    Raise `Refused` for an uncertainty in a unit with a zero of its own (barg, degF), for a unit that scenes refuse by
    name (barg, Hz), and for another spelling of one (psia, lpm).
    """
    si = tidy_unit(si_unit(declared(figure).units))
    named = [each for each in KINDS.values() if each.si == si]
    absolute = [each for each in named if not each.name.endswith("_difference")]
    differences = [each for each in named if each not in absolute]
    gauged = figure.endswith("pressure") or reading_figure(figure) is not None or not differences or si != "Pa"
    wanted = (absolute if kind == "figure" and gauged else differences or absolute)[:1]
    if wanted and _is_unit_of(wanted[0], unit):
        return wanted[0]
    if differences and wanted[:1] == differences[:1] and _is_unit_of(absolute[0], unit):
        if si == "K":
            raise not_a_difference(f"unit {shown(unit)}")
        what = "an uncertainty" if kind == "uncertainty" else "a difference"
        raise Refused(f"unit {shown(unit)} has an offset zero, and this is {what} (write {si})")
    for named in wanted:
        refuse_traps(named, unit, f"unit {shown(unit)}")
        if meant := likely_unit(named, unit):
            raise Refused(f"unit {shown(unit)} is not known (write {meant})")
    return None


def _is_unit_of(kind: Kind, unit: str) -> bool:
    try:
        parse_quantity(kind, f"1 {unit}")
    except Refused:
        return False
    return bool(unit)
