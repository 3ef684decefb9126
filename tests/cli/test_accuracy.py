"""How `accuracy` ends without a study; what it prints and writes of one stands in tests/study/test_accuracy.py."""

from screwsim.study import accuracy


def test_a_scene_without_a_reference_ends_with_one_line(folder, command, monkeypatch):
    def none(*arguments):
        raise accuracy.NoReference("the reference did not close")

    monkeypatch.setattr(accuracy, "reference_of", none)
    answer = command("accuracy", "small.yaml", "--quick")
    assert (answer.code, answer.out) == (4, "")
    assert "the reference did not close" in answer.err


def test_a_bad_scene_is_refused(folder, command):
    (folder / "bad.yaml").write_text("title: bad\n", encoding="utf-8")
    assert command("accuracy", "bad.yaml").code == 3
