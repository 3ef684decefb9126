"""The border of the phases in derivatives: where heat capacity jumps, a change passes it as cycles do."""

from types import SimpleNamespace

import numpy as np
import pytest
from closed_points import closed_scene
from folders import CONFIGS
from test_against_differences import all_differenced

import screwsim
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of
from screwsim.derivatives import residual
from screwsim.derivatives.collocation import QUICK
from screwsim.derivatives.lane_rates import rates
from screwsim.derivatives.phases import border_temperature
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.model.slots import S_RHO, S_T
from screwsim.study.uncertainty.point import sensitivities

HUMID = (
    "effects.air_package=off",
    "effects.separator=off",
    "oil_supply.temperature=325 K",
)
SETTLES = 15  # iterations until slices and states stand: 11, and 106 where nodes go to and fro over the border
PASSED = 3e-4  # slices of the default accuracy; without the jump at the border 1.2e-2 and 1.8e-2


@pytest.fixture(scope="module")
def humid():
    """Fog forms in what a chamber begins with, as it expands to suction, and goes as fresh air warms it."""
    return screwsim.load(CONFIGS / "air" / "humid_package.yaml", list(HUMID))


def test_a_change_passes_the_border_of_the_phases_as_cycles_do(humid):
    path = "machine.profile.wrap_angle"
    slopes = all_differenced(humid, path, ["gas_mass_flow", "trapped_mass"], 1e-3, 1e-6)
    found = sensitivities(humid, [path])
    assert found.method[path] == "exact"
    for figure, slope in slopes.items():
        assert found.relative(figure, path) == pytest.approx(slope, rel=PASSED), figure


def test_the_cycle_settles_on_the_border_of_the_phases(humid, monkeypatch):
    asked, size_of = [], residual.size_of
    monkeypatch.setattr(residual, "size_of", lambda *of: asked.append(1) or size_of(*of))
    cycle = closed_scene(humid, QUICK)
    assert np.diff(cycle.pitch.rates.held.phases, axis=0).any()  # there is a border
    assert 0 < len(asked) <= SETTLES


def test_a_chamber_keeps_the_phase_of_its_slice(humid):
    cycle = closed_scene(humid, QUICK)
    pitch, phases = cycle.pitch, cycle.pitch.rates.held.phases
    (k, chamber), *_ = np.argwhere(np.diff(phases, axis=0)).tolist()  # at the end of slice k it is passed
    T, rho = chamber * pitch.n + np.array([S_T, S_RHO])
    sides = []
    for by in (-1e-9, 1e-9):
        Y = cycle.nodes.copy()
        at = border_temperature(pitch, *Y[k, -1, [T, rho]].tolist(), pitch.numbers)
        Y[k, -1, T] = at * (1.0 + by)
        phase = pitch.machinery.trajectory.phases(Y[k, -1].reshape(-1, pitch.n))[chamber]
        sides.append((phase, pitch.rates.at(Y)[0][k, -1, T], rates(pitch.rates, Y)[0][k, -1, T]))
    (dry, *below), (fog, *above) = sides
    assert dry != fog
    behind = pitch.rates.at_start(k + 1, cycle.nodes[k, -1], phases[k + 1])[0][T]
    assert above == pytest.approx(below, rel=1e-5)
    assert abs(behind / above[0] - 1.0) > 0.1  # what it would be in the other phase


def test_at_the_border_vapour_is_saturated(humid):
    problem = problem_of(humid)
    gas, machinery = problem.parts.gas, lease_for(problem)
    machinery.begin(problem.composition)
    pitch, c = SimpleNamespace(machinery=machinery), machinery.composition
    numbers = RateNumbers(c.P, c.TAB, machinery.R)
    for rho in (1.2, 4.0, 8.0):
        dry = (1.0 - gas.share) * rho
        T = border_temperature(pitch, gas.dew_point(rho * gas.R * 310.0), rho, numbers)
        saturated = float(gas._kernels["saturated_density"](T, dry))
        assert saturated == pytest.approx(gas.share * rho, rel=1e-10)
