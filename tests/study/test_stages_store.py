"""Results of two stages in a file: what was printed, each stage's result, and scenes that give the same again."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from scenes import scene_dict

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import STAGES
from screwsim.outputs.display import cf_unit
from screwsim.report.quantities import shown_axis
from screwsim.study.stages import read_stages, run_stages

SWEEP = {"first.operation.speed": ["2500 rpm", "3000 rpm"], "second.operation.speed": ["1300 rpm", "10000 rpm"]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a plant, its results of one point and those of a sweep whose second speed is too high."""
    folder = tmp_path_factory.mktemp("stages")
    low = scene_dict({"output.derivatives": "all"})
    (folder / "low.yaml").write_text(json.dumps(low))
    (folder / "high.yaml").write_text(json.dumps(scene_dict({"operation.speed": "1300 rpm"})))
    between = {"kind": "cooler", "outlet_temperature": "300 K", "pressure_drop": "0.05 bar"}
    point = {"title": 'a "plant"', "stages": ["low.yaml", "high.yaml"], "intercooler": between}
    (folder / "point.stages.yaml").write_text(json.dumps(point))
    (folder / "sweep.stages.yaml").write_text(json.dumps(point | {"sweep": SWEEP}))
    assert exit_code(["run", str(folder / "point.stages.yaml"), "-o", str(folder / "point.h5"), "--json"]) == 0
    sweep = ["sweep", str(folder / "sweep.stages.yaml"), "-o", str(folder / "sweep.h5"), "--jobs", "1"]
    assert exit_code(sweep) == 4
    return folder


def test_figures_of_the_file_are_those_of_the_run(folder):
    found = run_stages(read_stages(folder / "point.stages.yaml"))
    results = screwsim.open_results(folder / "point.h5")
    for name, value in found.performance.items():
        about = results.figure(name)
        stated = STAGES[name]
        assert (about.units, about.long_name) == (cf_unit(stated.units), stated.long_name)
        assert about.scale == stated.scale
        assert float(results.performance[name]) == pytest.approx(value, rel=1e-12, abs=1e-12)
        if found.error[name] is not None:
            assert float(results.error[name]) == pytest.approx(found.error[name], rel=1e-4)
    assert set(results.figures) <= set(found.performance)
    for stage, result in zip(("first", "second"), found.stages, strict=True):
        own = results.stages[stage]
        for name, value in result.performance.items():
            assert float(own.performance[name]) == pytest.approx(value, rel=1e-12, abs=1e-12), name
        np.testing.assert_allclose(own.cycle["pressure"], result.cycle["pressure"], rtol=1e-12)
        assert float(own.balance["mass"]) <= float(own.balance["bound"])
        assert float(own.ledger["shaft_power"]) == pytest.approx(result.performance.shaft_power, rel=1e-12)


def test_a_figure_of_a_stage_is_found_from_the_whole_by_its_name(folder):
    results = screwsim.open_results(folder / "point.h5")
    first = results.stages["first"]
    about = results.figure("first_volumetric_efficiency")
    assert about.name == "first_volumetric_efficiency"
    assert about.long_name.endswith(", first stage")
    error = results.absolute_error("first_volumetric_efficiency")
    assert error == first.absolute_error("volumetric_efficiency") > 0.0
    # what both together state of a stage is the whole's own figure
    assert results.holder("first_shaft_power") == (results, "first_shaft_power")


def test_a_sweep_has_the_points_on_its_axes_in_the_whole_and_in_each_stage(folder):
    results = screwsim.open_results(folder / "sweep.h5")
    assert [*results.axes] == [*SWEEP]
    assert results.status.tolist() == [["ok", "failed"], ["ok", "failed"]]
    assert "no intermediate pressure" in str(results.messages[0, 1])
    for stage in results.stages.values():
        assert stage.status.tolist() == results.status.tolist()
        assert "both stages together have no result" in str(stage.messages[0, 1])
    first, second = results.stages.values()
    assert [*first.axes] == ["operation.speed", "second.operation.speed"]
    assert [*second.axes] == ["first.operation.speed", "operation.speed"]
    both = first.performance["shaft_power"] + second.performance["shaft_power"]
    np.testing.assert_allclose(both[:, 0], results.performance["shaft_power"][:, 0], rtol=1e-12)
    alone = run_stages(read_stages(folder / "point.stages.yaml", ["first.operation.speed=2500 rpm"]))
    assert float(results.performance["shaft_power"][0, 0]) == pytest.approx(alone.performance.shaft_power, rel=1e-9)


