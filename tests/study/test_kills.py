"""Kill −9 at any moment, of the sweep or of a worker: what comes out in the end is what an undisturbed sweep gives."""

import os
import random
import signal
import time
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest
from sweep_fakes import assert_same, forked, grid_scene, held, slow

from screwsim.study.sweep import run_sweep

pytestmark = [pytest.mark.slow, pytest.mark.around]
SPAN = 0.6  # [s] that the sweep takes, on idle cores


def running(output: Path) -> tuple[BaseProcess, Path]:
    """Return a sweep on two workers that has begun with its cases, and the file of their process numbers."""
    pids = output.with_name("pids")
    process = forked(pids, output)
    deadline = time.monotonic() + 60.0
    while not (pids.exists() and pids.read_text()):
        assert time.monotonic() < deadline, "no case has begun"
        time.sleep(0.002)
    return process, pids


@pytest.mark.parametrize("seed", range(6))
def test_a_parent_that_is_killed_at_any_moment(seed, reference, tmp_path):
    output = tmp_path / "out.h5"
    process, _ = running(output)
    time.sleep(random.Random(seed).uniform(0.0, SPAN))
    process.kill()
    process.join(10.0)
    there = 120 if output.exists() else held(output)
    assert run_sweep(grid_scene(), output, jobs=2, simulate_many=slow).reused == there
    assert_same(reference, output)
    assert sorted(os.listdir(tmp_path)) == ["out.h5", "pids"]


@pytest.mark.parametrize("seed", range(10, 16))
def test_a_worker_that_is_killed_at_any_moment(seed, reference, tmp_path):
    output = tmp_path / "out.h5"
    process, pids = running(output)
    chance = random.Random(seed)
    time.sleep(chance.uniform(0.0, SPAN))
    with suppress(ProcessLookupError):  # it ended before
        os.kill(int(chance.choice(pids.read_text().split())), signal.SIGKILL)
    process.join(60.0)
    assert process.exitcode == 0
    assert_same(reference, output)
