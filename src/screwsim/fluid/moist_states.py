"""Kernels of moist air, written from those of its dry air (M324–M326).

Per volume f = f_a(T, ρ_a) + f_v(T, ρ_v) + R_w T (2 b ρ_a ρ_v + c ρ_v²) + ρ_l μ_l(T), b = B_aw/M_a and c = B_ww/M_w; b
and c are zero for an ideal gas. μ_l is the potential of vapour that saturates without air, so that the liquid's
enthalpy and entropy follow from p_s alone. In equilibrium ρ_v minimises f at ρ_v + ρ_l = y ρ.
"""

import re
from functools import lru_cache
from typing import Any

from screwsim.fluid import water
from screwsim.fluid.nozzle import choking
from screwsim.numerics.kernel import Kernel, written

CLOSE = 1e-15  # relative width at which a search ends
IDEAL = (water.no_virials, water.ideal_energy, water.ideal_entropy)

LIQUID = '''def liquid(T{own}):
    """Return saturated vapour's rho [kg/m3] without air, and h, s and c of the liquid, h and s but for constants."""
    p, p1, p2 = saturation(T)
    _b, _b1, _b2, c, c1, c2 = virials(T)
    w, u = energy(T{own})
    q = p / (R_WATER * T)
    rho = 2.0 * q / (1.0 + math.sqrt(max(1.0 + 4.0 * c * q, 0.0)))
    r1 = (p1 / (R_WATER * T) - rho * (1.0 + c * rho) - c1 * rho * rho) / (1.0 + 2.0 * c * rho)
    latent = p1 / rho
    h = u - R_WATER * T * c1 * rho + p / rho - latent
    s = entropy(T{own}) - R_WATER * (math.log(rho) + (c + c1) * rho) - latent / T
    heat = w - R_WATER * (rho * (2.0 * c1 + c2) + (1.0 / rho + c + c1) * r1) - (p2 - p1 * r1 / rho) / (T * rho)
    return rho, h, s, heat
'''

SATURATED = '''def saturated_density(T, rho_a{own}):
    """Return the density [kg/m3] of saturated vapour at T [K] beside air of rho_a [kg/m3]."""
    p, _p1, _p2 = saturation(T)
    b, _b1, _b2, c, _c1, _c2 = virials(T)
    q = p / (R_WATER * T)
    pure = 2.0 * q / (1.0 + math.sqrt(max(1.0 + 4.0 * c * q, 0.0)))
    v = pure * math.exp(-2.0 * b * rho_a)
    v = v * (1.0 - 2.0 * c * (v - pure) / (1.0 + 2.0 * c * v))
    return v * (1.0 - (math.log(v / pure) + 2.0 * b * rho_a + 2.0 * c * (v - pure)) / (1.0 + 2.0 * c * v))
'''

RATIO = '''def saturated_ratio(p, T{dry}{own}):
    """Return vapour per dry air [kg/kg] that saturates it at p [Pa], T [K]; p is above that of water alone."""
    rho_a = (p - saturation(T)[0]) / (287.0 * T)
    b, _b1, _b2, c, _c1, _c2 = virials(T)
    ratio = 0.0
    for _ in range(50):
        v = saturated_density(T, rho_a{own})
        p_a = dry_state(T, rho_a{dry})[0]
        rest = p - R_WATER * T * (1.0 + 2.0 * b * rho_a + c * v) * v
        before, ratio = ratio, v / rho_a
        if not rest > 0.0 or abs(ratio - before) <= CLOSE * ratio:
            return ratio
        rho_a = rho_a * rest / p_a
    return ratio
'''

PHASE = '''def phase(T, rho, y_water{own}):
    """Return 1 where water of moist air is in part liquid at T [K], rho [kg/m3], else 0."""
    if T >= T_MOST or 2.0 * R_WATER * T * y_water * rho < saturation(T)[0]:
        return 0
    return 1 if y_water * rho > saturated_density(T, (1.0 - y_water) * rho{own}) else 0
'''

PHASED = '''def phased_state(phase, T, rho{dry}, y_water, u_water{own}, s_water):
    """Return what `state` of moist air returns, without liquid (0) or with it (1), beyond their border too."""
    rho_a = (1.0 - y_water) * rho
    v = y_water * rho
    p_a, h_a, c_a, tpt_a, a_a, _choke, _choked = dry_state(T, rho_a{dry})
    b, b1, b2, c, c1, c2 = virials(T)
    w, u_w = energy(T{own})
    liquid_energy, liquid_heat, rise, jump, held = 0.0, 0.0, 0.0, 0.0, y_water
    if phase == 1:
        v = saturated_density(T, rho_a{own})
        _rho, h_l, s_l, heat = liquid(T{own})
        stiff = 1.0 + 2.0 * c * v
        jump = entropy(T{own}) - R_WATER * (math.log(v) + 1.0 + 2.0 * ((b + b1) * rho_a + (c + c1) * v)) - s_l
        rise = jump * v / (R_WATER * stiff)
        held = -(1.0 - y_water) * 2.0 * b * v / stiff
        liquid_energy = (y_water * rho - v) * (h_l + u_water)
        liquid_heat = (y_water * rho - v) * heat
    x = (2.0 * b * rho_a + c * v) * v
    x1 = (2.0 * b1 * rho_a + c1 * v) * v
    x2 = (2.0 * b2 * rho_a + c2 * v) * v
    RT = R_WATER * T
    by_v = RT * (1.0 + 2.0 * (b * rho_a + c * v))
    by_a = p_a / (a_a * rho_a) - tpt_a * tpt_a / (T * rho_a * rho_a * c_a) + 2.0 * RT * b * v
    p = p_a + RT * (v + x)
    tpt = tpt_a + RT * (v + x + x1) + by_v * rise
    u = rho_a * h_a - p_a + v * (u_w + u_water) - RT * x1 + liquid_energy
    c_v = (rho_a * c_a + v * w - R_WATER * (2.0 * x1 + x2) + liquid_heat + jump * rise) / rho
    slope = (1.0 - y_water) * by_a + held * by_v
    a = p / (rho * (slope + tpt * tpt / (T * rho * rho * c_v)))
    choke, choked = choking(1.0 / a)
    return p, (u + p) / rho, c_v, tpt, a, choke, choked
'''

