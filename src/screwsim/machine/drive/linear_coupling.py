"""A linear torsional spring between motor and rotors (M211)."""

import math
from dataclasses import dataclass

from screwsim.inputs.declare import quantity


@dataclass(frozen=True)
class LinearCoupling:
    """M = c Θ up to a twist at which the coupling fails."""

    spring: float = quantity("torsional_stiffness", "torque over twist", gt=0.0)
    largest_twist: float | None = quantity("angle", "twist at which the coupling fails", None, gt=0.0)

    def torque(self, theta: float) -> float:
        """Return the torque at a twist [N m] (M211)."""
        return self.spring * theta

    def stiffness(self, theta: float) -> float:
        """Return the stiffness [N m/rad]; it is the same at every twist."""
        return self.spring

    def energy(self, theta: float) -> float:
        """Return the stored energy at a twist [J]."""
        return 0.5 * self.spring * theta * theta

    def twist(self, moment: float) -> float:
        """Return the twist that carries a torque [rad]."""
        return moment / self.spring

    def state(self, theta: float) -> str:
        """Return what a twist means: `sound`, or why it cannot be borne, with the remedy."""
        if self.largest_twist is None or abs(theta) <= self.largest_twist:
            return "sound"
        found, most = math.degrees(theta), math.degrees(self.largest_twist)
        return (
            f"the coupling fails: twisted by {found:.3g} deg, beyond {most:.3g} deg (choose a stiffer coupling or a "
            "softer start)"
        )
