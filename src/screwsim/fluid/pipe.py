"""Pressure loss of a liquid in a smooth pipe.

Source: Darcy–Weisbach; laminar 64/Re (Hagen–Poiseuille) up to Re = 2000, turbulent 0.3164 Re^−0.25 (Blasius 1913, to Re
= 1e5) from 4000 on; in the transition between, the factor is linear in Re (ours).
"""

import math

LAMINAR, TURBULENT = 2000.0, 4000.0  # Reynolds numbers


def friction_factor(Re: float) -> float:
    """Return Darcy's friction factor of a smooth pipe at a Reynolds number > 0."""
    if Re <= LAMINAR:
        return 64.0 / Re
    if Re >= TURBULENT:
        return 0.3164 * Re**-0.25
    share = (Re - LAMINAR) / (TURBULENT - LAMINAR)
    return (1.0 - share) * friction_factor(LAMINAR) + share * friction_factor(TURBULENT)


def pressure_loss(
    volume_flow: float, density: float, viscosity: float, diameter: float, length: float, fittings: float = 0.0
) -> float:
    """Return (f L/D + ζ) ρ w²/2 [Pa] (M390) at a volume flow [m³/s]; `fittings` is the sum of the ζ of fittings."""
    if volume_flow <= 0.0:
        return 0.0
    w = volume_flow / (0.25 * math.pi * diameter**2)
    f = friction_factor(density * w * diameter / viscosity)
    return (f * length / diameter + fittings) * 0.5 * density * w**2
