"""Two results files: which points are common, what differs beyond numerical error, and what of the scenes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from folders import POINT
from result_fakes import GRID, SCENE, fake_simulate

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures
from screwsim.printing.compare import _apart, _rounded, _shown_pair, comparison_document, print_comparison
from screwsim.report.overlay import _names
from screwsim.results import open_results, save
from screwsim.scene import load, loads
from screwsim.simulate import simulate
from screwsim.study.compare import compare, matched
from screwsim.study.sweep import run_sweep
from screwsim.study.uncertainty.point import with_uncertainty

ERROR = 1e-5  # estimated, of the shaft power of the fake


def other_power(factor: float):
    """Return a simulator whose shaft power is another by a factor."""

    def simulate(scene):
        result = fake_simulate(scene)
        if not result.performance:
            return result
        power = factor * result.performance.shaft_power
        return replace(result, performance=Figures(result.performance, shaft_power=power))

    return simulate


def swept(path, text: str = GRID, simulate=fake_simulate, scene: str = SCENE):
    run_sweep(loads(scene + text), path, jobs=1, simulate=simulate)
    return open_results(path)


def run(path, overrides=(), simulate=fake_simulate):
    scene = loads(SCENE, overrides=overrides)
    save(path, scene, simulate(scene))
    return open_results(path)


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    return swept(tmp_path_factory.mktemp("compare") / "grid.h5")


def figure(found, name):
    return next(each for each in found.figures if each.figure == name)


def test_a_file_equals_itself(grid):
    found = compare(grid, grid)
    assert found.equal and (found.common, found.only_a, found.only_b) == (30, 0, 0)
    assert found.scene == {} and found.status_changes == 0
    power = figure(found, "shaft_power")
    assert (power.points, power.beyond, power.change) == (24, 0, 0.0)  # 3 of 30 failed, 3 did not close


def test_points_that_failed_in_both_are_not_equal(tmp_path, capsys):
    failed = [run(tmp_path / f"{name}.h5", ["oil_supply.ratio=5"]) for name in "ab"]
    found = compare(*failed)
    assert (found.common, found.compared, found.equal, found.figures) == (1, 0, False, ())
    print_comparison(*failed, found)
    told = capsys.readouterr().out
    assert "none of them is ok in both files, so no figure is compared" in told and "equal" not in told
    assert comparison_document(*failed, found)["points"]["compared"] == 0


def test_what_is_compared_is_told_where_some_points_failed(grid, capsys):
    found = compare(grid, grid)
    assert found.compared == 24  # 3 of 30 failed, 3 did not close
    print_comparison(grid, grid, found)
    assert "24 are ok in both files; figures of the others are not compared" in capsys.readouterr().out


@pytest.mark.parametrize(("share", "beyond"), [(3.9, 0), (4.1, 24)])
def test_a_change_is_numerical_up_to_twice_both_errors(share, beyond, grid, tmp_path):
    found = compare(grid, swept(tmp_path / "b.h5", simulate=other_power(1.0 + share * ERROR)))
    power = figure(found, "shaft_power")
    assert (power.beyond, found.equal) == (beyond, beyond == 0)
    assert power.relative == pytest.approx(share * ERROR, rel=1e-6)
    assert power.error == pytest.approx(2.0 * ERROR * power.a, rel=1e-4)


def test_a_figure_without_an_error_is_known_to_the_accuracy_of_its_case(tmp_path):
    """The efficiency of the fake has no error; it changes by 1e-3 relative where 1e-2 and 1e-4 are wanted."""

    def other(scene):
        result = fake_simulate(scene)
        efficiency = 1.001 * result.performance.isothermal_efficiency
        return replace(result, performance=Figures(result.performance, isothermal_efficiency=efficiency))

    text = "sweep:\n  numerics.accuracy: [1e-2, 1e-4]\n"
    found = compare(swept(tmp_path / "a.h5", text), swept(tmp_path / "b.h5", text, other))
    efficiency = figure(found, "isothermal_efficiency")
    assert (efficiency.beyond, efficiency.points) == (1, 2)
    assert efficiency.at == {"numerics.accuracy": 1e-4}


def test_a_figure_that_is_an_axis_of_the_other_file_is_compared_with_its_values(tmp_path):
    """The temperature of the oil supply is a figure of a run, and in a sweep over it the axis of the same name."""

    def telling(scene):
        result = fake_simulate(scene)
        told = Figures(result.performance, oil_supply_temperature=scene.oil_supply.temperature)
        return replace(result, performance=told, error=Figures(dict.fromkeys(told, 1e-6)))

    axis = swept(tmp_path / "a.h5", "sweep:\n  oil_supply.temperature: [293 K, 300 K]\n", telling)
    found = compare(axis, run(tmp_path / "b.h5", simulate=telling))
    temperature = figure(found, "oil_supply_temperature")
    assert found.equal and (temperature.points, temperature.only_b, temperature.change) == (1, 0, 0.0)


def test_a_tolerance_counts_beside_the_errors(grid, tmp_path):
    other = swept(tmp_path / "b.h5", simulate=other_power(1.01))
    assert not compare(grid, other).equal
    assert compare(grid, other, tolerance=0.011).equal


def test_a_change_is_as_uncertain_as_inputs_that_are_not_off_alike(tmp_path, capsys):
    """A file against itself: they are all alike. Against the same machine without tolerances: none is."""
    tolerances = {"effects.tip_leakage.gap": "27.5 um ± 5 um", "oil_supply.ratio": "3 ± 10 %"}
    files = []
    for name, scene in (("with", load(POINT).with_(tolerances)), ("without", load(POINT))):
        save(tmp_path / f"{name}.h5", scene, with_uncertainty(scene, simulate(scene)))
        files.append(open_results(tmp_path / f"{name}.h5"))
    toleranced, exact = files
    alike, apart = (figure(compare(toleranced, other), "shaft_power") for other in files)
    assert alike.inputs == 0.0
    assert apart.inputs == pytest.approx(2.0 * float(toleranced.uncertainty["shaft_power"]), rel=1e-12)
    assert figure(compare(exact, exact), "shaft_power").inputs is None
    print_comparison(toleranced, exact, compare(toleranced, exact))
    assert "error inputs differ" in " ".join(capsys.readouterr().out.split())


GAPS = ("effects.tip_leakage.gap", "oil_supply.temperature")
TIP, BOTH = {GAPS[:1]: 30.0}, {GAPS: 50.0}


def toleranced(path, changes, left_out=(), gap="50 um ± 5 um"):
    """Return a file whose shaft power has these changes [W] by one standard uncertainty of groups of inputs."""
    told = [{"paths": list(paths), "share": 0.0, "change": 2.0 * change} for paths, change in changes.items()]
    groups = [*map(list, changes), *([name] for name in left_out)]
    about = {"coverage_factor": 2.0, "groups": groups, "left_out": dict.fromkeys(left_out, "no derivative")}
    uncertainty = about | {"figures": {"shaft_power": {"standard": 1.0, "contributors": told}}} if changes else {}
    overrides = [f"effects.tip_leakage.gap={gap}"]
    return run(path, overrides, lambda scene: replace(fake_simulate(scene), uncertainty=uncertainty))


@pytest.mark.parametrize(
    ("one", "other", "half"),
    [
        (BOTH, TIP, 2.0 * 20.0),  # alike: the tip's part cancels, that of the temperature remains
        (TIP, BOTH, 2.0 * 20.0),
        (BOTH, TIP | {GAPS[1:]: 15.0}, 2.0 * 5.0),
        (TIP | {("oil_supply.ratio",): 40.0}, TIP, 2.0 * 40.0),
        (TIP | {("oil_supply.ratio",): 40.0}, {GAPS[1:]: 40.0}, 2.0 * math.hypot(30.0, 40.0, 40.0)),
    ],
)
def test_inputs_that_err_together_in_one_file_alone_are_off_alike(tmp_path, one, other, half):
    a, b = toleranced(tmp_path / "a.h5", one), toleranced(tmp_path / "b.h5", other)
    assert figure(compare(a, b), "shaft_power").inputs == pytest.approx(half, rel=1e-12)


def test_a_change_by_an_unknown_part_of_the_inputs_has_no_interval(tmp_path):
    """A lost derivative, or figures without uncertainty in a scene with tolerances, are not certain: unknown."""
    known, lost = toleranced(tmp_path / "a.h5", TIP), toleranced(tmp_path / "b.h5", TIP, ["oil_supply.ratio"])
    none, exact = toleranced(tmp_path / "c.h5", {}), toleranced(tmp_path / "d.h5", {}, gap="50 um")
    for other in (lost, none):
        for pair in ((known, other), (other, known), (other, exact)):
            assert figure(compare(*pair), "shaft_power").inputs is None
    assert figure(compare(known, exact), "shaft_power").inputs == pytest.approx(2.0 * 30.0, rel=1e-12)


@pytest.mark.parametrize(
    ("size", "shown"), [(9.6, "10"), (9.4, "9"), (12.3, "12"), (0.96, "1"), (0.0123, "0.01"), (73.0, "73")]
)
def test_a_size_of_two_digits_has_no_exponent(size, shown):
    assert _rounded(size) == shown


def test_changes_of_a_hundred_percent_have_no_exponent(tmp_path, capsys):
    a, b = run(tmp_path / "a.h5"), run(tmp_path / "b.h5", simulate=other_power(1.998))
    print_comparison(a, b, compare(a, b))
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("shaft power"))
    assert "+100 %" in line


def test_points_are_matched_by_their_values(grid, tmp_path):
    axes = "sweep:\n  oil_supply.ratio: [9, 2, 2.5]\n  operation.speed: [3000 rpm, 4000 rpm]\n"
    found = compare(grid, swept(tmp_path / "b.h5", axes))
    assert (found.common, found.only_a, found.only_b) == (2, 28, 4)
    assert found.equal  # the figures are those of the inputs
    ratio = figure(found, "oil_ratio")
    assert ratio.at["oil_supply.ratio"] == ratio.a == ratio.b


def test_a_run_is_a_point_of_a_sweep(grid, tmp_path):
    found = compare(run(tmp_path / "run.h5", ["operation.speed=2000 rpm"]), grid)
    assert (found.common, found.only_a, found.only_b) == (1, 0, 29)
    assert found.equal and found.scene == {}


def test_two_runs_are_compared_whatever_their_scenes(tmp_path):
    changes = ["operation.speed=2000 rpm", "effects.blow_hole={area: 5 mm^2}", "oil.viscosity=null"]
    found = compare(run(tmp_path / "a.h5"), run(tmp_path / "b.h5", changes))
    assert found.common == 1 and not found.equal
    assert found.scene["operation.speed"] == ("3000 rpm", "2000 rpm")
    assert found.scene["oil.viscosity"] == ("20 mPa s", None)
    assert found.scene["effects.blow_hole.area"] == (None, "0.05 cm^2")
    assert figure(found, "shaft_power").relative == pytest.approx(-1.0 / 3.0, rel=1e-12)


def test_files_of_one_name_and_title_are_told_apart_by_their_paths_and_scenes(tmp_path):
    for side in "ab":
        (tmp_path / side).mkdir()
    a, b = run(tmp_path / "a" / "x.h5"), run(tmp_path / "b" / "x.h5", ["operation.speed=2000 rpm"])
    names = _names(a, b, _apart(compare(a, b).scene))
    assert names == (f"{a.path}, speed 3000 rpm", f"{b.path}, speed 2000 rpm")


def test_a_value_of_zero_has_the_unit_of_the_other_one(tmp_path, capsys):
    a, b = run(tmp_path / "a.h5", simulate=other_power(0.0)), run(tmp_path / "b.h5")
    print_comparison(a, b, compare(a, b))
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("shaft power"))
    assert line.split()[2:5] == ["0", f"{1e-3 * b.performance['shaft_power'].item():.5g}", "kW"]


def test_a_scenes_numbers_are_shown_without_their_rounding(tmp_path, capsys):
    assert _shown_pair("1.7000000000000002 cm^2", "-") == ("1.7 cm^2", "-")
    close = "1.7000000000000002 cm^2", "1.7 cm^2"
    assert _shown_pair(*close) == close


def test_another_status_is_a_difference(grid, tmp_path):
    def closing(scene):
        return fake_simulate(scene) if scene.oil_supply.ratio != 4.0 else replace(fake_simulate(scene), status="ok")

    found = compare(grid, swept(tmp_path / "b.h5", simulate=closing))
    assert not found.equal and found.status_changes == 3
    first = found.first_status_changes[0]
    assert (first.a, first.b, first.at["oil_supply.ratio"]) == ("not_closed", "ok", 4.0)
    assert figure(found, "shaft_power").beyond == 0


def test_a_figure_of_one_file_alone_is_a_difference(grid, tmp_path):
    def with_flow(scene):
        result = fake_simulate(scene)
        return replace(result, performance=Figures(result.performance, gas_mass_flow=0.3)) if result.balance else result

    found = compare(grid, swept(tmp_path / "b.h5", simulate=with_flow))
    assert not found.equal
    assert (figure(found, "gas_mass_flow").only_a, figure(found, "gas_mass_flow").only_b) == (0, 24)


def test_files_without_a_common_point_are_refused(grid, tmp_path):
    other = swept(tmp_path / "b.h5", "sweep: {oil_supply.ratio: [0.5, 1.5]}\n")
    with pytest.raises(UsageError, match=r"have no point in common: operation\.speed, oil_supply\.ratio differ"):
        compare(grid, other)


def test_an_axis_that_the_other_file_has_not_is_refused(grid, tmp_path):
    other = swept(
        tmp_path / "b.h5", "sweep: {effects.blow_hole.area: [5 mm^2]}\n", scene=SCENE + "  blow_hole: {area: 5 mm^2}\n"
    )
    with pytest.raises(UsageError, match=r"has no effects\.blow_hole\.area, over which the other file is swept"):
        compare(grid, other)


def test_points_of_a_sample_are_matched_by_all_columns_however_many():
    """Products of the columns' sizes wrap at 2^64: of 70 columns of two values the first would not count."""
    own = np.random.default_rng(0).integers(0, 2, (64, 70)).astype(float)
    own[1] = own[0]
    own[1, 0] = 1.0 - own[0, 0]
    other = own[::-1] * (1.0 + 1e-12)
    in_a, in_b = matched(own.T, other[:-1].T, (64, 63))
    assert in_a.tolist() == [*range(1, 64)] and in_b.tolist() == [*range(62, -1, -1)]


