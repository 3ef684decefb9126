"""Compiled text stays within its arrays: the shipped scenes, with every index checked, give the same bits."""

import math

import pytest
from folders import CONFIGS

import screwsim
from screwsim.codegen import modules
from screwsim.model import leases


@pytest.fixture
def checked(monkeypatch):
    """Let every module be one with checks, under a name of its own; no module of before is taken."""

    class Checked(modules.Module):
        def __init__(self, name, text, **how):
            super().__init__(f"{name}_checked", text, **how)  # a hash of its text: what is kept is of no other

        def _written(self, *what):
            self._checks = True  # and not before: a module of checks keeps nothing
            try:
                return super()._written(*what)
            finally:
                self._checks = False

    monkeypatch.setattr(modules, "Module", Checked)
    monkeypatch.setattr(modules, "PATIENCE", math.inf)  # of the same bits
    monkeypatch.setattr(modules, "_loaded", {})
    monkeypatch.setattr(leases, "_free", {})
    return modules._loaded


ONE, ALL = "rodas__integrate_one", "rodas__integrate_all"  # chamber on its own, chambers together


@pytest.mark.parametrize(
    ("name", "used"), [("everything", {ONE, ALL}), ("slider_crank/air", {ONE}), ("expander/point", {ONE, ALL})]
)
def test_every_index_lies_within_its_array(request, name, used):
    """Both closings of a scene are functions of one module, most of them the same."""
    closings = ["numerics.closing=histories"], ["numerics.closing=coupled"]
    scenes = [screwsim.load(CONFIGS / f"{name}.yaml", each) for each in closings]
    plain = [screwsim.simulate(scene) for scene in scenes]
    loaded = request.getfixturevalue("checked")
    for scene, without in zip(scenes, plain, strict=True):
        found = screwsim.simulate(scene)
        assert found.status == "ok"
        figures = found.performance, found.numerics.rhs_evaluations
        assert figures == (without.performance, without.numerics.rhs_evaluations)
    assert used <= {name for module in loaded.values() for name, each in vars(module).items() if called(each)}


def called(each):
    return isinstance(each, modules.Function) and bool(each._variants)
