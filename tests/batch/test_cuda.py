"""Points on a GPU: the same text in numba's simulator of CUDA, which runs kernels as Python, and on a device."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from screwsim.batch import cuda
from screwsim.codegen.program import read
from screwsim.cycle.problem import problem_of
from screwsim.scene import load

ROOT = Path(__file__).parents[2]
POINT = ROOT / "configs" / "paper" / "point.yaml"
REAL = ROOT / "tests" / "plain" / "r134a.yaml"
PORTS = "suction_port", "discharge_port", "tip_leakage"
ROOM = 64 * 1024  # bytes, of a device's memory for constants

SIMULATED = """
import sys
from screwsim.batch import cuda, simulate_courses
from screwsim.scene import load
from screwsim.simulate import simulate

cuda.STEPS = 16  # of the first call: turns of more are integrated here, and the next has room
asked = ["numerics.error=none", "numerics.accuracy=1e-2"]
left = [name for name in load(sys.argv[1]).effects if name not in sys.argv[2:]]
scenes = [load(sys.argv[1], [*asked, f"operation.speed={speed} rpm"], left) for speed in (2800, 3000)]
found = [result for result, in simulate_courses([[scene] for scene in scenes], gpu=True)]
for one, other in zip(found, (simulate(scene, trace=False) for scene in scenes), strict=True):
    assert one.status == other.status == "ok", one.message
    assert dict(one.performance) == dict(other.performance)
    assert one.numerics.rhs_evaluations == other.numerics.rhs_evaluations
print("the same bits")
"""

ON_A_DEVICE = """
import sys
from screwsim.batch import simulate_courses
from screwsim.scene import load
from screwsim.simulate import simulate

scenes = [load(sys.argv[1], [f"operation.speed={speed} rpm"]) for speed in range(1000, 5000, 500)]
for (one,), other in zip(simulate_courses([[scene] for scene in scenes], gpu=True), map(simulate, scenes), strict=True):
    assert one.status == other.status == "ok", one.message
    for name, value in other.performance.items():
        if isinstance(value, float) and value:
            bound = 0.3 * max(other.error.get(name) or 0.0, 3e-4 * abs(value))
            assert abs(one.performance[name] - value) <= bound, (name, one.performance[name], value)
print("within their errors")
"""


def _run(simulated: bool, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": str(int(simulated))}
    return subprocess.run([sys.executable, "-c", *arguments], env=environment, capture_output=True, text=True)


def _why_not(simulated: bool) -> str:
    """Return why numba's simulator, or a device, cannot run here; '' where it can."""
    found = _run(simulated, "from numba import cuda; assert cuda.is_available(), 'no device'")
    return (found.stderr.strip().splitlines() or ["it ended"])[-1] if found.returncode else ""


def test_points_on_a_gpu_come_to_the_same_bits_in_the_simulator():
    why = _why_not(simulated=True)
    if why:
        pytest.skip(f"numba's simulator of CUDA does not run: {why} (pip install 'screwsim[gpu]')")
    found = _run(True, SIMULATED, str(POINT), *PORTS)
    assert found.stdout.strip() == "the same bits", found.stderr


@pytest.mark.parametrize("scene", [POINT, REAL], ids=["paper", "R134a"])
def test_points_on_a_device_differ_from_single_ones_by_less_than_their_errors(scene):
    why = _why_not(simulated=False)
    if why:
        pytest.skip(f"no GPU that CUDA finds: {why}")
    found = _run(False, ON_A_DEVICE, str(scene))
    assert found.stdout.strip() == "within their errors", found.stderr


def test_a_gpu_that_is_not_there_is_told_in_one_line(monkeypatch):
    text = (
        "from screwsim.batch import simulate_courses; from screwsim.scene import load\n"
        "from screwsim.inputs.faults import *\n"
        f"try: simulate_courses([[load({str(POINT)!r})]], gpu=True)\n"
        "except UsageError as error: print(error)\n"
    )
    if not _why_not(simulated=False):
        pytest.skip("there is a GPU")
    found = _run(False, text)
    assert found.returncode == 0, found.stderr
    assert "GPU" in found.stdout and len(found.stdout.splitlines()) == 1


def test_the_text_for_a_gpu_has_no_array_whose_size_is_not_a_number():
    composition = problem_of(load(str(POINT))).composition
    text = cuda.text_of(composition.text, composition.n_E)
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    assert not [node for node in calls if ast.unparse(node.func) in ("np.empty", "np.zeros")]
    rooms = [node.args[0] for node in calls if ast.unparse(node.func) == "cuda.local.array"]
    assert len(rooms) > 10
    for shape in rooms:
        sizes = ast.literal_eval(shape)
        assert all(isinstance(size, int) and size > 0 for size in (sizes if isinstance(sizes, tuple) else (sizes,)))


def test_tables_of_real_gas_lie_in_a_gpus_own_memory_as_that_for_constants_is_small():
    composition = problem_of(load(str(REAL))).composition
    assert sum(np.asarray(value).nbytes for value in read(composition.text).constants.values()) > 0.4 * ROOM
    tree = ast.parse(cuda.text_of(composition.text, composition.n_E))
    values = [node.value for node in tree.body if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call)]
    constants = [value for value in values if ast.unparse(value.func) == "np.array"]
    assert len(constants) < len(values)
    assert sum(np.array(ast.literal_eval(value.args[0])).nbytes for value in constants) < ROOM / 20
