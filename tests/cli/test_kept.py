"""What lies where a study would write stays, unless it is of the same kind: measured data, results of a sweep."""

import itertools
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from screwsim.cli import exit_code
from screwsim.study import datasheet

CONFIGS = Path(__file__).parents[2] / "configs"
POINT = str(CONFIGS / "paper" / "point.yaml")
FIT = str(CONFIGS / "calibration" / "leakage.fit.yaml")
ROUGH = ["--set", "numerics.accuracy=1e-2", "--set", "numerics.error=none"]
AS_ROUGH = [*ROUGH, "--set", "numerics.rtol=1e-3"]  # where a search would ask for more and more
FOUND = ["--vary", "oil_supply.ratio=1..3", "--for", "discharge_temperature=20 degC"]
STUDIES = {
    "optimum": ["optimum", POINT, "--from", "1", "--to", "3", "--jobs", "1", *AS_ROUGH],
    "sensitivity": ["sensitivity", POINT, "--path", "oil_supply.ratio=1..3", "--samples", "2", "--jobs", "1", *ROUGH],
    "sensitivity --local": ["sensitivity", POINT, "--local", "oil_supply.ratio", *ROUGH],
    "find": ["find", POINT, *FOUND, "--jobs", "1", *ROUGH],
}
OTHERS = "already exists, and is not a file of this kind (choose another -o, or remove it)"


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
    filled[head.split(",").index("shaft_power [kW]")] = "9.850"
    planned.write_text(f"{head}\n{','.join(filled)}\n", encoding="utf-8")
    capsys.readouterr()
    assert exit_code([*asked, "-o", str(planned)]) == 2
    assert (
        f"{planned}: holds measured figures, which would be overwritten (choose another -o)" in capsys.readouterr().err
    )
    assert "9.850" in planned.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    axes = "sweep={operation.evaporating_temperature: {from: -10 degC, to: 10 degC, count: 4}, "
    axes += "operation.condensing_temperature: {from: 35 degC, to: 50 degC, count: 4}}"
    plain, file = str(Path(__file__).parents[1] / "plain" / "r134a.yaml"), tmp_path_factory.mktemp("map") / "map.h5"
    assert exit_code(["sweep", plain, "--set", axes, *ROUGH, "--jobs", "1", "-o", str(file)]) == 0
    return str(file)


def test_a_map_replaces_no_other_document(swept, tmp_path, capsys):
    for ending, text in ((".csv", "my,data\n"), (".json", "{}\n")):
        mine = tmp_path / f"mine{ending}"
        mine.write_text(text, encoding="utf-8")
        capsys.readouterr()
        assert exit_code(["map", swept, "-o", str(mine)]) == 2
        assert f"{mine}: {OTHERS}" in capsys.readouterr().err
        assert mine.read_text(encoding="utf-8") == text
        for _ in range(2):
            assert exit_code(["map", swept, "-o", str(tmp_path / f"own{ending}")]) == 0


def unit_of_another(path):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", '<fmiModelDescription generationTool="another"/>')


BUILDING = '{"Version": {}, "Curve:Bicubic": {}, "Refrigeration:Compressor": {}, "Zone": {}}'
EXPORTS = {  # the command, and what another program may have under such a name
    "fmu": (["fmu", "--sources-only"], ".fmu", None),
    "modelica": (["modelica"], ".mo", 'package Plant "mine"\nend Plant;\n'),
    "csv": (["csv"], ".csv", "temperature [K],mass_flow [kg/s]\n280,0.1\n"),
    "tespy": (["tespy"], ".json", '{"fluid": "R134a", "maps": []}'),
    "idf": (["energyplus"], ".idf", "! my building\n"),
    "epJSON": (["energyplus"], ".epJSON", BUILDING),
    "en12900 csv": (["en12900"], ".csv", "table,map\n"),
    "en12900 json": (["en12900"], ".json", '["formula", "maps"]'),
}


@pytest.mark.parametrize("kind", EXPORTS)
def test_an_export_replaces_its_own_file_and_no_other(kind, swept, tmp_path, capsys):
    (command, *more), ending, text = EXPORTS[kind]
    mine, own = tmp_path / f"mine{ending}", tmp_path / f"own{ending}"
    unit_of_another(mine) if text is None else mine.write_text(text, encoding="utf-8")
    before = mine.read_bytes()
    assert exit_code(["export", command, swept, *more, "-o", str(mine)]) == 2
    assert f"{mine}: {OTHERS}" in capsys.readouterr().err
    assert mine.read_bytes() == before
    for _ in range(2):  # 4: the map of four values an axis does not know its error
        assert exit_code(["export", command, swept, *more, "-o", str(own)]) in (0, 4)
    assert own.stat().st_size > 0 and "already exists, and is not" not in capsys.readouterr().err


def test_documents_of_one_export_are_not_taken_for_those_of_another(swept, tmp_path, capsys):
    for first, second in itertools.permutations(("tespy", "en12900", "map"), 2):
        file = tmp_path / f"{first}_{second}.json"
        for command, code in ((first, 0), (second, 2)):
            kind = ["map"] if command == "map" else ["export", command]
            assert exit_code([*kind, swept, "-o", str(file)]) == code
    assert capsys.readouterr().err.count("already exists, and is not") == 6


