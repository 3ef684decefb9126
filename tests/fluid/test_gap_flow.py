"""Gaps: the fitted friction against laminar flow in a slot, mixtures against closed forms, and the limits of both."""

import math

import pytest
from each_row import each_row

from screwsim.fluid import gap_flow, nozzle

MU, MU_OIL, GAP, PASSAGE = 1.2e-5, 2e-2, 20e-6, 2e-3


def mixture(kernel, flux, x, density=30.0, passage=PASSAGE, room=0.0):
    return kernel(flux, x, density, GAP, passage, MU, MU_OIL, room)


@pytest.mark.parametrize("micrometres", [10, 20, 40])
def test_slow_gas_passes_as_laminar_theory_says(micrometres):
    """Nozzle over slot: G²/(2 ρ) = Δp and G_slot = ρ Δp δ²/(12 μ L) give M = 48 (L/δ)/Re; the fit keeps within 10 %."""
    gap = 1e-6 * micrometres
    divisor = gap_flow.radial_divisor(200.0, 5e-3, gap)
    assert divisor == pytest.approx(48.0 * 5e-3 / gap / 200.0, rel=0.1)


def test_wide_gaps_at_high_speed_have_no_friction():
    assert gap_flow.radial_friction(1e5, 100e-6, 2e-3, MU) == 1.0
    assert gap_flow.flank_friction(1e5, 1e-3, 2e-3, MU) == pytest.approx(1.0, abs=0.12)  # the fit goes to 1/1.096


@pytest.mark.parametrize("kernel", [gap_flow.radial_friction, gap_flow.flank_friction])
def test_friction_holds_back_and_more_flux_passes_more(kernel):
    fluxes = [10.0**k for k in range(-3, 5)]
    shares = [kernel(flux, GAP, PASSAGE, MU) for flux in fluxes]
    assert all(0.0 < share <= 1.0 for share in shares)
    passed = [flux * share for flux, share in zip(fluxes, shares, strict=True)]
    assert passed == sorted(passed)


@pytest.mark.parametrize("kernel", [gap_flow.mcadams_mixture, gap_flow.cicchitti_mixture])
def test_without_oil_and_depth_a_gap_is_the_nozzle(kernel):
    assert mixture(kernel, 500.0, 0.0, passage=0.0) == 1.0


@pytest.mark.parametrize("kernel", [gap_flow.mcadams_mixture, gap_flow.cicchitti_mixture])
def test_without_depth_the_oils_inertia_slows_the_gas(kernel):
    assert mixture(kernel, 500.0, 3.0, passage=0.0) == pytest.approx(0.5, rel=1e-14)  # 1/√(1 + 3)


@pytest.mark.parametrize(
    ("kernel", "viscosity"),
    [
        (gap_flow.mcadams_mixture, 2.0 / (1.0 / MU + 1.0 / MU_OIL)),
        (gap_flow.cicchitti_mixture, 0.5 * (MU + MU_OIL)),
    ],
)
def test_a_viscous_gap_passes_what_a_slot_passes(kernel, viscosity):
    """Slow: Δp = G_h²/(2 ρ_m) drives the mixture, x = 1, by ρ_m Δp δ²/(12 μ_m L)."""
    flux = 1e-3
    G_h = flux * math.sqrt(2.0)
    laminar = 0.5 * G_h**2 * GAP**2 / (12.0 * viscosity * PASSAGE)
    assert 2.0 * flux * mixture(kernel, flux, 1.0) == pytest.approx(laminar, rel=1e-3)


def test_oil_seals_by_its_viscosity():
    thin, thick = (mixture(kernel, 500.0, 1.0) for kernel in (gap_flow.mcadams_mixture, gap_flow.cicchitti_mixture))
    assert thick < 0.002 < 0.1 < thin


def of_gas_and_oil(kernel, flux, gap=26e-6, x=1.0):
    """Return the flux of gas and oil that passes, and its Re = 2 δ G_m/μ_m by McAdams' viscosity."""
    passed = (1.0 + x) * flux * kernel(flux, x, 45.0, gap, PASSAGE, MU, MU_OIL, 0.0)
    return passed, 2.0 * gap * passed / ((1.0 + x) / (1.0 / MU + x / MU_OIL))


def test_a_gap_with_a_mixture_as_thin_as_gas_is_turbulent_by_blasius():
    """M192 has laminar friction, f = 96/Re, at any Re. Blasius's in its place: as docs/model.md says."""
    choke = nozzle.choking(1.1)
    gas = (45.0, 1.0 / 1.1, *choke)
    flux = nozzle.flow(1.0, 8e5, *gas, 10e5, *gas, 0.0)
    frictionless = flux * math.sqrt(2.0)
    laminar, Re = of_gas_and_oil(gap_flow.mcadams_mixture, flux)
    turbulent, _ = of_gas_and_oil(gap_flow.mcadams_blasius, flux)
    assert pytest.approx(9500.0, abs=50.0) == Re
    assert (laminar / frictionless, turbulent / frictionless) == pytest.approx((0.85, 0.66), abs=5e-3)
    thick, _ = of_gas_and_oil(gap_flow.cicchitti_mixture, flux)
    assert 2.0 * 26e-6 * thick / (0.5 * (MU + MU_OIL)) < 1.0
    assert of_gas_and_oil(gap_flow.cicchitti_blasius, flux)[0] == thick


