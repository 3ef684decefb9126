"""The fluid as an axis: names and blends of one's own, each read, written and checked as the gas is."""

from pathlib import Path

import pytest
from each_row import each_row

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.scene import case, load, loads
from screwsim.scene.grid import first_by_fluid
from screwsim.study.asked.inputs import check_continuous

CONFIG = Path(__file__).parents[2] / "configs" / "r454b" / "point.yaml"
OWN = "R32/R1234yf (0.6/0.4)"
NO_FLUID = "is not a fluid or predefined blend of CoolProp"
NAMED = "such as R134a, R1234yf, R32, R744, Ammonia or R454B)"
LISTED = "write NAME, or for a blend {fluid: [NAME, NAME], mass_fractions: [0.7, 0.3]}"


def swept(sweep, *overrides):
    return loads(f"base: {CONFIG}\nsweep: {sweep}\n", "x.yaml", overrides=overrides)


def fluids_of(scene):
    return list(scene.sweep["gas.fluid"])


def test_an_axis_takes_names_and_blends_of_ones_own():
    own = "{fluid: [R32, R1234yf], mass_fractions: [0.6, 0.4]}, R32/R1234yf (0.5/0.5)"
    scene = swept(f"{{gas.fluid: [R134a, R454B, {own}]}}")
    assert fluids_of(scene) == ["R134a", "R454B", OWN, "R32/R1234yf (0.5/0.5)"]
    assert loads(scene.text).sweep == scene.sweep
    assert [case(scene, index).gas.name for index in range(4)] == fluids_of(scene)


def test_a_case_forgets_the_fractions_of_the_scenes_own_blend():
    scene = swept("{gas.fluid: [R134a]}", "gas.fluid=[R32, R1234yf]", "gas.mass_fractions=[0.7, 0.3]")
    assert case(scene, 0).gas.mass_fractions is None and case(scene, 0).gas.name == "R134a"


def test_each_fluid_has_pressures_of_its_own():
    from screwsim.scene.lines import lines

    scene = swept("{gas.fluid: [R134a, Ammonia]}")
    p = [lines(case(scene, index)).p_d / 1e5 for index in range(2)]
    assert p == pytest.approx([11.60, 17.82], abs=0.01)  # tables of saturation at 45 degC


@pytest.mark.parametrize(
    "sweep",
    [
        "{zip: [{gas.fluid: [R134a, R1234yf], operation.speed: [3000 rpm, 3600 rpm]}]}",
        f"{{sample: {{kind: sobol, count: 4, over: {{gas.fluid: [R134a, '{OWN}']}}}}}}",
    ],
)
def test_fluids_vary_with_other_paths(sweep):
    scene = swept(sweep)
    assert loads(scene.text).sweep == scene.sweep
    assert {fluid for fluid, _ in first_by_fluid(scene)} == set(fluids_of(scene))


def test_fluids_come_from_a_column(tmp_path):
    (tmp_path / "fluids.csv").write_text("fluid\nR134a\nR1234yf\n")
    assert fluids_of(swept(f"{{gas.fluid: {{file: {tmp_path}/fluids.csv, column: fluid}}}}")) == ["R134a", "R1234yf"]
    (tmp_path / "fluids.csv").write_text("fluid\nR134a\nR134z\n")
    with pytest.raises(SceneError, match=r"line 3: 'R134z' is not a fluid"):
        swept(f"{{gas.fluid: {{file: {tmp_path}/fluids.csv, column: fluid}}}}")


@each_row(
    ("values", "told"),
    [
        ("[R134a, R134z]", f"x.yaml:2:28: sweep.gas.fluid: 'R134z' {NO_FLUID} (name one of them, {NAMED}"),
        ("[r134A]", f"x.yaml:2:21: sweep.gas.fluid: 'r134A' {NO_FLUID}; did you mean 'R134a'?"),
        ("[[R32, R125]]", f"x.yaml:2:21: sweep.gas.fluid: a list is not a fluid ({LISTED})"),
        ("[{fluids: R32}]", f"x.yaml:2:21: sweep.gas.fluid: a mapping is not a fluid ({LISTED})"),
        (
            "[{fluid: [R32, R125], mass_fractions: [0.6, 0.6]}]",
            "x.yaml:2:21: sweep.gas.fluid: mass_fractions: add up to 1.2, not to 1 (if they are ratios, write [0.5, "
            "0.5])",
        ),
        (
            "['R32/R125 (0.6/0.6)']",
            "x.yaml:2:21: sweep.gas.fluid: 'R32/R125 (0.6/0.6)': add up to 1.2, not to 1 (if they are ratios, write "
            "[0.5, 0.5])",
        ),
        ("{from: 1, to: 2, count: 2}", "x.yaml:2:20: sweep.gas.fluid: is a fluid: write a list of names"),
        ("[R134a, R134a]", "x.yaml:2:20: sweep.gas.fluid: has R134a twice (remove one)"),
        ("R134a", "x.yaml:2:20: sweep.gas.fluid: 'R134a' is neither a list nor {from, to, count} (write e.g. [R134a, "
                  "R1234yf])"),
    ],
)  # fmt: skip
def test_a_fluid_that_there_is_not_is_refused_at_its_place(values, told):
    with pytest.raises(SceneError) as caught:
        swept(f"{{gas.fluid: {values}}}")
    assert str(caught.value) == told


def test_a_fluid_that_lacks_data_is_left_to_its_cases():
    scene = swept("{gas.fluid: [R402A, R508B, R134a]}")  # no data of a pair; no saturation at 45 degC
    assert [fluid for fluid, _ in first_by_fluid(scene)] == ["R134a"]


def test_a_fluid_has_no_range():
    with pytest.raises(UsageError, match=r"gas\.fluid: is a fluid, not a continuous quantity"):
        check_continuous(load(CONFIG), "gas.fluid")