ROTORS = str(CONFIGS / "rotors" / "a.yaml")
DRIVE = str(CONFIGS / "drive" / "point.yaml")
FOLDERS = {  # the command, and files that it would write, of which each is somebody's
    "calibrate": (["calibrate", FIT, "--posterior"], ["fit.json", "scene.yaml", "posterior.csv", "predicted.h5"]),
    "startup": (["startup", DRIVE], ["startup.csv"]),
    "accuracy": (["accuracy", POINT, "--quick"], ["accuracy.csv", "accuracy.h5"]),
    "rotors": (["rotors", ROTORS], ["coefficients.csv", "curves/volume.csv", "rotors.html", "table/scene.yaml"]),
    "loads": (["export", "loads", POINT], ["loads.json", "flows.csv", "flows_spectrum.csv"]),
    "validate": (["validate", "exact"], ["validation.json"]),
}


@pytest.mark.parametrize(("command", "name"), [(each, name) for each, (_, names) in FOLDERS.items() for name in names])
def test_what_is_written_into_a_folder_replaces_nothing_of_others(command, name, tmp_path, capsys):
    mine = tmp_path / name
    mine.parent.mkdir(exist_ok=True)
    mine.write_text("mine\n", encoding="utf-8")
    assert exit_code([*FOLDERS[command][0], "-o", str(tmp_path)]) == 2
    assert f"{mine}: {OTHERS}" in capsys.readouterr().err
    assert mine.read_text(encoding="utf-8") == "mine\n"
    assert [each for each in tmp_path.rglob("*") if each.is_file()] == [mine]


@pytest.mark.around
@pytest.mark.parametrize(
    "command", [["rotors", ROTORS], ["export", "loads", POINT, *ROUGH], ["startup", DRIVE, "--longest", "0.02"]]
)
@pytest.mark.usefixtures("sketched")  # figures are told by their names
def test_what_is_written_into_a_folder_is_written_again(command, tmp_path):
    before = exit_code([*command, "-o", str(tmp_path)])
    written = sorted(tmp_path.rglob("*"))
    assert exit_code([*command, "-o", str(tmp_path)]) == before != 2
    assert written and sorted(tmp_path.rglob("*")) == written


PAGES = {  # the command, and what another program may have under such a name: it begins as ours does
    "report": ("report", ".html", b"<!DOCTYPE html>\n<html><body>my thesis</body></html>\n"),
    "sheet": ("datasheet", ".html", b"<!doctype html>\n<html><body>my thesis</body></html>\n"),
    "sheet as PDF": ("datasheet", ".pdf", b"%PDF-1.4\n% my thesis\n"),
}
RATED = ["--evaporating", "0 degC..5 degC", "--condensing", "40 degC..45 degC", "--jobs", "1", *ROUGH]


@pytest.fixture(scope="module")
def sheet():
    """Return what stands for `sheet_of`: the one sheet that is asked for here, computed once."""
    made, asked = {}, datasheet.sheet_of

    def sheet_of(scene, how):
        key = repr((scene, how._replace(progress=None)))
        if key not in made:
            made[key] = asked(scene, how)
        return made[key]

    return sheet_of


@pytest.mark.around
@pytest.mark.parametrize("kind", PAGES)
def test_a_page_replaces_its_own_and_no_other(kind, swept, sheet, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(datasheet, "sheet_of", sheet)
    command, ending, text = PAGES[kind]
    machine = str(CONFIGS / "r134a" / "point.yaml")
    asked = [command, swept] if command == "report" else [command, machine, *RATED]
    mine, own = tmp_path / f"mine{ending}", tmp_path / f"own{ending}"
    mine.write_bytes(text)
    assert exit_code([*asked, "-o", str(mine)]) == 2
    assert f"{mine}: {OTHERS}" in capsys.readouterr().err
    assert mine.read_bytes() == text
    own.touch()
    for _ in range(2):
        assert exit_code([*asked, "-o", str(own)]) == 0
    assert own.stat().st_size > 1000


@pytest.mark.parametrize("held", [(), ("mine.txt",)])
def test_a_folder_made_for_files_that_never_came_is_removed_at_the_end(held, tmp_path):
    """As after Ctrl-C; a folder that was there, or that holds something, stays."""
    old, new = tmp_path / "old", tmp_path / "outer" / "inner"
    old.mkdir()
    program = "import sys\nfrom pathlib import Path\nfrom screwsim.results.atomic import make_folder\n"
    program += "old, new, *held = map(Path, sys.argv[1:])\nmake_folder(old)\nmake_folder(new)\nassert new.is_dir()\n"
    program += "for name in held: (new / name).touch()\nraise KeyboardInterrupt\n"
    subprocess.run([sys.executable, "-c", program, old, new, *held], capture_output=True, check=False)
    assert old.is_dir()
    assert new.is_dir() == new.parent.is_dir() == bool(held)
