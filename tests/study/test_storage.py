"""Parts and files of large sweeps: few files, little memory, any cut of the cases gives the same file."""

import errno
import os
import sys
from dataclasses import replace
from pathlib import Path

import dask
import h5py
import numpy as np
import pytest
import xarray as xr
from result_fakes import CYCLE, SCENE, fake_simulate, scene
from sweep_fakes import StopAfter, assert_same, chained, grid_scene, held, parts_of

from screwsim.inputs.faults import UsageError
from screwsim.report import plot
from screwsim.results import open_results
from screwsim.results.schema import axes_of
from screwsim.results.table import InMemory, Table, join, regrouped, table_of
from screwsim.results.write import Draft, write_tables
from screwsim.scene import Scene, case, case_count
from screwsim.scene.grid import dimensions
from screwsim.study.columns import Column, write_columns
from screwsim.study.sweep import run_sweep, shards
from screwsim.study.sweep.cases import Blocks
from screwsim.study.sweep.shards import Parts

pytestmark = pytest.mark.usefixtures("one_moment")
LONG = SCENE + "sweep: {operation.speed: {from: 1000 rpm, to: 2000 rpm, count: 300}, oil_supply.ratio: [1, 2, 3]}\n"


@pytest.fixture(scope="module")
def long() -> tuple[Scene, Table]:
    """Return a scene of many cases and the table of all of them, which nobody writes into."""
    swept = scene(LONG)
    return swept, table_of([fake_simulate(case(swept, index)) for index in range(case_count(swept))], keep_cycle=False)


def test_small_parts_are_joined_and_the_file_is_the_same(reference, tmp_path, monkeypatch):
    monkeypatch.setattr(shards, "MOST_SMALL_PARTS", 3)
    monkeypatch.setattr("screwsim.study.sweep.run.CHUNK_TRACES", 1)  # one block a part
    output = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(8))
    assert len(list(parts_of(output).glob("cases_*.npz"))) == 3  # two of three blocks or more, two of one
    there = held(output)
    assert run_sweep(grid_scene(), output, jobs=2, simulate_many=chained).reused == there
    assert_same(reference, output)


def test_joined_parts_stay_as_they_are_when_they_are_large(tmp_path, monkeypatch):
    monkeypatch.setattr(shards, "MOST_SMALL_PARTS", 2)
    monkeypatch.setattr(shards, "LARGE_PART", 1)
    parts = Parts(tmp_path / "out.h5", {})
    parts.open(restart=False)
    for start in (0, 2, 4):
        parts.write(start, table_of([fake_simulate(scene())] * 2, keep_cycle=False))
    assert parts.finished() == [range(2), range(2, 4), range(4, 6)]
    parts.close()


def test_parts_left_beside_the_one_that_joins_them_are_not_taken_twice(tmp_path):
    parts = Parts(tmp_path / "out.h5", {})
    parts.open(restart=False)
    table = table_of([fake_simulate(scene())] * 4, keep_cycle=False)
    parts.write(0, table)
    parts.write(0, table.rows(slice(2)))
    parts.write(2, table.rows(slice(2, 4)))
    assert len(list(parts.all(4).tables(traces=False))) == 1
    assert parts.finished() == [range(4)]
    assert len(list(parts.folder.glob("*.npz"))) == 1
    parts.close()


def test_parts_that_another_process_took_are_told_with_the_remedy(long, tmp_path):
    """Without locks two sweeps may write one file, and any folder may be moved: nothing is lost."""
    _, table = long
    parts = Parts(tmp_path / "out.h5", {})
    parts.open(restart=False)
    try:
        parts.write(0, table.rows(slice(0, 200)))
        with pytest.raises(
            UsageError, match=r"out\.h5\.parts: cases from 200 onwards are gone: it was moved.*run this again"
        ):
            parts.all(len(table))
        parts.folder.rename(tmp_path / "elsewhere")
        with pytest.raises(UsageError, match=r"out\.h5\.parts: is gone: .*another sweep of the same file removed it"):
            parts.write(200, table.rows(slice(200, 400)))
        with pytest.raises(UsageError, match="cases from 0 onwards are gone"):
            parts.all(len(table))
    finally:
        parts.close()


def test_parts_that_are_no_whole_blocks_are_computed_again(reference, tmp_path, monkeypatch):
    output = tmp_path / "out.h5"
    monkeypatch.setattr("screwsim.study.sweep.run.blocks_of", shorter_blocks)
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(3))
    monkeypatch.undo()
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused == 0
    assert_same(reference, output)


def shorter_blocks(swept):
    return Blocks(tuple(each.size for each in dimensions(swept)), longest=6)


