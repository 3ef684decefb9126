"""`screwsim validate`: a small source of its own in a folder, what it shows, and how it ends."""

import json
import re
from pathlib import Path

import pytest

import screwsim
from screwsim import cli
from screwsim.inputs.faults import Interrupted, UsageError
from screwsim.study.validation import document, equal, folder_of, names_of, run_sources, trend
from screwsim.study.validation.record import Row, report, row_text, summary

SOURCE = """\
from screwsim.study.validation import Comparison, NotRun, Panel, Series, equal, trend

def compare(here):
    rows = [
        equal("near", 1.01, 1.0, 0.02, "published", unit="bar", basis="stated"),
        equal("far", 1.5, 1.0, 0.02, "published"),
        equal("another machine", 1.5, 1.0, 0.02, "published", comparable=False),
        trend("over speed", "falls", "rises", False),
    ]
    band = Series("spread", [1.0, 2.0], [0.9, 1.4], upper=[1.1, 1.6])
    series = (Series("ours", [1.0, 2.0], [1.0, 1.5]), band, Series("theirs", [1.0], [1.0], theirs=True, error=0.02))
    return Comparison("A small source", "nobody", "about", rows, (Panel("x", "y", series),))
"""
REFUSING = (
    "from screwsim.study.validation import NotRun\ndef compare(here):\n    raise NotRun('its scene does not close')\n"
)


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """Work below a checkout, that of the running package, which has validation/small."""
    (tmp_path / "validation" / "small").mkdir(parents=True)
    (tmp_path / "validation" / "small" / "compare.py").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "pyproject.toml").write_text('[project]\nname = "screwsim"\n', encoding="utf-8")
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    monkeypatch.setattr("screwsim.study.validation.PACKAGE_FOLDER", tmp_path / "src" / "screwsim")
    return tmp_path


@pytest.fixture
def trap(tmp_path, monkeypatch):
    """Work below a folder of somebody's whose validation/ holds a program; return what it would leave."""
    (tmp_path / "validation" / "trap").mkdir(parents=True)
    program = f"open({str(tmp_path / 'ran')!r}, 'w').close()\n" + SOURCE
    (tmp_path / "validation" / "trap" / "compare.py").write_text(program, encoding="utf-8")
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    return tmp_path / "ran"


def run(capsys, *arguments):
    code = cli.exit_code(("validate", *arguments))
    return code, *capsys.readouterr()


def test_the_folder_is_that_of_the_running_checkout(checkout, monkeypatch):
    monkeypatch.chdir("/")
    assert folder_of() == checkout / "validation"
    assert names_of(folder_of()) == ["small"]


def test_an_interruption_keeps_the_sources_that_were_compared(checkout, capsys):
    stopped = checkout / "validation" / "stopped"
    stopped.mkdir()
    (stopped / "compare.py").write_text("def compare(here):\n    raise KeyboardInterrupt\n", encoding="utf-8")
    code, out, err = run(capsys, "small", "stopped", "--jobs", "1", "-o", "kept")
    assert code == 130 and err.strip().endswith("interrupted")
    assert "stopped: not run: interrupted" in out and "small: A small source" in out
    kept = Path("kept/validation.json")
    assert json.loads(kept.read_text(encoding="utf-8"))["sources"]["small"]["status"] == "ok"
    assert run(capsys, "small", "--jobs", "1", "-o", "kept")[0] == 0
    whole = kept.read_text(encoding="utf-8")
    code, _, err = run(capsys, "small", "stopped", "--jobs", "1", "-o", "kept")
    assert code == 130 and "validation.json: stays as it was" in err
    assert kept.read_text(encoding="utf-8") == whole  # what an interruption leaves replaces nothing
    assert run(capsys, "stopped", "--jobs", "1")[0] == 130


