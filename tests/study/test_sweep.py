"""Sweeps: every case once, whatever dies on the way."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from result_fakes import GRID, SCENE, fake_simulate, scene
from sweep_fakes import (
    RATIOS,
    StopAfter,
    assert_same,
    begin,
    chained,
    environment,
    faulty,
    forbidden,
    grid_scene,
    held,
    parts_of,
    slow,
    start,
    stuck,
    wait_for_parts,
)

from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.study.sweep import run_sweep, sweep

pytestmark = pytest.mark.usefixtures("one_moment")


def test_each_case_lies_at_its_place_on_the_axes(reference):
    results = open_results(reference)
    speed, ratio = results.axes["operation.speed"], results.axes["oil_supply.ratio"]
    assert results.shape == (3, RATIOS)
    computed = results.status != "failed"
    expected = np.where(computed, 10.0 * speed[:, None] + 0.0 * ratio, np.nan)
    np.testing.assert_allclose(results.performance["shaft_power"], expected, rtol=1e-15)
    np.testing.assert_array_equal(results.performance["oil_ratio"][1][computed[1]], ratio[computed[1]])
    np.testing.assert_allclose(results.cycle["pressure"][2, 3], 1e5 + speed[2] * results.cycle["angle"], rtol=1e-15)


@pytest.mark.parametrize("jobs", [2, 5])
def test_the_number_of_workers_does_not_change_the_data(jobs, reference, tmp_path):
    run_sweep(grid_scene(), tmp_path / "out.h5", jobs=jobs, simulate_many=chained)
    assert_same(reference, tmp_path / "out.h5")
    assert os.listdir(tmp_path) == ["out.h5"]


def test_the_summary_counts_every_status(tmp_path):
    summary = run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate=fake_simulate)
    assert (summary.cases, summary.ok, summary.not_closed, summary.failed, summary.reused) == (120, 114, 3, 3, 0)


def test_slow_machines_are_simulated_first(tmp_path):
    """They take longest; one that began last would leave the other workers idle."""
    speeds = []

    def noted(case):
        speeds.append(case.operation.speed)
        return fake_simulate(case)

    fast_first = grid_scene()
    backwards = {path: values[::-1] for path, values in fast_first.sweep.items()}
    run_sweep(replace(fast_first, sweep=backwards), tmp_path / "out.h5", jobs=1, simulate=noted)
    assert len(speeds) == 120
    assert speeds == sorted(speeds)


@pytest.mark.around
@pytest.mark.parametrize("count", [1, 6])
@pytest.mark.parametrize("jobs", [1, 2])
def test_a_killed_sweep_resumes_where_it_was(jobs, count, reference, tmp_path):
    output = tmp_path / "out.h5"
    process = begin(output, jobs)
    wait_for_parts(output, count)
    process.kill()
    process.join(10.0)
    assert not output.exists()
    there = held(output)
    summary = run_sweep(grid_scene(), output, jobs=jobs, simulate_many=chained)
    assert summary.reused == there >= 13 * count
    assert_same(reference, output)


def test_workers_end_with_a_killed_parent(tmp_path):
    process = start(tmp_path / "out.h5", 2)
    wait_for_parts(tmp_path / "out.h5", 2)
    process.kill()
    process.communicate(timeout=10)  # returns when the last worker has closed the pipe


def test_ctrl_c_leaves_parts_that_resume(reference, tmp_path):
    output = tmp_path / "out.h5"
    process = begin(output, 2)
    wait_for_parts(output, 3)
    os.kill(process.pid, signal.SIGINT)
    process.join(10.0)
    assert process.exitcode == 1 and "KeyboardInterrupt" in (tmp_path / "err").read_text()
    assert not output.exists()
    summary = run_sweep(grid_scene(), output, jobs=1, simulate_many=chained)
    assert summary.reused >= 39
    assert_same(reference, output)


def test_ctrl_c_ends_a_sweep_while_a_worker_sends(tmp_path, monkeypatch):
    """The other half of the message never comes: a process that waits for it never ends."""
    sending = tmp_path / "sending"
    monkeypatch.setenv("SWEEP_FAKES_PIDS", str(sending))
    process = begin(tmp_path / "out.h5", 2, stuck)
    while not sending.exists():
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGINT)
    process.join(20.0)
    process.kill()
    assert process.exitcode == 1 and "KeyboardInterrupt" in (tmp_path / "err").read_text()


def test_an_exception_is_the_result_of_its_case_in_one_line(tmp_path):
    run_sweep(grid_scene(), tmp_path / "out.h5", jobs=1, simulate=faulty)
    results = open_results(tmp_path / "out.h5")
    assert set(results.messages[:, 2]) == {"ZeroDivisionError: float division by zero"}
    assert set(results.status[:, 2]) == {"failed"}


def test_a_case_whose_values_do_not_fit_together_is_failed_with_the_fault(tmp_path):
    text = SCENE + "sweep: {operation.discharge.pressure: [1 bar, 12 bar]}\n"
    run_sweep(scene(text), tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    results = open_results(tmp_path / "out.h5")
    assert results.status.tolist() == ["failed", "ok"]
    assert "operation.discharge.pressure" in results.messages[0]


def test_a_finished_sweep_is_not_computed_again(reference, tmp_path):
    output = tmp_path / "out.h5"
    output.write_bytes(reference.read_bytes())
    summary = run_sweep(grid_scene(), output, jobs=1, simulate=forbidden)
    assert (summary.cases, summary.reused, summary.failed) == (120, 120, 3)
    assert output.read_bytes() == reference.read_bytes()


def test_a_restart_computes_everything_again(reference, tmp_path):
    output = tmp_path / "out.h5"
    output.write_bytes(reference.read_bytes())
    summary = run_sweep(grid_scene(), output, jobs=1, restart=True, simulate=faulty)
    assert (summary.reused, summary.failed) == (0, 6)


def test_an_interrupted_restart_is_resumed_and_the_old_file_not_taken_for_it(reference, tmp_path):
    output = tmp_path / "out.h5"
    output.write_bytes(reference.read_bytes())
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, restart=True, simulate_many=chained, progress=StopAfter(2))
    assert_same(reference, output)
    summary = run_sweep(grid_scene(), output, jobs=1, simulate=faulty)
    assert 26 <= summary.reused < 120
    assert summary.failed > 3


@pytest.mark.parametrize("restart", [False, True])
def test_another_scenes_file_is_refused_and_not_touched(restart, reference, tmp_path):
    output = tmp_path / "out.h5"
    output.write_bytes(reference.read_bytes())
    with pytest.raises(UsageError, match=r"out\.h5: holds another scene's results, .*: .*, now .* \(choose another -o"):
        run_sweep(scene(SCENE + GRID), output, jobs=1, restart=restart, simulate=forbidden)
    assert output.read_bytes() == reference.read_bytes()
    assert os.listdir(tmp_path) == ["out.h5"]


def test_another_scenes_parts_are_refused_and_not_touched(tmp_path):
    output = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(3))
    before = sorted(os.listdir(parts_of(output)))
    with pytest.raises(UsageError, match="holds another scene's results"):
        run_sweep(scene(SCENE + GRID), output, jobs=1, simulate=forbidden)
    assert sorted(os.listdir(parts_of(output))) == before


def test_a_file_of_another_program_is_refused_and_not_touched(tmp_path):
    output = tmp_path / "out.h5"
    output.write_text("my thesis")
    with pytest.raises(UsageError, match="is not an HDF5 file"):
        run_sweep(grid_scene(), output, jobs=1, restart=True, simulate=forbidden)
    assert output.read_text() == "my thesis"


def at_version(monkeypatch, text: str) -> None:
    for module in ("identity", "schema"):
        monkeypatch.setattr(f"screwsim.results.{module}.version", lambda: text)


def test_results_of_another_version_are_refused_until_a_restart(reference, tmp_path, monkeypatch):
    output = tmp_path / "out.h5"
    output.write_bytes(reference.read_bytes())
    at_version(monkeypatch, "99")
    with pytest.raises(UsageError, match=r"from screwsim .* \(--restart computes them again\)"):
        run_sweep(grid_scene(), output, jobs=1, simulate=forbidden)
    assert run_sweep(grid_scene(), output, jobs=1, restart=True, simulate=fake_simulate).reused == 0


def test_results_of_another_commit_towards_a_release_resume_while_the_sources_are_the_same(tmp_path, monkeypatch):
    output = tmp_path / "out.h5"
    at_version(monkeypatch, "9.8.0.dev5+g1a2b3c4d")
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(4))
    there = held(output)
    at_version(monkeypatch, "9.8.0.dev7+g5e6f7a8b.dirty")
    assert run_sweep(grid_scene(), output, jobs=1, simulate_many=chained).reused == there > 0
    assert open_results(output).attributes["screwsim_version"] == "9.8.0.dev7+g5e6f7a8b.dirty"
    at_version(monkeypatch, "9.8.0")  # released of these sources
    assert run_sweep(grid_scene(), output, jobs=1, simulate=forbidden).reused > there
    monkeypatch.setattr("screwsim.numerics.sources.package_digest", lambda: "others")  # of the same version
    with pytest.raises(UsageError, match=r"but from different sources of screwsim 9\.8\.0; "):
        run_sweep(grid_scene(), output, jobs=1, simulate=forbidden)


@pytest.mark.parametrize("kept", [0.0, 0.5, 0.95])
def test_a_part_that_was_cut_short_is_computed_again(kept, reference, tmp_path):
    output = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(4))
    part = sorted(parts_of(output).glob("cases_*.npz"))[0]
    part.write_bytes(part.read_bytes()[: int(kept * part.stat().st_size)])
    there = held(output)
    summary = run_sweep(grid_scene(), output, jobs=1, simulate_many=chained)
    assert summary.reused == there - 13  # the first part holds one block
    assert_same(reference, output)


def test_a_part_with_a_changed_byte_is_computed_again(reference, tmp_path):
    output = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid_scene(), output, jobs=1, simulate_many=chained, progress=StopAfter(2))
    part = sorted(parts_of(output).glob("cases_*.npz"))[0]
    raw = bytearray(part.read_bytes())
    raw[len(raw) // 2] ^= 0xFF
    part.write_bytes(bytes(raw))
    run_sweep(grid_scene(), output, jobs=1, simulate_many=chained)
    assert_same(reference, output)


def test_two_sweeps_at_once_into_one_file_are_refused(tmp_path):
    output = tmp_path / "out.h5"
    process = begin(output, 1)
    wait_for_parts(output, 1)
    try:
        with pytest.raises(UsageError, match="another sweep is writing it"):
            run_sweep(grid_scene(), output, jobs=1, simulate=forbidden)
    finally:
        process.kill()
        process.join(10.0)


def test_a_place_that_cannot_be_written_is_told_in_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match=r"cannot be written: .*file is a file, not a folder \(choose") as caught:
        run_sweep(grid_scene(), tmp_path / "file" / "out.h5", jobs=1, simulate=forbidden)
    assert "\n" not in str(caught.value)


def test_the_compiled_module_is_made_once_before_the_workers_start(tmp_path):
    calls = tmp_path / "calls"
    # in a process of its own: where other tests have left threads, workers are not forked
    options = "jobs=2, simulate=f.fake_simulate, warm_up=f.note_warm_up"
    code = f"import sweep_fakes as f; f.run_sweep(f.grid_scene(), {str(tmp_path / 'out.h5')!r}, {options})"
    subprocess.run(
        [sys.executable, "-c", code], env=environment() | {"SWEEP_FAKES_WARM": str(calls)}, check=True, timeout=60
    )
    assert len(calls.read_text().split()) == 1  # workers inherit it


def test_a_scene_without_a_sweep_is_one_case(tmp_path):
    summary = run_sweep(scene(), tmp_path / "out.h5", simulate=fake_simulate)
    results = open_results(tmp_path / "out.h5")
    assert summary.cases == 1
    assert results.shape == ()
    assert results.status == "ok"


def test_traces_are_left_out_unless_the_scene_keeps_them(tmp_path):
    run_sweep(scene(SCENE + GRID), tmp_path / "out.h5", jobs=1, simulate=fake_simulate)
    assert len(open_results(tmp_path / "out.h5").cycle) == 0


def test_a_sweep_from_python_is_one_dataset(reference):
    data = sweep(grid_scene(), jobs=1, simulate_many=chained)
    stored = open_results(reference)
    assert data.shaft_power.dims == ("operation_speed", "oil_supply_ratio")
    assert data.cycle_pressure.dims == ("operation_speed", "oil_supply_ratio", "angle")
    np.testing.assert_array_equal(data.shaft_power, stored.performance["shaft_power"])
    assert data.shaft_power.attrs["units"] == "W"
    assert data.oil_supply_ratio.attrs["path"] == "oil_supply.ratio"
    assert {"balance_mass", "error_shaft_power", "numerics_steps", "status", "message"} <= set(data)


def test_a_sweep_from_a_program_with_threads_works(reference, tmp_path):
    import threading

    stop = threading.Event()
    thread = threading.Thread(target=stop.wait)
    thread.start()
    try:
        run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate_many=chained)
    finally:
        stop.set()
        thread.join()
    assert_same(reference, tmp_path / "out.h5")


def test_progress_counts_every_case_and_every_one_that_is_not_ok(tmp_path):
    class Count(StopAfter):
        total = done = failed = 0

        def start(self, cases: int, reused: int) -> None:
            self.total = cases

        def advance(self, cases: int, failed: int) -> None:
            self.done += cases
            self.failed += failed

    count = Count(0)
    run_sweep(grid_scene(), tmp_path / "out.h5", jobs=2, simulate_many=slow, progress=count)
    assert (count.total, count.done, count.failed) == (120, 120, 6)


def test_nothing_is_written_to_stdout_or_stderr(tmp_path):
    process = start(tmp_path / "out.h5", 2)
    _, told = process.communicate(timeout=30)
    assert isinstance(process, subprocess.Popen)
    assert (process.returncode, told) == (0, b"")
