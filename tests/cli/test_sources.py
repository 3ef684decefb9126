"""What `screwsim explain --sources` says is to be cited."""

import re

import pytest
from folders import CONFIGS, POINT, ROOT
from ruamel.yaml import YAML

from screwsim.cli import exit_code
from screwsim.effects import catalogue
from screwsim.explain.sources import TITLE, source_of, sources
from screwsim.scene import load

YEAR = re.compile(r"\b(?:19|20)\d\d\b")


@pytest.mark.parametrize("effect", catalogue().values(), ids=lambda effect: effect.name)
def test_an_effect_writes_out_every_source_that_it_names_in_short(effect):
    told = source_of(effect)
    assert told and told != effect.source
    assert set(YEAR.findall(effect.source)) <= set(YEAR.findall(told))
    assert "Assumptions:" not in told and "Parameters:" not in told


def test_a_scene_lists_the_program_the_paper_the_gas_and_its_own_effects_alone():
    words = " ".join(sources(load(POINT, ["effects.blow_hole=off"])).split())
    heads = (
        "screwsim version ",
        "balances Chernov et al. 2015: G. I. Chernov",
        "doi:10.1021/ie4033999",
        "tip_leakage Ch",
    )
    places = [words.index(head) for head in heads]
    assert places == sorted(places)
    assert "TillnerRoth-JPCRD-1994 (R134a)" in words
    assert "blow_hole" not in words and "droplets" not in words


def test_a_blend_has_the_equation_of_each_component():
    words = " ".join(sources(load(CONFIGS / "r454b" / "point.yaml")).split())
    assert "TillnerRoth-JPCRD-1997 (R32), Lemmon-IJT-2022 (R1234yf)" in words


def test_the_source_paper_has_one_title_everywhere():
    for page in ("docs/model.md", "docs/explanation/paper.md", "docs/how-to/reproduce.md"):
        words = " ".join((ROOT / page).read_text(encoding="utf-8").replace(">", " ").split())
        assert TITLE in words, page
    cited = YAML(typ="safe").load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["references"][0]["title"] == TITLE


def test_only_one_list_is_printed_at_a_time(capsys):
    assert exit_code(["explain", str(POINT), "--sources", "--parameters"]) == 2
    assert "--parameters and --sources exclude each other" in capsys.readouterr().err
