"""Derivatives against differences of tightly closed cycles: ideal and real gas, either closing, each kind of way."""

from dataclasses import replace
from pathlib import Path

import pytest
from tight import closed_tightly

import screwsim
from screwsim.cycle.guess import leased
from screwsim.cycle.problem import Series, problem_of
from screwsim.derivatives.figures import figures_of
from screwsim.scene import with_values
from screwsim.scene.fields import value_at
from screwsim.study.local import sensitivities

CONFIGS = Path(__file__).parents[2] / "configs"
PLAIN = Path(__file__).parents[1] / "plain"
STEP = 1e-4  # of a number
IDEAL = (
    "effects.tip_leakage.gap",
    "operation.discharge.pressure",
    "machine.discharge_port.opens",  # a breakpoint that moves
    "oil_supply.ratio",  # through the injection alone
    "effects.mechanical.fraction",  # through the figures alone
)
REAL = ("operation.condensing_temperature", "effects.interlobe_leakage.gap")
FIGURES = ("isentropic_efficiency", "gas_mass_flow", "shaft_power", "discharge_temperature")
LEAST = 1e-2  # percent per percent: what counts for less errs as that
OFF = 5e-4  # of the largest of a number's: by the slices at the default accuracy of 3e-4; median 1e-6


@pytest.mark.parametrize(
    ("file", "way", "paths"),
    [
        (CONFIGS / "paper" / "point.yaml", "histories", IDEAL),
        (CONFIGS / "paper" / "point.yaml", "coupled", IDEAL[:1]),
        (PLAIN / "r134a.yaml", "auto", REAL),
    ],
)
def test_derivatives_are_those_of_closed_cycles(file, way, paths):
    scene = screwsim.load(file, [f"numerics.closing={way}"])
    paths = [path for path in paths if value_at(scene, path) is not None]
    found = sensitivities(scene, paths)
    series, problem = Series(), problem_of(scene)
    machinery = leased(problem)
    base = closed_tightly(problem, machinery)
    for path in paths:
        value = value_at(scene, path)
        sides = [
            figures_of(
                closed_tightly(problem_of(with_values(scene, {path: value * (1.0 + by)}), series), machinery, base.life)
            )
            for by in (STEP, -STEP)
        ]
        at = figures_of(base)
        slopes = {name: (sides[0][name] - sides[1][name]) / (2.0 * STEP) / at[name] for name in FIGURES}
        close = OFF * max(LEAST, *map(abs, slopes.values()))
        assert found.method[path] == "exact"
        assert {name: found.relative(name, path) for name in FIGURES} == pytest.approx(slopes, abs=close), path


def test_a_stated_temperature_of_what_flows_back_moves_the_cycle_by_itself():
    scene = screwsim.load(CONFIGS / "paper" / "point.yaml", ["operation.discharge.temperature=330 K"])
    path = "operation.discharge.temperature"
    found = sensitivities(scene, [path])
    value, problem = value_at(scene, path), problem_of(scene)
    machinery = leased(problem)
    sides = [
        figures_of(closed_tightly(problem_of(with_values(scene, {path: value * (1.0 + by)})), machinery))
        for by in (STEP, -STEP)
    ]
    slope = (sides[0]["shaft_power"] - sides[1]["shaft_power"]) / (2.0 * STEP * value)
    assert found.derivatives["shaft_power"][path] == pytest.approx(slope, rel=OFF)


def test_a_scene_whose_speed_follows_from_a_drive_is_differenced_and_says_so():
    scene = screwsim.load(CONFIGS / "drive" / "point.yaml")
    scene = replace(scene, sweep={})
    path = "effects.tip_leakage.gap"
    found = sensitivities(scene, [path], ["gas_mass_flow"])
    assert found.method == {path: "differences"}
    assert "drive" in found.why[path]
    assert found.derivatives["gas_mass_flow"][path] < 0.0  # what leaks is not delivered
