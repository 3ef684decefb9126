"""The page on goal seek and optimisation is true: its piece of Python runs, names and numbers are the code's."""

import json
import re

import pytest
from folders import ROOT

from screwsim.study.optimize.seasons import standards

pytestmark = pytest.mark.around
PAGE = (ROOT / "docs" / "how-to" / "find-and-optimize.md").read_text(encoding="utf-8")
WORDS = " ".join(PAGE.split())  # wherever its lines break
(PIECE,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.M | re.S)


def test_the_piece_of_python_runs(monkeypatch):
    monkeypatch.chdir(ROOT)
    names: dict = {}
    exec(PIECE, names)
    assert names["found"].status == "ok" and names["width"] < 1e-3 * names["speed"]
    assert names["scene"].operation.speed == names["speed"]
    assert names["best"].status == "ok"


def test_every_seasonal_figure_is_named():
    named = {name.removesuffix("-water").removesuffix("-brine") for name in standards()}
    assert named == {"IPLV", "ESEER", "SEER", "SEPR", "SCOP-35", "SCOP-55"}
    assert all(f"`{name}`" in PAGE for name in (*named, "-water", "-brine"))


def test_the_benchmark_has_the_numbers_of_the_page():
    found = json.loads((ROOT / "benchmarks" / "optimize_front.json").read_text())
    assert found["samples"] == found["samples_beaten_without_errors"] == 10_000
    assert found["evaluations"] == 1000 and f"by the {found['front']} evaluations of the front" in WORDS
    ours, theirs = found["best_isothermal_efficiency"]
    assert f"{100 * ours:.1f} % (samples: {100 * theirs:.1f} %)" in WORDS
    ours, theirs = found["best_gas_mass_flow"]
    assert f"{ours:.4f} kg/s ({theirs:.4f} kg/s)" in WORDS
    assert found["hypervolume_of_front"] > found["hypervolume_of_samples"]


@pytest.mark.parametrize("option", re.findall(r"`(--[a-z-]+)", PAGE))
def test_every_option_that_is_named_is_there(option, capsys):
    from screwsim.cli import exit_code

    helps = []
    for command in ("find", "optimize", "run"):
        exit_code([command, "--help"])
        helps.append(capsys.readouterr().out)
    assert any(option in text for text in helps)
