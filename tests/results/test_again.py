"""The scene of a results file as a file: it loads, is the same scene, and says what has to stand beside it."""

from types import SimpleNamespace

import screwsim
from screwsim.results import open_results
from screwsim.results.read import stored_scene
from screwsim.results.write import save


def test_the_scene_of_a_file_is_simulated_again_to_the_same_digits(tmp_path):
    scene = screwsim.load("configs/paper/point.yaml")
    first = screwsim.simulate(scene)
    save(tmp_path / "a.h5", scene, first, "run")
    text = stored_scene(open_results(tmp_path / "a.h5"))
    assert text.startswith("# The scene of a.h5, scene_sha256 ") and "# screwsim " in text
    again = screwsim.loads(text)
    assert again.text == scene.text
    assert dict(screwsim.simulate(again).performance) == dict(first.performance)


def test_tables_that_a_scene_needs_are_named_with_their_hashes(tmp_path):
    attributes = {"scene_sha256": "0" * 64, "screwsim_identity": '{"file V.csv": "24be", "CoolProp": "8"}'}
    told = stored_scene(SimpleNamespace(path=tmp_path / "a.h5", attributes=attributes, scene_yaml="title: x\n"))
    assert "# It needs these files next to it, unchanged (first digits of their SHA-256): V.csv (24be)\n" in told
    assert told.endswith("\ntitle: x\n")
