"""Every block of code of the pages is run, or held against what reads it; notes: tests/docs/snippets.py."""

import ast
import csv
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import calls
import programs
import pytest
import yaml
from shown import commands, lines, missing
from snippets import PAGES, ROOT, SHELL, blocks, named_commands, run_together, unchecked

import screwsim
from screwsim import cli
from screwsim.scene import load
from screwsim.study.calibration.read import read_fit
from screwsim.study.stages import read_stages

pytestmark = pytest.mark.around

# pages whose blocks of a language (None: all) another test runs
ELSEWHERE = {
    ("docs/start/tutorial.md", None): "test_tutorial.py",
    ("docs/gallery.md", "python"): "test_site.py",
    ("docs/how-to/python.md", "python"): "test_python.py",
    ("docs/how-to/find-and-optimize.md", "python"): "test_find_and_optimize.py",
    ("docs/how-to/adding-an-effect.md", "python"): "test_adding_an_effect.py",
    ("docs/how-to/adding-an-effect.md", "yaml"): "test_adding_an_effect.py",
}
# commands that run long, by the words with which they begin: their options, files and scenes are read, and no more, but
# where SCREWSIM_LONG_SNIPPETS is set, as in .ci/run
LONG = (
    "screwsim accuracy",
    "screwsim calibrate",
    "screwsim datasheet configs/control/point.yaml --evap",  # as the one above it on its page
    "screwsim diagnose",
    "screwsim export fmu",
    "screwsim find best.yaml",
    "screwsim optimize",
    "screwsim plan",
    "screwsim rotors configs",
    "screwsim sensitivity configs/paper/point.yaml --set",  # indices of Sobol, from 1536 solutions
    "screwsim startup",
    "screwsim sweep configs/co2",
    "screwsim sweep configs/paper",
    "screwsim sweep configs/r454b",
    "screwsim validate",
)
STAYS = "screwsim explore"  # until it is interrupted
DRAWN = ("screwsim optimize", "--posterior", "--predict")  # chains and generations differ by processor
RUN_LONG = bool(os.environ.get("SCREWSIM_LONG_SNIPPETS"))
INSTALLS = ("pip install", "python3 -m venv")  # run by test_installing.py
CALL = re.compile(r"(?<!# )(?<!\S)screwsim (?=[a-z])[^;'&\n]+")  # within lines of a shell


def name_of(page):
    return page.relative_to(ROOT).as_posix()


def elsewhere(block):
    return ELSEWHERE.get((block.page, None)) or ELSEWHERE.get((block.page, block.language))


