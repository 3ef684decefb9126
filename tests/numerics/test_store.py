"""What is kept is sound and ours, or it is not there; what the system refuses to keep is told once."""

import os

import pytest

from screwsim.numerics import folder, store

CONTENT = b"what can be made again"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Name a folder of this test as the cache; return it."""
    monkeypatch.setenv(folder.CHOSEN, str(tmp_path / "cache"))
    monkeypatch.setattr(folder, "_told", set())
    store.keep("name", CONTENT)
    return tmp_path / "cache"


def test_what_is_kept_is_read(here):
    assert store.read("name") == CONTENT
    assert store.read("another") is None


@pytest.mark.parametrize("place", range(0, store.DIGEST + len(CONTENT), 7))
def test_one_damaged_bit_makes_it_nothing_and_removes_it(here, place):
    held = bytearray((here / "name").read_bytes())
    held[place] ^= 0x10
    (here / "name").write_bytes(held)
    assert store.read("name") is None
    assert not (here / "name").exists()


@pytest.mark.parametrize("length", [0, 1, store.DIGEST, store.DIGEST + 5])
def test_what_a_full_disk_left_of_it_is_nothing(here, length):
    (here / "name").write_bytes((here / "name").read_bytes()[:length])
    assert store.read("name") is None
    store.keep("name", CONTENT)
    assert store.read("name") == CONTENT


def test_a_file_under_anothers_name_is_nothing(here):
    (here / "name").rename(here / "another")
    assert store.read("another") is None


@pytest.mark.skipif(os.name != "posix", reason="links and owners of POSIX")
def test_a_link_is_nothing_even_to_a_sound_file(here):
    (here / "name").rename(here / "elsewhere")
    (here / "name").symlink_to(here / "elsewhere")
    assert store.read("name") is None


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() != 0, reason="only root gives files away")
def test_a_sound_file_of_another_user_is_nothing(here):
    os.chown(here / "name", 12345, 12345)
    assert store.read("name") is None


def test_a_text_that_was_edited_is_as_it_was_again(here):
    store.keep_text("text", "as it was\n")
    (here / "text").write_text("edited\n")
    store.keep_text("text", "as it was\n")
    assert (here / "text").read_text() == "as it was\n"


def test_damaged_lines_are_left_out(here):
    for line in ("one", "two", "three"):
        store.append_line("lines", line, 10_000)
    held = (here / "lines").read_bytes().replace(b" two", b" twp")
    (here / "lines").write_bytes(held + b"torn")
    store.append_line("lines", "four", 10_000)
    assert [*filter(None, map(store.checked_line, store.read_lines("lines", 10_000)))] == ["one", "three", "four"]


def test_a_full_disk_is_told_once_and_no_error(here, capsys, monkeypatch):
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store, "write_atomically", full)
    store.keep("more", CONTENT)
    store.keep("still more", CONTENT)
    told = capsys.readouterr().err
    assert told.startswith(f"screwsim: {here}: cannot be written: No space left on device; what is compiled now is not")
    assert "SCREWSIM_CACHE" in told and len(told.splitlines()) == 1
    assert store.read("name") == CONTENT


def test_a_folder_that_was_removed_is_made_again(here):
    for path in here.iterdir():
        path.unlink()
    here.rmdir()
    store.keep("name", CONTENT)
    assert store.read("name") == CONTENT
