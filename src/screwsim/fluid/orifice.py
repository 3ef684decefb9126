"""Injection orifice: steady flow of oil through a short bore (M30).

Source: Lichtarowicz, Duggins, Markland, J. Mech. Eng. Sci. 7 (1965) 210: C_du = 0.827 − 0.0085 L/D, 1/C_d = 1/C_du +
20/R (1 + 2.25 L/D) − 0.005 L/D / (1 + 7.5 lg²(0.00015 R)), with the hydraulic Reynolds number R = ρ D √(2 Δp/ρ)/μ of
the loss-free velocity, fitted for 10 < R < 20 000 and 2 ≤ L/D ≤ 10. Abridged quotations of the formula omit the last
term; it changes C_d by up to 0.8, 1.9 and 3.7 % at L/D = 2, 5 and 10. Above R = 20 000 C_d hardly changes any more (by
0.4 % at L/D = 2), so only the lower end of that range is checked.
"""

import math

from screwsim.numerics.kernel import kernel

FITTED_SLENDERNESS = (2.0, 10.0)  # L/D
LEAST_REYNOLDS = 10.0
NO_FLOW = 0.827 / 0.0085  # L/D at which C_du is zero
_EDGE = 1e-9  # relative tolerance, so that a bore of exactly two or ten diameters lies inside


def outside_fit(slenderness: float, reynolds: float) -> str:
    """Return in what respect a bore lies outside the range of M30, with the remedy; empty inside."""
    low, high = FITTED_SLENDERNESS
    if not low * (1.0 - _EDGE) <= slenderness <= high * (1.0 + _EDGE):
        what = f"the bore is {slenderness:.3g} diameters long, and the fit covers {low:g} to {high:g}"
        return f"{what} (choose another oil_supply.orifice_length)"
    if 0.0 < reynolds < LEAST_REYNOLDS:
        what = f"the bore's Reynolds number is {reynolds:.2g}, and the fit covers those above {LEAST_REYNOLDS:g}"
        return f"{what} (choose a wider oil_supply.orifice_diameter, or a thinner oil)"
    return ""


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
    """Return the oil flow [kg/s] through `number` bores under the pressure difference dp [Pa]; zero for dp ≤ 0."""
    if dp <= 0.0:
        return 0.0
    velocity = math.sqrt(2.0 * dp / density)
    reynolds = density * velocity * diameter / viscosity
    area = number * 0.25 * math.pi * diameter * diameter
    return discharge_coefficient(reynolds, length / diameter) * area * density * velocity


@kernel
def orifice_flow_behind_line(dp, line_loss, line_flow, density, viscosity, diameter, length, number):
    """Return the same as `orifice_flow`, with a line in series that loses line_loss [Pa] at line_flow [m³/s] (M392)."""
    free = orifice_flow(dp, density, viscosity, diameter, length, number)
    if free <= 0.0:
        return 0.0
    nominal = density * line_flow
    return free / math.sqrt(1.0 + line_loss * free * free / (nominal * nominal * dp))


@kernel
def smooth_orifice_flow(dp, width, density, viscosity, diameter, length, number):
    """Return the same as `orifice_flow`, with a continuous slope at dp = 0: Δp → Δp² (Δp² + ε²)^(−1/2), ε = width."""
    if dp <= 0.0:
        return 0.0
    smooth = dp * dp / math.sqrt(dp * dp + width * width)
    return orifice_flow(smooth, density, viscosity, diameter, length, number)