def test_inputs_have_their_stage_and_none_is_one_that_is_solved_for(folder):
    results = screwsim.open_results(folder / "sweep.h5")
    assert float(results.stated("second.oil_supply.ratio").flat[0]) > 0.0
    assert float(results.stated("intercooler.outlet_temperature").flat[0]) == pytest.approx(300.0)
    assert float(results.stated("intercooler.pressure_drop").flat[0]) == pytest.approx(5000.0)
    for path in ("first.operation.discharge.pressure", "second.operation.suction.temperature"):
        assert np.isnan(results.stated(path)).all()
    # the suction line of the first and the discharge line of the second stage are stated
    for path in ("first.operation.suction.pressure", "second.operation.discharge.pressure"):
        assert np.isfinite(results.stated(path)).all()
    assert "operation_speed" not in results.stages["first"].inputs
    assert (
        results.stages["first"].stated("operation.speed")[1, 0]
        > results.stages["first"].stated("operation.speed")[0, 0]
    )


def test_the_scenes_of_a_file_give_its_results_again(folder, tmp_path, capsys):
    for name in ("point", "sweep"):
        again = tmp_path / name
        again.mkdir()
        assert exit_code(["scene", str(folder / f"{name}.h5"), "-o", str(again / "plant.stages.yaml")]) == 0
        one, other = read_stages(folder / f"{name}.stages.yaml"), read_stages(again / "plant.stages.yaml")
        assert (one.title, one.intercooler, one.joints) == (other.title, other.intercooler, other.joints)
        assert {path: pytest.approx(values) for path, values in one.sweep.items()} == dict(other.sweep)
        for stage in ("first", "second"):
            assert getattr(one, stage).text == getattr(other, stage).text
    assert exit_code(["scene", str(folder / "point.h5"), "-o", str(tmp_path / "point" / "plant.stages.yaml")]) == 2
    assert "already exists and is not overwritten" in capsys.readouterr().err
    assert exit_code(["scene", str(folder / "point.h5"), "-o", str(tmp_path / "first.yaml")]) == 2
    assert "is the name of a stage's file" in capsys.readouterr().err


def test_a_stage_alone_at_the_pressure_found_gives_its_result(folder, tmp_path, capsys):
    results = screwsim.open_results(folder / "point.h5")
    for stage, own in results.stages.items():
        file = tmp_path / f"{stage}.yaml"
        assert exit_code(["scene", str(folder / "point.h5"), "--stage", stage, "-o", str(file)]) == 0
        alone = screwsim.simulate(screwsim.load(file))
        assert alone.performance.shaft_power == pytest.approx(float(own.performance["shaft_power"]), rel=1e-9)
    capsys.readouterr()
    assert exit_code(["scene", str(folder / "point.h5"), "--stage", "third"]) == 2
    assert "has no stage 'third' (its stages: first, second)" in capsys.readouterr().err
    assert exit_code(["scene", str(folder / "sweep.h5"), "--stage", "first"]) == 2
    assert "is of a sweep" in capsys.readouterr().err


def test_derivatives_that_a_stage_keeps_are_in_its_group(folder):
    first, second = screwsim.open_results(folder / "point.h5").stages.values()
    assert np.isfinite(first.derivatives["shaft_power", "operation.speed"])
    assert "shaft_power" not in second.derivatives


@pytest.mark.around
def test_files_are_compared_by_the_figures_of_both_and_of_each(folder, tmp_path, capsys):
    one, sweep = folder / "point.h5", folder / "sweep.h5"
    same = screwsim.compare(one, one)
    assert same.equal
    assert {"intermediate_pressure", "second_isentropic_efficiency"} <= {each.figure for each in same.figures}
    assert not same.scene
    slower = tmp_path / "slower.h5"
    changes = ["--set", "first.operation.speed=2500 rpm"]
    assert exit_code(["run", str(folder / "point.stages.yaml"), *changes, "-o", str(slower)]) == 0
    found = screwsim.compare(one, slower)
    assert not found.equal
    assert set(found.scene) == {"first.operation.speed"}
    changes = {each.figure: each for each in found.figures}
    assert changes["shaft_power"].beyond == 1
    mismatch = changes["flow_mismatch"]  # a residual: as far as it may be off in either file it is the same
    assert mismatch.change and not mismatch.beyond
    assert mismatch.error == pytest.approx(
        sum(each.accuracy.item() for each in map(screwsim.open_results, (one, slower)))
    )
    capsys.readouterr()
    assert exit_code(["compare", str(one), str(slower)]) == 0
    assert "of temperatures in K, of residuals as it is" in " ".join(capsys.readouterr().out.split())
    in_sweep = screwsim.compare(slower, sweep)
    assert (in_sweep.common, in_sweep.compared, in_sweep.equal) == (1, 1, True)


