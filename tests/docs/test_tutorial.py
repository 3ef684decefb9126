"""The tutorial is true: its files, commands and Python are run in the order of the page, and print what it shows."""

import re
import shlex
from pathlib import Path

import pytest

from screwsim import cli

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "start" / "tutorial.md").read_text(encoding="utf-8")
PIECES = re.compile(r"^```(?P<language>\w+)\n(?P<text>.*?)^```$|(?P<shell>(?:^    [^\n]*\n|^\n(?=    ))+)", re.M | re.S)
ESTIMATE = re.compile(r"\d\.\de[+-]\d\d")  # of an error: two solvers that are as good differ in it


def commands(shell: str) -> list[tuple[str, list[str]]]:
    """Return the commands of a block, each with the lines shown under it."""
    found: list[tuple[str, list[str]]] = []
    for line in (line.removeprefix("    ").rstrip() for line in shell.splitlines()):
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif line and found:
            found[-1][1].append(line)
    return found


def alike(shown: str, printed: str) -> bool:
    """Tell whether a line is the shown one, numbers within the accuracy; times and estimates are only to be there."""
    ours, theirs = shown.split(), printed.split()
    return len(ours) == len(theirs) and all(
        _same(a, b, later) for a, b, later in zip(ours, theirs, [*ours[1:], ""], strict=True)
    )


def _same(shown: str, printed: str, later: str) -> bool:
    if ESTIMATE.fullmatch(shown):
        return ESTIMATE.fullmatch(printed) is not None
    try:
        return later == "s" or float(printed) == pytest.approx(float(shown.strip("[]")), rel=1e-3)
    except ValueError:
        return shown == printed


def missing(shown: list[str], printed: list[str]) -> str | None:
    """Return the first line of the page that is not printed in its place; anything may stand for `...`."""
    place, anywhere = 0, False
    for line in shown:
        if line == "...":
            anywhere = True
            continue
        while anywhere and place < len(printed) and not alike(line, printed[place]):
            place += 1
        if place == len(printed) or not alike(line, printed[place]):
            return line
        place, anywhere = place + 1, False
    return None if anywhere or place == len(printed) else f"{printed[place]!r}, which is not on the page"


def lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.splitlines() if line.strip()]


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
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    ran = 0
    for piece in PIECES.finditer(PAGE):
        if piece["language"] == "yaml":
            name = piece["text"].partition("\n")[0].removeprefix("# ")
            (tmp_path / name).write_text(piece["text"], encoding="utf-8")
        elif piece["language"] == "python":
            run_python(piece["text"], capsys)
        else:
            for command, shown in commands(piece["shell"]):
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
