"""A discharge port through which the gas takes its oil along: closings agree, balances close, it vanishes (M430)."""

import numpy as np
import pytest
from scenes import CARRIED, OIL_VOLUME, balanced, make, run

from screwsim.build import build_parts
from screwsim.explain import explain
from screwsim.fluid import nozzle
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.wet_nozzle import wet_share
from screwsim.inputs.faults import SceneError

WET = {**CARRIED, "effects.discharge_port.chisholm_exponent": 0.5}
FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature", "trapped_mass")
OIL_DENSITY = 1000.0  # [kg/m³], of the scenes
COUPLED = {"numerics": {"closing": "coupled", "error": "none"}}


@pytest.mark.parametrize("more", [{}, OIL_VOLUME], ids=["dry room", "oil takes room"])
def test_mass_energy_oil_and_entropy_close_and_both_closings_agree(more):
    result, together = run({**WET, **more}), run({**WET, **more, **COUPLED}).performance
    balanced(result, "oil_mass")
    for name in FIGURES:
        assert together[name] == pytest.approx(result.performance[name], rel=3e-4), name  # numerics.accuracy


def area(changes, exponent=None):
    """Return angles [deg] and the area [m²] that the traces of the port ask for: its flow out over the law's flux."""
    result = run({**changes, "numerics": {"accuracy": 1e-6}})
    cycle, p_d = result.cycle, result.performance.discharge_pressure
    p, rho = cycle["pressure"], cycle["gas_mass"] / cycle["volume"]
    out = np.flatnonzero((cycle["mass_flow_discharge_port"] < -0.02) & (p > 1.02 * p_d))
    gas = build_parts(make(changes)).gas
    assert isinstance(gas, IdealGas)
    k = gas.k
    areas = []
    for i in out:
        choke, choked = nozzle.choking(k)
        end = rho[i], 1.0 / k, choke, choked
        flux = -nozzle.flow(1.0, p[i], *end, p_d, *end, 0.0)
        x = cycle["oil_mass"][i] / cycle["gas_mass"][i]
        share = 1.0 if exponent is None else wet_share(rho[i], x, exponent, OIL_DENSITY, 0.0)
        areas.append(-cycle["mass_flow_discharge_port"][i] / (flux * share))
    return cycle["angle"][out], np.array(areas)


@pytest.mark.parametrize("n", [0.25, 0.5])
def test_the_port_passes_the_share_of_the_law(n):
    """What passes over the law's flux is the area of the port, which is that of the dry port at the same angle."""
    at, wet = area({**WET, "effects.discharge_port.chisholm_exponent": n}, n)
    dry_at, dry = area(CARRIED)
    both = np.intersect1d(at, dry_at)
    assert len(both) > 10
    np.testing.assert_allclose(wet[np.isin(at, both)], dry[np.isin(dry_at, both)], rtol=1e-3)


def test_pressure_rises_and_power_with_the_oil_that_is_taken_along():
    peaks = [run({**CARRIED, "effects.discharge_port.chisholm_exponent": n}).performance for n in (0, 0.25, 0.5)]
    found = [each.peak_pressure for each in peaks]
    assert run(CARRIED).performance.peak_pressure < found[0] < found[1] < found[2]


def test_without_oil_it_is_the_dry_port():
    none = {"oil_supply.ratio": 1e-9}
    wet, dry = run({**WET, **none}).performance, run({**CARRIED, **none}).performance
    for name in FIGURES:
        assert wet[name] == pytest.approx(dry[name], rel=1e-6), name


def test_explain_says_which_law_the_port_has():
    assert "discharge line, flow coefficient 1, with its oil, Chisholm's n = 0.5 (M430)" in " ".join(
        str(explain(make(WET))).split()
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"effects.discharge_port.chisholm_exponent": 0.25, "oil.transport": "paper"}, "needs oil.transport: carried"),
        ({**CARRIED, "effects.discharge_port.chisholm_exponent": 0.6}, "chisholm_exponent"),
        ({**CARRIED, "effects.suction_port.chisholm_exponent": 0.25}, "chisholm_exponent"),
    ],
)
def test_what_it_lacks_is_refused(changes, message):
    with pytest.raises(SceneError, match=message):
        make(changes)
