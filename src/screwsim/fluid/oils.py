"""Oils with stored properties over temperature: density, heat capacity, dynamic viscosity (docs/model.md M140).

Source: POE ACD100FY: V. P. Zhelezny et al., measurements of 2007; the viscosity is their fit from 313 K to 387 K. The
grades: kinematic viscosities at 40 and 100 degC and densities at 15 degC as data sheets of such oils print them,
rounded (mineral: paraffinic, viscosity index about 100; POE: polyol esters for refrigeration; PAO: index about 135;
PAG: index about 200), between them ASTM D341; heat capacity of mineral oil and PAO by Cragoe (Bur. Standards Misc.
Publ. 97, 1929), of POE as measured for ACD100FY, of PAG a round figure. They represent no particular maker's oil: for a
known oil, write its own numbers.
"""

import math
from dataclasses import dataclass
from functools import cached_property

ZERO_CELSIUS = 273.15
AT_40, AT_100, AT_15 = (ZERO_CELSIUS + t for t in (40.0, 100.0, 15.0))
WATER = 999.1  # [kg/m^3] at 15 degC
MM2 = 1e-6  # [m^2/s] one mm^2/s, or centistokes


ESTER = "POE_"  # names of polyol esters begin so


def is_ester(name: str) -> bool:
    """Tell whether a stored oil is a polyol ester."""
    return name.startswith(ESTER)


@dataclass(frozen=True)
class MeasuredOil:
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


@dataclass(frozen=True)
class Grade:
    """An oil of an ISO grade by its data sheet: ν at 40 and 100 °C [mm²/s], ρ at 15 °C and its slope [kg/(m³ K)].

    `heat_capacity` are a and b of c = a + b (T − 273.15 K) [J/(kg K)]; `low`, `high`: range of the viscosity [K].
    """

    at_40: float
    at_100: float
    density: float
    slope: float
    heat_capacity: tuple[float, float]
    low: float = 253.15
    high: float = 423.15

    @cached_property
    def _line(self) -> tuple[float, float]:
        """A and B of ASTM D341."""
        z = [math.log10(math.log10(nu + 0.7)) for nu in (self.at_40, self.at_100)]
        slope = (z[0] - z[1]) / (math.log10(AT_100) - math.log10(AT_40))
        return z[0] + slope * math.log10(AT_40), slope

    def kinematic_at(self, T: float) -> float:
        """Return the kinematic viscosity [m²/s] (ASTM D341, above 2 mm²/s)."""
        a, b = self._line
        return MM2 * (10.0 ** (10.0 ** (a - b * math.log10(T))) - 0.7)

    def density_at(self, T: float) -> float:
        """Return the density [kg/m³]."""
        return self.density + self.slope * (T - AT_15)

    def heat_capacity_at(self, T: float) -> float:
        """Return the specific heat capacity [J/(kg K)]."""
        a, b = self.heat_capacity
        return a + b * (T - ZERO_CELSIUS)

    def viscosity_at(self, T: float) -> float:
        """Return the dynamic viscosity [Pa s]; outside `low` … `high` an extrapolation."""
        return self.kinematic_at(T) * self.density_at(T)


def _hydrocarbon(at_40: float, at_100: float, density: float, slope: float) -> Grade:
    """Return a grade of a hydrocarbon oil, whose heat capacity follows from its density at 15 °C (Cragoe)."""
    root = math.sqrt(density / WATER)
    return Grade(at_40, at_100, density, slope, (1685.0 / root, 3.39 / root))


_ESTER = 1785.6, 2.901  # heat capacity of ACD100FY, linearised about 60 degC
_GLYCOL = 1800.0, 3.0  # about 2.0 kJ/(kg K) at 60 degC
# grade: kinematic viscosity at 100 degC, density
_MINERAL = {
    32: (5.4, 865.0),
    46: (6.8, 870.0),
    68: (8.7, 875.0),
    100: (11.2, 880.0),
    150: (14.7, 885.0),
    220: (18.7, 890.0),
}
_POE = {32: 5.7, 46: 7.2, 68: 9.3, 100: 11.6, 150: 15.4, 220: 18.9}
_PAO = {
    32: (5.8, 830.0),
    46: (7.7, 834.0),
    68: (10.3, 838.0),
    100: (13.8, 842.0),
    150: (18.5, 846.0),
    220: (25.0, 850.0),
}
_PAG = {32: 6.9, 46: 9.6, 68: 13.2, 100: 18.8, 150: 26.3, 220: 37.0}

OILS: dict[str, MeasuredOil | Grade] = {
    "POE_ACD100FY": MeasuredOil(
        density=(1186.31, -0.731369),
        heat_capacity=(1304.0, 1.035, 2.801e-3),
        viscosity=(2.0022e31, -12.961),
        low=313.0,
        high=387.0,
    ),
    **{f"mineral_{grade}": _hydrocarbon(grade, nu, rho, -0.65) for grade, (nu, rho) in _MINERAL.items()},
    **{f"POE_{grade}": Grade(grade, nu, 978.0, -0.73, _ESTER) for grade, nu in _POE.items()},
    **{f"PAO_{grade}": _hydrocarbon(grade, nu, rho, -0.62) for grade, (nu, rho) in _PAO.items()},
    **{f"PAG_{grade}": Grade(grade, nu, 995.0, -0.75, _GLYCOL) for grade, nu in _PAG.items()},
}
