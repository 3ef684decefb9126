"""The benchmark beside PDSim, up to PDSim itself, which is not among what is installed for tests."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest

from screwsim.scene import loads
from screwsim.study.validation import sibling

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "beside_pdsim.py"


@pytest.fixture(scope="module")
def beside() -> ModuleType:
    return sibling(SCRIPT)


def test_without_pdsim_one_line_says_what_is_missing_and_what_to_do(beside):
    why = beside.missing(sys.executable, ("json", "no_such_module_of_pdsim"))
    assert "\n" not in why and "no_such_module_of_pdsim" in why and "--help" in why
    assert beside.missing(sys.executable, ("json",)) == ""
    assert "No such file" in beside.missing("/no/such/python")


TOLD = """
||..@..|...|| mdot [%] 9.0 || in: 0.4 g/s || out: 0.5 g/s
||.....@...|| mdot [%] -2.5 || in: 0.504 g/s || out: 0.491 g/s
mdot*(h2-h1),P-v,Qamb 0.0828 0.0749 -0.01
Mass flow rate is 0.504 g/s
time taken 0.5 s
time taken 2.5e-1 s
"""


def test_times_and_figures_are_those_that_an_example_tells(beside, tmp_path):
    example = tmp_path / "example.py"
    example.write_text(f"print({TOLD!r})\n")
    first, second = beside.theirs(sys.executable, example)
    assert first == pytest.approx((0.5, 0.504, 74.9, 0.025))
    assert second == beside.Solved(0.25)
    assert first.told() == "0.504 g/s, 74.9 W, mass unclosed by 2.5e-02"


def test_an_example_that_fails_is_told_by_its_last_line(beside, tmp_path):
    example = tmp_path / "example.py"
    example.write_text("raise ValueError('a valve is lost')\n")
    with pytest.raises(RuntimeError, match=r"example\.py: ValueError: a valve is lost"):
        beside.theirs(sys.executable, example)


def test_an_example_without_a_machine_of_ours_is_timed_alone(beside, tmp_path):
    example = tmp_path / "scroll_compressor.py"
    example.write_text("print('time taken', 2.0)\n")
    assert beside.pairs(sys.executable, example, None, 3) == "scroll_compressor.py: PDSim 2 s; no machine of ours"


def test_scenes_of_the_examples_are_in_order(beside):
    for text in filter(None, beside.EXAMPLES.values()):
        assert loads(text).machine.kind == "slider_crank"


def test_a_point_here_tells_what_an_example_tells(beside):
    found = beside.ours(loads(beside.ONE_CHAMBER))
    assert found.seconds > 0.0 and found.unclosed < 3e-4
    assert 0.4 < found.flow < 0.6 and 60.0 < found.power < 90.0  # 0.57 g/s is swept
