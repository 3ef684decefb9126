"""What is compiled is announced when something is missing."""

import pytest

from screwsim.numerics.compiling import announced, begins


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SCREWSIM_CACHE", str(tmp_path / "cache"))


def fail():
    raise KeyError("a signature")


def test_an_error_says_nothing_of_a_time(capsys):
    with pytest.raises(KeyError), announced("kind", "a thing", "a moment"):
        begins()
        fail()
    assert capsys.readouterr().err == "screwsim: compiling a thing, once (a moment) ...\n"


def test_nothing_is_said_where_nothing_is_missing(capsys):
    with announced("kind", "a thing", "a moment"):
        pass
    begins()  # outside, what is compiled takes no time worth a word
    assert capsys.readouterr().err == ""


def test_the_next_of_its_kind_is_told_how_long_the_last_one_took(capsys):
    for kind in ("kind", "kind", "other"):
        with announced(kind, "a thing", "a moment"):
            begins()
            begins()
    told = [line for line in capsys.readouterr().err.splitlines() if "compiling" in line]
    expected = ["a moment) ...", "the last one took 0.1 s here) ...", "a moment) ..."]
    assert [line.partition("(")[2] for line in told] == expected
