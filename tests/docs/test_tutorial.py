"""The tutorial is true: its files, commands and Python are run in the order of the page, and print what it shows."""

import re
import shlex
import textwrap

import pytest
from folders import CONFIGS, ROOT
from shown import alike, commands, lines, missing

from screwsim import cli

pytestmark = pytest.mark.around
PAGE = (ROOT / "docs" / "start" / "tutorial.md").read_text(encoding="utf-8")
PIECES = re.compile(r"^```(?P<language>\w+)\n(?P<text>.*?)^```$|(?P<shell>(?:^    [^\n]*\n|^\n(?=    ))+)", re.M | re.S)


def run_python(text: str, capsys) -> None:
    """Run lines of Python; what a line prints begins with what stands behind its `#`."""
    exec(compile(text, "tutorial", "exec"), {})
    shown = [line.partition("  # ")[2] for line in text.splitlines() if line.startswith("print")]
    printed = lines(capsys.readouterr().out.replace("[", "").replace("]", ""))
    for one, other in zip(shown, printed, strict=True):
        words = other.split()
        assert alike(" ".join(one.replace("[", "").replace("]", "").split()[: len(words)]), other), other


@pytest.mark.slow
def test_the_page_runs_from_its_first_line_to_its_last(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "configs").symlink_to(CONFIGS)
    ran = 0
    for piece in PIECES.finditer(PAGE):
        if piece["language"] == "yaml":
            name = piece["text"].partition("\n")[0].removeprefix("# ")
            (tmp_path / name).write_text(piece["text"], encoding="utf-8")
        elif piece["language"] == "python":
            run_python(piece["text"], capsys)
        elif "$ " in piece["shell"]:
            for command, shown in commands(textwrap.dedent(piece["shell"])):
                program, *arguments = shlex.split(command)
                assert program == "screwsim"
                code = cli.exit_code(arguments)
                told = capsys.readouterr()
                assert code == (0 if told.out else 3), command
                assert missing(shown, lines(told.out or told.err)) is None, command
                ran += 1
    assert ran >= 10


def test_what_is_not_printed_is_seen():
    printed = ["status: ok", "shaft power  42.585  kW  5.7e-05", "6 cases: 6 ok, 3.1 s"]
    assert missing(["status: ok", "...", "6 cases: 6 ok, 9.9 s"], printed) is None
    assert missing(["status: ok", "shaft power 42.58 kW 1.0e-05", "..."], printed) is None
    assert missing(["status: failed", "..."], printed) == "status: failed"
    assert missing(["...", "shaft power 42.1 kW 1.0e-05", "..."], printed) is not None
    assert missing(["status: ok"], printed) is not None
