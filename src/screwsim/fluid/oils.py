"""Oils whose properties over temperature are stored: density, heat capacity, dynamic viscosity (docs/model.md M140).

Source: POE ACD100FY: V. P. Zhelezny et al., measurements of 2007; the viscosity is their fit from 313 K to 387 K.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Oil:
    """Fits of one oil: ρ = a + b T, c = a + b T + d T², μ = A T^n; T [K], SI units; `low`, `high`: range of μ [K]."""

    density: tuple[float, float]
    heat_capacity: tuple[float, float, float]
    viscosity: tuple[float, float]
    low: float
    high: float

    def density_at(self, T: float) -> float:
        """Return the density [kg/m³] (M140)."""
        return self.density[0] + self.density[1] * T

    def heat_capacity_at(self, T: float) -> float:
        """Return the specific heat capacity [J/(kg K)] (M140)."""
        a, b, d = self.heat_capacity
        return a + T * (b + d * T)

    def viscosity_at(self, T: float) -> float:
        """Return the dynamic viscosity [Pa s] (M140); outside `low` … `high` an extrapolation."""
        return self.viscosity[0] * T ** self.viscosity[1]


OILS = {
    "POE_ACD100FY": Oil(
        density=(1186.31, -0.731369),
        heat_capacity=(1304.0, 1.035, 2.801e-3),
        viscosity=(2.0022e31, -12.961),
        low=313.0,
        high=387.0,
    )
}
