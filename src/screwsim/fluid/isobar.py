"""States of a real gas at a given pressure: density by temperature, temperature by enthalpy or entropy.

Newton's method inside a bracket. The pressure of vapour is a concave function of density, so that from the ideal gas's
density, which is too small, the steps approach the root from below without passing it; the bracket is a safeguard.
"""

from screwsim.numerics.kernel import Slot, kernel

single_state = Slot("single_state")
single_entropy = Slot("single_entropy")
saturated_vapour = Slot("saturated_vapour")
saturated_liquid = Slot("saturated_liquid")
saturation_temperature = Slot("saturation_temperature")
saturation_pressure = Slot("saturation_pressure")

CLOSE = 1e-15  # relative width at which a bracket, or a step, ends the search
LIQUID_CLOSE = 1e-13  # the same for a liquid's density, limited by rounding of p, which changes 1e3 times as fast


@kernel
def density(p, T, R, T_c, rho_c):
    """Return the density [kg/m³] at p [Pa], T [K], on the vapour's side and not above that of saturated vapour."""
    low = 0.0
    high = saturated_vapour(T) if T < T_c else 4.0 * rho_c
    rho = min(p / (R * T), 0.999 * high)
    for _ in range(100):
        found, _h, c_v, tpt, a, _choke, _choked = single_state(T, rho)
        slope = found / (a * rho) - tpt * tpt / (T * rho * rho * c_v)
        if found < p:
            low = rho
        else:
            high = rho
        new = rho + (p - found) / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - rho) <= CLOSE * rho or high - low <= CLOSE * high:
            return new
        rho = new
    return rho


@kernel
def liquid_density(p, T):
    """Return the density [kg/m³] of the liquid at p [Pa], T [K], from saturated liquid upwards (p ≥ p_sat(T))."""
    rho = saturated_liquid(T)
    for _ in range(100):
        found, _h, c_v, tpt, a, _choke, _choked = single_state(T, rho)
        step = (p - found) / (found / (a * rho) - tpt * tpt / (T * rho * rho * c_v))
        rho += step
        if abs(step) <= LIQUID_CLOSE * rho:
            return rho
    return rho


@kernel
def value_at(T, rho, entropy):
    """Return entropy [J/(kg K)] or enthalpy [J/kg] of the single phase, and its derivative by T at constant p."""
    p, h, c_v, tpt, a, _choke, _choked = single_state(T, rho)
    slope = p / (a * rho) - tpt * tpt / (T * rho * rho * c_v)
    c_p = c_v + tpt * tpt / (T * rho * rho * slope)
    if entropy:
        return single_entropy(T, rho), c_p / T
    return h, c_p


@kernel
def at_pressure(p, wanted, entropy, T_low, T_high, p_c, R, T_c, rho_c):
    """Return (T [K], ρ [kg/m³]) at p [Pa] and the wanted entropy (else enthalpy): vapour, two phases or liquid.

    The density is −1 where there is no such state: below T_c from the critical pressure on, or below T_low.
    """
    low = T_low
    if p >= p_c:
        low = T_c
        if wanted < value_at(T_c, density(p, T_c, R, T_c, rho_c), entropy)[0]:
            return low, -1.0
    elif p > saturation_pressure(T_low)[0]:
        low = saturation_temperature(p)
        rho_v = saturated_vapour(low)
        rho_l = saturated_liquid(low)
        vapour = value_at(low, rho_v, entropy)[0]
        if wanted <= vapour:
            liquid = value_at(low, rho_l, entropy)[0]
            share = (wanted - liquid) / (vapour - liquid)
            if share < 0.0:
                return liquid_at_pressure(p, wanted, entropy, T_low, low, R, T_c, rho_c)
            return low, 1.0 / (share / rho_v + (1.0 - share) / rho_l)
    T = low + 0.1 * (T_high - low)
    return search(p, wanted, entropy, low, T_high, T, False, CLOSE, R, T_c, rho_c)


@kernel
def liquid_at_pressure(p, wanted, entropy, low, high, R, T_c, rho_c):
    """Return (T [K], ρ [kg/m³]) of the liquid at p [Pa] and the wanted entropy (else enthalpy), low ≤ T ≤ high."""
    if wanted < value_at(low, liquid_density(p, low), entropy)[0]:
        return low, -1.0
    return search(p, wanted, entropy, low, high, high, True, LIQUID_CLOSE, R, T_c, rho_c)


@kernel
def density_of(p, T, liquid, R, T_c, rho_c):
    """Return the density [kg/m³] of the liquid or of the vapour at p [Pa], T [K]."""
    return liquid_density(p, T) if liquid else density(p, T, R, T_c, rho_c)


@kernel
def search(p, wanted, entropy, low, high, T, liquid, close, R, T_c, rho_c):
    """Return (T [K], ρ [kg/m³]) of one phase at p [Pa] and the wanted entropy (else enthalpy), starting from T."""
    for _ in range(100):
        value, slope = value_at(T, density_of(p, T, liquid, R, T_c, rho_c), entropy)
        if value < wanted:
            low = T
        else:
            high = T
        new = T + (wanted - value) / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - T) <= close * T or high - low <= CLOSE * high:
            return new, density_of(p, new, liquid, R, T_c, rho_c)
        T = new
    return T, density_of(p, T, liquid, R, T_c, rho_c)