@pytest.mark.parametrize("chunk", [640, 4096, 262144])
def test_a_file_does_not_depend_on_how_its_cases_came(chunk, long, tmp_path, monkeypatch):
    swept, whole = long
    monkeypatch.setattr("screwsim.results.netcdf._CHUNK", chunk)
    write_tables(tmp_path / "whole.h5", swept, axes_of(swept), InMemory(whole), "sweep")
    for sizes in ([900], [1, 899], [450, 450], [7] * 128 + [4]):
        source = InMemory(whole)
        pieces = list(regrouped([whole], sizes))
        assert [len(piece) for piece in pieces] == sizes
        with monkeypatch.context() as patch:
            patch.setattr(source, "tables", lambda traces, pieces=pieces: iter(pieces))
            patch.setattr(source, "heads", lambda pieces=pieces: iter(pieces))
            write_tables(tmp_path / "pieces.h5", swept, axes_of(swept), source, "sweep")
        assert_same(tmp_path / "whole.h5", tmp_path / "pieces.h5")
        assert join(pieces).texts["warnings"].words == ("first warning\nη of 2",)


@pytest.mark.parametrize("changes", [{}, {"effects": ("blow_hole",)}, {"ledger": {"residue": np.zeros(1)}}])
def test_a_file_laid_out_ahead_is_that_laid_out_in_the_end(changes, long, tmp_path):
    """A first part may know less of the names than all parts, or others: the file is laid out again then."""
    swept, whole = long
    write_tables(tmp_path / "late.h5", swept, axes_of(swept), InMemory(whole), "sweep")
    with Draft(tmp_path / "early.h5", swept, axes_of(swept), "sweep") as draft:
        draft.lay_out(replace(whole.rows(slice(1)), **changes))
        draft.complete(InMemory(whole))
    assert (tmp_path / "early.h5").read_bytes() == (tmp_path / "late.h5").read_bytes()
    assert sorted(os.listdir(tmp_path)) == ["early.h5", "late.h5"]


def test_a_draft_that_is_left_leaves_nothing(tmp_path):
    swept = scene(LONG)
    (tmp_path / "out.h5").write_text("old")
    one = table_of([fake_simulate(case(swept, 0))], keep_cycle=False)
    with pytest.raises(KeyboardInterrupt), Draft(tmp_path / "out.h5", swept, axes_of(swept), "sweep") as draft:
        draft.lay_out(one)
        assert len(os.listdir(tmp_path)) == 2
        raise KeyboardInterrupt
    assert os.listdir(tmp_path) == ["out.h5"]
    assert (tmp_path / "out.h5").read_text() == "old"


def test_parts_at_hand_are_bounded_and_the_file_is_the_same(reference, tmp_path, monkeypatch):
    monkeypatch.setattr(shards, "BYTES_IN_MEMORY", 30_000)  # some of the parts
    run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate_many=chained)
    assert_same(reference, tmp_path / "out.h5")


def test_traces_come_in_chunks_of_whole_cases(tmp_path):
    swept = scene(LONG + CYCLE)
    run_sweep(swept, tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    with h5py.File(tmp_path / "out.h5") as file:
        data = file["cycle/pressure"]
        assert data.shape == (300, 3, 73)
        assert data.chunks[1:] == (3, 73)
        assert data.compression == "gzip"
        speed = file["cycle/operation_speed"][217]
        np.testing.assert_allclose(data[217, 1], 1e5 + speed * file["cycle/angle"][()], rtol=1e-15)


def test_a_large_result_is_read_lazily(tmp_path):
    axes = "operation.speed: {from: 1000 rpm, to: 2000 rpm, count: 400}, oil_supply.ratio: {from: 1, to: 2, count: 200}"
    swept = scene(SCENE + f"sweep: {{{axes}}}\n")
    table = table_of([fake_simulate(scene())], keep_cycle=False).rows(np.zeros(80_000, int))
    speed, ratio = (axis.values for axis in axes_of(swept))
    table.column("performance", "shaft_power")[:] = np.add.outer(speed, ratio).ravel()
    write_tables(tmp_path / "out.h5", swept, axes_of(swept), InMemory(table), "sweep")
    for engine in ("h5netcdf", "netcdf4"):
        opened = xr.open_dataset(tmp_path / "out.h5", group="performance", engine=engine, chunks={})
        with opened as data, dask.config.set(scheduler=dask.get):  # so that no cluster is looked for
            power = data.shaft_power
            assert power.chunks is not None
            assert len(power.chunks[0]) > 1  # as it is stored
            assert power[321, 7].compute() == speed[321] + ratio[7]
            np.testing.assert_allclose(power.mean().compute(), speed.mean() + ratio.mean(), rtol=1e-12)


# Systems that refuse


def interrupted(tmp_path: Path) -> Path:
    """Return the output of a sweep that was interrupted after three parts."""
    output = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(3))
    return output


def full(descriptor: int) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_disk_that_fills_up_ends_the_sweep_in_one_line_and_loses_nothing(jobs, reference, tmp_path, monkeypatch):
    output = interrupted(tmp_path)
    there = held(output)
    monkeypatch.setattr("screwsim.results.atomic.os.fsync", full)
    with pytest.raises(UsageError, match=r"cases_\d+_\d+\.npz: cannot be written: No space left on device \(make"):
        run_sweep(grid_scene(), output, jobs=jobs, simulate_many=chained)
    monkeypatch.undo()
    assert held(output) == there
    assert not list(parts_of(output).glob(".*"))
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused == there
    assert_same(reference, output)


