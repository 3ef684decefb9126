"""Derivatives where a drive moves the rotors: the mean speed and the speed over the angle respond, too."""

from pathlib import Path

import pytest

import screwsim
from screwsim.derivatives import argument_changes, directions, driven, linear_cycle
from screwsim.scene import with_values
from screwsim.scene.fields import value_at
from screwsim.simulate import simulate
from screwsim.study.uncertainty.point import sensitivities

DRIVES = Path(__file__).parents[2] / "configs" / "drive"
FIGURES = ("gas_mass_flow", "shaft_power", "isentropic_efficiency", "coupling_torque_amplitude", "speed_ripple")
SHARE = 1e-3  # of a number, for differences
CLOSE = 2e-3  # of a slope: cycles at 1e-6 have narrower layers around reversals, which alone change it by 1e-3
NOISE = 3e-5  # percent per percent, of these differences


@pytest.mark.parametrize(
    ("file", "speed", "path"),
    [
        ("induction.yaml", "3000 rpm", "operation.speed"),  # the motor's no-load speed
        ("induction.yaml", "3000 rpm", "effects.drive.motor.breakdown_slip"),  # through the mean speed
        ("point.yaml", "700 rpm", "effects.drive.rotor_inertia"),  # through the ripple, of ten percent, alone
        ("point.yaml", "700 rpm", "operation.discharge.pressure"),
        ("rubber_cord.yaml", "900 rpm", "effects.drive.coupling.damping"),
    ],
)
def test_slopes_are_those_of_cycles_closed_with_their_drive(file, speed, path):
    scene = screwsim.load(DRIVES / file, [f"operation.speed={speed}"])
    found, value = sensitivities(scene, [path], FIGURES), value_at(scene, path)
    fine = with_values(scene, {"numerics.accuracy": 1e-6})
    high, low = (simulate(with_values(fine, {path: value * by}), trace=False) for by in (1.0 + SHARE, 1.0 - SHARE))
    assert found.method[path] == "exact"
    for name in FIGURES:
        one, other = (each.performance[name] for each in (high, low))
        slope = (one - other) / (2.0 * SHARE) / found.result.performance[name]
        assert found.relative(name, path) == pytest.approx(slope, rel=CLOSE, abs=NOISE), name


def test_what_the_rates_feel_of_unknowns_is_computed_once_for_all_rounds(monkeypatch):
    """Only the curve of the speed changes from round to round; bits as without that."""
    scene = screwsim.load(DRIVES / "point.yaml", ["operation.speed=700 rpm"])
    paths, counts, found = ["effects.drive.rotor_inertia"], [], []
    own, rates = linear_cycle.linearised, argument_changes.rates_of
    asked = []
    monkeypatch.setattr(argument_changes, "rates_of", lambda *of: asked.append(len(of[2])) or rates(*of))
    for each in (own, lambda cycle, changes, injected, _: own(cycle, changes, injected, None)):
        monkeypatch.setattr(directions, "linearised", each)
        asked.clear()
        found.append(sensitivities(scene, paths, FIGURES, fine=False))
        counts.append(sum(asked))
    assert counts[0] < 0.9 * counts[1]
    assert all(found[0].relative(name, paths[0]) == found[1].relative(name, paths[0]) for name in FIGURES)


def test_the_unshifted_cycle_is_read_once_for_all_rounds_of_chambers_and_drive(monkeypatch):
    """It was read again in every round, and once more for the curve."""
    read, rounds = [], []
    for name, calls in (("unshifted_evaluation", read), ("responses", rounds)):
        own = getattr(driven, name)
        monkeypatch.setattr(driven, name, lambda *given, _own=own, _calls=calls: _calls.append(0) or _own(*given))
    scene = screwsim.load(DRIVES / "point.yaml", ["operation.speed=700 rpm"])
    sensitivities(scene, ["effects.drive.rotor_inertia"], FIGURES, fine=False)
    assert len(read) == 1 and len(rounds) > 2
