"""The drive train: motor, coupling (a linear spring: M211), rotors as inertias on one shaft (docs/reference/drive.md).

What: two masses, a spring and a damper between them, the motor's torque on one, gas and losses on the other
(M210–M213); its torsional frequency and the speeds at which a lobe harmonic meets it (M216).
Source: textbook dynamics of two masses (M210); the spring may be the rubber-cord coupling (docs/reference/coupling.md).
Assumptions: no gear, or inertias and motor referred to the male rotor; rotors without play, the female's inertia
referred to the male shaft; viscous damping.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from screwsim.inputs.declare import quantity
from screwsim.machine.drive.motor_line import Motor

Array = np.ndarray
ORDERS = 4  # number of lobe harmonics that are checked for resonance
NEAR = 0.1  # relative distance of a harmonic's frequency from the torsional one that counts as resonance


@dataclass(frozen=True)
class Train:
    """Inertias [kg m²], coupling, damping [N m s/rad], motor, and the meaning of the scene's speed [rad/s].

    `holds_mean`: a controller sets the no-load speed so that the mean speed of the rotors is `speed`; else `speed` is
    the no-load speed. `lobes` of the male rotor: the pitch is 2π/lobes.
    """

    motor_inertia: float
    rotor_inertia: float
    coupling: Any  # LinearCoupling or RubberCordCoupling
    damping: float
    motor: Motor
    holds_mean: bool
    speed: float
    lobes: int

    @property
    def pitch(self) -> float:
        """Lobe pitch [rad]."""
        return 2.0 * math.pi / self.lobes

    def spring(self, theta: Array) -> tuple[Array, Array]:
        """Return torque [N m] and tangent stiffness [N m/rad] of the coupling at an array of twists [rad]."""
        if isinstance(self.coupling, LinearCoupling):
            return self.coupling.spring * theta, np.full(len(theta), self.coupling.spring)
        twists = theta.tolist()
        torque = np.array([self.coupling.torque(each) for each in twists])
        return torque, np.array([self.coupling.stiffness(each) for each in twists])

    def frequency(self, twist: float) -> float:
        """Return the first torsional frequency [Hz] of small undamped motions about a twist [rad] (M216)."""
        stiffness = self.coupling.stiffness(twist)
        return math.sqrt(stiffness * (1.0 / self.motor_inertia + 1.0 / self.rotor_inertia)) / (2.0 * math.pi)

    def resonance_speed(self, twist: float, order: int = 1) -> float:
        """Return the speed [rad/s] at which the lobe harmonic `order` has the torsional frequency (M216)."""
        return 2.0 * math.pi * self.frequency(twist) / (order * self.lobes)

    def near_resonance(self, twist: float, omega: float) -> int | None:
        """Return the lobe harmonic that is within `NEAR` of the torsional frequency; None where none is."""
        for order in range(1, ORDERS + 1):
            if abs(omega / self.resonance_speed(twist, order) - 1.0) <= NEAR:
                return order
        return None

    def stored(self, rotor_speed: float, motor_speed: float, twist: float) -> float:
        """Return the energy in both masses and the coupling [J] (M215)."""
        kinetic = 0.5 * (self.rotor_inertia * rotor_speed**2 + self.motor_inertia * motor_speed**2)
        return kinetic + self.coupling.energy(twist)


@dataclass(frozen=True)
class LinearCoupling:
    """M = c Θ up to a twist at which the coupling fails."""

    spring: float = quantity("torsional_stiffness", "stiffness: torque over twist", gt=0.0)
    largest_twist: float | None = quantity("angle", "twist at which the coupling fails", None, gt=0.0)

    def torque(self, theta: float) -> float:
        """Return the torque at a twist [N m] (M211)."""
        return self.spring * theta

    def stiffness(self, theta: float) -> float:
        """Return the stiffness [N m/rad], the same at every twist."""
        return self.spring

    def energy(self, theta: float) -> float:
        """Return the stored energy at a twist [J]."""
        return 0.5 * self.spring * theta * theta

    def twist(self, moment: float) -> float:
        """Return the twist [rad] at a torque [N m]."""
        return moment / self.spring

    def state(self, theta: float) -> str:
        """Return 'sound', or why the coupling cannot bear a twist [rad], with the remedy."""
        if self.largest_twist is None or abs(theta) <= self.largest_twist:
            return "sound"
        found, most = math.degrees(theta), math.degrees(self.largest_twist)
        return (
            f"the coupling fails: twisted by {found:.3g} deg, beyond {most:.3g} deg (choose a stiffer coupling or a "
            "softer start)"
        )
