"""`accuracy` on a small scene: what it prints and writes, and how it ends."""

import pytest

from screwsim.study import accuracy
from screwsim.study.accuracy import QUICK


@pytest.fixture
def least(monkeypatch):
    """Let --quick try as little as makes a study."""
    from dataclasses import replace

    few = {"asked": (1e-2, 1e-3), "widths": (1.0,), "closures": (), "dead_volumes": (), "points": (1,)}
    extent = replace(QUICK, **few, reference=1e-6, check=1e-7, limit=0.3, pairs=1)
    monkeypatch.setattr(accuracy, "QUICK", extent)


@pytest.mark.slow
def test_accuracy_prints_tables_and_a_sentence_and_writes_files(folder, command, least):
    answer = command("accuracy", "small.yaml", "--quick", "-o", "out/study")
    assert answer.code == 0, answer.err
    names = {path.name for path in (folder / "out" / "study").iterdir()}
    assert names == {"accuracy.csv", "accuracy.h5", "accuracy.png", "accuracy.pdf"}
    assert "rodas4 histories" in answer.out
    assert "What failed or was left out" in answer.out
    assert "1e-3 costs" in answer.out
    assert answer.out.rstrip().endswith("accuracy.pdf")


def test_a_scene_without_a_reference_ends_with_one_line(folder, command, least, monkeypatch):
    def none(*arguments):
        raise accuracy.NoReference("the reference did not close")

    monkeypatch.setattr(accuracy, "truth", none)
    answer = command("accuracy", "small.yaml", "--quick")
    assert (answer.code, answer.out) == (4, "")
    assert "the reference did not close" in answer.err


def test_a_bad_scene_is_refused(folder, command):
    (folder / "bad.yaml").write_text("title: bad\n", encoding="utf-8")
    assert command("accuracy", "bad.yaml").code == 3
