"""What lies where a study would write stays, unless it is of the same kind: measured data, results of a sweep."""

import shutil
from pathlib import Path

import pytest

from screwsim.cli import exit_code

CONFIGS = Path(__file__).parents[2] / "configs"
POINT = str(CONFIGS / "paper" / "point.yaml")
FIT = str(CONFIGS / "calibration" / "leakage.fit.yaml")
ROUGH = ["--set", "numerics.accuracy=1e-2", "--set", "numerics.error=none"]
FOUND = ["--vary", "oil_supply.ratio=1..3", "--for", "discharge_temperature=20 degC"]
STUDIES = {
    "optimum": ["optimum", POINT, "--from", "1", "--to", "3", "--jobs", "1", *ROUGH],
    "sensitivity": ["sensitivity", POINT, "--path", "oil_supply.ratio=1..3", "--samples", "2", "--jobs", "1", *ROUGH],
    "sensitivity --local": ["sensitivity", POINT, "--local", "oil_supply.ratio", *ROUGH],
    "find": ["find", POINT, *FOUND, "--jobs", "1", *ROUGH],
}
OTHERS = "is there, and not of the kind that would be written (choose another -o, or remove it)"


@pytest.mark.parametrize("study", STUDIES)
def test_a_study_replaces_its_own_rows_and_no_others(study, tmp_path, capsys):
    mine = tmp_path / "mine.csv"
    mine.write_text("my,data\n1,2\n", encoding="utf-8")
    assert exit_code([*STUDIES[study], "-o", str(mine)]) == 2
    assert f"{mine}: {OTHERS}" in capsys.readouterr().err
    assert mine.read_text(encoding="utf-8") == "my,data\n1,2\n"
    for _ in range(2):  # the second replaces the first
        assert exit_code([*STUDIES[study], "-o", str(tmp_path / "own.csv")]) == 0


@pytest.mark.parametrize("study", STUDIES)
def test_a_study_does_not_replace_the_results_of_a_sweep(study, tmp_path, capsys):
    swept = tmp_path / "swept.h5"
    axis = ["--set", "sweep={oil_supply.ratio: [1, 2]}"]
    assert exit_code(["sweep", POINT, *axis, "--jobs", "1", *ROUGH, "-o", str(swept)]) == 0
    before = swept.read_bytes()
    capsys.readouterr()
    assert exit_code([*STUDIES[study], "-o", str(swept)]) == 2
    assert "choose another -o, or remove it" in capsys.readouterr().err
    assert swept.read_bytes() == before


def test_a_plan_does_not_replace_what_was_measured(tmp_path, capsys):
    """Neither the data of the fit, nor points that it planned itself once a figure is filled in."""
    asked = [
        "plan",
        FIT,
        "--path",
        "operation.speed=1000 rpm..4000 rpm",
        "--levels",
        "2",
        "--count",
        "1",
        "--jobs",
        "1",
    ]
    data, planned = tmp_path / "points.csv", tmp_path / "next.csv"
    shutil.copy(CONFIGS / "calibration" / "points.csv", data)
    assert exit_code([*asked, "-o", str(data)]) == 2
    assert OTHERS in capsys.readouterr().err
    assert data.read_bytes() == (CONFIGS / "calibration" / "points.csv").read_bytes()
    for _ in range(2):  # empty figures are planned anew
        assert exit_code([*asked, "-o", str(planned)]) == 0
    head, row = planned.read_text(encoding="utf-8").splitlines()
    filled = row.split(",")
    filled[head.split(",").index("shaft_power [W]")] = "9850"
    planned.write_text(f"{head}\n{','.join(filled)}\n", encoding="utf-8")
    capsys.readouterr()
    assert exit_code([*asked, "-o", str(planned)]) == 2
    assert f"{planned}: has measured figures, which would be lost (choose another -o)" in capsys.readouterr().err
    assert "9850" in planned.read_text(encoding="utf-8")


def test_a_map_replaces_no_other_document(tmp_path, capsys):
    axes = "sweep={operation.evaporating_temperature: {from: -10 degC, to: 10 degC, count: 4}, "
    axes += "operation.condensing_temperature: {from: 35 degC, to: 50 degC, count: 4}}"
    plain, swept = str(Path(__file__).parents[1] / "plain" / "r134a.yaml"), str(tmp_path / "map.h5")
    assert exit_code(["sweep", plain, "--set", axes, *ROUGH, "--jobs", "1", "-o", swept]) == 0
    for ending, text in ((".csv", "my,data\n"), (".json", "{}\n")):
        mine = tmp_path / f"mine{ending}"
        mine.write_text(text, encoding="utf-8")
        capsys.readouterr()
        assert exit_code(["map", swept, "-o", str(mine)]) == 2
        assert f"{mine}: {OTHERS}" in capsys.readouterr().err
        assert mine.read_text(encoding="utf-8") == text
        for _ in range(2):
            assert exit_code(["map", swept, "-o", str(tmp_path / f"own{ending}")]) == 0