STATE = '''def state(T, rho{dry}, y_water, u_water{own}, s_water):
    """Return (p, h, c_v, T dp/dT, 1/k, drop and psi2 of choking) of moist air at T [K], rho [kg/m3]."""
    return phased_state(phase(T, rho, y_water{own}), T, rho{dry}, y_water, u_water{own}, s_water)
'''

ENTROPY = '''def specific_entropy(T, rho{dry_s}, y_water, s_water{own}):
    """Return the specific entropy s [J/(kg K)] of moist air at T [K], rho [kg/m3]."""
    rho_a = (1.0 - y_water) * rho
    v = y_water * rho
    of_liquid = 0.0
    if phase(T, rho, y_water{own}) == 1:
        v = saturated_density(T, rho_a{own})
        _rho, _h, s_l, _heat = liquid(T{own})
        of_liquid = (y_water * rho - v) * (s_l + s_water)
    b, b1, _b2, c, c1, _c2 = virials(T)
    x = (2.0 * (b + b1) * rho_a + (c + c1) * v) * v
    of_vapour = v * (entropy(T{own}) + s_water - R_WATER * math.log(v)) - R_WATER * x
    return (rho_a * dry_entropy(T, rho_a{dry_s}) + of_vapour + of_liquid) / rho
'''

DENSITY = '''def density(p, T, R{values}):
    """Return the density [kg/m3] at p [Pa], T [K]; p grows with it, and bends where water begins to condense.

    A step that is not half as long as the one before halves the bracket: Newton's go to and fro about a bend.
    """
    rho = p / (R * T)
    low, high = 0.0, 4.0 * rho / (1.0 - y_water)
    step = high
    for _ in range(100):
        found, _h, c_v, tpt, a, _choke, _choked = state(T, rho{state})
        slope = found / (a * rho) - tpt * tpt / (T * rho * rho * c_v)
        if found < p:
            low = rho
        else:
            high = rho
        new = rho + (p - found) / slope
        if not low <= new <= high or abs(new - rho) > 0.5 * step:
            new = 0.5 * (low + high)
        step = abs(new - rho)
        if step <= CLOSE * rho or high - low <= CLOSE * high:
            return new
        rho = new
    return rho
'''

AT_PRESSURE = '''def at_pressure(p, wanted, of_entropy, low, high, R{values}):
    """Return (T [K], rho [kg/m3]) at p [Pa] and the wanted entropy (else enthalpy) between low and high [K].

    The density is -1 where there is none.
    """
    T, least, step = min(max(300.0, low), high), low, high - low
    for _ in range(200):
        rho = density(p, T, R{values})
        _p, value, c_v, tpt, a, _choke, _choked = state(T, rho{state})
        by_rho = p / (a * rho) - tpt * tpt / (T * rho * rho * c_v)
        slope = c_v + tpt * tpt / (T * rho * rho * by_rho)
        if of_entropy:
            value = specific_entropy(T, rho{entropy})
            slope = slope / T
        if value < wanted:
            low = T
        else:
            high = T
        new = T + (wanted - value) / slope
        if not low <= new <= high or abs(new - T) > 0.5 * step:
            new = 0.5 * (low + high)
        step = abs(new - T)
        if step <= CLOSE * T or high - low <= CLOSE * high:
            return (new, density(p, new, R{values})) if new > least else (least, -1.0)
        T = new
    return T, density(p, T, R{values})
'''


@lru_cache(maxsize=8)
def kernels(dry_state: Kernel, dry_entropy: Kernel, real: bool) -> dict[str, Kernel]:
    """Return the kernels of moist air by name, made from state and entropy of its dry air."""
    of, own = f"moist air {'real' if real else 'ideal'}", "" if real else ", c_water"
    dry, dry_s = ("".join(f", {name}" for name in each.arguments[2:]) for each in (dry_state, dry_entropy))
    values = f"{dry}, y_water, u_water{own}, s_water"
    named = {"own": own, "dry": dry, "dry_s": dry_s, "values": values, "state": values}
    named["entropy"] = f"{dry_s}, y_water, s_water{own}"
    parts = (water.virials, water.energy, water.entropy)
    known: dict[str, Any] = dict(zip(("virials", "energy", "entropy"), parts if real else IDEAL, strict=True))
    known |= {"saturation": water.saturation, "choking": choking, "dry_state": dry_state, "dry_entropy": dry_entropy}
    known |= {"R_WATER": water.R_WATER, "T_MOST": water.T_MOST, "CLOSE": CLOSE}
    found: dict[str, Kernel] = {}
    for text in (LIQUID, SATURATED, RATIO, PHASE, PHASED, STATE, ENTROPY, DENSITY, AT_PRESSURE):
        source = text.format(**named)
        uses = {name: item for name, item in (known | found).items() if re.search(rf"\b{name}\b", source)}
        made = written(source, of, uses)
        found[made.__name__] = made
    return found
