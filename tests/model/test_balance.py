"""The first law of one chamber: dT/dφ makes the inner energy change as the paper's energy balance says."""

import pytest

from screwsim.fluid.ideal_gas import IdealGas
from screwsim.model.balance import oil_temperature_slope, temperature_slope

GAS = IdealGas(R=81.49, k=1.12)
T, M, V, DV, OMEGA = 320.0, 4e-3, 3e-4, -1e-4, 314.0
RHO = M / V
P = RHO * GAS.R * T
ROUNDING = 1e-12


def slope(mass_rate=0.0, enthalpy_rate=0.0, heat=0.0, dV=DV):
    return temperature_slope(T, M, RHO, GAS.c_p * T, GAS.c_v, P, mass_rate, enthalpy_rate, heat, dV, OMEGA)


def test_compression_alone_is_adiabatic():
    assert slope() == pytest.approx(-(GAS.k - 1) * T / V * DV, rel=ROUNDING)  # the last term of the paper's (5)


@pytest.mark.parametrize(
    ("mass_in", "T_in", "mass_out", "heat"), [(0.3, 290.0, 0.0, 0.0), (0.1, 400.0, 0.5, 2e3), (0.0, 0.0, 0.7, -1e3)]
)
def test_inner_energy_changes_by_enthalpies_heat_and_work(mass_in, T_in, mass_out, heat):
    """d(m c_v T) = (Σ ṁ h + Q̇)/ω − p dV (M2)."""
    enthalpy = mass_in * GAS.c_p * T_in - mass_out * GAS.c_p * T
    found = slope(mass_in - mass_out, enthalpy, heat)
    change = GAS.c_v * (M * found + T * (mass_in - mass_out) / OMEGA)
    assert change == pytest.approx((enthalpy + heat) / OMEGA - P * DV, rel=1e-11)  # terms cancel a digit


@pytest.mark.parametrize(("mass_in", "T_in", "mass_out"), [(0.3, 290.0, 0.0), (0.1, 400.0, 0.5)])
def test_the_papers_equation_5_is_the_same_law(mass_in, T_in, mass_out):
    k = GAS.k
    paper = (k - 1) * T / M * -mass_out / OMEGA + (k * T_in - T) * mass_in / (M * OMEGA) - (k - 1) * T / V * DV
    enthalpy = mass_in * GAS.c_p * T_in - mass_out * GAS.c_p * T
    assert slope(mass_in - mass_out, enthalpy) == pytest.approx(paper, rel=1e-11)


def test_oil_mixes_as_its_energies_do():
    """d(m_oil T_oil) = Σ ṁ_oil T_oil/ω without heat."""
    m_oil, T_oil, came, T_came = 1e-2, 300.0, 0.5, 350.0
    found = oil_temperature_slope(T_oil, m_oil, M, 2000.0, came, came * T_came, 0.0, OMEGA)
    assert m_oil * found + T_oil * came / OMEGA == pytest.approx(came * T_came / OMEGA, rel=1e-9)  # floor of 1e-12 m


def test_oil_that_leaves_takes_its_own_temperature():
    assert oil_temperature_slope(300.0, 1e-2, M, 2000.0, -0.5, -0.5 * 300.0, 0.0, OMEGA) == 0.0


def test_oil_cools_by_the_heat_it_gives():
    found = oil_temperature_slope(300.0, 1e-2, M, 2000.0, 0.0, 0.0, 1e3, OMEGA)
    assert found == pytest.approx(-1e3 / (2000.0 * 1e-2 * OMEGA), rel=1e-9)


def test_no_oil_has_no_infinite_slope():
    assert abs(oil_temperature_slope(300.0, 0.0, M, 2000.0, 0.0, 0.0, 0.0, OMEGA)) == 0.0
