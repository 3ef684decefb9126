"""The border of the phases in derivatives: where heat capacity jumps, a change passes it as cycles do."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from test_against_differences import all_differenced

import screwsim
from screwsim.cycle.guess import leased
from screwsim.cycle.problem import problem_of
from screwsim.derivatives.phases import border_temperature
from screwsim.derivatives.pitch import Numbers
from screwsim.study.local import sensitivities

CONFIGS = Path(__file__).parents[2] / "configs"
HUMID = (
    "effects.air_package=off",
    "effects.separator=off",
    "oil_supply.temperature=325 K",
)
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


def test_at_the_border_vapour_is_saturated(humid):
    problem = problem_of(humid)
    gas, machinery = problem.parts.gas, leased(problem)
    machinery.begin(problem.composition)
    pitch, c = SimpleNamespace(machinery=machinery), machinery.composition
    numbers = Numbers(c.P, c.TAB, machinery.R)
    for rho in (1.2, 4.0, 8.0):
        dry = (1.0 - gas.share) * rho
        T = border_temperature(pitch, gas.dew_point(rho * gas.R * 310.0), rho, numbers)
        saturated = float(gas._compiled("saturated_density", T, dry))
        assert saturated == pytest.approx(gas.share * rho, rel=1e-10)
