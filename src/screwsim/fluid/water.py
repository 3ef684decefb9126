"""Water in moist air: saturation, ideal-gas part, virial coefficients with air (M321–M323).

Source: saturation pressure W. Wagner, A. Pruss, J. Phys. Chem. Ref. Data 22 (1993) 783, IAPWS SR1-86; heat capacity of
the dilute vapour W. Wagner, A. Pruss, J. Phys. Chem. Ref. Data 31 (2002) 387, Table 6.1; B_ww A. Harvey, E. Lemmon, J.
Phys. Chem. Ref. Data 33 (2004) 369; B_aw of water with air A. Harvey, P. Huang, Int. J. Thermophys. 28 (2007) 556.
Derivatives are multiplied by powers of T. For an ideal gas: no virial terms, a constant heat capacity. Nothing here
uses CoolProp; tests/fluid/test_moist_air.py compares with it.
"""

import math

from screwsim.numerics.kernel import kernel

M_WATER, M_AIR = 0.018015268, 0.02896546  # [kg/mol]
R_WATER = 8.314462618 / M_WATER  # [J/(kg K)]
T_TRIPLE = 273.16  # [K] below which condensate would freeze
T_CRITICAL = 647.096  # [K]
P_CRITICAL = 22.064e6  # [Pa]
T_MOST = 500.0  # [K] above which no condensation is assumed: water boils at 26 bar there


A1, A2, A3, A4, A5, A6 = -7.85951783, 1.84408259, -11.7866497, 22.6807411, -15.9618719, 1.80122502  # for p_s
FREE = 3.00632  # c_v/R without oscillators
N1, N2, N3, N4, N5 = 0.012436, 0.97315, 1.2795, 0.96956, 0.24873  # weights of the oscillators
Q1, Q2, Q3, Q4, Q5 = (T_CRITICAL * x for x in (1.28728967, 3.53734222, 7.74073708, 9.24437796, 27.5075105))  # [K]
C1, C2, C3 = (1e-6 / M_AIR * x for x in (66.5687, -238.834, -176.755))  # of B_aw/M_a [m³/kg]
E1, E2, E3 = -0.237, -1.048, -3.183  # exponents of T/100 K
D1, D2, D3, D4 = (1e-3 / M_WATER * x for x in (0.34404, -0.75826, -24.219, -3978.2))  # of B_ww/M_w [m³/kg]
F1, F2, F3, F4 = -0.5, -0.8, -3.35, -8.3  # exponents of T/100 K


@kernel
def saturation(T):
    """Return (p_s [Pa], T dp_s/dT, T² d²p_s/dT²) of water at T [K], supercooled below 273.16 K (M321)."""
    t = T / T_CRITICAL
    x = max(1.0 - t, 1e-9)
    r = math.sqrt(x)
    x2 = x * x
    y = x2 * x * r
    f = x * (A1 + A2 * r + x2 * (A3 + A4 * r + x * (A5 + A6 * y)))
    f1 = A1 + 1.5 * A2 * r + x2 * (3.0 * A3 + 3.5 * A4 * r + x * (4.0 * A5 + 7.5 * A6 * y))
    f2 = 0.75 * A2 / r + x * (6.0 * A3 + 8.75 * A4 * r + x * (12.0 * A5 + 48.75 * A6 * y))
    p = P_CRITICAL * math.exp(f / t)
    g1 = -f1 - f / t
    g2 = t * f2 + 2.0 * f1 + 2.0 * f / t
    return p, p * g1, p * (g2 + g1 * g1)


@kernel
def energy(T):
    """Return (c_v [J/(kg K)], u [J/kg]) of dilute water vapour, u up to a constant (M322)."""
    c, u = FREE, FREE * T
    x = Q1 / T
    e = 1.0 / math.expm1(x)
    c, u = c + N1 * x * x * e * (1.0 + e), u + N1 * Q1 * e
    x = Q2 / T
    e = 1.0 / math.expm1(x)
    c, u = c + N2 * x * x * e * (1.0 + e), u + N2 * Q2 * e
    x = Q3 / T
    e = 1.0 / math.expm1(x)
    c, u = c + N3 * x * x * e * (1.0 + e), u + N3 * Q3 * e
    x = Q4 / T
    e = 1.0 / math.expm1(x)
    c, u = c + N4 * x * x * e * (1.0 + e), u + N4 * Q4 * e
    x = Q5 / T
    e = 1.0 / math.expm1(x)
    c, u = c + N5 * x * x * e * (1.0 + e), u + N5 * Q5 * e
    return c * R_WATER, u * R_WATER


@kernel
def oscillating(x):
    """Return x/(eˣ − 1) − ln(1 − e⁻ˣ), the entropy of an oscillator over R (M322)."""
    return x / math.expm1(x) - math.log(-math.expm1(-x))


@kernel
def entropy(T):
    """Return s + R ln ρ [J/(kg K)] of dilute water vapour, up to a constant (M322)."""
    s = FREE * math.log(T) + N1 * oscillating(Q1 / T) + N2 * oscillating(Q2 / T) + N3 * oscillating(Q3 / T)
    return R_WATER * (s + N4 * oscillating(Q4 / T) + N5 * oscillating(Q5 / T))


@kernel
def virials(T):
    """Return B_aw/M_a and B_ww/M_w [m³/kg], each followed by T and T² times its derivatives (M323)."""
    log_t = math.log(0.01 * T)
    a, b, c = C1 * math.exp(E1 * log_t), C2 * math.exp(E2 * log_t), C3 * math.exp(E3 * log_t)
    d, e = D1 * math.exp(F1 * log_t), D2 * math.exp(F2 * log_t)
    f, g = D3 * math.exp(F3 * log_t), D4 * math.exp(F4 * log_t)
    first = E1 * a + E2 * b + E3 * c
    second = E1 * (E1 - 1.0) * a + E2 * (E2 - 1.0) * b + E3 * (E3 - 1.0) * c
    own = F1 * d + F2 * e + F3 * f + F4 * g
    bent = F1 * (F1 - 1.0) * d + F2 * (F2 - 1.0) * e + F3 * (F3 - 1.0) * f + F4 * (F4 - 1.0) * g
    return a + b + c, first, second, d + e + f + g, own, bent


@kernel
def no_virials(T):
    """Return the virial coefficients of an ideal gas: zeros."""
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@kernel
def ideal_energy(T, c_water):
    """Return (c_v [J/(kg K)], u [J/kg] up to a constant) of vapour of constant heat capacity."""
    return c_water, c_water * T


@kernel
def ideal_entropy(T, c_water):
    """Return s + R ln ρ [J/(kg K)], up to a constant, of vapour of constant heat capacity."""
    return c_water * math.log(T)
