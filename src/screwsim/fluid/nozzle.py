"""Isentropic nozzle flow between two places, choked and not, in both directions, regularised at equal pressures.

Source: Chernov et al. 2015, eqs. (3), (4), restated as M12; choking M13 is added (the paper has none).

ṁ = S √(p_u ρ_u ψ²), ψ² = 2k/(k−1) · (r^(2/k) − r^((k+1)/k)), r = max(p_d/p_u, (2/(k+1))^(k/(k−1))).
Regularisation: Δp under the root becomes Δp²/√(Δp² + ε²), so that ṁ is smooth through Δp = 0; the relative error is
1 − (1 + (ε/Δp)²)^(−1/4), 16 % at Δp = ε and (ε/Δp)²/4 far from it.
Written as ṁ = S Δp √q with q = ρ_u (ψ²/x)/√(Δp² + ε²) > 0 and x = |Δp|/p_u, so that neither ṁ nor its slopes cancel.
"""

from __future__ import annotations

import math

from screwsim.numerics.kernel import kernel

HALF, THIRD, FOURTH, FIFTH, SIXTH, SEVENTH, EIGHTH = (1.0 / i for i in range(2, 9))
SMALL = 0.02  # relative pressure drop below which ψ²/x is summed as a series (truncation below 1e-15)


@kernel
def power_drop(b, x):
    """Return (1 − (1−x)^b)/x by its series for 0 ≤ x ≤ 0.02 (reciprocals: a division costs as much as the rest)."""
    s = 1.0 + (7.0 - b) * (x * EIGHTH)
    s = 1.0 + (6.0 - b) * (x * SEVENTH) * s
    s = 1.0 + (5.0 - b) * (x * SIXTH) * s
    s = 1.0 + (4.0 - b) * (x * FIFTH) * s
    s = 1.0 + (3.0 - b) * (x * FOURTH) * s
    s = 1.0 + (2.0 - b) * (x * THIRD) * s
    s = 1.0 + (1.0 - b) * (x * HALF) * s
    return b * s


@kernel
def expansion(x, a, choke, choked):
    """Return ψ²/x by the relative pressure drop x = 1 − p_d/p_u (M12, M13).

    a = 1/k; `choke` is the drop beyond which the flow is choked, `choked` is ψ² there.
    """
    if x >= choke:
        return choked / x
    f = 2.0 / (1.0 - a)
    if x < SMALL:
        return f * (1.0 - x * power_drop(2.0 * a, x)) * power_drop(1.0 - a, x)
    e = math.exp(a * math.log(1.0 - x))
    return f * e * (e - (1.0 - x)) / x


@kernel
def choking(k):
    """Return (drop, ψ²) at which an isentropic expansion chokes, x = 1 − (2/(k+1))^(k/(k−1)) (M13)."""
    log_r = k / (k - 1.0) * math.log(2.0 / (k + 1.0))
    e = math.exp(log_r / k)
    r = math.exp(log_r)
    return 1.0 - r, 2.0 * k / (k - 1.0) * e * (e - r)


@kernel
def flow(area, p_1, rho_1, a_1, choke_1, choked_1, p_2, rho_2, a_2, choke_2, choked_2, width):
    """Return the mass flow [kg/s] from place 2 into place 1 (M12, M13); width is ε [Pa].

    A place: pressure [Pa], density [kg/m³], 1/k, and drop and ψ² of choking.
    """
    dp = p_2 - p_1
    if dp >= 0.0:
        q = rho_2 * expansion(dp / p_2, a_2, choke_2, choked_2)
    else:
        q = rho_1 * expansion(-dp / p_1, a_1, choke_1, choked_1)
    return area * dp * math.sqrt(q / math.sqrt(dp * dp + width * width))


@kernel
def expansion_slope(x, value, a, choke, choked):
    """Return d(ψ²/x)/dx where `value` is ψ²/x: analytic, but by a difference of the series for small drops."""
    if x >= choke:
        return -value / x
    if x < SMALL:
        return (expansion(x + 1e-4, a, choke, choked) - value) * 1e4
    e = math.exp(a * math.log(1.0 - x))
    slope = 2.0 / (1.0 - a) * e * (2.0 * a * e / (1.0 - x) - (1.0 + a))
    return -(value + slope) / x


@kernel
def flow_slopes(area, p_1, rho_1, a_1, choke_1, choked_1, p_2, rho_2, a_2, choke_2, choked_2, width):
    """Return (ṁ, ∂ṁ/∂p_1, ∂ṁ/∂ρ_1, ∂ṁ/∂p_2, ∂ṁ/∂ρ_2) of `flow`; the exponent is held."""
    dp = p_2 - p_1
    if dp >= 0.0:
        p = p_2
        rho = rho_2
        x = dp / p
        psi = expansion(x, a_2, choke_2, choked_2)
        slope = expansion_slope(x, psi, a_2, choke_2, choked_2)
    else:
        p = p_1
        rho = rho_1
        x = -dp / p
        psi = expansion(x, a_1, choke_1, choked_1)
        slope = expansion_slope(x, psi, a_1, choke_1, choked_1)
    smooth2 = dp * dp + width * width
    inverse = 1.0 / math.sqrt(smooth2)
    q = rho * psi * inverse
    root = math.sqrt(q)
    m = area * dp * root
    # ṁ = S Δp √q, q = ρ (ψ²/x)(x)/√(Δp² + ε²), x = |Δp|/p_u
    half = 0.5 * area * dp / root
    by_x = half * rho * slope * inverse / p
    by_dp = area * root - half * q * dp / smooth2
    by_rho = 0.5 * m / rho
    if dp >= 0.0:
        return m, -by_dp - by_x, 0.0, by_dp + by_x * (1.0 - x), by_rho
    return m, -by_dp + by_x * (1.0 - x), by_rho, by_dp - by_x, 0.0
