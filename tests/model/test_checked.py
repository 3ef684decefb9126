"""Compiled text stays within its arrays: the shipped scenes, with every index checked, give the same bits."""

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
        def __init__(self, name, text):
            super().__init__(name, text, checks=True)

    monkeypatch.setattr(modules, "Module", Checked)
    monkeypatch.setattr(modules, "_loaded", {})
    monkeypatch.setattr(leases, "_free", {})
    return modules._loaded


@pytest.mark.parametrize("name", ["everything", "slider_crank/air", "expander/point"])
@pytest.mark.parametrize("closing", ["histories", "coupled"])
def test_every_index_lies_within_its_array(request, name, closing):
    scene = screwsim.load(CONFIGS / f"{name}.yaml", [f"numerics.closing={closing}"])
    plain = screwsim.simulate(scene)
    compiled = request.getfixturevalue("checked")
    found = screwsim.simulate(scene)
    assert any("rodas__integrate_one" in module.made for module in compiled.values())
    assert found.status == "ok"
    assert (found.performance, found.numerics.rhs_evaluations) == (plain.performance, plain.numerics.rhs_evaluations)
