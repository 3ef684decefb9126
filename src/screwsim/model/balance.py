"""Kernels of the balances: streams between port states, and the first law of one chamber.

Source: Chernov et al. 2015, eqs. (5)–(15), in the form of docs/model.md M1–M8. Positive flow is into the chamber.
"""

from screwsim.numerics.kernel import kernel


@kernel
def temperature_slope(T, m, rho, h, c_v, TpT, mass_rate, enthalpy_rate, heat, dV, omega):
    """Return dT/dφ [K/rad] from the first law of an open system (M2), for any equation of state.

    m c_v dT/dφ = [Σ ṁh − (h − T p_T/ρ) Σ ṁ + Q̇]/ω − T p_T dV/dφ
    """
    inner = enthalpy_rate - (h - TpT / rho) * mass_rate + heat
    return (inner / omega - TpT * dV) / (m * c_v)


@kernel
def oil_temperature_slope(T_oil, m_oil, m, c_oil, oil_rate, oil_energy_rate, heat_lost, omega):
    """Return dT_oil/dφ [K/rad]: mixing with incoming oil, minus the heat given to the gas (M4, M9).

    `oil_energy_rate` is Σ ṁ_oil T_oil [kg K/s] of all streams. A floor of 1e-12 m keeps it finite without oil.
    """
    mixing = oil_energy_rate - T_oil * oil_rate
    return (mixing - heat_lost / c_oil) / ((m_oil + 1e-12 * m) * omega)


@kernel
def held_slope(w, m_oil, m, oil_rate, held_rate, omega):
    """Return dw/dφ [1/rad] of the gas w dissolved per kilogram of oil; `held_rate` [kg/s] comes with oil (M230).

    Gas that leaves the oil is part of that rate. The floor is that of `oil_temperature_slope`.
    """
    return (held_rate - w * oil_rate) / ((m_oil + 1e-12 * m) * omega)
