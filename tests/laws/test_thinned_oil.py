"""Oil that holds dissolved refrigerant is thinner (M199): the mixing law, and what a machine has of it."""

import math

import pytest
from each_row import each_row
from scenes import SOLUBLE, make, refusal, run

from screwsim.build import build_parts
from screwsim.fluid.solubility_laws import COLUMNS, ESTER
from screwsim.fluid.solution_viscosity import solution_viscosity
from screwsim.model.compose import compose

SOLUBILITY = "effects.refrigerant_solubility"
FILMS = f"{SOLUBILITY}.films_at"
DRAG = {"tip_gap": "0.1 mm", "tip_land": "1.5 mm"}
BEARINGS = {
    "friction": "two_term",
    "count": 4,
    "mean_diameter": "75 mm",
    "f_0": 4,
    "f_1": 0.0,
    "load": "stated",
    "radial_load": "8 kN",
    "axial_load": "3 kN",
}
OILED = {**SOLUBLE, "oil": {"name": "POE_ACD100FY"}, "effects.oil_drag": DRAG, "effects.bearings": BEARINGS}
R134A, ESTER_MASS = 102.032, 590.0


def weighted_by_moles(ratio, refrigerant, oil):
    """Return Yokozeki's mixture as he writes it: mole fractions weighted with powers of the molar masses."""
    x = ratio / R134A / (ratio / R134A + 1.0 / ESTER_MASS)
    weights = x * R134A**0.58, (1.0 - x) * ESTER_MASS**0.58
    return math.exp((weights[0] * math.log(refrigerant) + weights[1] * math.log(oil)) / sum(weights))


@pytest.mark.parametrize("ratio", [0.01, 0.15, 3.0])
def test_the_law_is_yokozekis_in_mole_fractions(ratio):
    found = solution_viscosity(ratio, 1.2e-4, 3e-2, R134A, ESTER_MASS)
    assert found == pytest.approx(weighted_by_moles(ratio, 1.2e-4, 3e-2), rel=1e-12)


def test_thin_and_rich_solutions_are_oil_and_refrigerant():
    assert solution_viscosity(0.0, 1.2e-4, 3e-2, R134A, ESTER_MASS) == pytest.approx(3e-2, rel=1e-14)
    assert solution_viscosity(1e12, 1.2e-4, 3e-2, R134A, ESTER_MASS) == pytest.approx(1.2e-4, rel=1e-10)


def test_more_dissolved_gas_makes_thinner_oil():
    found = [solution_viscosity(each, 1.2e-4, 3e-2, R134A, ESTER_MASS) for each in (0.0, 0.05, 0.1, 0.2, 0.4)]
    assert found == sorted(found, reverse=True)


@pytest.fixture(scope="module")
def machines():
    """One machine with pure oil in its films, and with films under suction and under discharge gas."""
    return {at: run(OILED if at is None else {**OILED, FILMS: at}).performance for at in (None, "suction", "discharge")}


def test_films_under_discharge_gas_hold_what_is_supplied_where_they_are_colder_than_the_separator(machines):
    scene, found = make(OILED), machines["discharge"]
    T = 0.5 * (scene.oil_supply.temperature + found.oil_discharge_temperature)
    mu = scene.oil.at(T).viscosity
    separator = scene.effects["refrigerant_solubility"].parameters.separator_temperature
    assert separator > T
    thin = solution_viscosity(found.dissolved_gas_ratio, ESTER.liquid_viscosity(T), mu, R134A, ESTER_MASS)
    assert found.oil_drag_power == pytest.approx(machines[None].oil_drag_power * thin / mu, rel=1e-4)


def test_films_under_suction_gas_are_thicker_than_under_discharge_gas_and_thinner_than_pure_oil(machines):
    pure, suction, discharge = machines.values()
    assert discharge.oil_drag_power < 0.9 * suction.oil_drag_power < 0.8 * pure.oil_drag_power
    assert discharge.bearing_power < suction.bearing_power < pure.bearing_power


def test_idle_friction_of_bearings_follows_the_power_two_thirds_of_the_viscosity(machines):
    """Palmgren's idle moment: with f_1 = 0 it is all friction."""
    pure, _, discharge = machines.values()
    thinner = discharge.oil_drag_power / pure.oil_drag_power
    assert discharge.bearing_power / pure.bearing_power == pytest.approx(thinner ** (2.0 / 3.0), rel=1e-9)


def test_films_change_neither_cycle_nor_compiled_text(machines):
    assert machines["suction"].indicated_power == machines[None].indicated_power
    texts = [compose(build_parts(make(scene))).text for scene in (OILED, {**OILED, FILMS: "suction"})]
    assert texts[0] == texts[1]


def test_the_result_tells_the_viscosity_of_the_supplied_oil(machines):
    found, scene = machines["suction"], make(OILED)
    T = scene.oil_supply.temperature
    mu, liquid = scene.oil.at(T).viscosity, ESTER.liquid_viscosity(T)
    expected = solution_viscosity(found.dissolved_gas_ratio, liquid, mu, R134A, ESTER_MASS)
    assert found.supplied_oil_viscosity == pytest.approx(expected, rel=1e-6)
    assert "supplied_oil_viscosity" not in machines[None]


def test_thinner_oil_loses_less_in_the_pumps_line():
    line = {"effects.oil_pump": {"efficiency": 0.6, "line": {"diameter": "30 mm", "length": "6 m"}}}
    pure, thin = (run({**OILED, **line, **films}).performance for films in ({}, {FILMS: "suction"}))
    assert thin.oil_line_pressure_loss < 0.9 * pure.oil_line_pressure_loss


def test_a_larger_molar_mass_of_the_oil_makes_the_solution_thinner():
    """At one mass of refrigerant more molecules of it meet one of the oil."""
    assert solution_viscosity(0.15, 1.2e-4, 3e-2, R134A, 800.0) < solution_viscosity(0.15, 1.2e-4, 3e-2, R134A, 590.0)


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """A file of points that M195 has."""
    path = tmp_path_factory.mktemp("oil") / "oil.csv"
    rows = [
        f"{t},{1e-5 * ESTER.equilibrium_pressure(each / (100.0 - each), t + 273.15):.9g},{each}"
        for t in (20, 50, 90)
        for each in (2, 10, 30)
    ]
    path.write_text("\n".join([",".join(COLUMNS), *rows]) + "\n", encoding="utf-8")
    return str(path)


@each_row(
    "changes, words",
    [
        (
            {f"{SOLUBILITY}.oil_molar_mass": "590 g/mol"},
            "oil_molar_mass: is used with films_at only (write films_at, or remove it)",
        ),
        (
            {FILMS: "suction", "oil": {"density": "960 kg/m^3", "heat_capacity": "1.95 kJ/(kg K)"}},
            "oil.viscosity: is missing (effects.refrigerant_solubility.films_at needs it, or oil.name)",
        ),
        ({FILMS: "condenser"}, "films_at: 'condenser' is not an option"),
    ],
)
def test_what_films_lack_is_said(changes, words):
    assert words in refusal({**SOLUBLE, **changes})


def test_an_oil_of_measured_points_needs_its_molar_mass(points):
    scene = {**OILED, f"{SOLUBILITY}.points_file": points, FILMS: "suction"}
    assert "oil_molar_mass: is missing (films_at needs it with points_file, e.g. oil" in refusal(scene)
    assert make({**scene, f"{SOLUBILITY}.oil_molar_mass": "590 g/mol"}).effects
