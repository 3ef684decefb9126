"""Within a long step while a port holds the pressure, the gas in the chamber changes by what flows."""

import numpy as np
import pytest
from scenes import closed, make

from screwsim.cycle.between_ends import STIFF, _followed, missed_pressure

WIDE = {"machine.discharge_port.area": "60 cm^2", "operation.speed": "4500 rpm"}
HELD_FROM, LONG = np.radians(645.0), np.radians(4.0)  # [rad] the port is wide open; steps longer than that
SHARES = np.linspace(0.1, 0.9, 9)


def life_of(accuracy):
    """Return a life of that machine; with 1e-6 it has steps of a fraction of a degree, which are taken as true."""
    _, _, cycle = closed(make(WIDE | {"numerics": {"accuracy": accuracy}}))
    return cycle.trajectory


def test_pressures_between_the_ends_of_steps_at_discharge_are_those_of_shorter_steps():
    life, true = life_of(3e-4), life_of(1e-6)
    times = life.times[: life.steps + 1]
    widths = np.diff(times)
    begins = np.flatnonzero((widths > LONG) & (times[:-1] > HELD_FROM))
    angles = (times[begins, None] + SHARES * widths[begins, None]).ravel()
    dense, right = (each.states_at(angles)[:, -1] for each in (life, true))
    assert np.abs(dense / right - 1.0).max() > 4e-5  # what is to be found: a seventh of the accuracy
    assert np.abs((dense + missed_pressure(life, angles)) / right - 1.0).max() < 4e-6  # ends of steps err by 3e-6


def test_nothing_is_added_at_the_ends_of_steps_and_where_no_port_holds_the_pressure():
    life = life_of(3e-4)
    ends = life.times[1 : life.steps]
    assert np.abs(missed_pressure(life, ends)).max() < 1e-6  # Pa, of a way of no length
    closed_chamber = np.radians(np.linspace(430.0, 590.0, 40))
    assert not missed_pressure(life, closed_chamber).any()


@pytest.mark.parametrize("decay", [STIFF, 50.0])
def test_a_departure_follows_what_balances_the_flows_at_its_rate_of_decay(decay):
    """δ' = −λ (δ − a x) with δ(0) = 0 has the solution a (x − (1 − exp(−λ x))/λ)."""
    x, slope = np.linspace(0.0, 1.0, 5)[None], 0.3
    found = _followed(slope * x, np.full_like(x, decay), np.diff(x))
    assert found == pytest.approx(slope * (1.0 + np.expm1(-decay) / decay), rel=1e-12)
