"""screwsim rotors: what it prints and writes, and how it refuses; faults of rotors at their place in the scene."""

import contextlib
import io
import json
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from screwsim.cli import exit_code
from screwsim.report import rotors_scene, style
from screwsim.scene import load

CONFIGS = Path(__file__).parents[2] / "configs"
B = str(CONFIGS / "rotors" / "b.yaml")


def answer(capsys, *arguments):
    """Return (exit code, stdout, stderr)."""
    code = exit_code(["rotors", *map(str, arguments)])
    out = capsys.readouterr()
    return code, out.out, out.err


class Written(NamedTuple):
    """What the command did of a scene with -o and --json, and the folder that it filled."""

    code: int
    document: dict[str, Any]
    err: str
    folder: Path


@pytest.fixture(scope="module")
def written(tmp_path_factory, sketch) -> Callable[..., Written]:
    """Return a function that gives what was written of a scene, once for all tests; figures small if not `whole`."""

    @cache
    def write(scene: str, whole: bool) -> Written:
        folder = tmp_path_factory.mktemp("rotors")
        with pytest.MonkeyPatch.context() as patch, contextlib.ExitStack() as stack:
            out = stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
            err = stack.enter_context(contextlib.redirect_stderr(io.StringIO()))
            if not whole:
                patch.setattr(style, "write", sketch)
            code = exit_code(["rotors", scene, "-o", str(folder), "--json"])
        return Written(code, json.loads(out.getvalue()), err.getvalue(), folder)

    return lambda scene, whole=False: write(str(scene), whole)


def test_coefficients_are_printed(capsys):
    code, out, _ = answer(capsys, B)
    assert code == 0
    assert "Cn = (A01 + A02) z1/D²" in out and "the port opens for Vi = 3.2" in " ".join(out.split())


@pytest.mark.parametrize("scene", ["a", "b", "c"])
def test_the_blow_holes_of_the_docs_are_those_that_are_printed(capsys, scene):
    _, out, _ = answer(capsys, CONFIGS / "rotors" / f"{scene}.yaml")
    printed = {line[:26].strip(): line[26:37].strip() for line in out.splitlines()}
    page = (CONFIGS.parent / "docs" / "reference" / "rotors.md").read_text(encoding="utf-8")
    told = page[page.index("1.6 times as large") :].partition("\n\n")[0]
    assert printed["blow hole area"] in told and printed["suction blow hole area"] in told


def pair_of(kind, z1, z2, A, D2, r4, *flank):
    """Return the overrides of a pair of other lobes, lengths in mm."""
    lengths = {"centre_distance": A, "female_diameter": D2, "female_tip_radius": r4}
    lengths |= {"flank_radius": flank[0]} if flank else {}
    given = [f"machine.male_lobes={z1}", f"machine.female_lobes={z2}"]
    given += [f"machine.profile.{name}={value} mm" for name, value in lengths.items()]
    given += [f"machine.profile.pressure_angle={flank[1]} deg"] if flank else []
    return kind, given


PAIRS = {
    "3/4": pair_of("b", 3, 4, 125, 150, 4.5, 44, 30),
    "4/5": pair_of("b", 4, 5, 120, 140, 4.2, 30, 32),
    "4/5 symmetric": pair_of("a", 4, 5, 120, 140, 4.2),
    "4/6": ("b", []),
    "5/6 symmetric": pair_of("a", 5, 6, 128, 150, 6.5),
    "5/7": pair_of("b", 5, 7, 124, 150, 6.4, 28, 32),
    "5/7 symmetric": pair_of("a", 5, 7, 128, 150, 1),
    "6/7 symmetric": pair_of("a", 6, 7, 130, 140, 1),
}
ROTORS = sorted(
    path for path in CONFIGS.rglob("*.yaml") if "law: profile" in path.read_text() or path.parent.name == "rotors"
)


