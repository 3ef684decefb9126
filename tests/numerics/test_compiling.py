"""What is compiled is announced when something is missing; Ctrl-C ends it whatever the compiler made of it."""

import gc
import signal
import sys

import pytest

from screwsim.numerics.compiling import announced, begins


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SCREWSIM_CACHE", str(tmp_path / "cache"))


def work(then=lambda: None):
    """Begin to compile, be interrupted, and do with it what `then` does."""
    with announced("kind", "a thing", "a moment"):
        begins()
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            then()


def fail():
    raise KeyError("a signature")


@pytest.mark.parametrize("then", [fail, begins, lambda: None])
def test_an_interruption_stays_one(then, capsys):
    with pytest.raises(KeyboardInterrupt):
        work(then)
    assert capsys.readouterr().err == "screwsim: compiling a thing, once (a moment) ...\n"


def test_a_process_is_left_as_it_was():
    before = signal.getsignal(signal.SIGINT), sys.unraisablehook, gc.isenabled()
    with pytest.raises(KeyboardInterrupt):
        work()
    with announced("kind", "a thing", "a moment"):
        begins()
        assert not gc.isenabled() and signal.getsignal(signal.SIGINT) != before[0]
    assert (signal.getsignal(signal.SIGINT), sys.unraisablehook, gc.isenabled()) == before


def test_an_error_stays_one_too():
    with pytest.raises(KeyError), announced("kind", "a thing", "a moment"):
        begins()
        fail()


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
    expected = ["a moment) ...", "the last one took 0 s here) ...", "a moment) ..."]
    assert [line.partition("(")[2] for line in told] == expected
