"""Laminar flow through a long slot, a law that the package does not have: its kernel alone."""

from screwsim.numerics.kernel import kernel


@kernel
def slot_flux(p_1, rho_1, p_2, rho_2, height, length, viscosity):
    """Return the mass flux [kg/(m² s)] into 1: plane Poiseuille flow at the mean density, h² ρ Δp/(12 μ l)."""
    return height * height * 0.5 * (rho_1 + rho_2) * (p_2 - p_1) / (12.0 * viscosity * length)