def test_failing_verdicts_are_shown_and_are_no_error(checkout, capsys):
    code, out, _ = run(capsys)
    assert code == 0
    lines = {line.split()[0]: line for line in out.splitlines() if line.strip()}
    assert lines["near"].split()[-1] == "holds"
    assert lines["far"].split()[-1] == "fails"
    assert lines["another"].endswith("no verdict")
    assert lines["over"].split()[-1] == "fails"
    assert "1 of 3 judged comparisons hold, 2 fail; 1 have no verdict" in out


def test_json_is_one_document_on_stdout(checkout, capsys):
    code, out, _ = run(capsys, "--json", "-o", str(checkout / "out"))
    found = json.loads(out)
    assert code == 0
    assert found["verdicts"] == {"holds": 1, "fails": 2, "no verdict": 1}
    assert found["sources"]["small"]["rows"][1]["verdict"] == "fails"
    assert set(found["seconds"]) == {"small"}


def test_files_are_written_and_keep_no_times(checkout, capsys):
    code, out, _ = run(capsys, "-o", "out/here")
    assert code == 0
    folder = checkout / "below" / "out" / "here"
    assert {path.name for path in folder.iterdir()} == {"validation.json", "small.png", "small.pdf"}
    assert "seconds" not in json.loads((folder / "validation.json").read_text(encoding="utf-8"))
    assert out.rstrip().endswith("small.pdf")


def test_a_source_that_cannot_run_says_why_and_ends_with_4(checkout, capsys):
    (checkout / "validation" / "open").mkdir()
    (checkout / "validation" / "open" / "compare.py").write_text(REFUSING, encoding="utf-8")
    code, out, _ = run(capsys)
    assert code == 4
    assert "open: not run: its scene does not close" in out
    assert "A small source" in out


@pytest.mark.parametrize(
    ("program", "told"),
    [
        ("def compare(here):\n    return {}['x']\n", "compare.py:2: fails (KeyError: 'x'); fix that program"),
        ("def compare(here:\n", "compare.py: fails (SyntaxError: '(' was never closed (compare.py, line 1))"),
        ("x = 1\n", "has no attribute 'compare'); fix that program"),
        ("def compare(here):\n    pass\n", "compare.py: compare returns a NoneType (return a Comparison)"),
        (
            "from screwsim.study.validation import solved\ndef compare(here):\n    solved(here / 'm.yaml')\n",
            "m.yaml:1:1: cannot be read: No such file",
        ),
    ],
)
def test_a_source_whose_program_is_wrong_says_where_and_leaves_the_others(checkout, capsys, program, told):
    wrong = checkout / "validation" / "wrong"
    wrong.mkdir()
    (wrong / "compare.py").write_text(program, encoding="utf-8")
    code, out, err = run(capsys, "--jobs", "1")
    assert (code, err) == (4, "")
    assert "wrong: not run: " in out and told in out and "A small source" in out


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (
            "record.row_text(None)",
            r"compare\.py:5: fails \(TypeError: .*\); it is a fault of screwsim, raised at "
            r"screwsim/study/validation/record\.py:\d+: please report it with that program",
        ),
        ("screwsim.simulatee", r"compare\.py:5: fails \(AttributeError: .*\); fix that program"),
        ("Figures(cop=4.0).cpo", r"compare\.py:5: fails \(AttributeError: .*\); fix that program"),
        ("Figures(cop=4.0)['cpo']", r"compare\.py:5: fails \(KeyError: .*\); fix that program"),
    ],
)
def test_a_fault_of_screwsim_is_not_laid_on_the_program_that_met_it(tmp_path, body, told):
    (tmp_path / "wrong").mkdir()
    imports = "import screwsim\nfrom screwsim.outputs import Figures\nfrom screwsim.study.validation import record"
    (tmp_path / "wrong" / "compare.py").write_text(f"{imports}\ndef compare(here):\n    {body}\n", encoding="utf-8")
    (outcome,) = run_sources(tmp_path)
    assert outcome.comparison is None
    assert re.fullmatch(rf"{re.escape(str(tmp_path / 'wrong'))}.{told}", outcome.reason), outcome.reason


