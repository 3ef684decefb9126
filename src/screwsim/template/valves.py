"""Reed valves of a new cylinder: ports by the gas's mean velocity, reeds by its pressure drop and the shaft's speed.

Velocity W = c_m F/A: valves of process compressors are chosen for 18.2 m/s at a molar mass of 20 kg/kmol and for 35.6
m/s at 7 (Bloch, Hoefner: Reciprocating Compressors, Gulf 1996, p. 391-392), some 0.05 of the speed of sound of either
gas; W is that of API 618, 6.9.1. For refrigeration no number was found (docs/reference/slider-crank.md, S36, S37).
Reed: that of the example compressor of PDSim (examples/recip_compressor.py; R410A, bore 20 mm, 3600 rpm), scaled.
Its natural frequency and damping: fitted to two rated cylinders from 25 to 87 Hz (validation/varispeed).
"""

import math
from typing import NamedTuple

MACH = 0.05  # mean velocity through an open valve over the speed of sound
LARGEST_MACH = 0.12  # ours: both valves then take 6 % of the indicated power at -10/40 degC, 14 % at 5/30 degC (R134a)
FLOW_COEFFICIENT = 0.7  # default of effects.reed_valves
FULLY_OPEN = 0.5**0.5  # opening of a reed at its stop, where curtain and port are equal (S27)

PORT, WIDTH, LENGTH, ARM, THICKNESS = 5.9e-3, 7e-3, 18e-3, 14e-3, 0.1532e-3  # [m] of the reed that is scaled
YOUNG, DENSITY = 193e9, 8000.0  # [Pa], [kg/m³] of its steel
FREQUENCIES = 10.0  # natural frequency of a reed over that of its shaft: fitted (validation/varispeed)
DAMPING_RATIO = 0.25  # fitted with it; the gas that a reed displaces gives 0.02 to 0.09 of it (S38)
LARGEST_LIFT = 0.09  # of the cylinder's bore; scenes warn above 0.1
ROOM = 0.25 * (PORT / WIDTH) ** 2  # of the piston's area: two reeds side by side are half as wide as the bore


class Valve(NamedTuple):
    """A valve in SI units; `bore`: diameter of each of its round ports, `frequency`: natural one of its reed [Hz]."""

    area: float
    velocity: float
    mach: float
    bore: float
    stop: float
    mass: float
    stiffness: float
    frequency: float

    @property
    def perimeter(self) -> float:
        """Perimeter [m] of all ports, so that the curtain at the stop is as large as the ports."""
        return self.area / self.stop


def valve(piston: float, piston_speed: float, speed: float, pressure: float, k: float, sound: float) -> Valve:
    """Return the valve of a piston's area [m²] and mean speed [m/s], a shaft's speed [rad/s] and a gas (S36, S37).

    The gas has a pressure [Pa], an isentropic exponent and a speed of sound [m/s].
    """
    area = piston * min(piston_speed / (MACH * sound), ROOM)
    velocity = piston_speed * piston / area
    mach = velocity / sound
    spring = 0.5 * k * pressure * (mach / (FLOW_COEFFICIENT * FULLY_OPEN)) ** 2
    thickness = (spring / _spring()) ** (1.0 / 3.0)  # over that of the known reed, in port diameters
    wanted = FREQUENCIES * speed / (2.0 * math.pi)
    largest = min(_diameter(area), 4.0 * LARGEST_LIFT * _diameter(piston))
    bore = min(PORT * thickness * known_frequency() / wanted, largest)
    frequency, stop = known_frequency() * thickness * PORT / bore, 0.25 * bore
    stiffness = spring * area / stop
    mass = stiffness / (2.0 * math.pi * frequency) ** 2
    return Valve(area, velocity, mach, bore, stop, mass, stiffness, frequency)


def _diameter(area: float) -> float:
    """Return the diameter [m] of a circle's area [m²]."""
    return math.sqrt(4.0 * area / math.pi)


def _stiffness() -> float:
    """Return the stiffness [N/m] of the known reed: a cantilever loaded at its arm."""
    inertia = WIDTH * THICKNESS**3 / 12.0
    return 6.0 * YOUNG * inertia / (ARM**2 * (3.0 * LENGTH - ARM))


def known_frequency() -> float:
    """Return the natural frequency [Hz] of the known reed, of whose mass a third moves."""
    mass = DENSITY * LENGTH * WIDTH * THICKNESS / 3.0
    return math.sqrt(_stiffness() / mass) / (2.0 * math.pi)


def _spring() -> float:
    """Return the force of the known reed over its port [Pa] at a lift of a quarter of the port's diameter."""
    return _stiffness() * 0.25 * PORT / (0.25 * math.pi * PORT**2)
