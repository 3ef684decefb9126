"""Rules of the tolerance study: what is drawn, what moves the dead centre, what is counted; simulation faked."""

import numpy as np
import pytest

from screwsim.inputs.faults import UsageError
from screwsim.machine.slider_crank.tolerance import tolerance
from screwsim.outputs import Figures, Result
from screwsim.scene import loads
from screwsim.study.tolerance import drawn_lengths, tolerances, widths_of, with_lengths

TEXT = """\
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, offset: 3 mm, clearance: 3 cm^3}
gas: {fluid: Air, isentropic_exponent: 1.4}
operation: {speed: 1500 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 4 bar}}
"""
GRADES = {"crank_radius": 10, "rod_length": 10, "offset": 10}


def fake(scene) -> Result:
    """Return figures that follow from the lengths: capacity that of the swept volume."""
    machine = scene.machine
    return Result("ok", performance=Figures(gas_mass_flow=machine.swept_volume, shaft_power=machine.crank_radius))


def test_lengths_lie_within_half_their_tolerance():
    machine = loads(TEXT).machine
    widths = widths_of(machine, GRADES)
    assert widths["rod_length"] == tolerance(machine.rod_length, 10)
    for name, values in drawn_lengths(machine, widths, 1000, 1).items():
        off = values - getattr(machine, name)
        assert np.abs(off).max() <= 0.5 * widths[name]
        assert off.std() == pytest.approx(widths[name] / np.sqrt(12.0), rel=0.05)
        assert np.array_equal(values, drawn_lengths(machine, widths, 1000, 1)[name])


def test_what_the_piston_comes_nearer_is_lost_clearance():
    scene = loads(TEXT)
    other, shift = with_lengths(scene, {"rod_length": scene.machine.rod_length + 1e-4})
    assert shift == pytest.approx(1e-4, rel=1e-3)
    lost = scene.machine.clearance - other.machine.clearance
    assert lost == pytest.approx(scene.machine.piston_area * shift)


def test_the_spread_is_that_of_the_machines_and_its_shares_tell_the_cause():
    found = tolerances(loads(TEXT), GRADES, count=200, jobs=1, simulate=fake)
    power = next(each for each in found.spreads if each.figure == "shaft_power")
    assert power.shares["crank_radius"] == pytest.approx(1.0)
    assert power.shares["rod_length"] < 0.05
    assert power.deviation == pytest.approx(found.widths["crank_radius"] / np.sqrt(12.0), rel=0.1)
    assert (found.count, found.hits, found.failed) == (200, 0, 0)


def test_one_length_in_twenty_without_influence_has_more_than_the_share_of_chance():
    found, random = tolerances(loads(TEXT), GRADES, count=12, jobs=1, simulate=fake), np.random.default_rng(1)
    shares = [np.corrcoef(random.random((2, 12)))[0, 1] ** 2 for _ in range(4000)]
    assert np.mean(np.array(shares) > found.chance_share) == pytest.approx(0.05, abs=0.01)  # its deviation: 0.0034


def test_pistons_that_reach_the_head_are_counted_and_not_simulated():
    scene = loads(TEXT.replace("3 cm^3", "0.1 cm^3"))

    def check(other) -> Result:
        assert other.machine.clearance > 0.0
        return fake(other)

    found = tolerances(scene, dict.fromkeys(GRADES, 12), count=50, jobs=1, simulate=check)
    assert 0 < found.hits < 50
    assert len(found.shifts) == 50 - found.hits


def test_failed_cycles_are_counted_with_their_message():
    nominal = loads(TEXT).machine.rod_length

    def fails(other) -> Result:
        return fake(other) if other.machine.rod_length == nominal else Result("failed", "it stopped")

    found = tolerances(loads(TEXT), GRADES, count=3, jobs=1, simulate=fails)
    assert (found.failed, found.message) == (3, "failed: it stopped")
    assert found.spreads == ()


@pytest.mark.parametrize(
    ("text", "count", "message"),
    [
        (TEXT, 1, "too small for a spread"),
        (
            "machine: {rotor_diameter: 160 mm, rotor_length: 176 mm, volume: {max: 600 cm^3, phi_A: 60 deg}}\n"
            + TEXT.partition("\n")[2],
            8,
            "there is no crank",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(text, count, message):
    with pytest.raises(UsageError, match=message):
        tolerances(loads(text), GRADES, count=count, jobs=1, simulate=fake)
