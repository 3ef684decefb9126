"""Isentropic nozzle flow between two port states, choked and not, in both directions, regularised at equal pressures.

Source: Chernov et al. 2015, eqs. (3), (4), restated as M12; choking M13 is added (the paper has none).

ṁ = S √(p_u ρ_u ψ²), ψ² = 2k/(k−1) · (r^(2/k) − r^((k+1)/k)), r = max(p_d/p_u, (2/(k+1))^(k/(k−1))). Regularisation: Δp
under the root becomes Δp²/√(Δp² + ε²), so that ṁ is smooth through Δp = 0; the relative error is 1 − (1 +
(ε/Δp)²)^(−1/4), 16 % at Δp = ε and (ε/Δp)²/4 for large Δp. Written as ṁ = S Δp √q, q = ρ_u (ψ²/x)/√(Δp² + ε²) > 0, x =
|Δp|/p_u, so that neither ṁ nor its slopes cancel. With a = 1/k, ψ² = 2 r^a (r^a − r)/(1 − a); near k = 1, which real
gases may have, r^a − r = r E with E = expm1((a−1) ln r), and E/(1 − a) → −ln r, so that every k > 0 is equally
accurate.
"""

import math

import numpy as np

from screwsim.numerics.kernel import kernel

HALF, THIRD, FOURTH, FIFTH, SIXTH, SEVENTH, EIGHTH = (1.0 / i for i in range(2, 9))
SMALL = 0.02  # relative pressure drop below which ψ²/x is summed as a series (truncation below 1e-15)


NEAR_ONE = 0.05  # |1 − 1/k| below which r^a − r is taken from expm1 (the plain difference loses a digit or more)


@kernel
def power_drop(b, x):
    """Return (1 − (1−x)^b)/(b x) by its series for 0 ≤ x ≤ 0.02, with reciprocals in place of costly divisions."""
    s = 1.0 + (7.0 - b) * (x * EIGHTH)
    s = 1.0 + (6.0 - b) * (x * SEVENTH) * s
    s = 1.0 + (5.0 - b) * (x * SIXTH) * s
    s = 1.0 + (4.0 - b) * (x * FIFTH) * s
    s = 1.0 + (3.0 - b) * (x * FOURTH) * s
    s = 1.0 + (2.0 - b) * (x * THIRD) * s
    return 1.0 + (1.0 - b) * (x * HALF) * s


@kernel
def expansion_near_one(log_r, a):
    """Return (r^(a−1), (r^(a−1) − 1)/(1 − a)) for a near or at 1."""
    b = 1.0 - a
    grown = math.expm1(-b * log_r)
    return 1.0 + grown, (grown / b if b != 0.0 else -log_r)


@kernel
def expansion(x, a, choke, choked):
    """Return ψ²/x as a function of the relative pressure drop x = 1 − p_d/p_u (M12, M13).

    a = 1/k; `choke` is the drop beyond which the flow is choked, `choked` is ψ² there.
    """
    if x >= choke:
        return choked / x
    if x < SMALL:
        return 2.0 * (1.0 - x * (2.0 * a) * power_drop(2.0 * a, x)) * power_drop(1.0 - a, x)
    r = 1.0 - x
    if abs(1.0 - a) < NEAR_ONE:
        grown, share = expansion_near_one(math.log(r), a)
        return 2.0 * r * r * grown * share / x
    e = math.exp(a * math.log(r))
    return 2.0 / (1.0 - a) * e * (e - r) / x


def _critical_power(y):
    """Return r^(1/k) at choking, (1−y)^((1−y)/(2y)), from y = (k−1)/(k+1) ≠ 0."""
    return np.exp((1.0 - y) * np.log1p(-y) / (2.0 * y))


def _fitted(width, n):
    """Return coefficients in y/width of the polynomial through `_critical_power` at n Chebyshev points."""
    s = np.cos(np.pi * (np.arange(n) + 0.5) / n)
    a = np.polynomial.chebyshev.chebfit(s, _critical_power(s.astype(np.longdouble) * width).astype(float), n - 1)
    return np.polynomial.chebyshev.cheb2poly(a)


FITTED = 0.26  # |k−1|/(k+1) up to which a polynomial gives r^(1/k) at choking: 0.59 < k < 1.70
CRITICAL = _fitted(FITTED, 16)  # error below 3e-15; three times as fast as logarithm and exponential


@kernel
def critical_power(y):
    """Return r^(1/k) at choking from y = (k−1)/(k+1).

    It is held constant below k = 0.05 and above 19, which only unstable states in an iteration have.
    """
    if abs(y) > FITTED:
        y = min(max(y, -0.9), 0.9)
        return math.exp((1.0 - y) * math.log1p(-y) / (2.0 * y))
    s = y * (1.0 / FITTED)
    s2 = s * s
    s4 = s2 * s2
    a = (CRITICAL[0] + CRITICAL[1] * s) + s2 * (CRITICAL[2] + CRITICAL[3] * s)
    b = (CRITICAL[4] + CRITICAL[5] * s) + s2 * (CRITICAL[6] + CRITICAL[7] * s)
    c = (CRITICAL[8] + CRITICAL[9] * s) + s2 * (CRITICAL[10] + CRITICAL[11] * s)
    d = (CRITICAL[12] + CRITICAL[13] * s) + s2 * (CRITICAL[14] + CRITICAL[15] * s)
    return a + s4 * b + (s4 * s4) * (c + s4 * d)


@kernel
def choking(k):
    """Return (drop, ψ²) at which an isentropic expansion chokes, x = 1 − (2/(k+1))^(k/(k−1)) (M13).

    With y = (k−1)/(k+1) and e = r^(1/k) = (1−y)^((1−y)/(2y)), r = (1−y) e and ψ² = (1+y) e²; e → exp(−1/2) as k → 1.
    """
    y = (k - 1.0) / (k + 1.0)
    e = critical_power(y)
    return 1.0 - (1.0 - y) * e, (1.0 + y) * e * e


@kernel
def flow(area, p_1, rho_1, a_1, choke_1, choked_1, p_2, rho_2, a_2, choke_2, choked_2, width):
    """Return the mass flow [kg/s] from port state 2 into port state 1 (M12, M13); width is ε [Pa].

    A port state: pressure [Pa], density [kg/m³], 1/k, and drop and ψ² of choking.
    """
    dp = p_2 - p_1
    if dp >= 0.0:
        q = rho_2 * expansion(dp / p_2, a_2, choke_2, choked_2)
    else:
        q = rho_1 * expansion(-dp / p_1, a_1, choke_1, choked_1)
    return area * dp * math.sqrt(q / math.sqrt(dp * dp + width * width))
