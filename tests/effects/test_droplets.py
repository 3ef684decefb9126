"""Droplets: Ranz and Marshall, Sauter diameters, transfer units, and the limit of the stated coefficient."""

import math

import numpy as np
import pytest
from each_row import each_row
from scenes import CARRIED, DROP, balanced, refusal, run

from screwsim.effects import droplets, oil_heat
from screwsim.effects.base import Around
from screwsim.fluid.constants import gas_constant, ideal_heat_capacity
from screwsim.fluid.settings import OilProperties
from screwsim.fluid.transport import transport

LAMBDA, MU, PR = transport("R134a", 6e5, 310.0)
STATED = {"gas_conductivity": "0.0146 W/(m K)", "gas_viscosity": "0.0122 mPa s", "prandtl": 0.81}


def with_droplets(**parameters):
    return run({**CARRIED, "effects.oil_heat": DROP, "effects.droplets": parameters})


# ---- correlations ----


def test_the_conductivity_is_that_of_the_source():
    assert pytest.approx(0.01463, abs=5e-6) == LAMBDA  # R134a, 6 bar, 310 K, as printed


@each_row(("micrometres", "printed"), [(10, 2925), (20, 1463), (50, 585), (100, 293), (200, 146)])
def test_without_slip_the_coefficient_is_twice_conductivity_over_diameter(micrometres, printed):
    alpha = droplets.heat_transfer_coefficient(25.0, 0.0, 1e-6 * micrometres, LAMBDA, MU, PR)
    assert alpha == pytest.approx(printed, abs=0.6)  # printed to 1 W/(m² K)


@pytest.mark.parametrize(
    ("radius", "printed"),
    [(10e-6, (69.0, 17.0, 5.8, 3.5)), (50e-6, (2.8, 0.7, 0.2, 0.1))],
)
def test_transfer_units_over_half_a_turn(radius, printed):
    """NTU = (3 α/(r ρ_o c_v)) π/ω per unit d (M157), ρ_o = 980 kg/m³; printed to two digits, or to one decimal."""
    c_v = ideal_heat_capacity("R134a", 310.0) - gas_constant("R134a")
    alpha = droplets.heat_transfer_coefficient(25.0, 0.0, 2.0 * radius, LAMBDA, MU, PR)
    for rpm, value in zip((250, 1000, 3000, 5000), printed, strict=True):
        units = 3.0 * alpha / (radius * 980.0 * c_v) * math.pi / (rpm * math.pi / 30.0)
        assert units == pytest.approx(value, rel=0.025, abs=0.05)


def test_nusselt_at_a_reynolds_number():
    """Re = 100, Pr = 1: Nu = 2 + 0.6 · 10 = 8."""
    alpha = droplets.heat_transfer_coefficient(1.0, 100.0 * MU / 1e-4, 1e-4, LAMBDA, MU, 1.0)
    assert alpha == pytest.approx(8.0 * LAMBDA / 1e-4, rel=1e-12)


def test_heat_is_that_of_the_stated_coefficient():
    own = droplets.heat(300.0, 310.0, 0.01, 20.0, 0.0, 25.0, 1e-4, LAMBDA, MU, PR, 1000.0)
    stated = oil_heat.heat(300.0, 310.0, 0.01, 0.5e-4, 2.0 * LAMBDA / 1e-4, 1000.0)
    assert own == pytest.approx(stated, rel=1e-14)


def test_sauter_diameters_are_those_of_the_formulas():
    """3 mm bore, 5 bar, 1000 kg/m³, 20 mPa s, 30 mN/m: u = 31.62 m/s, Re = 4743, We = 10⁵."""
    oil, jet = OilProperties(1000.0, 2e3, 0.02), {"orifice_diameter": 3e-3, "jet_pressure": 5e5}
    mr = droplets.sauter_diameter(droplets.Parameters(size="merrington_richardson", **jet), oil.density, oil.viscosity)
    assert mr == pytest.approx(500.0 * 3e-3**1.2 * 2e-5**0.2 / math.sqrt(1000.0), rel=1e-12)
    varde = droplets.sauter_diameter(droplets.Parameters(size="varde", surface_tension=0.03, **jet), 1000.0, 0.02)
    assert varde == pytest.approx(8.7 * 3e-3 * (4743.4 * 1e5) ** -0.28, rel=1e-4)
    assert (mr, varde) == pytest.approx((1.7e-3, 0.10e-3), rel=0.05)  # as docs/model.md says


def test_reference_state_is_the_stated_one_or_that_of_the_suction():
    around = Around("R134a", 2e5, 285.0, 1e6, 25.0, 325.0, OilProperties(960.0, 2e3, 0.02))
    stated = {"reference_pressure": 6e5, "reference_temperature": 310.0}
    assert droplets.numbers(droplets.Parameters(diameter=1e-4, **stated), around)["gas_conductivity"] == LAMBDA
    own = droplets.numbers(droplets.Parameters(diameter=1e-4, slip=0.1), around)
    assert own["gas_viscosity"] == transport("R134a", 2e5, 325.0)[1]


