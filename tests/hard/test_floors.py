"""Floors of the model: what each one changes is stated and bounded."""

import numpy as np
import pytest
from each_row import each_row
from scenes import CARRIED, DROP, GAS_FIGURES, make, run

from screwsim import outputs
from screwsim.cycle import coordinates, relaxation
from screwsim.figures.errors import relative_errors, worst
from screwsim.model import port_states, slots
from screwsim.model.balance import oil_temperature_slope
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Network
from screwsim.model.network.steps import step_texts
from screwsim.simulate import simulate

ACCURACY = 3e-4  # the default one
SHUT = {"effects": {}, "oil": DROP, "oil_supply": DROP}


@pytest.mark.parametrize("factor", [0.1, 10.0])
@pytest.mark.parametrize("d", [1e-5, 1e-4, 1e-3])
def test_the_least_oil_that_counts_moves_no_figure(factor, d, monkeypatch):
    """`LEAST_OIL`: oil below 1e-4 of the gas is not waited for; the gas does not notice, within the accuracy."""
    changes = {**CARRIED, "oil_supply.ratio": d}
    usual = run(changes)
    monkeypatch.setattr(coordinates, "LEAST_OIL", factor * coordinates.LEAST_OIL)
    found = simulate(make(changes))
    assert found.status == usual.status == "ok"
    for name in GAS_FIGURES:
        assert found.performance[name] == pytest.approx(usual.performance[name], rel=ACCURACY), name


@pytest.mark.parametrize("transport", ["paper", "carried"])
def test_figures_are_continuous_over_the_least_oil(transport):
    """Just below and above LEAST_OIL: d differs by 2 %, which is 2e-6 of the gas and its heat less than 1e-5."""
    below, above = (run({"oil.transport": transport, "oil_supply.ratio": d}) for d in (0.99e-4, 1.01e-4))
    for name in GAS_FIGURES:
        assert below.performance[name] == pytest.approx(above.performance[name], rel=ACCURACY), name
    assert below.performance.oil_ratio == pytest.approx(0.99e-4, rel=1e-9)  # an input
    assert above.performance.oil_ratio == pytest.approx(1.01e-4, rel=1e-9)


def test_errors_of_oil_have_the_same_least_scale():
    assert outputs.LEAST_OIL == coordinates.LEAST_OIL
    for name in ("oil_ratio", "oil_flow_ratio", "oil_mass_flow"):
        assert outputs.PERFORMANCE[name].scale.least == outputs.LEAST_OIL


@pytest.mark.parametrize("d", [0, 1e-9, 1e-6])
def test_next_to_no_oil_is_as_no_oil(d):
    """The line's least ratio (1e-9) and the guess's (1e-3) leave nothing behind: gas as without oil, no oil made."""
    none, found = run({"oil_supply.ratio": 0}), run({**CARRIED, "oil_supply.ratio": d})
    for name in GAS_FIGURES:  # with the paper's transport, none is as without oil heat: tests/laws
        assert found.performance[name] == pytest.approx(none.performance[name], rel=ACCURACY), name
    assert found.performance.oil_ratio == pytest.approx(d, abs=coordinates.LEAST_OIL * ACCURACY)
    assert abs(found.performance.oil_flow_ratio) <= d + coordinates.LEAST_OIL


@pytest.mark.parametrize("factor", [0.1, 10.0])
@pytest.mark.parametrize("p_d", ["12 bar", "1.50015 bar"])
def test_the_least_work_moves_no_figure(p_d, factor, monkeypatch):
    """`LEAST_WORK`: work below 1e-6 p V is rounding; a pressure ratio of 1.0001 still asks for more."""
    changes = {"operation.discharge": {"pressure": p_d}}
    usual = simulate(make(changes))
    monkeypatch.setattr(relaxation, "LEAST_WORK", factor * relaxation.LEAST_WORK)
    found = simulate(make(changes))
    assert found.status == usual.status == "ok"
    assert worst(relative_errors(found.performance, usual.performance))[1] <= ACCURACY


def test_a_chamber_that_does_no_work_is_within_the_least_work():
    """A chamber that never opens gives back what it takes: without the floor, nothing would close its balance."""
    found = simulate(make(SHUT))
    assert found.status == "ok"
    assert abs(found.performance.work_per_cycle) <= relaxation.LEAST_WORK * 1.5e5 * 600e-6  # p V of the full chamber


