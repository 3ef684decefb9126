"""The paper's laws of volume and port areas over the male-rotor angle.

Source: Chernov et al. 2015, eqs. (16)–(18). All three are one C1 bump B(x; c) on x ∈ [0, 2]; the middle branch of
(18) is corrected (docs/model.md, M18).
"""

from math import pi

from screwsim.numerics.kernel import kernel

TURN = 2.0 * pi
LIFE = 2.0 * TURN  # angle of a chamber's life, 720° (before eq. 5)


@kernel
def bump(x, c):
    """Return B(x; c): x²/c, then 1 + (x−1)²/(c−1), then (x−2)²/c; zero outside [0, 2] (M15).

    c in (0, 1]; at c = 1 there is no middle branch.
    """
    if x <= 0.0 or x >= 2.0:
        return 0.0
    if x < c:
        return x * x / c
    if x > 2.0 - c:
        return (x - 2.0) * (x - 2.0) / c
    if c >= 1.0:
        return 1.0
    return 1.0 + (x - 1.0) * (x - 1.0) / (c - 1.0)


@kernel
def bump_slope(x, c):
    """Return dB/dx (M15)."""
    if x <= 0.0 or x >= 2.0:
        return 0.0
    if x < c:
        return 2.0 * x / c
    if x > 2.0 - c:
        return 2.0 * (x - 2.0) / c
    if c >= 1.0:
        return 0.0
    return 2.0 * (x - 1.0) / (c - 1.0)


@kernel
def volume(phi, V_max, V_min, phi_A):
    """Return the chamber volume [m³] (M16)."""
    return V_min + V_max * bump(phi / TURN, phi_A / TURN)


@kernel
def volume_slope(phi, V_max, phi_A):
    """Return dV/dφ [m³/rad] (M16)."""
    return V_max / TURN * bump_slope(phi / TURN, phi_A / TURN)


@kernel
def suction_area(phi, S_suc, phi_B):
    """Return the area of the suction port [m²] (M17)."""
    return S_suc * bump(phi / (0.5 * TURN), phi_B / (0.5 * TURN))


@kernel
def discharge_area(phi, S_dis, phi_dis, phi_C):
    """Return the area of the discharge port [m²] (M18, corrected)."""
    half = 0.5 * (2.0 * TURN - phi_dis)
    return S_dis * bump((phi - phi_dis) / half, (phi_C - phi_dis) / half)
