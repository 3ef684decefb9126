"""Oil that a pump presses through a port: what it brings into the chamber, what the pump pays, and nothing negative."""

import numpy as np
import pytest
from scenes import OIL_VOLUME, PUMPED_PORT, balanced, closed, make, run

EFFICIENCY = 0.6  # of the pump in the base scene
LATE = {"effects.oil_injection": {"opens": "600 deg", "closes": "690 deg"}}  # reaches above the discharge pressure
SUMP = {"oil_supply.source": "suction"}
CASES = {"separator": {}, "sump": SUMP, "separator, late": LATE, "sump, late": {**SUMP, **LATE}}


@pytest.mark.parametrize("room", [{}, OIL_VOLUME], ids=["no room", "room"])
@pytest.mark.parametrize("case", CASES)
def test_nothing_of_pumped_oil_creates_exergy(case, room):
    result = balanced(run({**PUMPED_PORT, **CASES[case], **room}), "oil_mass")
    entries = [result.ledger[f"exergy_destroyed_oil_{name}"] for name in ("injection", "supply", "pump")]
    assert min(entries) >= -1e-9 * result.performance.shaft_power  # rounding


@pytest.mark.parametrize("case", CASES)
def test_the_pump_pays_the_rise_while_the_chamber_is_above_the_source(case):
    """M255, over the port's window, with ramps of 10° at both ends."""
    scene = {**PUMPED_PORT, **CASES[case], **OIL_VOLUME}
    found = run(scene).performance
    cycle = closed(make(scene))[2].trajectory
    window = make(scene).effects["oil_injection"].parameters
    phi = np.linspace(window.opens, window.closes, 4001)
    ramp = np.minimum(1.0, np.minimum(phi - window.opens, window.closes - phi) / np.radians(10.0))
    weight = ramp * ramp * (3.0 - 2.0 * ramp)
    p = cycle.sample(phi)[0][:, 1]
    rise = np.trapezoid(weight * np.maximum(p - (1.5e5 if "sump" in case else 12e5), 0.0), phi)
    rise /= np.trapezoid(weight, phi)
    oil = found.oil_mass_flow / 1000.0
    assert rise > 1e3 or case == "separator"
    assert found.oil_pump_power == pytest.approx(oil * rise / EFFICIENCY, rel=2e-3, abs=1e-6)


def test_oil_of_a_sump_is_not_cooled_by_its_lift():
    """The same chamber, the same oil: where it comes from is the pump's matter, and heats it only from above."""
    found = [run({**PUMPED_PORT, **OIL_VOLUME, **LATE, **source}) for source in ({}, SUMP)]
    separator, sump = (result.performance.oil_discharge_temperature for result in found)
    lost = 12e5 - found[1].performance.injection_pressure  # what the separator's oil loses in pressure more
    assert separator - sump == pytest.approx(lost / (1000.0 * 2000.0), abs=0.05)
    assert separator > sump
