"""What CoolProp was asked of a fluid is kept, verified, and announced where it must be asked."""

import pytest

from screwsim.fluid.description import cached_answer
from screwsim.numerics.compiling import announced


def asked(name: str, answer: object) -> object:
    with announced("equation", "the equation of state of X", "some seconds"):
        return cached_answer(name, lambda: answer)


def test_a_new_fluid_is_announced_and_a_known_one_is_not(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("SCREWSIM_CACHE", str(tmp_path / "cache"))
    assert asked("fluid X", 1) == 1
    assert capsys.readouterr().err.startswith("screwsim: compiling the equation of state of X, once (some seconds) ...")
    assert asked("fluid X", 2) == 1
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("old, new", [(b"1.25", b"1.35"), (b'{"name"', b"")])
def test_a_damaged_answer_is_asked_again(tmp_path, monkeypatch, old, new):
    monkeypatch.setenv("SCREWSIM_CACHE", str(tmp_path / "cache"))
    assert asked("fluid X", 1.25) == 1.25
    [path] = (tmp_path / "cache").glob("coolprop-*")
    path.write_bytes(path.read_bytes().replace(old, new))
    assert asked("fluid X", 1.5) == 1.5
    assert asked("fluid X", 2.0) == 1.5
