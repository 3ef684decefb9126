"""Nozzle flow of gas that carries oil along: Murdock's and Chisholm's separated flow through an orifice.

Source: docs/model.md M430. J. W. Murdock, J. Basic Eng. 84 (1962) 419; D. Chisholm, Two-phase flow through sharp-edged
orifices, J. Mech. Eng. Sci. 19 (1977) 128, the exponent 1/4; measured there with steam and water, gas and water.
"""

import math

from screwsim.fluid.gap_flow import volume_share
from screwsim.fluid.nozzle import choking, flow
from screwsim.numerics.kernel import kernel


# M430
@kernel
def wet_share(density, oil_ratio, chisholm_exponent, oil_density, oil_room):
    """Return the share of a dry nozzle's flux that gas passes with its oil; `density` is the effective one [kg/m³].

    1/√(1 + C X + X²), X = x √(ρ/ρ_o), C = (ρ_o/ρ)ⁿ + (ρ/ρ_o)ⁿ. The result includes the oil's share of the opening, so
    the one that the effective density already contains (M107) is divided out.
    """
    x = max(oil_ratio, 0.0)
    beta = volume_share(density, x, oil_room)
    ratio = oil_density * beta * beta / density
    slip = ratio**chisholm_exponent
    met = 1.0 + (slip + 1.0 / slip) * x / math.sqrt(ratio) + x * x / ratio
    return 1.0 / (beta * math.sqrt(met))


@kernel
def wet_flux(
    p_1,
    rho_1,
    exponent_1,
    oil_ratio_1,
    p_2,
    rho_2,
    exponent_2,
    oil_ratio_2,
    width,
    chisholm_exponent,
    oil_density,
    oil_room,
):
    """Return the flux of gas [kg/(m² s)] from port state 2 into 1, which carries the donor's oil along (M430)."""
    if p_2 >= p_1:
        density, exponent = rho_2, exponent_2
        share = wet_share(rho_2, oil_ratio_2, chisholm_exponent, oil_density, oil_room)
    else:
        density, exponent = rho_1, exponent_1
        share = wet_share(rho_1, oil_ratio_1, chisholm_exponent, oil_density, oil_room)
    choke, choked = choking(1.0 / exponent)
    return share * flow(1.0, p_1, density, exponent, choke, choked, p_2, density, exponent, choke, choked, width)
