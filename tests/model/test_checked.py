"""Compiled text stays within its arrays: the shipped scenes, with every index checked, give the same bits."""

import math
from pathlib import Path

import pytest

import screwsim
from screwsim.codegen import modules
from screwsim.model import leases

CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.fixture
def checked(monkeypatch):
    """Compile every module anew, with checks; no module of before is taken."""

    class Checked(modules.Module):
        def __init__(self, name, text, **how):
            super().__init__(name, text, **how, checks=True)

    monkeypatch.setattr(modules, "Module", Checked)
    monkeypatch.setattr(modules, "_patience", math.inf)  # code that is thrown away, of the same bits
    monkeypatch.setattr(modules, "_loaded", {})
    monkeypatch.setattr(leases, "_free", {})
    return modules._loaded


ONE, ALL = "rodas__integrate_one", "rodas__integrate_all"  # chamber on its own, chambers together


@pytest.mark.parametrize(
    ("name", "compiled"), [("everything", {ONE, ALL}), ("slider_crank/air", {ONE}), ("expander/point", {ONE, ALL})]
)
def test_every_index_lies_within_its_array(request, name, compiled):
    """Both closings of a scene are functions of one module, most of them the same."""
    closings = ["numerics.closing=histories"], ["numerics.closing=coupled"]
    scenes = [screwsim.load(CONFIGS / f"{name}.yaml", each) for each in closings]
    plain = [screwsim.simulate(scene) for scene in scenes]
    modules = request.getfixturevalue("checked")
    for scene, without in zip(scenes, plain, strict=True):
        found = screwsim.simulate(scene)
        assert found.status == "ok"
        figures = found.performance, found.numerics.rhs_evaluations
        assert figures == (without.performance, without.numerics.rhs_evaluations)
    assert compiled <= {function for module in modules.values() for function in module.made}
