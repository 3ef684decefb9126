"""Gas that takes oil along through a port: Chisholm's law against its two ends and a sum by hand."""

import math

import pytest

from screwsim.fluid import nozzle
from screwsim.fluid.gap_flow import volume_share
from screwsim.fluid.wet_nozzle import wet_flux, wet_share

RHO, RHO_OIL = 10.0, 850.0  # [kg/m³], air at 9 bar and 315 K, oil


def share(x, n, rho=RHO, room=0.0):
    return wet_share(rho, x, n, RHO_OIL, room)


@pytest.mark.parametrize("n", [0.0, 0.25, 0.5])
def test_without_oil_it_is_the_nozzle(n):
    assert share(0.0, n) == 1.0


@pytest.mark.parametrize("x", [0.1, 1.0, 5.0, 30.0])
def test_without_slip_it_is_the_homogeneous_mixture(x):
    """G = √(2 Δp ρ_H), of it gas 1/(1 + x), over √(2 Δp ρ): ρ_H = (1 + x)/(1/ρ + x/ρ_o)."""
    mixture = (1.0 + x) / (1.0 / RHO + x / RHO_OIL)
    assert share(x, 0.5) == pytest.approx(math.sqrt(mixture / RHO) / (1.0 + x), rel=1e-12)


@pytest.mark.parametrize("x", [0.1, 1.0, 5.0, 30.0])
def test_at_no_exponent_both_flow_beside_each_other(x):
    """Each in its own part of the opening under one pressure difference: S_g/S = 1/(1 + X), X = x √(ρ/ρ_o)."""
    assert share(x, 0.0) == pytest.approx(1.0 / (1.0 + x * math.sqrt(RHO / RHO_OIL)), rel=1e-12)


def test_chisholms_multiplier_by_hand():
    """x = 4, ρ_o/ρ = 81: X = 4/9, C = 3 + 1/3, 1 + C X + X² = 2.67901."""
    assert wet_share(10.0, 4.0, 0.25, 810.0, 0.0) == pytest.approx(2.679012346**-0.5, rel=1e-9)


def test_more_oil_and_less_slip_pass_less():
    by_oil = [share(x, 0.25) for x in (0.1, 1.0, 4.0, 10.0)]
    by_slip = [share(4.0, n) for n in (0.0, 0.25, 0.41, 0.5)]
    assert by_oil == sorted(by_oil, reverse=True) and by_slip == sorted(by_slip, reverse=True)


@pytest.mark.parametrize("n", [0.0, 0.25, 0.5])
def test_the_room_of_the_oil_counts_once(n):
    """Where flows feel ρ β² and pass β of the dry flux (M107), the wet flux is that without the oil's room."""
    x, room = 4.0, 1.0 / RHO_OIL
    beta = 1.0 / (1.0 + x * RHO * room)
    felt = RHO * beta * beta
    assert volume_share(felt, x, room) == pytest.approx(beta, rel=1e-12)
    assert math.sqrt(felt) * share(x, n, felt, room) == pytest.approx(math.sqrt(RHO) * share(x, n), rel=1e-12)


@pytest.mark.parametrize(("p_1", "p_2"), [(9.0e5, 8.9e5), (8.9e5, 9.0e5), (9.0e5, 1.0e5), (9.0e5, 9.0e5)])
def test_the_donors_oil_holds_its_gas_back_in_both_directions_choked_or_not(p_1, p_2):
    rho_1, rho_2, k_1, k_2, width = 10.0, 9.0, 1.39, 1.3, 50.0
    states = [(p, rho, 1.0 / k, *nozzle.choking(k)) for p, rho, k in ((p_1, rho_1, k_1), (p_2, rho_2, k_2))]
    dry = nozzle.flow(1.0, *states[0], *states[1], width)
    wet = wet_flux(p_1, rho_1, 1.0 / k_1, 3.0, p_2, rho_2, 1.0 / k_2, 0.5, width, 0.25, RHO_OIL, 0.0)
    donor = share(0.5, 0.25, rho_2) if p_2 >= p_1 else share(3.0, 0.25, rho_1)
    assert wet == pytest.approx(dry * donor, rel=1e-12)
