"""What is no file, or an immense one, is refused before it is waited for; every place where files are named."""

import os

import apart
import pytest
import report_fakes
from result_fakes import SCENE

from screwsim.inputs.faults import SceneError
from screwsim.inputs.textfiles import MOST_YAML, Unreadable, read_text
from screwsim.scene import load, loads
from screwsim.scene.load import MOST_BASES
from screwsim.scene.yaml_tree import MOST_LEVELS, MOST_NODES

NO_FILE = "cannot be read: it is a pipe or a device, not a file"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Work in a folder with a scene and a pipe to which nobody writes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.yaml").write_text(SCENE, encoding="utf-8")
    os.mkfifo(tmp_path / "pipe")
    return tmp_path


def lines_of(action) -> list[str]:
    with pytest.raises(SceneError) as caught:
        action()
    return caught.value.lines


@pytest.mark.parametrize(("name", "why"), [("pipe", NO_FILE), ("/dev/zero", NO_FILE), (".", "it is a folder")])
def test_a_scene_or_a_base_that_is_no_file_is_refused(name, why, folder):
    (line,) = lines_of(lambda: load(name))
    assert why in line
    (folder / "based.yaml").write_text(f"base: {name}\n", encoding="utf-8")
    (line,) = (line for line in lines_of(lambda: load("based.yaml")) if ": base: " in line)
    assert line.startswith(f"based.yaml:1:7: base: '{name}' cannot be read: ")
    assert why in line


def test_a_file_that_is_too_large_is_refused(folder):
    with (folder / "large.yaml").open("wb") as file:
        file.truncate(MOST_YAML + 1)
    (line,) = lines_of(lambda: load("large.yaml"))
    assert "cannot be read: it is larger than 4 MB" in line


def test_a_pipe_is_not_waited_for(folder):
    with pytest.raises(Unreadable, match="pipe"):
        read_text("pipe")


@pytest.mark.parametrize(
    "arguments",
    [
        ("explain", "pipe"),
        ("calibrate", "pipe"),
        ("run", "x.yaml", "-o", "pipe"),
        ("run", "x.yaml", "-o", "/dev/zero"),
        ("sweep", "x.yaml", "--set", "sweep.operation.speed=[1000 rpm, 2000 rpm]", "-o", "pipe"),
        ("sweep", "x.yaml", "--set", "sweep.operation.speed={file: pipe, column: a}"),
        ("sweep", "x.yaml", "--set", "sweep.operation.speed=[1000 rpm]", "--scheduler", "pipe"),
        ("explain", "x.yaml", "--set", "machine.volume={law: table, file: pipe}"),
        ("plot", "pipe"),
        ("report", "good.h5", "-o", "pipe"),
        ("compare", "pipe", "good.h5"),
        ("map", "/dev/zero"),
    ],
    ids=lambda arguments: " ".join(arguments[:1] + arguments[-2:]),
)
def test_no_command_waits_for_a_pipe_or_a_device(arguments, folder):
    report_fakes.file(folder / "good.h5", SCENE)
    done = apart.ended(apart.command, *arguments)
    assert done.code in (2, 3), done.err
    assert done.err.count("\n") == 1
    assert (folder / "pipe").is_fifo()


def bomb(levels: int, wide: int, mapping: bool = True) -> str:
    rows = []
    for level in range(levels):
        inner = [f"*a{level - 1}"] * wide if level else ["x"] * wide
        pairs = ", ".join(f"k{i}: {each}" for i, each in enumerate(inner))
        rows.append(f"a{level}: &a{level} " + (f"{{{pairs}}}" if mapping else f"[{', '.join(inner)}]"))
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize("mapping", [True, False])
def test_aliases_of_aliases_are_refused_however_few_letters_they_are(mapping, folder):
    text = bomb(12, 9, mapping)
    (line,) = lines_of(lambda: loads(text))
    assert f"has more than {MOST_NODES} values when its aliases are written out" in line
    (folder / "bomb.yaml").write_text(text, encoding="utf-8")
    (folder / "small.yaml").write_text(f"base: bomb.yaml\n{SCENE}", encoding="utf-8")
    (line,) = lines_of(lambda: load("small.yaml"))
    assert line.startswith("bomb.yaml:1:1: ")


def test_aliases_that_stay_small_are_values_like_any(folder):
    scene = loads(SCENE.replace("{gap: 50 um}", "{gap: &gap 50 um}") + "  blow_hole: {area: 6 mm^2}\n")
    assert scene.effects["tip_leakage"].parameters.gap == pytest.approx(50e-6)


@pytest.mark.parametrize("deep", [MOST_LEVELS, 330, 1500])
@pytest.mark.parametrize("shape", ["brackets", "braces", "lines", "dashes"])
def test_deep_nesting_is_one_fault(deep, shape):
    texts = {
        "brackets": "[" * deep + "]" * deep,
        "braces": "{a: " * deep + "}" * deep,
        "lines": "\n" + "\n".join(" " * level + " a:" for level in range(deep)),
        "dashes": "\n " + "- " * deep,
    }
    (line,) = lines_of(lambda: loads(f"machine: {texts[shape]}\n"))
    assert f"is nested deeper than {MOST_LEVELS} levels" in line


def test_a_chain_of_bases_ends(folder):
    for number in range(MOST_BASES + 5):
        (folder / f"{number}.yaml").write_text(f"base: {number + 1}.yaml\n", encoding="utf-8")
    line = lines_of(lambda: load("0.yaml"))[-1]
    assert line.endswith(f"is the base of more than {MOST_BASES} files (a chain of bases must end)")


def test_a_base_with_a_null_character_is_a_fault():
    assert "<text>:1:7: base: contains a null character (remove it)" in lines_of(lambda: loads('base: "a\\0b"\n'))


def test_a_volume_that_is_zero_everywhere_is_a_fault(folder):
    (folder / "v.csv").write_text("angle_deg,volume_m3\n0,0\n360,0\n720,0\n", encoding="utf-8")
    lines = lines_of(lambda: load("x.yaml", ["machine.volume={law: table, file: v.csv}"]))
    assert any("'v.csv': the volume is zero everywhere" in line for line in lines)


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        (
            "0,0\n450,1\n900,0\n",
            "goes from 0 to 900 deg, beyond the chamber's life of 720 deg (write machine.volume.life",
        ),
        ("-20,0\n360,1\n720,0\n", "goes from -20 to 720 deg, beyond the chamber's life of 720 deg"),
        (
            "0,0\n6.2832,1\n12.566,0\n",
            "goes from 0 to 12.566 deg, of a chamber's life of 720 deg (are the angles in deg",
        ),
    ],
)
def test_a_volume_over_other_angles_than_the_chambers_life_is_a_fault(rows, told, folder):
    """Beyond the life it would be cut off, and in radians it would be a chamber that lives next to never."""
    (folder / "v.csv").write_text(f"angle_deg,volume_m3\n{rows}", encoding="utf-8")
    lines = lines_of(lambda: load("x.yaml", ["machine.volume={law: table, file: v.csv, phi_A: null}"]))
    assert any(f"machine.volume.file: 'v.csv': {told}" in line for line in lines)


def test_an_area_over_radians_is_a_fault(folder):
    (folder / "s.csv").write_text("angle_deg,area_m2\n0,0\n3.1,0.001\n6.28,0\n", encoding="utf-8")
    (line,) = lines_of(
        lambda: load("x.yaml", ["machine.suction_port={law: table, file: s.csv, area: null, phi_B: null}"])
    )
    assert "machine.suction_port.file: 's.csv': has no angle above 6.28 deg (are the angles in degrees?)" in line
