"""The drive train: motor, coupling (a linear spring: M211), rotors as inertias on one shaft (docs/reference/drive.md).

What: two masses, a spring and a damper between them, the motor's torque on one, gas and losses on the other
(M210–M213); its torsional frequency and the speeds at which a lobe harmonic meets it (M216). M_m(ω_m; ω_0) of a motor,
whose torque vanishes at its no-load speed ω_0, is a straight line, as an inverter imposes it, or Kloss's law of an
induction motor (M212).
Source: textbook dynamics of two masses (M210); the spring may be the rubber-cord coupling (docs/reference/coupling.md);
M. Kloss, Drehmoment und Schlüpfung des Drehstrommotors, Archiv für Elektrotechnik 5 (1916) 59–87; the line is its
tangent at small slip.
Assumptions: no gear, or inertias and motor referred to the male rotor; rotors without play, the female's inertia
referred to the male shaft; viscous damping; the torque follows the speed at once (no electrical transients); no field
weakening.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from screwsim.inputs.declare import choice, number, optional, quantity
from screwsim.inputs.faults import Fault

LINE, INDUCTION = "line", "induction"
NEEDED = {LINE: ("slope",), INDUCTION: ("breakdown_torque", "breakdown_slip")}
BELONGS = {LINE: (*NEEDED[LINE], "torque_limit"), INDUCTION: NEEDED[INDUCTION]}


@dataclass(frozen=True)
class Motor:
    """The torque law of the motor and its numbers."""

    law: str = choice("line: a slope and a limit; induction: Kloss's law", (LINE, INDUCTION))
    slope: float | None = optional("torsional_damping", "slope of torque over the drop of speed below no load")
    torque_limit: float | None = optional("torque", "largest torque of the motor (law: line)")
    breakdown_torque: float | None = optional("torque", "M_k: largest torque of the motor (law: induction)")
    breakdown_slip: float | None = number("s_k: slip at that torque (law: induction)", None, gt=0.0, lt=1.0)

    @property
    def is_line(self) -> bool:
        """Whether the torque falls in a straight line, without a breakdown."""
        return self.law == LINE

    @property
    def most(self) -> float:
        """Largest torque [N m]; infinite for a line without a limit."""
        known = self.torque_limit if self.is_line else self.breakdown_torque
        return math.inf if known is None else known

    def torque(self, omega: Any, no_load: float) -> Any:
        """Return the torque [N m] at a speed [rad/s] and no-load speed [rad/s], without the limit of a line (M212)."""
        if self.is_line:
            return (self.slope or 0.0) * (no_load - omega)
        x = (no_load - omega) / (no_load * (self.breakdown_slip or 1.0))
        return 2.0 * (self.breakdown_torque or 0.0) * x / (x * x + 1.0)

    def limited_torque(self, omega: float, no_load: float) -> float:
        """Return the torque [N m] during a start-up, where a line stays within its limit."""
        found = self.torque(omega, no_load)
        return float(min(max(found, -self.most), self.most))

    def slopes(self, omega: Any, no_load: float) -> tuple[Any, Any]:
        """Return the derivatives [N m s/rad] of the torque by the speed and by the no-load speed."""
        if self.is_line:
            slope = (self.slope or 0.0) * np.ones_like(omega)
            return -slope, slope
        scale = no_load * (self.breakdown_slip or 1.0)
        x = (no_load - omega) / scale
        by_x = 2.0 * (self.breakdown_torque or 0.0) * (1.0 - x * x) / (x * x + 1.0) ** 2
        return -by_x / scale, by_x * omega / (no_load * scale)

    def no_load_speed(self, omega: float, moment: float) -> float:
        """Return the no-load speed [rad/s] at which the motor gives `moment` [N m] at `omega` on its stable branch.

        The torque has to lie below `most`.
        """
        if self.is_line:
            return omega + moment / (self.slope or 1.0)
        return omega / (1.0 - self._slip(moment))

    def speed(self, no_load: float, moment: float) -> float:
        """Return the speed [rad/s] at which the motor gives a torque [N m], on its stable branch."""
        if self.is_line:
            return no_load - moment / (self.slope or 1.0)
        return no_load * (1.0 - self._slip(moment))

    def _slip(self, moment: float) -> float:
        most, slip = self.breakdown_torque or 1.0, self.breakdown_slip or 1.0
        if moment == 0.0:
            return 0.0
        ratio = most / moment
        return slip / (ratio + math.copysign(math.sqrt(max(ratio * ratio - 1.0, 0.0)), ratio))


def check_motor(motor: Motor, path: str) -> list[Fault]:
    """Return the faults of keys that the motor's law lacks, or that belong to the other law."""
    faults = [
        Fault(f"{path}.{name}", f"is missing ({motor.law} needs it)")
        for name in NEEDED[motor.law]
        if getattr(motor, name) is None
    ]
    others = {name for law, names in BELONGS.items() if law != motor.law for name in names}
    return faults + [
        Fault(f"{path}.{name}", f"applies only to the other law, and {motor.law} is chosen (remove it)")
        for name in sorted(others - set(BELONGS[motor.law]))
        if getattr(motor, name) is not None
    ]


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
    largest_twist: float | None = optional("angle", "twist at which the coupling fails")

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
