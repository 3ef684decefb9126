"""Odd letters: what steers a terminal is shown and not sent; half letters and null characters are faults."""

import json
import re

import pytest
import report_fakes
from result_fakes import GRID, SCENE

from screwsim.cli import options
from screwsim.inputs.faults import SceneError
from screwsim.printing import print_result
from screwsim.printing.stages import print_stages
from screwsim.scene import loads
from screwsim.screen import json_safe, printable
from screwsim.study.stages import ChainResult

STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e]")
HOSTILE = "\x1b]0;owned\x07\x1b[31mred\x9b1m\u202egpj"
ESCAPED = r"\x1b]0;owned\x07\x1b[31mred\x9b1m\u202egpj"


def titled(title: str) -> str:
    return SCENE.replace("title: fake", f"title: {json.dumps(title)}")


def test_letters_that_say_something_stay_as_they_are():
    text = "η = 0.5 – R134a, 20 µm, 😀\n\ttab"
    assert printable(text) == text
    assert json_safe(text) == text


def test_json_means_the_same_without_steering():
    text = json.dumps({"title": HOSTILE + "\ud800"}, ensure_ascii=False)
    safe = json_safe(text)
    assert not STEERING.search(safe)
    assert json.loads(safe) == {"title": HOSTILE + "\ud800"}
    safe.encode()


@pytest.mark.parametrize("verb", ["explain", "plot", "compare", "compare --json", "map"])
def test_no_text_of_a_file_steers_the_terminal(verb, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = "a\x1b[2Jb"
    (tmp_path / f"{name}.yaml").write_text(titled(HOSTILE), encoding="utf-8")
    report_fakes.file(tmp_path / f"{name}.h5", titled(HOSTILE))
    arguments = {"explain": [f"{name}.yaml"], "compare": [f"{name}.h5"] * 2, "plot": [f"{name}.h5"]}
    arguments |= {"compare --json": [*arguments["compare"], "--json"], "map": arguments["plot"]}
    answer = command(verb.split()[0], *arguments[verb])
    assert answer.out + answer.err
    assert not STEERING.search(answer.out + answer.err)


def test_a_title_is_printed_with_its_controls_written_out(capsys):
    print_result(HOSTILE, report_fakes.ok(loads(SCENE)))
    assert capsys.readouterr().out.startswith(ESCAPED)
    print_stages(HOSTILE, ChainResult("failed", HOSTILE))
    assert capsys.readouterr().out.startswith(f"{ESCAPED}\nstatus: failed; {ESCAPED}")


def test_a_sweep_left_aside_is_told_without_steering(capsys):
    options.report_ignored_sweep(loads(SCENE + GRID), f"{HOSTILE}.yaml: its", "a remedy")
    told = capsys.readouterr().err
    assert told.startswith(f"{ESCAPED}.yaml: its sweep of ") and not STEERING.search(told)


def test_arguments_that_make_no_sense_are_shown_without_steering(command):
    answer = command("run", "x.yaml", "y\x1b[31m")
    assert answer.code == 2
    assert r"y\x1b[31m" in answer.err
    assert not STEERING.search(answer.err)


def test_a_scene_in_json_has_whole_letters():
    title = "compressor 😀 𝜂"
    assert "\\ud83d" in json.dumps(title)
    scene = loads(titled(title))
    assert scene.title == title
    assert loads(scene.text).title == title


@pytest.mark.parametrize(
    ("letters", "what"),
    [("\\ud83d", "half a letter (a lone surrogate)"), ("\\0", "a null character"), ("\\u0000", "a null character")],
)
def test_half_letters_and_null_characters_are_faults_where_they_stand(letters, what):
    with pytest.raises(SceneError) as caught:
        loads(SCENE.replace("title: fake", f'title: "x{letters}"'))
    assert caught.value.lines == [f"<text>:1:8: title: contains {what} (remove it)"]
    with pytest.raises(SceneError) as caught:
        loads(SCENE + f'  "x{letters}": {{}}\n')
    assert any(f"effects: contains {what} (remove it)" in line for line in caught.value.lines)


def test_an_anchor_may_be_given_again():
    assert loads(SCENE.replace("{gap: 50 um}", "{gap: &a 50 um, flow_coefficient: &a 0.7}")).effects


def test_a_long_key_does_not_fill_the_screen():
    with pytest.raises(SceneError) as caught:
        loads(SCENE + "x" * 5000 + ": 1\n")
    assert all(len(line) < 1000 for line in caught.value.lines)
