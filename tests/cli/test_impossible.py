"""States that cannot be: what a person reads of them in a terminal."""

from pathlib import Path

import pytest

from screwsim.cli import exit_code

B = str(Path(__file__).parents[2] / "configs" / "rotors" / "b.yaml")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("operation.subcooling=44 K", "colder than the evaporator of 2 degC"),
        ("effects.tip_leakage.gap=80 mm", "80 mm is 2.5 times the height of a lobe, which is impossible"),
        ("effects.interlobe_leakage.gap=40 mm", "40 mm is 1.25 times the height of a lobe, which is impossible"),
    ],
)
def test_an_impossible_state_is_refused_before_anything_is_solved(change, told, capsys):
    assert exit_code(["run", B, "--set", change]) == 3
    out, err = capsys.readouterr()
    assert out == "" and len(err.strip().splitlines()) == 1
    assert told in err and "Traceback" not in err