def test_a_disk_that_fills_up_over_the_last_file_keeps_all_parts(reference, tmp_path, monkeypatch):
    output = interrupted(tmp_path)
    monkeypatch.setattr("screwsim.results.guarded.GuardedFile.write", no_room)
    with pytest.raises(UsageError, match=r"out\.h5: cannot be written: No space left on device \(make room"):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained)
    monkeypatch.undo()
    assert not output.exists()
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused == 120
    assert_same(reference, output)


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of a file's size")
@pytest.mark.parametrize("room", [0, 3000, 7000, 11_000])
def test_a_table_that_finds_no_room_is_told_in_one_line_and_the_old_one_stays(room, tmp_path, monkeypatch):
    import resource

    monkeypatch.setattr("screwsim.study.columns.version", lambda: "0")  # git would be under that limit, too

    columns = {name: Column([1.0, None] * 2000, "W", name) for name in "abc"}
    columns |= {"status": Column(["ok", "failed"] * 2000, "", "how it ended")}
    path = tmp_path / "x.h5"
    path.write_bytes(b"old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        with pytest.raises(UsageError, match=r"x\.h5: cannot be written: File too large \(make room"):
            write_columns(path, "table", columns)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == b"old" and [each.name for each in tmp_path.iterdir()] == ["x.h5"]


def no_room(file, data) -> int:
    file.error = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return len(data)


def test_a_folder_that_cannot_be_written_is_told_in_one_line(tmp_path, monkeypatch):
    def refuse(self, *arguments, **options):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "mkdir", refuse)  # root may write anywhere
    with pytest.raises(UsageError, match=r": cannot be written: Permission denied \(make room") as told:
        run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate_many=chained)
    assert "\n" not in str(told.value)


def test_a_case_is_found_again_in_a_zipped_sweep(tmp_path):
    sweep = "zip: [{operation.speed: [1000 rpm, 2000 rpm, 1000 rpm], oil_supply.ratio: [1, 2, 3]}]"
    swept = scene(SCENE + CYCLE + f"sweep: {{{sweep}, operation.discharge.pressure: [9 bar, 10 bar]}}\n")
    run_sweep(swept, tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    results = open_results(tmp_path / "out.h5")
    assert results.shape == (3, 2)
    assert list(results.axes) == ["case", "operation.discharge.pressure"]
    assert [(path, number) for path, (number, _) in results.varied.items()] == [
        ("operation.speed", 0),
        ("oil_supply.ratio", 0),
        ("operation.discharge.pressure", 1),
    ]
    np.testing.assert_array_equal(results.inputs["oil_supply_ratio"], [1.0, 2.0, 3.0])
    data = results.to_xarray(None)
    assert data.shaft_power.dims == ("case", "operation_discharge_pressure")
    np.testing.assert_array_equal(data.oil_supply_ratio, [1.0, 2.0, 3.0])
    assert data.oil_supply_ratio.dims == ("case",)
    np.testing.assert_allclose(data.shaft_power[:, 0], 10.0 * data.operation_speed, rtol=1e-15)
    for engine in ("h5netcdf", "netcdf4"):
        stored = xr.open_dataset(tmp_path / "out.h5", group="cycle", engine=engine)
        assert {"case", "operation_speed", "oil_supply_ratio", "angle"} <= set(stored.coords)
        assert stored.operation_speed.dims == ("case",)


def test_a_sample_of_words_and_numbers_reads_back(tmp_path):
    over = "oil_supply.source: [separator, suction], oil_supply.ratio: {from: 1, to: 2}"
    swept = scene(SCENE + f"sweep: {{sample: {{kind: sobol, count: 8, seed: 3, over: {{{over}}}}}}}\n")
    run_sweep(swept, tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    results = open_results(tmp_path / "out.h5")
    assert results.varied["oil_supply.source"][1].tolist() == list(swept.sweep["oil_supply.source"])
    np.testing.assert_array_equal(results.performance["oil_ratio"], swept.sweep["oil_supply.ratio"])
    assert results.to_xarray().oil_supply_source.values.tolist() == list(swept.sweep["oil_supply.source"])


def test_paths_that_vary_together_are_drawn_as_points(sketched, tmp_path):
    zipped = "zip: [{operation.speed: [1000 rpm, 2000 rpm], machine.male_lobes: [4, 5]}]"
    swept = scene(SCENE + f"sweep: {{{zipped}, oil_supply.ratio: [1, 2, 3]}}\n")
    run_sweep(swept, tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    names = {Path(name).name for name in plot(tmp_path / "out.h5", tmp_path / "figures")}
    assert "samples.png" in names