def test_a_point_that_a_sample_has_twice_is_matched_each_time():
    a, b = np.array([3.0, 1.0, 3.0, 2.0, 3.0]), np.array([1.0, 3.0, 5.0, 3.0, 1.0])
    in_a, in_b = matched([a], [b], (5, 5))
    assert list(zip(in_a.tolist(), in_b.tolist(), strict=True)) == [(0, 1), (1, 0), (1, 4), (2, 3), (4, 3)]
    for each in (a, b):
        rows = matched([each], [each], (5, 5))
        assert np.array_equal(rows[0], np.arange(5)) and np.array_equal(rows[1], np.arange(5))


def test_a_sample_of_few_values_equals_itself(tmp_path):
    over = "{operation.speed: [1000 rpm, 1500 rpm], machine.volume.phi_A: [60 deg, 65 deg]}"
    sample = swept(tmp_path / "a.h5", f"sweep: {{sample: {{kind: sobol, count: 8, seed: 20, over: {over}}}}}\n")
    found = compare(sample, sample)
    assert (found.common, found.only_a, found.only_b) == (8, 0, 0)


def test_choices_are_matched_by_their_words(tmp_path):
    axis = "sweep: {oil_supply.source: [separator, suction]}\n"
    found = compare(swept(tmp_path / "a.h5", axis), run(tmp_path / "b.h5", ["oil_supply.source=suction"]))
    assert (found.common, found.only_a) == (1, 1)


def test_a_negative_tolerance_is_refused(grid):
    with pytest.raises(UsageError, match="--tolerance -1: is not a relative tolerance"):
        compare(grid, grid, -1.0)
