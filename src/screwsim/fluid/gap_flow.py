"""Flow through a narrow gap, relative to that of an isentropic nozzle: with friction or oil in it, or full of oil.

Source: docs/model.md M190–M193, M250–M252, M256. Friction: I. H. Bell, E. A. Groll, J. E. Braun, W. T. Horton, Int. J.
Refrigeration 36 (2013) 1965. Viscosity of mixtures: W. H. McAdams, W. K. Woods, L. C. Heroman, Trans. ASME 64 (1942)
193; A. Cicchitti et al., Energia Nucleare 7 (1960) 407. Turbulent friction: H. Blasius, VDI-Forschungsheft 131 (1913).
"""

import math

from screwsim.numerics.kernel import kernel

LENGTH_0 = 5e-3  # [m] reference length of the fit
GAP_0 = 1e-5  # [m] reference clearance of the fit
RADIAL_TRANSITION, FLANK_TRANSITION = 5243.58, 826.167  # Reynolds numbers of the transition to turbulence
LEAST_REYNOLDS = 1e-6
TURBULENT_FROM = 50.0  # Reynolds number below which the turbulent power is held constant, as its weight is zero there
LEAST_FLUX = 1e-9  # [kg/(m² s)]
BLASIUS = 0.3164  # friction factor of a smooth channel times Re^¼, from Re = 2000 to 1e5


@kernel
def turbulent_weight(reynolds, transition):
    """Return the weight ξ of the turbulent branch (M191)."""
    return 1.0 / (1.0 + math.exp(-0.01 * (reynolds - transition)))


@kernel
def radial_divisor(reynolds, length, gap):
    """Return M of a flat gap `length` [m] deep in the direction of flow (M191).

    Re refers to the nozzle's flow and 2 gap.
    """
    xi = turbulent_weight(reynolds, RADIAL_TRANSITION)
    size = 25932.107 * (length / LENGTH_0) ** 0.914825434 / (-177.588568 * (gap / GAP_0) - 0.237052788)
    turbulent = -172347.611 * max(reynolds, TURBULENT_FROM) ** -12.06876 - 0.012886116
    laminar = -151.202604 * reynolds**-0.999674458 + 0.016143504
    return size * (xi * turbulent + (1.0 - xi) * laminar) + 0.825533457


@kernel
def flank_divisor(reynolds, length, gap):
    """Return M between two flanks whose radii of curvature differ by `length` [m] (M191)."""
    xi = turbulent_weight(reynolds, FLANK_TRANSITION)
    size = -2.639703959 * (length / LENGTH_0) ** -0.567164431 / (0.836554999 * (gap / GAP_0) + 0.810567168)
    turbulent = 6174.02826 * max(reynolds, TURBULENT_FROM) ** -7.609079625 - 0.510200923
    laminar = -1205.17483 * reynolds**-1.029389142 + 0.689497786
    return size * (xi * turbulent + (1.0 - xi) * laminar) + 1.096077351


@kernel
def radial_friction(flux, gap, passage, gas_viscosity):
    """Return the share of the nozzle's flux [kg/(m² s)] that passes a flat gap: 1/M, at most 1 (M191)."""
    reynolds = max(2.0 * gap * flux / gas_viscosity, LEAST_REYNOLDS)
    return 1.0 / max(1.0, radial_divisor(reynolds, passage, gap))


@kernel
def flank_friction(flux, gap, passage, gas_viscosity):
    """Return the share of the nozzle's flux [kg/(m² s)] that passes between two flanks: 1/M, at most 1 (M191)."""
    reynolds = max(2.0 * gap * flux / gas_viscosity, LEAST_REYNOLDS)
    return 1.0 / max(1.0, flank_divisor(reynolds, passage, gap))


@kernel
def volume_share(density, oil_ratio, oil_room):
    """Return the gas's share β of the volume, above one half, from the effective density ρ β² of a flow (M107)."""
    return 0.5 + 0.5 * math.sqrt(max(0.0, 1.0 - 4.0 * oil_ratio * oil_room * density))


@kernel
def homogeneous(oil_ratio, density, oil_room):
    """Return s: the share of the gas nozzle's flux that passes an opening without depth, with its oil (M192)."""
    x = max(oil_ratio, 0.0)
    return 1.0 / math.sqrt((1.0 + x) * volume_share(density, x, oil_room))


@kernel
def mixture_passes(flux, oil_ratio, density, gap, passage, viscosity, oil_room):
    """Return the share of the gas nozzle's flux that passes with its oil, slowed by inertia and friction (M192)."""
    x = max(oil_ratio, 0.0)
    slowed = homogeneous(x, density, oil_room)
    mixture_flux = max(flux * slowed * (1.0 + x), LEAST_FLUX)
    r = 12.0 * viscosity * passage / (mixture_flux * gap * gap)
    return slowed / (math.sqrt(1.0 + r * r) + r)


@kernel
def mcadams_viscosity(oil_ratio, gas_viscosity, oil_viscosity):
    """Return McAdams' viscosity [Pa s] of a mixture, which is close to the gas's (M193)."""
    return (1.0 + oil_ratio) / (1.0 / gas_viscosity + oil_ratio / oil_viscosity)


