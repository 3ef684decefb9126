"""The body of a release is its section of the changelog."""

import pytest
from folders import ROOT

from screwsim.study.validation import sibling

CHANGELOG = """# Changelog

## 1.1.0 (unreleased)

- New.

## 1.0.0

- One,
  over two lines.
- Two: `## not a heading`.

### Removed

- Three.

## 0.9.0

"""


@pytest.fixture
def notes(tmp_path, capsys):
    """Return a function that runs the script on a small changelog: (exit code, output, errors)."""
    module = sibling(ROOT / "scripts" / "release_notes.py")
    file = tmp_path / "CHANGELOG.md"
    file.write_text(CHANGELOG)

    def call(*arguments: str) -> tuple[int, str, str]:
        code = module.main(arguments, file)
        return (code, *capsys.readouterr())

    return call


@pytest.mark.parametrize("name", ["1.0.0", "v1.0.0"])
def test_a_section_is_printed_whole_and_alone(notes, name):
    body = "- One,\n  over two lines.\n- Two: `## not a heading`.\n\n### Removed\n\n- Three.\n"
    assert notes(name) == (0, body, "")


def test_what_is_not_released_yet_is_said(notes):
    code, text, told = notes("1.1.0")
    assert (code, text) == (0, "- New.\n") and "(unreleased): change that before the tag" in told


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["2.0.0"], "no section of 2.0.0 (it has 1.1.0, 1.0.0, 0.9.0"),
        (["0.9.0"], "is empty"),
        ([], "usage"),
        (["-h"], "usage"),
    ],
)
def test_what_cannot_be_printed_is_one_line(notes, arguments, says):
    code, text, told = notes(*arguments)
    assert (code, text) == (2, "") and says in told and told.count("\n") == 1