@each_row("gap", [10e-6, 26e-6, 100e-6])
@each_row("flux", [3.0, 100.0, 1000.0, 2e4])
def test_entry_and_the_larger_friction_take_the_dynamic_pressure_of_the_frictionless_mixture(flux, gap):
    """G_h² = G_m² (1 + f L/(2 δ)), f the larger of 96/Re and 0.3164 Re^(-1/4)."""
    passed, Re = of_gas_and_oil(gap_flow.mcadams_blasius, flux, gap)
    f = max(96.0 / Re, 0.3164 * Re**-0.25)
    assert passed**2 * (1.0 + f * PASSAGE / (2.0 * gap)) == pytest.approx(2.0 * flux**2, rel=1e-7)
    laminar, _ = of_gas_and_oil(gap_flow.mcadams_mixture, flux, gap)
    assert (passed < laminar) == (Re > (96.0 / 0.3164) ** (4.0 / 3.0))


def test_with_room_the_homogeneous_mixture_is_exact():
    """ρ_m = (1 + x)/(1/ρ + x/ρ_o); the felt density is ρ β². Gas flux: √(2 Δp ρ_m)/(1 + x)."""
    rho, rho_o, x, dp = 40.0, 900.0, 3.0, 1e4
    beta = 1.0 / (1.0 + x * rho / rho_o)
    felt = rho * beta**2
    flux = math.sqrt(2.0 * felt * dp)
    mixture_density = (1.0 + x) / (1.0 / rho + x / rho_o)
    found = flux * mixture(gap_flow.mcadams_mixture, flux, x, felt, 0.0, 1.0 / rho_o)
    assert found == pytest.approx(math.sqrt(2.0 * dp * mixture_density) / (1.0 + x), rel=1e-12)


def test_no_flow_no_division_by_nothing():
    assert gap_flow.radial_friction(0.0, GAP, PASSAGE, MU) == pytest.approx(0.0, abs=1e-9)
    assert mixture(gap_flow.cicchitti_mixture, 0.0, 1.0) == pytest.approx(0.0, abs=1e-9)


# ---- a gap full of oil ---------------------------------------------------------------------------------------------

RHO_OIL = 950.0


def film(drop, gap=GAP, viscosity=MU_OIL):
    return gap_flow.film_flux(drop, gap, PASSAGE, viscosity, RHO_OIL)


def test_oil_creeps_through_a_full_gap_as_between_plates():
    """Plane Poiseuille flow: ρ h³ Δp/(12 μ L) of a unit length, h times the flux."""
    viscous = 1e4 * MU_OIL
    assert GAP * film(1e6, viscosity=viscous) == pytest.approx(
        RHO_OIL * GAP**3 * 1e6 / (12.0 * viscous * PASSAGE), rel=1e-7
    )


def test_thin_oil_in_a_wide_gap_is_bernoullis():
    assert film(1e6, gap=5e-3, viscosity=1e-4) == pytest.approx(math.sqrt(2.0 * RHO_OIL * 1e6), rel=1e-3)


@each_row("drop", [1.0, 1e3, 1e5, 2e6])
@each_row("gap", [10e-6, 50e-6, 300e-6])
def test_entry_and_friction_take_the_whole_pressure_drop(drop, gap):
    flux = film(drop, gap)
    friction = 12.0 * MU_OIL * PASSAGE * flux / (RHO_OIL * gap * gap)
    assert flux**2 / (2.0 * RHO_OIL) + friction == pytest.approx(drop, rel=1e-12)


def test_what_oil_fills_is_not_open_to_the_gas():
    for x, filled in ((-1e-9, 0.0), (0.0, 0.0), (0.1, 0.5), (0.2, 1.0), (3.0, 1.0)):
        assert gap_flow.filled_share(x, 0.2) == pytest.approx(filled, abs=1e-15)
        assert gap_flow.open_share(x, 0.2) == 1.0 - gap_flow.filled_share(x, 0.2)
        share = gap_flow.oil_film(1e6, x, GAP, PASSAGE, 0.2, MU_OIL, RHO_OIL) / film(1e6)
        assert share == pytest.approx(filled, abs=1e-15)


def test_the_filled_share_is_smooth_where_it_begins_and_ends():
    for x, side in ((0.0, 1e-6), (0.2, -1e-6)):
        slope = (gap_flow.filled_share(x + side, 0.2) - gap_flow.filled_share(x, 0.2)) / side
        assert abs(slope) < 1e-3  # of 7.5 in the middle


def test_no_film_without_a_pressure_difference_or_without_oil():
    assert film(0.0) == 0.0
    assert gap_flow.oil_film(1e6, 0.0, GAP, PASSAGE, 0.2, MU_OIL, RHO_OIL) == 0.0


def test_a_wall_drags_half_its_speed_along_where_there_is_oil():
    """Plane Couette flow: ρ u/2, of the share that oil fills; without oil nothing, and smoothly so."""
    for x, filled in ((0.0, 0.0), (0.1, 0.5), (0.2, 1.0), (3.0, 1.0)):
        found = gap_flow.dragged_oil(x, 0.2, 0.4, 25.0, RHO_OIL)
        assert found == pytest.approx(filled * RHO_OIL * 0.4 * 25.0 / 2.0, abs=1e-12)
    assert gap_flow.dragged_oil(1e-6, 0.2, 0.4, 25.0, RHO_OIL) < 1e-9 * RHO_OIL * 25.0