class Page:
    """A page that is gone through from its first line to its last, in a folder with what the checkout has."""

    def __init__(self, capsys):
        self.capsys = capsys
        self.names: dict = {}
        self.promised: set[str] = set()  # files that commands would write which are not run
        self.printed: list[str] = []

    def check(self, block):
        if "given" in block.notes:
            exec(compile(block.notes["given"], block.place, "exec"), self.names)
        if block.file is not None:
            Path(block.file).parent.mkdir(parents=True, exist_ok=True)
            Path(block.file).write_text(block.text, encoding="utf-8")
        if "printed above" in block.notes:
            assert self.printed, "no command above is run"
            self.compare(lines(block.text), "above")
        elif reason := block.notes.get("not run,", block.notes.get("long,")):
            self.read(block, reason)
            if RUN_LONG and "long," in block.notes:
                self.run_whole(block)
        elif block.kind == "noted":
            rows = list(csv.reader(block.text.splitlines()))
            assert len({len(row) for row in rows}) == 1 < len(rows)
        elif block.kind == "python":
            exec(compile(block.text, block.place, "exec"), self.names)
            self.capsys.readouterr()
        elif block.kind == "yaml":
            self.load(block)
        elif block.kind == "shell":
            for command, shown in commands(block.text):
                self.command(command, shown)

    def read(self, block, reason):
        """Hold a block that is not run against what reads it."""
        assert len(reason.split()) > 3, "a note says why"
        if block.language == "python":
            ast.parse(block.text)
        elif block.language == "yaml":
            yaml.safe_load(block.text)
        elif block.language in SHELL and shutil.which("bash"):
            subprocess.run(["bash", "-n"], input=block.text, text=True, check=True)
        if block.language in ("", *SHELL):
            for line in CALL.findall(block.text):
                calls.taken(shlex.split(line)[1:])

    def run_whole(self, block):
        """Run a block as one script."""
        if block.language == "python":
            exec(compile(block.text, block.place, "exec"), {"screwsim": screwsim} | self.names)
        else:
            programs.run_script(block.text, Path.cwd())

    def load(self, block):
        """Load a scene, the part of one, what is fitted to what, or two stages."""
        within, file = block.notes.get("part of"), Path(block.file or "part.yaml")
        if within is not None:
            assert Path(within).is_file() and not re.search("^base:", block.text, re.M)
            file.write_text(f"base: {within}\n{block.text}", encoding="utf-8")
        elif block.file is None:
            file.write_text(block.text, encoding="utf-8")
        if "stages" in (written := yaml.safe_load(block.text)):
            read_stages(str(file), ())
        elif "parameters" in written:
            read_fit(file)
        else:
            load(file)

    def compare(self, shown, said):
        """Hold lines of the page against the output, or against that and the lines for the user behind it."""
        end = self.printed.index("")
        wrong = missing(shown, self.printed[:end])
        if shown and wrong is not None:
            line = missing(shown, self.printed[:end] + self.printed[end + 1 :])
            assert line is None, f"{said}: {wrong}"

    def command(self, command, shown):
        if calls.is_synopsis(command):
            for each in calls.written_out(command):
                calls.taken(shlex.split(each)[1:])
            return
        words = shlex.split(command, comments=True)
        words[0] = words[0].removeprefix(".venv/bin/") if words[0].endswith("screwsim") else words[0]
        said = " ".join(words)
        if words[0] != "screwsim":
            if not said.startswith(INSTALLS):
                programs.run(said, Path.cwd(), RUN_LONG)
            return
        arguments, into = (words[1:-2], words[-1]) if words[-2] == ">" else (words[1:], None)
        if said.startswith(STAYS):
            calls.check(arguments, self.promised)
            programs.open_page(words, Path.cwd())
            return
        if (not RUN_LONG and said.startswith(LONG)) or self.promised & set(arguments):
            parameters = calls.check(arguments, self.promised)
            self.promised |= {str(parameters.get(name)) for name in ("output", "best")} - {"None"}
            return
        code = cli.exit_code(arguments)
        told = self.capsys.readouterr()
        assert code == 0 or (shown and code in (3, 4)), f"{said}: {code}, {told.err}"
        if into is not None:
            Path(into).write_text(told.out, encoding="utf-8")
        self.printed = [*lines(told.out), "", *lines(told.err)]
        if not any(words in said for words in DRAWN):
            self.compare(shown, said)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Be in a folder that has the files of the checkout that pages name, on one core: no command starts workers."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    for name in ("configs", "validation"):  # what commands may write to
        shutil.copytree(ROOT / name, tmp_path / name)
    for name in ("scripts", "benchmarks", "docs/tools"):  # each finds what it writes to from where it lies
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    os.symlink(ROOT / "tests", tmp_path / "tests")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page)], ids=lambda page: page.relative_to(ROOT).as_posix()
)
def test_every_block_of_the_page_is_true(page, folder, capsys):
    found, wrong = Page(capsys), []
    for block in blocks(page):
        if elsewhere(block) is None:
            try:
                found.check(block)
            except Exception as error:  # noqa: BLE001 - whatever it is, the page is wrong there
                wrong.append(f"{block.place}: {type(error).__name__}: {error}")
    assert not wrong, "\n".join(wrong)


def all_commands():
    return [
        " ".join(shlex.split(command, comments=True)).removeprefix(".venv/bin/")
        for page in PAGES
        for block in blocks(page)
        if block.kind == "shell"
        for command, _ in commands(block.text)
    ]


def test_no_block_is_without_a_check():
    assert [place for page in PAGES for place in unchecked(blocks(page))] == []


def test_no_block_is_prose():
    assert [place for page in PAGES for place in run_together(page)] == []
    below_a_list = "- one\n\n    $ screwsim run x.yaml\n    …\n"
    assert run_together(ROOT / "README.md", below_a_list) == ["README.md:3"]
    assert run_together(ROOT / "README.md", below_a_list.replace("    ", "      ")) == []


def test_a_block_that_nobody_checks_is_seen():
    page = ROOT / "README.md"
    text = "```text\nwhat\n```\n\n<!-- snippet: not run, it is nothing to run -->\n\n    what\n\n    else\n"
    assert unchecked(blocks(page, text)) == ["README.md:1"]
    assert unchecked(blocks(page, "# A\n\n    a, formula\n")) == ["README.md:3"]
    assert unchecked(blocks(page, "    screwsim run x.yaml\n")) == []


def test_what_is_left_out_is_still_on_a_page():
    said = all_commands()
    for begin in (*LONG, *INSTALLS, *programs.PROGRAMS):
        assert any(each.startswith(begin) for each in said), begin


@pytest.mark.parametrize(("place", "test"), ELSEWHERE.items(), ids=str)
def test_a_page_of_another_test_is_read_there(place, test):
    page, language = place
    text = (ROOT / "tests" / "docs" / test).read_text(encoding="utf-8")
    assert Path(page).name in text and (language is None or language in text or "gallery(" in text)
    assert any(elsewhere(block) == test for block in blocks(ROOT / page))


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_within_sentences_exist(page):
    for command in named_commands(page):
        calls.exists(command)


def test_extras_that_pages_name_exist():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    named = {
        extra
        for page in PAGES
        for group in re.findall(r"(?:screwsim|'\.)\[([a-z,-]+)\]", page.read_text(encoding="utf-8"))
        for extra in group.split(",")
    }
    assert named and named <= set(extras)