# ---- in the cycle ----


@pytest.mark.slow
def test_without_slip_the_cycle_is_that_of_the_stated_coefficient():
    own = with_droplets(diameter="100 um", **STATED)
    alpha = 2.0 * 0.0146 / 100e-6
    stated = {"droplet_radius": "50 um", "heat_transfer_coefficient": f"{alpha!r} W/(m^2 K)"}
    other = run({**CARRIED, "effects.oil_heat": stated})
    for name in ("shaft_power", "discharge_temperature", "oil_discharge_temperature", "gas_mass_flow"):
        assert own.performance[name] == pytest.approx(other.performance[name], rel=1e-9), name


def test_mass_energy_and_entropy_close_with_slip():
    result = balanced(with_droplets(diameter="100 um", slip=0.2))
    assert result.ledger.exergy_destroyed_droplets > 0.0
    assert result.performance.droplet_diameter == 1e-4


def test_slip_and_finer_droplets_cool_more():
    coarse, moving, fine = (
        with_droplets(**p).performance.discharge_temperature
        for p in ({"diameter": "100 um"}, {"diameter": "100 um", "slip": 0.02}, {"diameter": "30 um"})
    )
    assert fine < moving < coarse


def test_huge_droplets_exchange_nothing():
    """NTU falls with d²: 10 mm drops leave the gas as it is without oil heat."""
    huge = with_droplets(diameter="10 mm").performance
    none = run({**CARRIED, "effects.oil_heat": DROP}).performance
    assert huge.discharge_temperature == pytest.approx(none.discharge_temperature, abs=0.05)
    # not of the shaft: without heat no oil leaks back, and more is injected and lifted
    assert huge.indicated_power == pytest.approx(none.indicated_power, rel=1e-3)


@each_row(
    ("changes", "words"),
    [
        ({"effects.droplets": {"diameter": "50 um"}}, "effects.droplets: is simulated together with effects.oil_heat"),
        (
            {"effects.oil_heat": DROP, "effects.droplets": {}},
            "effects.droplets.diameter: is missing (size: fixed needs it",
        ),
        (
            {"effects.oil_heat": DROP, "effects.droplets": {"diameter": "50 um", "jet_pressure": "5 bar"}},
            "effects.droplets.jet_pressure: has no meaning with size: fixed",
        ),
        (
            {"effects.oil_heat": DROP, "effects.droplets": {"diameter": "50 um", "prandtl": 0.8}},
            "effects.droplets.gas_conductivity: is missing (these are stated together",
        ),
        (
            {"effects.oil_heat": DROP, "effects.droplets": {"diameter": "50 um"}, "gas.fluid": "R1234ze(Z)"},
            "effects.droplets: CoolProp has no transport properties of R1234ze(Z)",
        ),
    ],
)
def test_a_fault_is_found_with_its_remedy(changes, words):
    assert words in refusal(changes)


@pytest.mark.parametrize(
    ("fluid", "p", "T", "rho", "diameter", "slip", "least", "most"),
    [
        ("R134a", 6e5, 310.0, 30.0, 1e-4, 2.5, 0.20, 0.22),
        ("Air", 4e5, 340.0, 4.0, 5e-5, 2.5, 0.13, 0.15),
        ("Air", 4e5, 340.0, 4.0, 5e-5, 0.0, 0.05, 0.07),
    ],
)
def test_what_conduction_inside_the_drop_would_take(fluid, p, T, rho, diameter, slip, least, most):
    """As docs/model.md says of what M154 leaves out, with 0.13 W/(m K) of the oil."""
    alpha = droplets.heat_transfer_coefficient(rho, slip, diameter, *transport(fluid, p, T))
    assert least < alpha / (alpha + math.pi**2 * 0.13 / (1.5 * diameter)) < most


def test_the_coefficient_inside_a_drop_is_that_of_its_slowest_mode():
    """α_i = π² λ/(1.5 d): r T of a sphere, cold at its surface, conducts as in a wall; r = λ = ρ c = 1 here."""
    r = np.linspace(0.0, 1.0, 101)
    profile, step, means = r * (1.0 - r**2), 0.4 * (r[1] - r[0]) ** 2, []
    for i in range(10_000):
        profile[1:-1] += 0.4 * (profile[2:] - 2.0 * profile[1:-1] + profile[:-2])
        if i in (7999, 9999):
            means.append(float(np.trapezoid(3.0 * profile * r, r)))
    coefficient = math.log(means[0] / means[1]) / (2000 * step) / 3.0  # surface over volume: 3
    assert coefficient == pytest.approx(math.pi**2 / (1.5 * 2.0), rel=1e-3)  # the grid's error is (π/100)²/12 and less
