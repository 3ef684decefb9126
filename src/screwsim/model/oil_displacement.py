"""Room taken by the oil: the gas's volume, its effect on flows, and an injection of oil that displaces gas.

Source: docs/model.md M106–M110. The oil is incompressible: V_gas = V − m_oil/ρ_oil, and its enthalpy is c_oil T_oil +
p/ρ_oil. In a port state the density is then that of the gas times the square of its share of the volume, so that a
nozzle's flow, S √(ρ …), contains the share as a factor; the oil temperature is enthalpy over heat capacity.
"""

import math

from screwsim.model.slots import (
    P_C_OIL,
    P_P_SOURCE,
    P_ROOM,
    P_T_OIL,
    R_LOCK,
    R_PRESSURE,
    S_RHO,
    S_T_OIL,
    S_X_OIL,
    gas_phase,
    phased_state,
)
from screwsim.numerics.derivative import tangent
from screwsim.numerics.kernel import kernel

FULL = 0.99  # share of a chamber's volume above which oil locks the chamber
PARTS = 24  # steps of the isentropic compression of displaced gas


@kernel
def gas_share(rho, x, P):
    """Return the gas's share of a volume, at gas density rho with x oil per gas (M106)."""
    return 1.0 / (1.0 + x * rho * P[P_ROOM])


@kernel
def gas_mass(V, rho, x, P):
    """Return the gas [kg] in a chamber of volume V, at density rho in its own room, with x oil per gas (M106)."""
    return V * rho * gas_share(rho, x, P)


gas_mass_slopes = tangent(gas_mass, ("V", "rho", "x"))


@kernel
def gas_mass_slope(V, dV, rho, drho, x, dx, P):
    """Return the change of `gas_mass` with the changes of its arguments."""
    _m, by_V, by_rho, by_x = gas_mass_slopes(V, rho, x, P)
    return by_V * dV + by_rho * drho + by_x * dx


@kernel
def density_of(m, V, x, P):
    """Return the density of gas m [kg] in a chamber of volume V with x oil per gas: the inverse of `gas_mass`."""
    return m / (V - x * m * P[P_ROOM])


@kernel
def locked(y, at, P):
    """Return whether oil takes more than the share FULL of a chamber's volume."""
    return gas_share(y[at + S_RHO], y[at + S_X_OIL], P) < 1.0 - FULL


@kernel
def entropic_slope(T, rho, P, TAB):
    """Return dT/d(ln ρ) [K] along an isentrope, and the pressure [Pa]."""
    p, _h, c_v, tpt, _a, _x, _f = phased_state(gas_phase(T, rho, P, TAB), T, rho, P, TAB)
    return tpt / (rho * c_v), p


@kernel
def displaced(y, at, m, V, before, injected, P, TAB, R):
    """Inject oil [kg] into a chamber of fixed volume V with gas m and oil `before`; changes y (M110).

    The gas is compressed isentropically; pressure work of the oil beyond that heats the oil. R_LOCK is set where
    there is no room.
    """
    free = V - (before + injected) * P[P_ROOM]
    if not free > (1.0 - FULL) * V:
        R[R_LOCK] = 1.0
        y[at + S_RHO] = math.nan  # no step is accepted with it
        return
    R[R_LOCK] = 0.0
    T = y[at]
    rho = y[at + S_RHO]
    p, h, _c, _t, _a, _x, _f = phased_state(gas_phase(T, rho, P, TAB), T, rho, P, TAB)
    energy = h - p / rho
    step = math.log(m / (free * rho)) / PARTS
    for _ in range(PARTS):
        a, _p = entropic_slope(T, rho, P, TAB)
        b, _p = entropic_slope(T + 0.5 * step * a, rho * math.exp(0.5 * step), P, TAB)
        c, _p = entropic_slope(T + 0.5 * step * b, rho * math.exp(0.5 * step), P, TAB)
        rho *= math.exp(step)
        e, _p = entropic_slope(T + step * c, rho, P, TAB)
        T += step * (a + 2.0 * b + 2.0 * c + e) / 6.0
    rho = m / free
    end, h, _c, _t, _a, _x, _f = phased_state(gas_phase(T, rho, P, TAB), T, rho, P, TAB)
    work = m * (h - end / rho - energy)
    volume = injected * P[P_ROOM]
    R[R_PRESSURE] = work / volume if volume > 1e-9 * V else p
    pressure = max(P[P_P_SOURCE], R[R_PRESSURE])
    total = before + injected
    if total > 0.0:
        heat = (pressure - R[R_PRESSURE]) * volume / P[P_C_OIL]
        y[at + S_T_OIL] = (before * y[at + S_T_OIL] + injected * P[P_T_OIL] + heat) / total
    y[at] = T
    y[at + S_RHO] = rho