@pytest.mark.around
def test_curves_pages_and_columns_are_made_of_both_and_of_each(folder, tmp_path, capsys):
    drawn = screwsim.plot.write(folder / "point.h5", tmp_path / "point")
    assert {"first_pressure_volume.png", "second_pressure_volume.png"} <= {Path(each).name for each in drawn}
    capsys.readouterr()
    assert exit_code(["report", str(folder / "sweep.h5"), "-o", str(tmp_path / "page.html")]) == 0
    names = [Path(line).name for line in capsys.readouterr().out.split()]
    assert names == ["page.html", "page_first.html", "page_second.html"]
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert 'href="page_first.html">first stage</a>' in page
    assert "first stage: relative residual of the gas mass balance" in page
    frame = screwsim.open_results(folder / "sweep.h5").stages["second"].to_pandas()
    assert "volumetric_efficiency" in frame
    assert len(frame) == 4


def test_an_axis_of_a_stage_is_labelled_with_it_in_the_whole_and_in_the_other_stage(folder):
    results = screwsim.open_results(folder / "sweep.h5")
    labels = [shown_axis(axis).label for axis in results.axis_list]
    assert labels == ["male-rotor speed, first stage (rpm)", "male-rotor speed, second stage (rpm)"]
    own, other = (shown_axis(axis).label for axis in results.stages["first"].axis_list)
    assert "stage" not in own
    assert other == labels[1]


def test_measured_pressures_need_the_file_of_one_machine(folder, tmp_path, capsys):
    points = tmp_path / "points.csv"
    points.write_text("angle_deg,pressure_bar\n10,1\n20,1.1\n30,1.2\n")
    assert exit_code(["plot", str(folder / "point.h5"), "--measured", str(points), "-o", str(tmp_path / "x")]) == 2
    error = capsys.readouterr().err
    assert "holds two stages" in error and "--stage first gives its scene, to be run" in error


@pytest.mark.around
@pytest.mark.parametrize("sweep", [None, {"second.operation.speed": ["10000 rpm", "12000 rpm"]}])
def test_a_file_without_any_result_has_a_page_and_nothing_to_draw(folder, tmp_path, capsys, sweep):
    path, out = folder / "failing.stages.yaml", tmp_path / "fail.h5"
    content = json.loads((folder / "point.stages.yaml").read_text())
    path.write_text(json.dumps(content | ({} if sweep is None else {"sweep": sweep})))
    words = ["run", str(path), "--set", "second.operation.speed=10000 rpm"]
    words = words if sweep is None else ["sweep", str(path), "--jobs", "1"]
    assert exit_code([*words, "-o", str(out)]) == 4
    assert exit_code(["report", str(out), "-o", str(tmp_path / "page.html")]) == 0
    assert "no intermediate pressure" in str(screwsim.open_results(out).messages.flat[0])
    capsys.readouterr()
    assert exit_code(["plot", str(out), "-o", str(tmp_path / "figures")]) == 2
    why = "has nothing to draw: all cases failed (the first: no intermediate pressure"
    assert why in capsys.readouterr().err


def test_the_screen_says_how_to_get_scenes_that_can_be_simulated(folder, capsys):
    assert exit_code(["scene", str(folder / "point.h5")]) == 0
    told = capsys.readouterr()
    assert "# first.yaml" in told.out and "# second.yaml" in told.out
    assert told.err == "scene: these are several files (-o NAME.stages.yaml writes all, to be simulated)\n"


def test_points_of_another_sweep_are_not_replaced(folder, tmp_path, capsys):
    content = json.loads((folder / "sweep.stages.yaml").read_text()) | {
        "sweep": {"first.operation.speed": ["2500 rpm"]}
    }
    other = folder / "other.stages.yaml"
    other.write_text(json.dumps(content))
    before = (folder / "sweep.h5").read_bytes()
    assert exit_code(["sweep", str(other), "-o", str(folder / "sweep.h5")]) == 2
    assert "holds results of another scene or sweep (choose another -o, or remove it)" in capsys.readouterr().err
    assert (folder / "sweep.h5").read_bytes() == before


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda file: file["first"].__delitem__("performance"), "/first/performance is missing"),
        (lambda file: file["second"].attrs.__delitem__("scene_yaml"), "attribute scene_yaml is missing"),
    ],
)
def test_a_file_that_lacks_a_part_of_a_stage_is_one_line(folder, tmp_path, damage, words):
    path = tmp_path / "damaged.h5"
    path.write_bytes((folder / "point.h5").read_bytes())
    with h5py.File(path, "a") as file:
        damage(file)
    with pytest.raises(UsageError, match=words):
        screwsim.open_results(path)
