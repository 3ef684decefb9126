"""The line of displaced oil: in series with the bore, its loss goes with the square of the flow; also at 360°."""

import math

import pytest
from each_row import each_row
from scenes import DROP, OIL_PORT, PUMPED_PORT, make, run

from screwsim.effects.oil_injection import flow
from screwsim.fluid.orifice import orifice_flow, orifice_flow_behind_line, smooth_orifice_flow
from screwsim.inputs.faults import SceneError

BORE = (1000.0, 0.02, 0.006, 0.012, 1.0)  # oil's density, viscosity; diameter, length, count of the bore
WINDOW = (1.0, 4.0)
P_SEPARATOR, NOMINAL = 12e5, 30e-3 / 60


def through(p, loss):
    behind, free = (flow(2.0, p, 1.0, *WINDOW, 0.0, each, NOMINAL, P_SEPARATOR, *BORE) for each in (loss, 0.0))
    return behind, free


@each_row("p", [1e5, 6e5, 11.9e5, 11.999e5])
@each_row("loss", [1e3, 5e4, 1e6, 1e9])
def test_line_and_bore_lose_together_what_there_is(p, loss):
    """The bore's loss goes with the square of its flow, too: both sum up to the difference of pressures."""
    behind, free = through(p, loss)
    line, available = loss * (behind / (1000.0 * NOMINAL)) ** 2, P_SEPARATOR - p
    assert 0.0 < behind < free and 0.0 < line < available
    bore = available * (behind / free) ** 2
    assert line + bore == pytest.approx(available, rel=1e-4)


def test_a_line_without_loss_is_none_and_nothing_flows_back():
    _, free = through(3e5, 0.0)
    assert free == smooth_orifice_flow(P_SEPARATOR - 3e5, 1.0, *BORE)
    assert through(13e5, 1e5)[0] == 0.0


@each_row("dp", [1e3, 2e5, 11e5])
@each_row("loss", [1e3, 1e6, 1e9])
def test_at_360_degrees_line_and_bore_lose_together_what_there_is(dp, loss):
    behind, free = orifice_flow_behind_line(dp, loss, NOMINAL, *BORE), orifice_flow(dp, *BORE)
    line = loss * (behind / (1000.0 * NOMINAL)) ** 2
    assert 0.0 < behind < free
    assert line + dp * (behind / free) ** 2 == pytest.approx(dp, rel=1e-12)
    assert orifice_flow_behind_line(dp, 0.0, NOMINAL, *BORE) == free
    assert orifice_flow_behind_line(-dp, loss, NOMINAL, *BORE) == 0.0


DISPLACED = {"oil_supply": OIL_PORT["oil_supply"], "effects.oil_pump": DROP}


def displaced_through(line):
    return run({**DISPLACED, "oil_supply": {**OIL_PORT["oil_supply"], "line": line}})


def test_the_oil_of_one_angle_comes_through_its_line():
    free, none = run(DISPLACED), displaced_through({"pressure_loss": "0 bar", "flow": "30 L/min"})
    assert dict(none.performance.items()) == dict(free.performance.items())
    lossy = displaced_through({"pressure_loss": "2 bar", "flow": "30 L/min"})
    assert lossy.status == "ok" and lossy.balance["energy"] < 3e-4
    found = lossy.performance
    dp = found.discharge_pressure - found.injection_pressure
    assert found.oil_mass_flow < 0.95 * free.performance.oil_mass_flow
    expected = orifice_flow_behind_line(dp, 2e5, NOMINAL, *BORE)
    assert found.oil_mass_flow == pytest.approx(expected, rel=1e-6)


def with_line(loss):
    port = {**OIL_PORT["effects.oil_injection"], "line": {"pressure_loss": loss, "flow": "30 L/min"}}
    return run({**OIL_PORT, "effects.oil_injection": port})


def test_a_line_that_loses_nothing_changes_no_bit():
    assert dict(with_line("0 bar").performance.items()) == dict(run(OIL_PORT).performance.items())


def test_the_machine_gets_the_oil_that_the_line_lets_through():
    free, lossy = run(OIL_PORT), with_line("0.5 bar")
    assert lossy.status == "ok" and lossy.balance["energy"] < 3e-4
    # bore and line as resistances: the ratio of flows where both lose by the square of it
    ratio = lossy.performance.oil_mass_flow / free.performance.oil_mass_flow
    mean = free.performance.discharge_pressure - free.performance.injection_pressure
    steady = free.performance.oil_mass_flow * 90.0 / 80.0  # while the window is open
    expected = 1.0 / math.sqrt(1.0 + 0.5e5 * (steady / (1000.0 * NOMINAL)) ** 2 / mean)
    assert ratio == pytest.approx(expected, rel=0.02)
    assert with_line("5 bar").performance.oil_mass_flow < lossy.performance.oil_mass_flow


@pytest.mark.parametrize(
    ("base", "more", "told"),
    [
        (PUMPED_PORT, {}, r"oil_injection\.line: applies to displaced oil; with oil_supply\.kind: pump the pump"),
        (
            OIL_PORT,
            {"pressure": "8 bar"},
            r"oil_injection\.line: is given as well as pressure, which is that after the line",
        ),
    ],
)
def test_a_line_that_has_no_place_is_refused(base, more, told):
    port = {**base["effects.oil_injection"], **more, "line": {"pressure_loss": "1 bar", "flow": "30 L/min"}}
    with pytest.raises(SceneError, match=told):
        make({**base, "effects.oil_injection": port})


@pytest.mark.parametrize(
    ("base", "more", "told"),
    [
        (
            {},
            {"line": {"pressure_loss": "1 bar", "flow": "30 L/min"}},
            r"oil_supply\.line: applies to displaced oil",
        ),
        ({}, {"orifice_count": 3}, r"oil_supply\.orifice_count: applies only to kind: displacement"),
        (
            OIL_PORT,
            {"line": {"pressure_loss": "1 bar", "flow": "30 L/min"}},
            r"oil_supply\.line: is for oil that enters at one angle \(write it under effects\.oil_injection",
        ),
    ],
)
def test_no_key_of_the_supply_is_taken_and_ignored(base, more, told):
    supply = base.get("oil_supply", {"kind": "pump", "ratio": 3, "temperature": "293 K"})
    with pytest.raises(SceneError, match=told):
        make({**base, "oil_supply": {**supply, **more}})
