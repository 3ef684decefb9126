"""Points on a GPU: in a simulation on this processor, as text for a device, and on one where there is one."""

import math
import re

import numpy as np
import pytest
import simulated_device
from folders import CONFIGS, POINT, ROOT

from screwsim.batch import driver, on_device, simulate_courses, tasks
from screwsim.codegen import machine
from screwsim.codegen.calls import FLOAT
from screwsim.codegen.device_library import HELD, DeviceLibrary
from screwsim.codegen.program import read
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of
from screwsim.inputs.faults import UsageError
from screwsim.model.side_by_side import TURN
from screwsim.scene import load
from screwsim.simulate import simulate

REAL = ROOT / "tests" / "plain" / "r134a.yaml"
EVERYTHING = CONFIGS / "everything.yaml"
WITHIN = 1e-3  # of their errors figures on a device differ from those of the processor


@pytest.fixture
def simulation(monkeypatch):
    found = simulated_device.Simulated()
    monkeypatch.setattr(tasks, "device", lambda: found)
    monkeypatch.setattr(tasks, "_on_device", {})
    return found


def _scenes(path, *more):
    return [load(str(path), [f"operation.speed={speed} rpm", *more]) for speed in (1200, 2000, 3000)]


def _held_against_single_ones(scenes):
    found = simulate_courses([[scene] for scene in scenes], gpu=True)
    for (one,), other in zip(found, map(simulate, scenes), strict=True):
        assert one.status == other.status == "ok", one.message
        for name, value in other.performance.items():
            if isinstance(value, float) and value:
                bound = WITHIN * max(other.error.get(name) or 0.0, 3e-4 * abs(value))
                assert abs(one.performance[name] - value) <= bound, (name, one.performance[name], value)


@pytest.mark.parametrize("scene", [POINT, REAL], ids=["paper", "R134a"])
def test_points_in_the_simulation_differ_from_single_ones_by_a_thousandth_of_their_errors(scene, simulation):
    _held_against_single_ones(_scenes(scene))
    assert len(simulation.held) == 1  # room that grew was given back


def test_a_turn_that_finds_no_room_on_the_device_is_the_processors(simulation, monkeypatch):
    monkeypatch.setattr(on_device, "STEPS", 16)
    _held_against_single_ones(_scenes(POINT))
    (turns,) = tasks._on_device.values()
    assert turns.steps > 16  # of the next calls


def test_no_point_depends_on_those_beside_it_on_a_device(simulation):
    scenes = _scenes(POINT, "numerics.error=none")
    together = simulate_courses([[scene] for scene in scenes], gpu=True)
    for scene, (one,) in zip(scenes, together, strict=True):
        ((alone,),) = simulate_courses([[scene]], gpu=True)
        assert dict(one.performance) == dict(alone.performance)


@pytest.mark.parametrize("scene", [POINT, REAL, EVERYTHING], ids=["paper", "R134a", "everything"])
def test_the_text_for_a_device_calls_nothing_that_it_lacks(scene):
    problem = problem_of(load(str(scene)))
    turns = {on_device.N_E: problem.composition.n_E}
    text = lease_for(problem).module.of_device(TURN, on_device.KINDS, turns).decode()
    assert text.count(".entry turns(") == 1
    assert not re.search(r"\.extern|\balloca\b|\bfma\.", text)  # no joined products: the bits of a processor
    assert ".const" not in text  # that memory is small


def test_what_a_device_lacks_is_told(simulation, monkeypatch):
    program = read("def f(x):\n    return math.tan(x)\n")
    monkeypatch.setattr(simulation, "turns", lambda *_asked: DeviceLibrary(program).entry("f", (FLOAT,), "f"))
    with pytest.raises(
        UsageError, match=r"cannot be solved on a GPU: f: a GPU has no math\.tan.*; leave it to the processor"
    ):
        simulate_courses([[scene] for scene in _scenes(POINT)], gpu=True)


def test_a_device_without_room_is_told_with_how_many_points_to_ask_for(simulation, monkeypatch):
    def full(_words):
        raise MemoryError

    monkeypatch.setattr(simulation, "room", full)
    with pytest.raises(UsageError, match=r"no memory for 3 points at once; use fewer \(.* in_flight=1\)"):
        simulate_courses([[scene] for scene in _scenes(POINT)], gpu=True)


def _function(name, *kinds):
    text = f"def f({', '.join('xy'[: len(kinds)])}):\n    return math.{name}({', '.join('xy'[: len(kinds)])})\n"
    symbol = f"of_a_device.{name}"
    returned, written = DeviceLibrary(read(text)).entry("f", kinds, symbol)
    entry = machine.loaded(machine.compiled(written, fast=True), symbol)

    def called(*given):
        out = np.empty(1)
        entry(np.array(given).ctypes.data, out.ctypes.data)
        return out[0]

    assert returned == FLOAT
    return called


@pytest.mark.parametrize("name", sorted(HELD))
def test_a_devices_functions_are_those_of_the_library_to_some_units_in_the_last_place(name):
    random = np.random.default_rng(1)
    if name == "pow":
        own = _function(name, FLOAT, FLOAT)
        for x, y in zip(random.uniform(0.01, 100.0, 500), random.uniform(-5.0, 5.0, 500), strict=True):
            assert own(x, y) == pytest.approx(x**y, rel=1e-14)
        return
    own = _function(name, FLOAT)
    angles = [*random.uniform(-50.0, 50.0, 2000), *(k * math.pi / 4 for k in range(-9, 10))]
    spans = {"sin": angles, "cos": angles}
    spans |= {"exp": random.uniform(-50.0, 50.0, 2000), "expm1": random.uniform(-1.0, 1.0, 2000) ** 5}
    spans |= {"log1p": random.uniform(-0.9, 1.0, 2000) ** 5}
    for x in spans.get(name, 10.0 ** random.uniform(-20.0, 20.0, 2000)):
        wanted = getattr(math, name)(x)
        bound = 3e-16 if name in ("sin", "cos") else 8e-16 * max(abs(wanted), 1e-300)
        assert abs(own(float(x)) - wanted) <= bound, x


def test_a_device_gives_the_ends_of_logarithms():
    assert _function("log1p", FLOAT)(math.inf) == math.inf
    assert _function("log1p", FLOAT)(1e-20) == 1e-20
    assert math.isnan(_function("log", FLOAT)(-1.0))


def _device():
    try:
        return driver.Driver()
    except UsageError as why:
        pytest.skip(str(why))


@pytest.mark.parametrize("scene", [POINT, REAL], ids=["paper", "R134a"])
def test_points_on_a_device_differ_from_single_ones_by_a_thousandth_of_their_errors(scene):
    _device()
    _held_against_single_ones(_scenes(scene))


def test_a_gpu_that_is_not_there_is_told_in_one_line():
    try:
        driver.Driver()
    except UsageError as told:
        assert "GPU" in str(told) and len(str(told).splitlines()) == 1
        return
    pytest.skip("there is a GPU")
