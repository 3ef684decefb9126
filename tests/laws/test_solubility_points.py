"""Refrigerant solubility by measured points (M198): a machine with points of M195 is that with M195 itself."""

import pytest
from each_row import each_row
from scenes import SOLUBLE, SOLUBLE_RATE, make, refusal, run

from screwsim.fluid.solubility_laws import COLUMNS, ESTER

SOLUBILITY = "effects.refrigerant_solubility"
CELSIUS, PERCENT = (-10, 20, 50, 70, 90), (1, 3, 7, 12, 20, 30)


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """A file of points that M195 has."""
    path = tmp_path_factory.mktemp("oil") / "oil.csv"
    rows = [
        f"{t},{1e-5 * ESTER.equilibrium_pressure(each / (100.0 - each), t + 273.15):.9g},{each}"
        for t in CELSIUS
        for each in PERCENT
    ]
    path.write_text("\n".join([",".join(COLUMNS), *rows]) + "\n", encoding="utf-8")
    return str(path)


@each_row("scene", [SOLUBLE, SOLUBLE_RATE])
def test_a_machine_with_points_of_a_law_is_the_machine_with_that_law(scene, points):
    result, known = run({**scene, f"{SOLUBILITY}.points_file": points}), run(scene).performance
    assert result.status == "ok" and result.balance.entropy < 1e-4
    found = result.performance
    assert 0.0 < found.solubility_misfit < 0.06
    assert "solubility_misfit" not in known
    assert found.dissolved_gas_ratio == pytest.approx(known.dissolved_gas_ratio, rel=2.0 * found.solubility_misfit)
    assert found.isentropic_efficiency == pytest.approx(known.isentropic_efficiency, abs=5e-3)
    assert found.volumetric_efficiency == pytest.approx(known.volumetric_efficiency, abs=5e-3)


def test_any_oil_may_have_points(points):
    oil = {"name": "mineral_46", "transport": "carried"}
    assert make({**SOLUBLE, "oil": oil, f"{SOLUBILITY}.points_file": points}).oil.name == "mineral_46"


def test_a_separator_at_the_end_of_the_points_may_be_passed_by_what_a_search_leaves_open(points):
    at = {**SOLUBLE, f"{SOLUBILITY}.points_file": points}
    assert make({**at, f"{SOLUBILITY}.separator_temperature": "90.05 degC"}).effects
    assert "90.2 degC lies outside -10 degC to 90 degC, where the solubility" in refusal(
        {**at, f"{SOLUBILITY}.separator_temperature": "90.2 degC"}
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"gas.fluid": "R407C"},
            "points_file: is for a pure refrigerant; of R407C an oil dissolves another",
        ),
        ({f"{SOLUBILITY}.separator_temperature": "94 degC"}, "is known (choose one inside, add points there, or"),
        (
            {f"{SOLUBILITY}.separator_temperature": "50 degC"},
            "at 50 degC and 12 bar the oil holds more than the 30 % up to which points_file tells (state a warmer",
        ),
        ({f"{SOLUBILITY}.points_file": "none.csv"}, "points_file: cannot be read"),
    ],
)
def test_what_points_do_not_tell_is_said(changes, words, points):
    assert words in refusal({**SOLUBLE, f"{SOLUBILITY}.points_file": points, **changes})