@kernel
def cicchitti_viscosity(oil_ratio, gas_viscosity, oil_viscosity):
    """Return Cicchitti's viscosity [Pa s] of a mixture, which is close to the oil's (M193)."""
    return (gas_viscosity + oil_ratio * oil_viscosity) / (1.0 + oil_ratio)


@kernel
def mcadams_mixture(flux, oil_ratio, density, gap, passage, gas_viscosity, oil_viscosity, oil_room):
    """Return the same as `mixture_passes` with McAdams' viscosity, which is close to the gas's (M193)."""
    x = max(oil_ratio, 0.0)
    viscosity = mcadams_viscosity(x, gas_viscosity, oil_viscosity)
    return mixture_passes(flux, x, density, gap, passage, viscosity, oil_room)


@kernel
def cicchitti_mixture(flux, oil_ratio, density, gap, passage, gas_viscosity, oil_viscosity, oil_room):
    """Return the same as `mixture_passes` with Cicchitti's viscosity, which is close to the oil's (M193)."""
    x = max(oil_ratio, 0.0)
    viscosity = cicchitti_viscosity(x, gas_viscosity, oil_viscosity)
    return mixture_passes(flux, x, density, gap, passage, viscosity, oil_room)


@kernel
def turbulent_passes(mixture_flux, gap, passage, viscosity):
    """Return the share g of a mixture's frictionless flux [kg/(m² s)] that Blasius's friction lets pass (M192).

    It solves g² + b g^1.75 = 1 by Newton's method, from above as the left side is convex: within 1e-8 up to b = 20, and
    4e-6 up to 1000.
    """
    b = 0.5 * BLASIUS * passage / (gap * math.sqrt(math.sqrt(2.0 * gap * mixture_flux / viscosity)))
    g = 1.0 / math.sqrt(1.0 + b)
    for _ in range(3):
        friction = b / math.sqrt(math.sqrt(g))
        g = g - (g * g * (1.0 + friction) - 1.0) / (g * (2.0 + 1.75 * friction))
    return g


@kernel
def mixture_passes_by_larger(flux, oil_ratio, density, gap, passage, viscosity, oil_room):
    """Return `mixture_passes` with the larger friction of both, laminar or Blasius's (M192)."""
    x = max(oil_ratio, 0.0)
    slowed = homogeneous(x, density, oil_room)
    mixture_flux = max(flux * slowed * (1.0 + x), LEAST_FLUX)
    turbulent = slowed * turbulent_passes(mixture_flux, gap, passage, viscosity)
    return min(mixture_passes(flux, x, density, gap, passage, viscosity, oil_room), turbulent)


@kernel
def mcadams_blasius(flux, oil_ratio, density, gap, passage, gas_viscosity, oil_viscosity, oil_room):
    """Return the same as `mixture_passes_by_larger` with McAdams' viscosity (M193)."""
    viscosity = mcadams_viscosity(max(oil_ratio, 0.0), gas_viscosity, oil_viscosity)
    return mixture_passes_by_larger(flux, oil_ratio, density, gap, passage, viscosity, oil_room)


@kernel
def cicchitti_blasius(flux, oil_ratio, density, gap, passage, gas_viscosity, oil_viscosity, oil_room):
    """Return the same as `mixture_passes_by_larger` with Cicchitti's viscosity (M193)."""
    viscosity = cicchitti_viscosity(max(oil_ratio, 0.0), gas_viscosity, oil_viscosity)
    return mixture_passes_by_larger(flux, oil_ratio, density, gap, passage, viscosity, oil_room)


@kernel
def filled_share(oil_ratio, filled_from):
    """Return the share of a gap's length that oil fills: 0 without oil, 1 from `filled_from` on, C1 (M250)."""
    u = min(max(oil_ratio, 0.0) / filled_from, 1.0)
    return u * u * (3.0 - 2.0 * u)


@kernel
def open_share(oil_ratio, filled_from):
    """Return the share of a gap's length that oil leaves to the gas, which flows there as through a nozzle (M250)."""
    return 1.0 - filled_share(oil_ratio, filled_from)


@kernel
def film_flux(drop, gap, passage, oil_viscosity, oil_density):
    """Return the mass flux [kg/(m² s)] of oil that a pressure difference ≥ 0 [Pa] drives through a full gap (M251)."""
    laminar = oil_density * gap * gap / (12.0 * oil_viscosity * passage)
    return 2.0 * laminar * drop / (1.0 + math.sqrt(1.0 + 2.0 * laminar * laminar * drop / oil_density))


@kernel
def oil_film(drop, oil_ratio, gap, passage, filled_from, oil_viscosity, oil_density):
    """Return the flux [kg/(m² s)] of oil over the gap's whole area: `film_flux` in the share that oil fills (M252)."""
    return filled_share(oil_ratio, filled_from) * film_flux(drop, gap, passage, oil_viscosity, oil_density)


@kernel
def dragged_oil(oil_ratio, filled_from, wall_speed, tip_speed, oil_density):
    """Return the flux [kg/(m² s)] of oil over the gap's area that a moving wall drags along (M256).

    `wall_speed` is the wall's speed across the gap over the tip speed; `oil_ratio` is that of the chamber ahead.
    """
    return 0.5 * filled_share(oil_ratio, filled_from) * oil_density * wall_speed * tip_speed