def lengths_of(found):
    """Return the numbers of a document, by name."""
    return {name: entry["value"] for name, entry in found["coefficients"].items()}


@pytest.mark.around
@pytest.mark.parametrize("scene", ROTORS, ids=lambda path: path.stem)
def test_every_shipped_machine_with_rotors_gives_its_figures_and_files(written, scene):
    code, document, err, _ = written(scene)
    assert (code, err) == (0, "")
    assert all(math.isfinite(value) for value in lengths_of(document).values())
    assert all(Path(path).stat().st_size > 100 for path in document["files"])


@pytest.mark.around
def test_every_figure_and_file_is_written_and_the_same_again(capsys, written, tmp_path):
    first = written(B, whole=True).folder
    assert answer(capsys, B, "-o", tmp_path)[0] == 0
    files = sorted(path.relative_to(first) for path in first.rglob("*") if path.is_file())
    assert sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()) == files
    names = {path.name for path in files}
    assert {"rotors.png", "sealing_line.pdf", "volume.png", "areas.png", "volume.csv", "male.dxf"} <= names
    assert {"suction_port.csv", "discharge_port.csv", "blow_hole.csv", "coefficients.csv", "male_lobe.csv"} <= names
    for path in files:
        assert (first / path).read_bytes() == (tmp_path / path).read_bytes(), path


@pytest.mark.parametrize("name", PAIRS)
def test_every_pair_of_lobes_gives_its_figures(capsys, name):
    kind, given = PAIRS[name]
    scene = CONFIGS / "rotors" / f"{kind}.yaml"
    code, out, err = answer(capsys, scene, "--json", *(part for each in given for part in ("--set", each)))
    assert (code, err) == (0, "")
    assert all(math.isfinite(value) and value > 0.0 for value in lengths_of(json.loads(out)).values())


@pytest.mark.parametrize(("scene", "at_100_mm"), [("a", 102.9e-3), ("b", 114.7e-3), ("c", 109.0e-3)])
def test_the_longest_contact_line_is_that_of_the_whole_chamber(capsys, scene, at_100_mm):
    """Both branches are whole at once on rotors so long: the sealing line of docs/reference/rotors.md, at 160 mm."""
    _, out, _ = answer(capsys, CONFIGS / "rotors" / f"{scene}.yaml", "--json")
    assert lengths_of(json.loads(out))["sealing_line_length"] == pytest.approx(1.6 * at_100_mm, rel=6e-4)


def test_files_are_told_below_the_tables(capsys, monkeypatch):
    monkeypatch.setattr(rotors_scene, "write", lambda scene, folder: [str(folder / "rotors.png")])
    code, out, _ = answer(capsys, B, "-o", "drawn")
    assert code == 0
    assert out.endswith("\ndrawn/rotors.png\n")


@pytest.mark.around
def test_figures_page_profiles_and_tables_are_written(written):
    code, document, _, folder = written(B)
    assert code == 0
    assert document["coefficients"]["life"]["value"] == pytest.approx(13.6386, abs=1e-4)  # 781.43°
    names = {str(Path(path).relative_to(folder)) for path in document["files"]}
    assert {
        "rotors.png",
        "sealing_line.png",
        "volume.png",
        "areas.png",
        "rotors.html",
        "male.dxf",
        "female.csv",
    } <= names
    assert {"table/volume.csv", "table/scene.yaml", "table/blow_hole.csv", "curves/male_tip.csv"} <= names
    assert all((folder / name).stat().st_size > 100 for name in names)
    assert load(folder / "table" / "scene.yaml").machine.volume.law == "table"


def test_the_page_loads_nothing_and_is_small(written):
    page = (written(B).folder / "rotors.html").read_text(encoding="utf-8")
    assert "http" not in page and "src=" not in page and "@" not in page.replace("@media", "")
    assert len(page) < 100_000
    assert page.count("<script>") == page.count("</script>") == 1


