"""Blow-down and filling of a vessel through an opening, choked and not, against closed forms."""

import math

import pytest
from scipy.integrate import quad
from vessel import AREA, VOLUME, run, vessel

from screwsim.fluid.nozzle import choking

HIGH, LOW = (12e5, 360.0), (1.5e5, 283.0)
CLOSE = 1e-7  # a hundred steps of rtol 1e-9


@pytest.fixture(scope="module")
def v(tmp_path_factory):
    return vessel(tmp_path_factory.mktemp("vessel"))


def flow(gas, p_u, T_u, p_d):
    """Return the textbook's nozzle flow [kg/s]."""
    k, r = gas.k, max(p_d / p_u, (2 / (gas.k + 1)) ** (gas.k / (gas.k - 1)))
    return AREA * p_u * math.sqrt(2 * k / (k - 1) / (gas.R * T_u) * (r ** (2 / k) - r ** ((k + 1) / k)))


def test_choked_blow_down(v):
    """m = m_0 [1 + (k−1)/2 · t/τ]^(−2/(k−1)), τ = V/(S ψ √(R T_0)); T falls with m^(k−1)."""
    k, (p_0, T_0), time = v.gas.k, HIGH, 1.0
    rate = AREA / VOLUME * math.sqrt(choking(k)[1] * v.gas.R * T_0)
    left = (1 + (k - 1) / 2 * rate * time) ** (-2 / (k - 1))
    assert left**k * p_0 > 2 * LOW[0]  # still choked at the end
    T, m = run(v, HIGH, LOW, time)
    assert m == pytest.approx(v.gas.density(p_0, T_0) * VOLUME * left, rel=CLOSE)
    assert T == pytest.approx(T_0 * left ** (k - 1), rel=CLOSE)


def test_choked_blow_down_pressure(v):
    k, (p_0, T_0), time = v.gas.k, HIGH, 1.0
    rate = AREA / VOLUME * math.sqrt(choking(k)[1] * v.gas.R * T_0)
    T, m = run(v, HIGH, LOW, time)
    expected = p_0 * (1 + (k - 1) / 2 * rate * time) ** (-2 * k / (k - 1))
    assert m * v.gas.R * T / VOLUME == pytest.approx(expected, rel=CLOSE)


def test_unchoked_blow_down_takes_its_time(v):
    """From p_0 to p: t = ∫ V/(k R T) dp/ṁ along the isentrope, T = T_0 (p/p_0)^((k−1)/k)."""
    gas, p_0, T_0, p_end, p_out = v.gas, 2.0e5, 320.0, 1.6e5, 1.5e5

    def seconds(p):
        T = T_0 * (p / p_0) ** ((gas.k - 1) / gas.k)
        return VOLUME / (gas.k * gas.R * T) / flow(gas, p, T, p_out)

    time, _ = quad(seconds, p_end, p_0, epsrel=1e-11)
    T, m = run(v, (p_0, T_0), (p_out, 283.0), time)
    assert m * gas.R * T / VOLUME == pytest.approx(p_end, rel=CLOSE)


def test_choked_filling_raises_the_pressure_evenly(v):
    """p = p_0 + k R T_s ṁ t/V with a constant ṁ."""
    gas, time = v.gas, 0.3
    rise = gas.k * gas.R * HIGH[1] / VOLUME * flow(gas, *HIGH, 0.0) * time
    assert LOW[0] + rise < 0.5 * HIGH[0]  # still choked at the end
    T, m = run(v, LOW, HIGH, time)
    assert m * gas.R * T / VOLUME == pytest.approx(LOW[0] + rise, rel=CLOSE)


def test_unchoked_filling_takes_its_time(v):
    gas, p_0, p_end = v.gas, 8e5, 11e5
    time, _ = quad(lambda p: VOLUME / (gas.k * gas.R * HIGH[1]) / flow(gas, *HIGH, p), p_0, p_end, epsrel=1e-11)
    T, m = run(v, (p_0, 300.0), HIGH, time)
    assert m * gas.R * T / VOLUME == pytest.approx(p_end, rel=CLOSE)


def test_what_fills_an_empty_vessel_is_k_times_as_hot(v):
    """The first law of filling: T → k T_s where nothing was before."""
    gas, nearly_empty = v.gas, 1e-3
    T, _ = run(v, (HIGH[0] * nearly_empty, 300.0), HIGH, 1.0)
    # what was there holds a share p_0/p of the energy: ten times its part at the start, pressure is then above a tenth
    assert T == pytest.approx(gas.k * HIGH[1], rel=10 * nearly_empty)


def test_a_vessel_at_the_plenums_state_stays_there(v):
    T, m = run(v, LOW, LOW, 1.0)
    assert (T, m) == pytest.approx((LOW[1], v.gas.density(*LOW) * (VOLUME + 1e-12)), rel=1e-12)