def test_an_unknown_name_is_one_line_with_the_nearest(checkout, capsys):
    code, out, err = run(capsys, "smal")
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert "did you mean small?" in err


@pytest.mark.parametrize("project", [None, '[project]\nname = "other"\n', "no TOML ["])
def test_without_a_checkout_nothing_is_run_and_one_line_says_where_it_is(trap, project, monkeypatch, capsys):
    monkeypatch.setattr("screwsim.study.validation.PACKAGE_FOLDER", trap.parent / "src" / "screwsim")
    if project is not None:
        (trap.parent / "pyproject.toml").write_text(project, encoding="utf-8")
    code, out, err = run(capsys)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert "checkout" in err
    assert "--folder" in err
    assert not trap.exists()


def test_programs_beside_the_working_folder_are_not_run(trap, capsys):
    assert folder_of() == Path(screwsim.__file__).resolve().parents[2] / "validation"
    code, out, err = run(capsys, "trap")
    assert (code, out) == (2, "")
    assert "trap: no source of that name" in err
    assert not trap.exists()


def test_programs_of_a_folder_that_is_named_are_run(trap, capsys):
    code, out, _ = run(capsys, "--folder", str(trap.parent / "validation"))
    assert code == 0
    assert "A small source" in out
    assert trap.exists()


def test_a_folder_without_sources_is_refused(tmp_path):
    with pytest.raises(UsageError, match="holds no sources"):
        folder_of(tmp_path)


def test_only_the_named_sources_run(checkout):
    (checkout / "validation" / "open").mkdir()
    (checkout / "validation" / "open" / "compare.py").write_text(REFUSING, encoding="utf-8")
    assert [each.name for each in run_sources(folder_of(), ["small"])] == ["small"]


def test_sources_give_the_same_one_after_the_other_and_at_once(checkout):
    for name in ("open", "third"):
        (checkout / "validation" / name).mkdir()
        text = REFUSING if name == "open" else SOURCE
        (checkout / "validation" / name / "compare.py").write_text(text, encoding="utf-8")
    one, two = (document(run_sources(folder_of(), jobs=jobs)) for jobs in (1, 2))
    assert one == two
    assert list(one["sources"]) == ["open", "small", "third"]


def test_the_verdict_turns_at_the_uncertainty():
    assert equal("x", 1.2, 1.0, 0.25, "published").verdict == "holds"
    assert equal("x", 1.3, 1.0, 0.25, "published").verdict == "fails"
    assert equal("x", 1.0, 1.0, None, "published").verdict == "no verdict"
    assert trend("x", "rises", "rises", True).verdict == "holds"


def test_kinds_and_verdicts_are_those_listed():
    with pytest.raises(ValueError, match="guess"):
        Row("x", 1.0, 1.0, "guess", "holds")
    with pytest.raises(ValueError, match="maybe"):
        Row("x", 1.0, 1.0, "exact", "maybe")


def test_long_words_stand_below_the_row():
    text = row_text(vars(trend("x", "1.0, 1.1, 1.2, 1.3, 1.4", "rises", True)))
    assert "below" in text[0]
    assert any("ours: 1.0, 1.1, 1.2, 1.3, 1.4" in line for line in text[1:])


def test_fitted_numbers_are_no_evidence(checkout):
    found = document(run_sources(folder_of()))
    rows = found["sources"]["small"]["rows"]
    for row in rows:
        row["kind"] = "calibrated"
    assert summary(found).startswith("0 of 0 judged comparisons hold")
    assert "4 are fitted or estimates" in report(found)


def test_an_interruption_is_raised_with_the_sources_that_were_compared(checkout):
    stopped = checkout / "validation" / "stopped"
    stopped.mkdir()
    (stopped / "compare.py").write_text("def compare(here):\n    raise KeyboardInterrupt\n", encoding="utf-8")
    with pytest.raises(Interrupted) as raised:
        run_sources(folder_of(), ["small", "stopped"])
    assert [(each.name, each.reason) for each in raised.value.found] == [("small", ""), ("stopped", "interrupted")]
