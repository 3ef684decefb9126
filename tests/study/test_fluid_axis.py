"""A sweep over fluids: its cases, its file, its figures; what a fluid cannot do is the status of its cases alone."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray
from result_fakes import SCENE, fake_simulate

from screwsim.report import families, maps, plot, sweeps
from screwsim.report.page.data import document, selection
from screwsim.results import open_results
from screwsim.results.schema import axis_of
from screwsim.results.table import InMemory, table_of
from screwsim.results.write import write_tables
from screwsim.scene import case, loads
from screwsim.simulate import simulate
from screwsim.study.compare import compare
from screwsim.study.sweep import run_sweep

PLAIN = Path(__file__).parents[1] / "plain" / "r134a.yaml"
FLUIDS = ["R134a", "R402A", "R508B", "R454B"]  # the second has a pair without data, the third no saturation at 45 degC


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A sweep of real cycles: fluids fastest, so that those of one fluid are not neighbours in the file."""
    text = f"base: {PLAIN}\nsweep:\n  operation.speed: [2950 rpm, 3600 rpm]\n  gas.fluid: [{', '.join(FLUIDS)}]\n"
    path = tmp_path_factory.mktemp("fluids") / "fluids.h5"
    scene = loads(text)
    return scene, run_sweep(scene, path, jobs=1), open_results(path)


def test_each_fluid_ends_as_it_can_and_the_rest_goes_on(swept):
    _, summary, results = swept
    assert (summary.ok, summary.failed) == (4, 4)
    assert results.status[0].tolist() == ["ok", "failed", "failed", "ok"]
    assert "no data of the pair R125 and R22" in results.messages[0, 1]
    assert "critical temperature of R508B" in results.messages[0, 2]


def test_a_case_is_that_of_its_fluid(swept):
    scene, _, results = swept
    alone = simulate(case(scene, 3)).performance  # R454B at 2950 rpm, begun from its own guess: default accuracy
    for name in ("gas_mass_flow", "shaft_power", "cop"):
        assert results.performance[name][0, 3] == pytest.approx(alone[name], rel=1e-4)


def test_the_names_are_read_by_others(swept):
    path = swept[2].path
    for engine in ("netcdf4", "h5netcdf"):
        with xarray.open_dataset(path, group="performance", engine=engine) as data:
            assert data.gas_fluid.attrs["flag_meanings"].split() == FLUIDS
            assert data.gas_fluid.attrs["labels"].splitlines() == FLUIDS
    with netCDF4.Dataset(path) as data:
        assert data["performance"]["gas_fluid"].flag_meanings.split() == FLUIDS
    ours = swept[2].to_xarray()
    assert float(ours.sel(gas_fluid="R454B").shaft_power[0]) == swept[2].performance["shaft_power"][0, 3]


def test_fluids_are_curves_of_one_figure(swept):
    results = swept[2]
    assert [name for name, _ in sweeps.plans(results)] == ["efficiency", "performance"]
    assert [curve.text for curve in families.curves_of(families.family_of(results), "cop")] == ["R134a", "R454B"]


def fakes(path, fluids, stop=None):
    """Sweep fakes over fluids; `stop` breaks off at that fluid."""

    def fake(scene):
        if scene.gas.name == stop:
            raise KeyboardInterrupt
        return fake_simulate(scene)

    axis = ", ".join(f'"{fluid}"' for fluid in fluids)
    run_sweep(loads(f"{SCENE}sweep: {{gas.fluid: [{axis}]}}\n"), path, jobs=1, simulate=fake)
    return open_results(path)


PURE = [
    *("R134a", "R32", "R125", "R143a", "R152A", "R22", "R23", "R12", "R13", "R11", "R123", "R124", "R1234yf"),
    *("R1234ze(E)", "R227EA", "R236FA", "R245fa", "Ammonia"),
]


def test_a_sweep_of_fluids_resumes_and_compares(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        fakes(tmp_path / "a.h5", PURE, stop=PURE[-1])
    results = fakes(tmp_path / "a.h5", PURE)
    assert results.axes["gas.fluid"].tolist() == PURE and (results.status == "ok").all()
    found = compare(results, fakes(tmp_path / "b.h5", PURE[::-3]))
    assert found.equal and found.common == len(PURE[::-3])


def test_more_names_than_a_byte_numbers_are_kept(tmp_path):
    names = [f"R32/R125 (0.{x}/0.{1000 - x})" for x in range(300, 500)]
    table = table_of([fake_simulate(loads(SCENE))] * len(names), keep_cycle=False)
    write_tables(tmp_path / "d.h5", loads(SCENE), [axis_of("gas.fluid", names, "1", "fluid")], InMemory(table), "sweep")
    assert open_results(tmp_path / "d.h5").axes["gas.fluid"].tolist() == names


def test_words_alone_are_drawn_as_points(sketched, tmp_path):
    fakes(tmp_path / "c.h5", ["R134a", "Ammonia", "R32"])
    assert [Path(each).name for each in plot(tmp_path / "c.h5", tmp_path)] == ["fluid.png", "fluid.pdf"]
    assert np.all(open_results(tmp_path / "c.h5").performance["shaft_power"] > 0.0)


def test_a_page_begins_over_the_words_where_nothing_else_varies(tmp_path):
    results = fakes(tmp_path / "e.h5", ["R134a", "Ammonia"])
    start = document(results, selection(results))["start"]
    assert (start["x"], start["curves"]) == (0, None)


def test_maps_over_two_axes_of_numbers_are_drawn_for_each_fluid(tmp_path):
    axes = "operation.speed: [1000 rpm, 2000 rpm, 3000 rpm], oil_supply.ratio: [1, 2, 3]"
    scene = loads(f"{SCENE}sweep: {{gas.fluid: [R134a, Ammonia], {axes}}}\n")
    run_sweep(scene, tmp_path / "f.h5", jobs=1, simulate=fake_simulate)
    results = open_results(tmp_path / "f.h5")
    assert [name for name, _ in maps.plans(results)] == ["map_1", "map_2"]  # a fluid each
    assert [name for name, _ in sweeps.plans(results) if "eff" in name] == [f"efficiency_{n}" for n in (1, 2, 3)]
