"""What a page shows is of files as they were: each file that the scene is made of is watched, by its content."""

import math
import os

import pytest
from explore_line import PAPER

from screwsim.explore.changes import open_base

OWN = '''"""An effect that does nothing."""

from dataclasses import dataclass

from screwsim.effects.base import Effect


@dataclass(frozen=True)
class Parameters:
    """None."""


EFFECT = Effect("idle", "nothing", ("M12",), "a test", Parameters, lambda parameters, machine: ())
'''
SCENE = """\
base: below.yaml
machine: {volume: {law: table, file: volume.csv}}
effects: {explore_watched.idle: {}}
"""
FILES = ("scene.yaml", "below.yaml", "volume.csv", "explore_watched/idle.py")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("watched")
    (found / "explore_watched").mkdir()
    angles = range(0, 721, 10)
    rows = (f"{angle},{2.7e-4 * (1.001 - math.cos(math.radians(0.5 * angle)))}" for angle in angles)
    texts = (SCENE, f"base: {PAPER}\n", "angle_deg,volume_m3\n" + "\n".join(rows) + "\n", OWN)
    for name, text in zip(FILES, texts, strict=True):
        (found / name).write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(found))
        yield found


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_the_scene_with_another_content_is_named(folder, name):
    base, path = open_base(str(folder / "scene.yaml")), folder / name
    text = path.read_text(encoding="utf-8")
    assert base.changed() == ""
    path.write_text(text + "\n# more\n", encoding="utf-8")
    assert base.changed().startswith(f"{path} has changed since this page was made")
    path.write_text(text, encoding="utf-8")
    assert base.changed() == ""


def test_a_file_that_was_only_touched_has_not_changed(folder):
    base = open_base(str(folder / "scene.yaml"))
    os.utime(folder / "below.yaml", (1.0, 1.0))
    assert base.changed() == ""


def test_a_file_that_is_gone_has_changed(folder):
    base, path = open_base(str(folder / "scene.yaml")), folder / "below.yaml"
    text = path.read_text(encoding="utf-8")
    path.unlink()
    assert base.changed().startswith(f"{path} has changed")
    path.write_text(text, encoding="utf-8")
