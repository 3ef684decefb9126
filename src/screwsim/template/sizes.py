"""Scaling of new scenes' machines with size, from machines known to the program and stated sources.

Rotors (b) of 160 mm were fitted to mean curves of compact screws (validation/bitzer): gaps of 26 um, and 9.6 mm^2 past
the shafts as a nozzle, or 42 um sealed by oil, which the speeds of an air package call for (validation/cagi). Others
are geometrically similar: clearances grow with the diameter, as assumed in validation/cagi and configs/air (discharge
end faces of one maker grow faster: 0.05 mm at 160 mm, 0.095 at 250, MYCOM V series, manual).
Rated machines of 98 to 129 mm leak even less (validation/hsk). Below these, where none is known, clearances follow the
tolerance unit of ISO 286, i = 0.45 D^(1/3) + 0.001 D: they cannot be made ever finer.
"""

import math
from typing import NamedTuple

from screwsim.effects.parts import motor_classes
from screwsim.machine.derived_sizes import unit_volume
from screwsim.machine.rotors.settings import FAMILIES
from screwsim.outputs.customary import RPM

SMALLEST, LARGEST = 0.05, 0.55  # [m] diameters of manufactured rotors
KNOWN_DIAMETER = 0.160  # [m] diameter of the fitted machine
GAP = 26e-6  # [m]
SHAFT_DIAMETER, SHAFT_CLEARANCE, SHAFT_PASSAGE = 70e-3, 42e-6, 10e-3  # [m] (validation/cagi/machine.yaml)
SIMILAR_FROM = 0.098  # [m] diameter of the smallest rated machine that leaks no more than a similar one
# [m] along the leak (validation/bitzer/machine.yaml)
LAND_LENGTHS = {"tip": 2e-3, "interlobe": 5e-3, "end_face": 10e-3}
MOTORS = (  # [kW] rated powers of IEC 60072-1
    *(0.75, 1.1, 1.5, 2.2, 3, 4, 5.5, 7.5, 11, 15, 18.5, 22, 30, 37, 45, 55, 75, 90, 110, 132, 160, 200, 250, 315, 355),
    *(400, 450, 500, 560, 630, 710, 800, 900, 1000),
)
MOTOR_RESERVE = 1.1  # of a motor's rated power over the estimated one


class Size(NamedTuple):
    """Rotors of a family: their diameter and length [m], and the flow [m³/s] that they displace at a speed [rad/s]."""

    diameter: float
    length: float
    flow: float
    speed: float

    @property
    def scale(self) -> float:
        """Ratio of the diameter to that of the fitted machine."""
        return self.diameter / KNOWN_DIAMETER

    @property
    def clearance(self) -> float:
        """Ratio of the clearances to those of the fitted machine."""
        similar = max(self.diameter, SIMILAR_FROM)
        return similar / KNOWN_DIAMETER * tolerance_unit(self.diameter) / tolerance_unit(similar)


def size_of(flow: float, speed: float, family: str = "b") -> Size:
    """Return the rotors that displace a flow [m³/s] at a speed [rad/s]."""
    rotors = FAMILIES[family]
    volume = 2.0 * math.pi * flow / speed / rotors.male_lobes / unit_volume(family, rotors.wrap_angle)
    diameter = (volume / rotors.length) ** (1.0 / 3.0)
    return Size(diameter, rotors.length * diameter, flow, speed)


def tolerance_unit(diameter: float) -> float:
    """Return the tolerance unit i [µm] of ISO 286 for a diameter [m]."""
    mm = 1e3 * diameter
    return 0.45 * mm ** (1.0 / 3.0) + 0.001 * mm


def motor_for(power: float, reserve: float = MOTOR_RESERVE) -> float:
    """Return the rated power [kW] of the smallest motor with a reserve above a power [W]."""
    wanted = reserve * 1e-3 * power
    return next((float(each) for each in MOTORS if each >= wanted), float(math.ceil(wanted / 100.0) * 100.0))


def motor_efficiency(rated: float) -> str:
    """Return a scene's entry on the efficiency of a four-pole motor of a rated power [kW]: IE3 (M450)."""
    if motor_classes.SMALLEST <= 1e3 * rated <= motor_classes.LARGEST:
        return f"efficiency_class: {motor_classes.IE3}"
    return f"efficiency: {motor_classes.class_efficiency(motor_classes.IE3, 4, 1e3 * rated):.3g}"


def bore(oil_flow: float, density: float, drop: float, count: int = 2) -> float:
    """Return the bore [m] of `count` jets that pass an oil flow [kg/s] at a pressure difference [Pa].

    As in configs/r134a/point.yaml, the discharge coefficient is 0.7.
    """
    return math.sqrt(4.0 / math.pi * oil_flow / density / count / (0.7 * math.sqrt(2.0 * drop / density)))


def isentropic_work(k: float, gas_constant: float, T: float, ratio: float) -> float:
    """Return the work [J/kg] of lossless compression of an ideal gas by a pressure ratio, to estimate powers."""
    return k / (k - 1.0) * gas_constant * T * (ratio ** ((k - 1.0) / k) - 1.0)


def beyond_matching(pressures: float, k: float, ratio: float | None) -> float:
    """Return the work of compression to a built-in volume ratio, then at constant volume, over the lossless work.

    It holds for an ideal gas, to estimate powers; 1 for None, a ratio that matches the pressures.
    """
    if ratio is None or pressures <= 1.0:
        return 1.0
    built_in = (ratio ** (k - 1.0) - 1.0) / (k - 1.0) + pressures / ratio - 1.0
    return max(built_in / isentropic_work(k, 1.0, 1.0, pressures), 1.0)


def matching(ratio: float, k: float, share: float) -> float:
    """Return the built-in volume ratio that matches a pressure ratio, within the range on the market, to a tenth."""
    return min(max(round(share * ratio ** (1.0 / k), 1), 1.8), 5.0)


def mm(length: float, digits: int = 3) -> str:
    """Return a length [m] in millimetres, with some digits."""
    return f"{float(f'{1e3 * length:.{digits}g}'):g} mm"


def um(length: float) -> str:
    """Return a length [m] in micrometres."""
    return f"{1e6 * length:.3g} um"


def area(value: float, digits: int = 3) -> str:
    """Return an area [m²] in square millimetres, with some digits."""
    return f"{float(f'{1e6 * value:.{digits}g}'):g} mm^2"


def flow_text(flow: float) -> str:
    """Return a flow [m³/s] as in catalogues, in m³/h."""
    return f"{3600.0 * flow:.6g} m^3/h"


def rounded_flow(flow: float) -> float:
    """Return a flow [m³/s] with four digits in m³/h, as a size that was sought is stated."""
    return float(f"{3600.0 * flow:.4g}") / 3600.0


def rpm(speed: float) -> str:
    """Return a speed [rad/s] in revolutions per minute."""
    return f"{speed / RPM:.6g} rpm"


def displaced(diameter: float, speed: float, family: str = "b") -> float:
    """Return the flow [m³/s] displaced by rotors of a diameter [m] at a speed [rad/s]."""
    rotors = FAMILIES[family]
    volume = unit_volume(family, rotors.wrap_angle) * rotors.length * diameter**3
    return volume * rotors.male_lobes * speed / (2.0 * math.pi)
