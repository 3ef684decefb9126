"""Bit for bit: the same scene gives the same numbers, whatever the number of jobs and whatever ran before."""

import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
from apart import command, command_for_speed, ended
from scenes import scene_dict

from screwsim.numerics.folder import cache_folder
from screwsim.results import open_results
from screwsim.scene import loads
from screwsim.simulate import simulate
from screwsim.study.sweep import run_sweep

SWEEP = {  # histories that take few turns, coupled chambers, no oil; no case takes seconds
    "oil.transport": "carried",
    "output.keep": "cycle",
    "sweep": {"operation.speed": ["400 rpm", "1000 rpm", "3000 rpm", "9000 rpm"], "oil_supply.ratio": [0, 0.5, 3]},
}
GROUPS = ("inputs", "performance", "balance", "error", "numerics", "cycle")
TIMES = ("wall_time", "estimating_time")
SCENE = json.dumps(scene_dict(SWEEP))  # JSON is YAML


def arrays(path):
    """Return every array of a file that does not measure time, as bytes."""
    results = open_results(path)
    found = {f"{group}.{name}": value for group in GROUPS for name, value in getattr(results, group).items()}
    return {name: np.asarray(value).tobytes() for name, value in found.items() if name.split(".")[1] not in TIMES}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Return the arrays of the sweep, computed in this process."""
    path = tmp_path_factory.mktemp("alone") / "one.h5"
    summary = run_sweep(loads(SCENE), path, jobs=1)
    assert (summary.cases, summary.ok) == (12, 12)
    return arrays(path)


def test_every_group_is_compared(alone):
    assert {name.split(".")[0] for name in alone} == set(GROUPS)


@pytest.mark.parametrize("jobs", [2, 3])
def test_the_number_of_jobs_changes_no_bit(jobs, alone, tmp_path):
    run_sweep(loads(SCENE), tmp_path / "out.h5", jobs=jobs)
    assert arrays(tmp_path / "out.h5") == alone


def test_a_fresh_process_changes_no_bit(alone, tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    asked = ["sweep", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out.h5"), "--jobs", "2"]
    assert ended(command, *asked).code == 0
    assert arrays(tmp_path / "out.h5") == alone


ORDER = "first", "second"


def test_one_run_after_another_changes_no_bit(tmp_path):
    (tmp_path / "scene.yaml").write_text(json.dumps(scene_dict({"operation.speed": "700 rpm"})), encoding="utf-8")
    first, second = (["run", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / f"{name}.h5")] for name in ORDER)
    subprocess.run([sys.executable, "-m", "screwsim", *first], check=True, capture_output=True)
    assert ended(command, *second).code == 0  # hashes other seeds than the first
    assert arrays(tmp_path / "first.h5") == arrays(tmp_path / "second.h5")


REAL = {
    "gas.model": "real",
    "oil.transport": "carried",
    "oil_supply.temperature": "328 K",
    "effects": {"suction_port": {}, "discharge_port": {}, "tip_leakage": {"gap": "50 um", "reading": "interface"}},
}


def answered(cache, changes):
    """Make a cache in which nothing is compiled but CoolProp has answered: its import takes as long as compiling."""
    simulate(loads(json.dumps(scene_dict(changes))), trace=False)
    cache.mkdir(mode=0o700)
    for file in cache_folder().glob("coolprop-*"):
        shutil.copy(file, cache)


@pytest.mark.slow
def test_a_module_compiled_now_gives_the_bits_of_one_that_was_loaded(tmp_path):
    """And that which was written soon those of one that was written for speed."""
    (tmp_path / "scene.yaml").write_text(json.dumps(scene_dict(REAL)), encoding="utf-8")
    answered(tmp_path / "cache", REAL)
    found = []
    for name, how in (("soon.h5", command), ("loaded.h5", command), ("fast.h5", command_for_speed)):
        asked = ["run", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / name)]
        done = ended(how, *asked, SCREWSIM_CACHE=str(tmp_path / "cache"))
        said = [line.partition(" ")[2].partition(",")[0] for line in done.err.splitlines() if "once (" in line]
        found.append((done.code, said[:2], arrays(tmp_path / name)))
    told = ["compiling the equation of state of R134a", "compiling this combination of effects"]
    assert [each[:2] for each in found] == [(0, told), (0, []), (0, told)]
    assert found[0][2] == found[1][2] == found[2][2]
    assert len(list((tmp_path / "cache").glob("*.rodas__integrate_one.*.fast"))) == 1
