"""Results files: what is written is read back, by us and by the programs that others use."""

import hashlib
import math
import resource
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from result_fakes import CYCLE, GRID, SCENE, fake_simulate, scene

from screwsim.inputs.faults import UsageError
from screwsim.outputs import BALANCE, KNOCK_OUT, KNOCK_OUT_STATUSES, NUMERICS, PERFORMANCE, Figures, Result
from screwsim.results import open_results, save
from screwsim.results.schema import numeric_inputs
from screwsim.scene import case, case_count, load

GROUPS = ("inputs", "performance", "balance", "error", "numerics", "cycle", "ledger")
R134A = Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml"
ENGINES = ("h5netcdf", "netcdf4")


def results_of(swept):
    return [fake_simulate(case(swept, index)) for index in range(case_count(swept))]


@pytest.fixture(scope="module")
def single(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("single") / "run.h5"
    save(path, scene(), fake_simulate(scene()))
    return path


@pytest.fixture(scope="module")
def swept(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("swept") / "sweep.h5"
    grid = scene(SCENE + GRID + CYCLE)
    save(path, grid, results_of(grid), "sweep")
    return path


def datasets(file):
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    return found


@pytest.mark.parametrize(
    "sweep",
    ["numerics.accuracy: [1e-3, 1e-4]", "zip:\n  - {numerics.accuracy: [1e-3, 1e-4], operation.speed: [1 rpm, 2 rpm]}"],
)
def test_a_number_of_the_scene_is_told_for_every_case_varied_or_not(sweep, tmp_path):
    grid = scene(f"{SCENE}sweep:\n  {sweep}\n")
    save(tmp_path / "x.h5", grid, results_of(grid), "sweep")
    found = open_results(tmp_path / "x.h5")
    assert found.stated("numerics.accuracy").tolist() == [1e-3, 1e-4]
    assert found.stated("machine.rotor_length").tolist() == [0.14, 0.14]
    assert np.isnan(found.stated("machine.crank_radius")).all()


def test_one_run_reads_back_as_it_was(single):
    result, results = fake_simulate(scene()), open_results(single)
    assert results.axes == {}
    assert results.status == "ok"
    assert results.performance["shaft_power"] == result.performance.shaft_power
    assert results.numerics["integrator"] == "rodas4"
    assert results.performance["warnings"] == "first warning\nη of 2"
    assert results.performance["notes"] == "isothermal_efficiency: no meaning here"
    np.testing.assert_array_equal(results.cycle["angle"], result.cycle["angle"])
    np.testing.assert_array_equal(results.cycle["pressure"], result.cycle["pressure"])
    assert results.attributes["effects"] == "suction_port, tip_leakage"


def test_the_ledger_reads_back_on_the_axes_of_the_sweep(single, swept):
    one, many = open_results(single).ledger, open_results(swept).ledger
    assert one["exergy_destroyed_tip_leakage"] == 3.0
    assert one.about["exergy_destroyed_tip_leakage"] == ("W", "exergy destroyed, tip leakage")
    assert math.isnan(one["oil_exergy_rise"])
    assert many["gas_moved_tip_leakage"].shape == (3, 10)
    assert math.isnan(many["exergy_destroyed_tip_leakage"][0, 5])  # the case that fails
    assert many["exergy_destroyed_tip_leakage"][1, 7] == 7.0


def knocked_out() -> Result:
    """Return a result with the knock-out of two effects, of which the scene needs one."""
    nothing = dict.fromkeys(KNOCK_OUT)
    found = {"shaft_power": 9.0, "change_of_shaft_power": -1.0}
    return replace(
        fake_simulate(scene()),
        knock_out=(
            Figures(effect="suction_port", status="needed", message="write it", **nothing),
            Figures(effect="tip_leakage", status="ok", message="", **(nothing | found)),
        ),
    )


def test_a_knock_out_reads_back_by_effect(tmp_path):
    save(tmp_path / "x.h5", scene(), knocked_out())
    found = open_results(tmp_path / "x.h5").knock_out
    assert found["effect"].tolist() == ["suction_port", "tip_leakage"]
    assert [KNOCK_OUT_STATUSES[number] for number in found["status"]] == ["needed", "ok"]
    assert found["message"].tolist() == ["write it", ""]
    np.testing.assert_array_equal(found["change_of_shaft_power"], [np.nan, -1.0])
    assert found.about["change_of_shaft_power"].units == "W"
    assert set(found) == {"effect", "status", "message", *KNOCK_OUT}


@pytest.mark.parametrize("engine", ENGINES)
def test_a_knock_out_opens_in_xarray(engine, tmp_path):
    save(tmp_path / "x.h5", scene(), knocked_out())
    with xr.open_dataset(tmp_path / "x.h5", group="knock_out", engine=engine) as data:
        assert data.effect.attrs["labels"].split("\n") == ["suction_port", "tip_leakage"]
        assert data.shaft_power.dims == ("effect",) and data.shaft_power.attrs["units"] == "W"
    own = open_results(tmp_path / "x.h5").to_xarray("knock_out")
    assert float(own.shaft_power.sel(effect="tip_leakage")) == 9.0


def test_a_figure_that_is_asked_of_the_results_themselves_says_where_it_is(single):
    found = open_results(single)
    with pytest.raises(AttributeError, match=r"'shaft_power': performance\['shaft_power'\] has it; to_xarray\(\)"):
        found.shaft_power  # noqa: B018 - the access is what is tried
    with pytest.raises(AttributeError, match=r"^results have no attribute 'beauty'$"):
        found.beauty  # noqa: B018


@pytest.mark.parametrize("kind", ["performance", "error", "ledger"])
def test_a_figure_that_is_missing_says_so_by_index_as_by_attribute(kind):
    of = getattr(fake_simulate(scene()), kind)
    with pytest.raises(AttributeError) as by_attribute:
        of.beauty  # noqa: B018
    with pytest.raises(KeyError) as by_index:
        of["beauty"]
    assert by_index.value.args == by_attribute.value.args
    assert "no figure 'beauty'" in by_index.value.args[0]


def test_a_run_without_a_knock_out_stores_none(single):
    assert len(open_results(single).knock_out) == 0


def test_a_sweep_without_cycles_stores_no_ledger(tmp_path):
    grid = scene(SCENE + GRID)
    save(tmp_path / "x.h5", grid, results_of(grid))
    assert len(open_results(tmp_path / "x.h5").ledger) == 0


def test_a_figure_without_a_value_is_nan(single):
    results = open_results(single)
    assert math.isnan(results.performance["gas_mass_flow"])  # of every scene, and the fake gives none
    assert math.isnan(results.error["isothermal_efficiency"])


def test_the_figures_of_every_scene_are_there_and_those_that_were_called_for(single):
    results = open_results(single)
    always = {name for name, figure in PERFORMANCE.items() if not figure.needs}
    assert set(results.performance) == {*always, "oil_ratio", "status", "message", "warnings", "notes"}
    assert set(BALANCE) == set(results.balance)
    assert set(results.error) == {*always, "oil_ratio"}
    assert set(NUMERICS) <= set(results.numerics)


def test_the_scene_is_stored_whole_with_its_hash(single):
    results = open_results(single)
    text = scene().text
    assert results.scene_yaml == text
    assert results.attributes["scene_sha256"] == hashlib.sha256(text.encode()).hexdigest()


def test_root_attributes_name_conventions_and_versions(single):
    attributes = open_results(single).attributes
    assert attributes["Conventions"] == "CF-1.11"
    assert attributes["screwsim_schema"] == 1
    for name in ("title", "source", "history"):
        assert attributes[name]
    for name in ("python", "numpy", "scipy", "numba", "llvmlite"):
        assert attributes[f"{name}_version"]
    assert attributes["coolprop_version"]


def test_inputs_are_stored_in_si_with_their_paths(single):
    with h5py.File(single) as file:
        gap = file["inputs/effects_tip_leakage_gap"]
        assert gap[()] == pytest.approx(50e-6, rel=1e-12)
        texts = {name: value.decode() for name, value in gap.attrs.items() if isinstance(value, bytes)}
    assert (texts["path"], texts["units"], texts["long_name"]) == ("effects.tip_leakage.gap", "m", "clearance")


def test_an_input_that_is_found_with_the_cycle_is_stored_as_none():
    """The scene holds 0 K there, where the search begins; what was found is a figure."""
    port = "{temperature: auto, area: 100 mm^2, opens: 455 deg, closes: 545 deg}"
    auto = load(R134A, [f"effects.economizer={port}"])
    values = {path: value for path, _, value in numeric_inputs(auto)}
    assert math.isnan(values["effects.economizer.temperature"])
    assert values["effects.economizer.area"] == pytest.approx(1e-4, rel=1e-12)


@pytest.mark.parametrize("name", ["single", "swept"])
def test_every_variable_has_units_and_long_name(name, request):
    with h5py.File(request.getfixturevalue(name)) as file:
        for path, data in datasets(file).items():
            if not path.rpartition("/")[2].startswith("string"):  # a dimension without values
                assert data.attrs["units"], path
                assert data.attrs["long_name"], path


@pytest.mark.parametrize("name", ["single", "swept"])
def test_no_string_has_a_variable_length(name, request):
    def kinds(item):
        yield from (item.attrs.get_id(key).dtype for key in item.attrs if key not in ("DIMENSION_LIST",))
        if isinstance(item, h5py.Dataset):
            yield item.dtype

    with h5py.File(request.getfixturevalue(name)) as file:
        for item in [file, *(file[group] for group in file), *datasets(file).values()]:
            for dtype in kinds(item):
                text = h5py.check_string_dtype(dtype)
                assert text is None or text.length is not None, item.name


def test_each_axis_is_a_coordinate_of_every_group(swept):
    for group in GROUPS:
        data = xr.open_dataset(swept, group=group, engine="h5netcdf")
        assert list(data.sizes)[:2] == ["operation_speed", "oil_supply_ratio"], group
        np.testing.assert_allclose(data.oil_supply_ratio, np.arange(10.0), atol=1e-12)
        assert data.operation_speed.attrs["path"] == "operation.speed"
        assert data.operation_speed.attrs["units"] == "rad s-1"


def test_every_unit_in_a_file_is_in_one_style(swept):
    """CF, section 3.1: the units of axes and inputs are written as those of figures ("rad s-1", "m3", not "rad/s")."""
    with h5py.File(swept) as file:
        units = {name: item.attrs["units"].decode() for name, item in datasets(file).items() if "units" in item.attrs}
    assert {"rad s-1", "m3", "J kg-1 K-1", "Pa"} <= set(units.values())
    assert {name: text for name, text in units.items() if set("/^()") & set(text)} == {}


def test_axes_of_older_files_that_name_their_units_as_scenes_do_read_the_same(swept, tmp_path):
    older = tmp_path / "older.h5"
    shutil.copy(swept, older)
    spelled = {"rad s-1": "rad/s", "m3": "m^3", "J kg-1 K-1": "J/(kg K)", "kg m-3": "kg/m^3"}
    with h5py.File(older, "r+") as file:
        for item in datasets(file).values():
            units = item.attrs.get("units", b"").decode()
            if units in spelled:
                item.attrs["units"] = spelled[units]
    new, old = open_results(swept), open_results(older)
    for new_axis, old_axis in zip(new.axis_list, old.axis_list, strict=True):
        assert (new_axis.units, new_axis.long_name) == (old_axis.units, old_axis.long_name)
    assert old.axis_list[0].units == "rad/s"  # as scenes and tables of people have it
    assert old.inputs.about == new.inputs.about
    assert old.to_xarray().operation_speed.attrs["units"] == "rad s-1"
    xr.testing.assert_identical(old.to_xarray(), new.to_xarray())


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", ["single", "swept"])
def test_xarray_opens_every_group(engine, name, request):
    path = request.getfixturevalue(name)
    results = open_results(path)
    for group in GROUPS:
        data = xr.open_dataset(path, group=group, engine=engine).load()
        for variable in getattr(results, group):
            if variable == "status" or f"{variable}_text" in data:
                continue
            np.testing.assert_array_equal(data[variable].values, getattr(results, group)[variable], err_msg=variable)


@pytest.mark.parametrize("engine", ENGINES)
def test_xarray_opens_the_whole_tree(engine, swept):
    tree = xr.open_datatree(swept, engine=engine)
    assert set(tree.groups) == {"/", *(f"/{group}" for group in GROUPS)}
    assert tree["cycle"]["pressure"].dims == ("operation_speed", "oil_supply_ratio", "angle")
    performance = tree["performance"].to_dataset()
    texts = str(performance.message_text.values).split("\n\n")
    assert texts[performance.message.values[0, 5]] == "pressure left the range at 123° (choose a smaller gap)"


def test_the_status_is_a_flag_variable(swept):
    data = xr.open_dataset(swept, group="performance", mask_and_scale=False)
    assert data.status.dtype == np.int8
    assert data.status.attrs["flag_values"].tolist() == [0, 1, 2]
    assert data.status.attrs["flag_meanings"] == "ok not_closed failed"
    assert data.status.attrs["_FillValue"] == -1
    assert data.status.values[0].tolist() == [0, 0, 0, 0, 1, 2, 0, 0, 0, 0]


def test_the_netcdf_library_sees_ordered_dimensions_and_texts(swept):
    import netCDF4

    with netCDF4.Dataset(swept) as file:
        group = file["performance"]
        assert list(group.dimensions)[:2] == ["operation_speed", "oil_supply_ratio"]
        assert group["shaft_power"].dimensions == ("operation_speed", "oil_supply_ratio")
        texts = "".join(group["message_text"][:].tolist())
        assert texts.split("\n\n")[group["message"][0, 4]] == "energy residual 1e-3 above the bound"


@pytest.mark.parametrize("command", [["ncdump"], ["h5dump"]])
def test_the_dump_programs_print_the_file(command, swept):
    if shutil.which(command[0]) is None:  # then the netCDF library and h5py above stand for it
        return
    done = subprocess.run([*command, str(swept)], capture_output=True, text=True, check=True)
    assert "oil_supply_ratio" in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize("name", ["single", "swept"])
def test_texts_are_single_characters_in_one_dimension_the_only_form_that_all_read(name, request):
    with h5py.File(request.getfixturevalue(name)) as file:
        texts = [data for data in datasets(file).values() if data.dtype.kind not in "if"]
        assert texts
        assert {(data.ndim, data.dtype) for data in texts} == {(1, np.dtype("S1"))}


def test_octave_reads_the_file(swept):
    if shutil.which("octave-cli") is None:  # then the rules on strings above stand for it
        return
    code = f"a = load('{swept}'); disp(size(a.cycle.pressure)); disp(a.performance.message_text(3:8)')"
    done = subprocess.run(["octave-cli", "--no-gui", "--eval", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.split() == ["73", "10", "3", "energy"]


def test_an_axis_of_words_reads_back_as_words(tmp_path):
    grid = scene(SCENE + "sweep: {oil_supply.source: [separator, suction], oil_supply.ratio: [1, 2]}\n")
    save(tmp_path / "x.h5", grid, results_of(grid))
    results = open_results(tmp_path / "x.h5")
    assert results.axes["oil_supply.source"].tolist() == ["separator", "suction"]
    assert results.to_xarray().sel(oil_supply_source="suction", oil_supply_ratio=2.0).oil_ratio == 2.0
    stored = xr.open_dataset(tmp_path / "x.h5", group="performance")
    assert stored.oil_supply_source.attrs["flag_meanings"] == "separator suction"


def test_the_same_results_give_the_same_file_apart_from_its_history(tmp_path):
    contents = []
    for name in ("a.h5", "b.h5"):
        save(tmp_path / name, scene(), fake_simulate(scene()))
        with h5py.File(tmp_path / name, "r+") as file:
            del file.attrs["history"]
        with h5py.File(tmp_path / name) as file:
            contents.append({path: data[()].tobytes() for path, data in datasets(file).items()} | dict(file.attrs))
    assert contents[0] == contents[1]


def test_a_scene_longer_than_64_kb_is_stored(tmp_path):
    ratios = ", ".join(f"{0.003 * index + 1e-12:.12f}" for index in range(4500))
    grid = scene(SCENE + f"sweep: {{oil_supply.ratio: [{ratios}]}}\n")
    assert len(grid.text) > 65536
    save(tmp_path / "x.h5", grid, [Result("failed")] * 4500)
    assert open_results(tmp_path / "x.h5").scene_yaml == grid.text
    assert xr.open_dataset(tmp_path / "x.h5", engine="netcdf4").attrs["scene_yaml"] == grid.text


def test_a_long_message_is_cut_between_two_characters(tmp_path):
    save(tmp_path / "x.h5", scene(), Result("failed", message="°" * 3000))
    assert set(str(open_results(tmp_path / "x.h5").messages)) == {"°", "…"}


def test_a_failed_run_without_a_cycle_is_stored(tmp_path):
    save(tmp_path / "x.h5", scene(), Result("failed", message="no start"))
    results = open_results(tmp_path / "x.h5")
    assert results.status == "failed"
    assert len(results.cycle) == 0


def test_a_file_without_xarray_asked_for_opens_without_importing_it(single):
    code = "import sys, screwsim.results as r; r.open_results(sys.argv[1]); sys.exit('xarray' in sys.modules)"
    paths = ":".join(path for path in sys.path if path)
    subprocess.run([sys.executable, "-c", code, str(single)], check=True, env={"PYTHONPATH": paths})


def test_importing_results_and_sweeps_loads_no_heavy_library():
    heavy = ("h5py", "xarray", "rich", "llvmlite", "CoolProp", "pandas", "multiprocessing.pool")
    code = f"import sys, screwsim.results, screwsim.study.sweep.run; sys.exit(bool(set({heavy}) & set(sys.modules)))"
    paths = ":".join(path for path in sys.path if path)
    done = subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": paths}, stderr=-1)
    assert done.returncode == 0, done.stderr.decode()[-3000:]


def test_a_figure_that_no_table_names_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"performance\.beauty has no entry"):
        save(tmp_path / "x.h5", scene(), Result("ok", performance=Figures(beauty=1.0)))
    assert list(tmp_path.iterdir()) == []


def test_traces_over_different_angles_are_refused(tmp_path):
    grid = scene(SCENE + "sweep: {oil_supply.ratio: [1, 2]}\n" + CYCLE)
    one, two = results_of(grid)
    other = replace(two, cycle={**two.cycle, "angle": two.cycle["angle"] * 0.5})
    with pytest.raises(UsageError, match=r"^output.keep: chambers live 720 and 360 deg .* share no angles \(write"):
        save(tmp_path / "x.h5", grid, [one, other])


# What can be wrong with a file: one line, what and the remedy


def refusal(path: Path) -> str:
    with pytest.raises(UsageError) as caught:
        open_results(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    return text


def test_a_missing_file_is_told(tmp_path):
    assert "there is no such file" in refusal(tmp_path / "x.h5")


def test_a_folder_is_told(tmp_path):
    assert "is a folder" in refusal(tmp_path)


@pytest.mark.parametrize("content", ["", "speed,power\n1,2\n"])
def test_a_file_that_is_not_hdf5_is_told(content, tmp_path):
    (tmp_path / "x.h5").write_text(content)
    assert "is not an HDF5 file" in refusal(tmp_path / "x.h5")


def test_a_file_of_another_program_is_told(tmp_path):
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file["a"] = 1.0
    assert "of another program" in refusal(tmp_path / "x.h5")


@pytest.mark.parametrize("kept", [0.1, 0.5, 0.9])
def test_a_truncated_file_is_told(kept, single, tmp_path):
    raw = single.read_bytes()
    (tmp_path / "x.h5").write_bytes(raw[: int(kept * len(raw))])
    assert "is damaged or cut short" in refusal(tmp_path / "x.h5")


def test_a_newer_schema_is_told(single, tmp_path):
    shutil.copy(single, tmp_path / "x.h5")
    with h5py.File(tmp_path / "x.h5", "r+") as file:
        file.attrs["screwsim_schema"] = 2
    assert "schema 2, newer than 1 (update screwsim)" in refusal(tmp_path / "x.h5")


def test_a_file_without_a_group_is_told(single, tmp_path):
    shutil.copy(single, tmp_path / "x.h5")
    with h5py.File(tmp_path / "x.h5", "r+") as file:
        del file["balance"]
    assert "is not a complete results file" in refusal(tmp_path / "x.h5")


def test_an_unknown_figure_is_told_with_those_there_are(single):
    with pytest.raises(KeyError, match="performance has no 'shaft'; it has status, isothermal_efficiency"):
        open_results(single).performance["shaft"]


# A place that refuses


def test_a_place_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="cannot be written"):
        save(tmp_path / "file" / "x.h5", scene(), fake_simulate(scene()))


@pytest.mark.parametrize("room", [100, 20_000, 50_000])
def test_a_full_disk_keeps_the_old_file_and_leaves_no_other(room, single, tmp_path):
    path = tmp_path / "x.h5"
    shutil.copy(single, path)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, limits[1]))
    try:
        with pytest.raises(UsageError, match=r"x\.h5: cannot be written: File too large \(make room"):
            save(path, scene(), fake_simulate(scene()))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == single.read_bytes()
    assert [file.name for file in tmp_path.iterdir()] == ["x.h5"]
