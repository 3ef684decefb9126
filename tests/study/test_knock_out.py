"""Effects left out one at a time: which of them the chambers cannot do without."""

import importlib

import pytest
from folders import POINT

from screwsim.outputs import Figures, Result
from screwsim.scene import load
from screwsim.study import knock_out
from screwsim.study.pool.progress import Progress


@pytest.mark.parametrize(
    ("effects", "status"),
    [(("discharge_port",), "needed"), (("tip_leakage", "suction_port"), "needed"), (("tip_leakage",), "failed")],
)
def test_a_way_in_or_out_without_which_no_cycle_closes_is_needed(monkeypatch, effects, status):
    module = importlib.import_module("screwsim.simulate")  # the name in the package is the function
    monkeypatch.setattr(module, "simulate", lambda scene, trace: Result("failed", "the chamber stays shut"))
    left_out = [knock_out.LeftOut("+".join(effects), effects)]
    whole = Result("ok", performance=Figures(shaft_power=1e4, gas_mass_flow=0.2))
    (cost,) = knock_out.knock_out(load(POINT), whole, left_out, Progress()).knock_out
    assert (cost["status"], cost["message"], cost["shaft_power"]) == (status, "the chamber stays shut", None)
