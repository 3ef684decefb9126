"""An answer says what the result says, to the bit; what JSON has no word for is null."""

import json
import math

import numpy as np
import pytest
from explore_line import PAPER

from screwsim.explore import answer
from screwsim.explore.worker import Job, answer_job
from screwsim.outputs import Figures, Result
from screwsim.scene import load
from screwsim.simulate import simulate

SETTINGS = {"set": {"operation.speed": "1234.5 rpm", "oil_supply.ratio": 1.7}, "effects": {"end_face_leakage": False}}
OVERRIDES = ["operation.speed=1234.5 rpm", "oil_supply.ratio=1.7", "effects.end_face_leakage=off"]


def solved(changes=SETTINGS, kind="point", machine=""):
    return answer.unpack_message(answer_job((PAPER, ()), Job(kind, changes, {"first": 1, "number": 2}, machine)))


@pytest.fixture(scope="module")
def both():
    """Return an answer, and the result of the same settings."""
    return solved(), simulate(load(PAPER, OVERRIDES))


def test_figures_are_those_of_simulate_to_the_bit(both):
    (head, _), result = both
    assert head["status"] == result.status == "ok"
    for name in ("performance", "error", "balance"):
        assert head[name] == dict(getattr(result, name))


def test_traces_are_those_of_simulate_as_float32(both):
    (head, numbers), result = both
    rows = numbers.reshape(len(head["traces"]), -1)
    assert [name for name, _ in head["traces"]] == list(result.cycle)
    for row, values in zip(rows, result.cycle.values(), strict=True):
        np.testing.assert_array_equal(row, np.asarray(values, np.float32))


def test_the_ledger_adds_up_as_in_the_result(both):
    (head, _), result = both
    entries = {entry["words"]: entry["exergy_destroyed"] for entry in head["ledger"]["entries"]}
    assert sum(entries.values()) == pytest.approx(result.ledger.exergy_destroyed, rel=1e-12)


def test_the_tag_comes_back(both):
    (head, _), _ = both
    assert (head["first"], head["number"]) == (1, 2)


def test_the_drawing_comes_when_the_page_has_another(both):
    (head, _), _ = both
    assert head["machine"]["kind"] == "rotors"
    again, _ = solved(machine=head["machine_key"])
    assert "machine" not in again
    other, _ = solved({"set": {"machine.rotor_length": "190 mm"}}, machine=head["machine_key"])
    assert other["machine"]["length"] == pytest.approx(190.0)


def test_a_point_of_a_sweep_has_the_same_figures_without_traces(both):
    head, numbers = solved(kind="curve")
    assert head["performance"] == dict(both[1].performance)
    assert len(numbers) == 0


def test_what_is_not_finite_is_null():
    result = Result("failed", "no", performance=Figures(a=math.nan, b=math.inf, c=1.0, d=None))
    head, _ = answer.unpack_message(answer.result_answer(result, {}))
    assert head["performance"] == {"a": None, "b": None, "c": 1.0, "d": None}


def test_numbers_lie_where_float32_may():
    """A browser makes an array only where the place is a multiple of four."""
    for text in ("", "a", "ab", "abc"):
        message = answer.pack_message({"text": text}, [np.array([1.5, -2.5])])
        size = int.from_bytes(message[:4], "little")
        assert size % 4 == 0
        assert json.loads(message[4 : 4 + size]) == {"text": text}
        assert answer.unpack_message(message)[1].tolist() == [1.5, -2.5]


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"set": {"operation.discharge.pressure": "1.1 bar"}}, "operation.discharge.pressure"),
        ({"effects": {"wall_heat": True}}, "effects.wall_heat.rotor_area"),
    ],
)
def test_faults_are_told_by_their_paths(changes, path):
    head, _ = solved(changes)
    assert head["kind"] == answer.REFUSED
    assert path in [fault[0] for fault in head["faults"]]
    assert PAPER not in head["message"] and "--set" not in head["message"]


@pytest.mark.parametrize("changes", [None, {"set": {"gas.fluid": "Air"}}, {"effects": {"os": True}}, {"set": 3}])
def test_what_a_page_may_not_ask_is_an_answer_too(changes):
    head, _ = solved(changes)
    assert head["kind"] == answer.REFUSED and head["message"] and head["number"] == 2


def test_a_report_and_a_whole_scene_are_files():
    head, _ = solved(kind="scene")
    assert head["text"] == load(PAPER, OVERRIDES).text
    head, _ = solved(kind="report")
    assert head["text"].startswith("<!doctype html>") and "1234.5 rpm" in head["text"]


def test_with_the_derivatives_comes_what_the_tolerances_make_of_the_figures():
    tolerant = ("operation.speed=1000 rpm ± 3 %", "numerics.error=none")
    job = Job("slopes", {"set": {"operation.speed": "2000 rpm"}, "effects": {}}, {})
    head, _ = answer.unpack_message(answer_job((PAPER, tolerant), job))
    flow = simulate(load(PAPER, ["operation.speed=2000 rpm"]), trace=False).performance.displacement_flow
    assert head["halves"]["displacement_flow"] == pytest.approx(0.03 * flow, rel=1e-6)
    assert head["lost"] == []
