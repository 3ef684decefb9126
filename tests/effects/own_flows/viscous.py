"""Laminar flow through a long slot, a law that the package does not have: its kernels alone."""

from screwsim.numerics.kernel import kernel


@kernel
def slot_flux(p_1, rho_1, p_2, rho_2, height, length, viscosity):
    """Return the mass flux [kg/(m² s)] into 1: plane Poiseuille flow at the mean density, h² ρ Δp/(12 μ l)."""
    return height * height * 0.5 * (rho_1 + rho_2) * (p_2 - p_1) / (12.0 * viscosity * length)


@kernel
def flux_of_warm_gas(p_1, h_1, exponent_1, p_2, h_2, exponent_2, height, length, viscosity):
    """Return the same of an ideal gas of h = k/(k−1) p/ρ, from its enthalpies [J/kg] and exponents 1/k."""
    rho_1, rho_2 = p_1 / (h_1 * (1.0 - exponent_1)), p_2 / (h_2 * (1.0 - exponent_2))
    return slot_flux(p_1, rho_1, p_2, rho_2, height, length, viscosity)
