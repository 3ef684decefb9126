"""Injection orifice: steady flow of oil through a short bore (M30).

Source: Lichtarowicz, Duggins, Markland, J. Mech. Eng. Sci. 7 (1965) 210: C_du = 0.827 − 0.0085 L/D,
1/C_d = 1/C_du + 20/R (1 + 2.25 L/D) − 0.005 L/D / (1 + 7.5 lg²(0.00015 R)), with the hydraulic Reynolds number
R = ρ D √(2 Δp/ρ)/μ of the loss-free velocity, fitted for 10 < R < 20 000 and 2 ≤ L/D ≤ 10. The last term is missing
where the formula is quoted short; it changes C_d by up to 0.8, 1.9 and 3.7 % at L/D = 2, 5 and 10.
"""

from __future__ import annotations

import math

from screwsim.numerics.kernel import kernel


@kernel
def discharge_coefficient(reynolds, slenderness):
    """Return C_d of a bore of length over diameter `slenderness` at the hydraulic Reynolds number (M30)."""
    ultimate = 0.827 - 0.0085 * slenderness
    log_term = math.log10(0.00015 * reynolds)
    inverse = (
        1.0 / ultimate
        + 20.0 / reynolds * (1.0 + 2.25 * slenderness)
        - 0.005 * slenderness / (1.0 + 7.5 * log_term * log_term)
    )
    return 1.0 / inverse


@kernel
def orifice_flow(dp, density, viscosity, diameter, length, number):
    """Return the oil flow [kg/s] through `number` bores under the pressure difference dp [Pa]; none backwards."""
    if dp <= 0.0:
        return 0.0
    velocity = math.sqrt(2.0 * dp / density)
    reynolds = density * velocity * diameter / viscosity
    area = number * 0.25 * math.pi * diameter * diameter
    return discharge_coefficient(reynolds, length / diameter) * area * density * velocity


@kernel
def smooth_orifice_flow(dp, width, density, viscosity, diameter, length, number):
    """Return what `orifice_flow` does, with a continuous slope where it ends: Δp → Δp² (Δp² + ε²)^(−1/2), ε = width."""
    if dp <= 0.0:
        return 0.0
    smooth = dp * dp / math.sqrt(dp * dp + width * width)
    return orifice_flow(smooth, density, viscosity, diameter, length, number)
