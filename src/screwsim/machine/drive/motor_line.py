"""The motor's torque over its speed: a straight line, as an inverter imposes it, or Kloss's law of an induction motor.

What: M_m(ω_m; ω_0) of a motor whose torque vanishes at its no-load speed ω_0 (M212).
Source: M. Kloss, Drehmoment und Schlüpfung des Drehstrommotors, Archiv für Elektrotechnik 5 (1916) 59–87; the line is
its tangent at small slip.
Assumptions: the torque follows the speed at once (no electrical transients); no field weakening.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from screwsim.inputs.declare import choice, number, quantity
from screwsim.inputs.faults import Fault

LINE, INDUCTION = "line", "induction"
NEEDED = {LINE: ("slope",), INDUCTION: ("breakdown_torque", "breakdown_slip")}
BELONGS = {LINE: (*NEEDED[LINE], "torque_limit"), INDUCTION: NEEDED[INDUCTION]}


@dataclass(frozen=True)
class Motor:
    """The torque law of the motor and its numbers."""

    law: str = choice("line: a slope and a limit; induction: Kloss's law", (LINE, INDUCTION))
    slope: float | None = quantity(
        "torsional_damping", "slope of torque over the drop of speed below no load", None, gt=0.0
    )
    torque_limit: float | None = quantity("torque", "largest torque of the motor (law: line)", None, gt=0.0)
    breakdown_torque: float | None = quantity(
        "torque", "M_k: largest torque of the motor (law: induction)", None, gt=0.0
    )
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
