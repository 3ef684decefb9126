"""Points on a GPU: the same text, in numba's simulator of CUDA, which runs kernels as Python. Untested on a device."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from screwsim.batch import cuda
from screwsim.cycle.problem import problem_of
from screwsim.scene import load

POINT = Path(__file__).parents[2] / "configs" / "paper" / "point.yaml"
PORTS = "suction_port", "discharge_port", "tip_leakage"

SIMULATED = """
import sys
from screwsim.batch import simulate_courses
from screwsim.scene import load
from screwsim.simulate import simulate

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


def _why_not() -> str:
    """Return why numba's simulator cannot run here; '' where it can."""
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": "1"}
    asked = [sys.executable, "-c", "from numba import cuda; assert cuda.is_available()"]
    found = subprocess.run(asked, env=environment, capture_output=True, text=True)
    lines = found.stderr.strip().splitlines()
    return lines[-1] if found.returncode else ""


def test_points_on_a_gpu_come_to_the_same_bits_in_the_simulator():
    why = _why_not()
    if why:
        pytest.skip(f"numba's simulator of CUDA does not run: {why} (pip install 'screwsim[gpu]')")
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": "1"}
    asked = [sys.executable, "-c", SIMULATED, str(POINT), *PORTS]
    found = subprocess.run(asked, env=environment, capture_output=True, text=True)
    assert found.stdout.strip() == "the same bits", found.stderr


def test_a_gpu_that_is_not_there_is_told_in_one_line(monkeypatch):
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": "0"}
    text = (
        "from screwsim.batch import simulate_courses; from screwsim.scene import load\n"
        "from screwsim.inputs.faults import *\n"
        f"try: simulate_courses([[load({str(POINT)!r})]], gpu=True)\n"
        "except UsageError as error: print(error)\n"
    )
    found = subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, text=True)
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
