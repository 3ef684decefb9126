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


def test_a_fluid_that_does_not_condense_is_refused_where_the_temperature_is_stated(capsys):
    """Effects that ask for the condenser's pressure leave it to the check of the operation."""
    everything = str(Path(B).parents[1] / "everything.yaml")
    assert exit_code(["run", everything, "--set", "gas.fluid=CO2"]) == 3
    _, err = capsys.readouterr()
    place, _, what = err.strip().splitlines()[-1].partition(": operation.condensing_temperature: ")
    assert place.endswith("point.yaml:36:27") and "not below the critical temperature of CO2" in what