@pytest.mark.parametrize("x", [1e-9, 1e-6, 1e-3, 1.0])
def test_the_floor_of_the_oils_mass_is_a_share_of_it(x):
    """`oil_temperature_slope` divides by m_oil + 1e-12 m: it is low by 1e-12/x of itself, at most by 1e-3."""
    m, heat, c, omega = 2e-4, 5.0, 2000.0, 300.0
    slope = oil_temperature_slope(300.0, x * m, m, c, 1e-6, 1e-6 * 310.0, heat, omega)
    exact = (1e-6 * (310.0 - 300.0) - heat / c) / (x * m * omega)
    assert (exact - slope) / exact == pytest.approx(1e-12 / x, rel=1e-3, abs=1e-15)  # next order of the floor; rounding
    assert abs(exact - slope) <= 1e-3 * abs(exact)


def size_of(y0, y1, error):
    """Return the size of a step's error of one chamber with carried oil, an ideal gas."""
    network = Network(("T", "rho", "T_oil", "x_oil"), (), heated=True, carried=True, dissolves=False, roomed=False)
    network.cells = ["suction_line", "discharge_line", ""]
    names = {"PRESSURE": slots.PRESSURE, "TPT": slots.TPT, port_states.relative.flat_name: port_states.relative}
    names |= Layout(network).constants((), ())
    exec("\n".join(step_texts(network)), names)
    port_state = np.zeros(slots.PORT_STATE)
    port_state[[slots.PRESSURE, slots.TPT]] = 1e5
    return names["chamber__error"](np.array(y0), np.array(y1), np.array(error), 0, port_state, 0, ())


@pytest.mark.parametrize(("x", "possible"), [(0.0, True), (-0.9, True), (-1.1, False), (-100.0, False)])
def test_oil_below_none_is_rounding_or_impossible(x, possible):
    """`port_states.NO_OIL`: oil per gas of -1e-13 passes, less makes the step smaller."""
    y = [300.0, 1.0, 310.0, x * port_states.NO_OIL]
    size = size_of(y, y, [0.0, 0.0, 0.0, 0.0])
    assert size == (0.0 if possible else port_states.IMPOSSIBLE)


@pytest.mark.parametrize("x", [-1.0, 1.0])
def test_oil_that_is_rounding_changes_no_sign(x):
    """The floor of the oil's mass is ten times NO_OIL: the oil's temperature goes the same way, off by a tenth."""
    m, omega = 2e-4, 300.0
    found, none = (
        oil_temperature_slope(300.0, share * m, m, 2000.0, 1e-6, 1e-6 * 310.0, 0.0, omega)
        for share in (x * port_states.NO_OIL, 0.0)
    )
    assert none > 0.0
    assert found / none == pytest.approx(1.0, abs=0.12)


@pytest.mark.parametrize("speed", ["1000 rpm", "3000 rpm"])
def test_a_chamber_without_oil_makes_none(speed):
    """What `port_states.NO_OIL` lets pass does not grow: no more oil, of either sign, passes than a step tells."""
    found = run({**CARRIED, "oil_supply.ratio": 0, "operation.speed": speed})
    assert found.status == "ok"
    assert abs(found.performance.oil_ratio) <= 0.1 * port_states.SOME_OIL
    assert abs(found.performance.oil_flow_ratio) <= 0.1 * port_states.SOME_OIL
    assert found.performance.oil_discharge_temperature is None  # that of nothing


@each_row(("x", "share"), [(1e-9, 1e-3), (1e-7, 0.1), (1e-6, 1.0), (1e-3, 1.0), (3.0, 1.0)])
def test_the_temperature_of_next_to_no_oil_counts_as_little(x, share):
    """`SOME_OIL`: below 1e-6 of the gas, oil holds less than 1e-5 of the heat; its temperature counts so."""
    y = [300.0, 1.0, 310.0, x]
    assert size_of(y, y, [0.0, 0.0, 31.0, 0.0]) == pytest.approx(0.1 * share, rel=1e-12)
    assert size_of(y, y, [0.0, 0.0, 0.0, 1e-7]) == pytest.approx(1e-7 / max(x, port_states.SOME_OIL), rel=1e-9)


def test_without_oil_the_slope_of_its_temperature_is_finite():
    assert oil_temperature_slope(300.0, 0.0, 2e-4, 2000.0, 0.0, 0.0, 0.0, 300.0) == 0.0