def test_a_machine_without_a_profile_is_refused(capsys):
    code, out, err = answer(capsys, CONFIGS / "paper" / "point.yaml")
    assert (code, out) == (2, "")
    assert err == "machine.volume.law is paper: there are no rotors (write machine.profile and law: profile)\n"


FAULTS = {
    "machine.profile=null": ("machine.profile", "is missing (law: profile needs it"),
    "machine.built_in_volume_ratio=null": ("machine.built_in_volume_ratio", "is missing"),
    "machine.built_in_volume_ratio=40": ("machine.built_in_volume_ratio", "leaves no opening for the discharge port"),
    "machine.profile.female_tip_radius=1 mm": ("machine.profile.female_tip_radius", "undercut"),
    "machine.profile.flank_radius=null": ("machine.profile.flank_radius", "is missing (kind: rack needs it)"),
    "machine.profile.centre_distance=200 mm": ("machine.profile.centre_distance", "do not mesh"),
    "machine.profile.wrap_angle=400 deg": ("machine.profile.wrap_angle", "above 360 deg"),
    "machine.profile.wrap_angle=300": ("machine.profile.wrap_angle", "has no unit"),
    "machine.volume.max=500 cm^3": ("machine.volume.max", "profile finds it from the rotors (remove it)"),
    "machine.volume.life=720 deg": ("machine.volume.life", "applies only to law: table"),
    "effects.interlobe_leakage.length=100 mm": ("effects.interlobe_leakage.length", "finds it by angle (remove it)"),
    "effects.end_face_leakage.length=60 mm": ("effects.end_face_leakage.length", "finds it by angle (remove it)"),
    "machine.suction_port={law: paper, area: 80 cm^2, phi_B: 60 deg}": ("machine.suction_port.law", "720 deg"),
    "machine.profile.kind=points": ("machine.profile.file", "is missing (kind: points needs it)"),
}


@pytest.mark.parametrize("override", FAULTS)
def test_a_fault_of_the_rotors_is_one_line_at_its_place(capsys, override):
    code, out, err = answer(capsys, B, "--set", override)
    path, words = FAULTS[override]
    assert (code, out) == (3, "")
    assert f" {path}: " in err and words in err
    assert len(err.splitlines()) == 1


def test_rotors_of_another_size_than_their_profile_are_warned_of(capsys):
    code, out, err = answer(capsys, B, "--set", "machine.rotor_diameter=140 mm", "--json")
    assert code == 0
    assert json.loads(out)
    assert "warning: machine.profile.centre_distance: 128 mm is 0.914 rotor diameters (usual: at most 0.9)" in err


def test_points_that_are_not_there_are_named(capsys):
    code, _, err = answer(capsys, B, "--set", "machine.profile.kind=points", "--set", "machine.profile.file=no.csv")
    assert code == 3
    assert " machine.profile.file: " in err and "no.csv" in err and len(err.splitlines()) == 1


def test_a_fault_stands_at_its_line(capsys, tmp_path):
    text = Path(B).read_text().replace("wrap_angle: 300 deg", "wrap_angle: 365 deg")
    (tmp_path / "scene.yaml").write_text(text)
    line = next(i for i, line in enumerate(text.splitlines(), start=1) if "wrap_angle" in line)
    code, _, err = answer(capsys, tmp_path / "scene.yaml")
    assert code == 3
    assert err.startswith(f"{tmp_path / 'scene.yaml'}:{line}:")


def test_gaps_on_another_life_need_a_table(capsys):
    volume = (
        "machine.volume={law: table, file: validation/none.csv, max: 500 cm^3, life: 900 deg, injection_angle: 450 deg}"
    )
    code, _, err = answer(capsys, CONFIGS / "r134a" / "point.yaml", "--set", volume)
    assert code == 3
    assert "effects.tip_leakage: has a formula for a chamber life of 720 deg" in err
    assert "machine.suction_port.law: paper is for a chamber life of 720 deg" in err
