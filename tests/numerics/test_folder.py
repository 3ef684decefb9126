"""The cache folder is the user's own, or a private one that ends with the process; never a shared one."""

import os
import stat
import tempfile
from pathlib import Path

import pytest

from screwsim.numerics import folder

POSIX = pytest.mark.skipif(os.name != "posix", reason="modes and owners of POSIX")
ROOT = pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() != 0, reason="only root gives files away")
PLACE = "from screwsim.numerics.folder import cache_folder; print(cache_folder())"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Name a folder of this test as the cache, and another one as the place of temporary files; return the former."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    monkeypatch.setenv(folder.CHOSEN, str(tmp_path / "cache"))
    monkeypatch.setenv(folder.PRIVATE, "")
    monkeypatch.setattr(folder, "_told", set())
    return tmp_path / "cache"


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def assert_private(here: Path, said: str, why: str) -> Path:
    """Check that another folder is used, that nobody could foresee, told in one line; return it."""
    found = folder.cache_folder()
    assert found is not None and found.parent == here.with_name("tmp") and found.name != "screwsim"
    assert mode(found) == 0o700
    assert folder.cache_folder() == found
    assert why in said and "SCREWSIM_CACHE" in said and len(said.splitlines()) == 1
    return found


@POSIX
def test_the_folder_is_made_for_the_user_alone(here):
    assert folder.cache_folder() == here
    assert mode(here) == 0o700


@POSIX
def test_the_usual_folder_is_closed_to_others(here, tmp_path, monkeypatch):
    usual = tmp_path / "home" / ".cache" / "screwsim"
    usual.mkdir(parents=True, mode=0o755)
    monkeypatch.delenv(folder.CHOSEN)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert folder.cache_folder() == usual
    assert mode(usual) == 0o700


@POSIX
def test_a_folder_that_was_chosen_may_be_read_by_others_and_stays_as_it_is(here):
    here.mkdir()
    here.chmod(0o755)
    assert folder.cache_folder() == here
    assert mode(here) == 0o755


@POSIX
@pytest.mark.parametrize("open_to", [0o770, 0o777, 0o1777])
def test_a_folder_that_others_may_write_is_not_used(here, capsys, open_to):
    here.mkdir()
    here.chmod(open_to)
    folder.cache_folder()
    assert_private(here, capsys.readouterr().err, f"{here}: others may write there")


@POSIX
def test_a_folder_of_another_user_is_not_used(here, capsys, monkeypatch):
    here.mkdir(mode=0o700)
    user = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    found = folder.cache_folder()
    assert "belongs to another user" in capsys.readouterr().err
    assert found != here


@ROOT
@pytest.mark.parametrize("what", ["folder", "link"])
def test_neither_folder_nor_link_of_another_user_is_followed(here, tmp_path, capsys, what):
    target = here if what == "folder" else tmp_path / "target"
    target.mkdir(mode=0o700)
    if what == "link":
        here.symlink_to(target)
        assert folder.cache_folder() == here
    os.chown(here, 12345, 12345, follow_symlinks=False)
    folder.cache_folder()
    assert_private(here, capsys.readouterr().err, f"{here}: belongs to another user")


def test_a_file_in_its_place_is_told(here, capsys):
    here.write_text("a file")
    folder.cache_folder()
    assert_private(here, capsys.readouterr().err, f"{here}: is not a folder")


def test_a_predictable_folder_is_never_used(here, capsys):
    planted = here.with_name("tmp") / "screwsim"
    planted.mkdir()
    here.write_text("a file")
    assert folder.cache_folder() not in (planted, None)


def test_where_no_folder_can_be_made_there_is_none(here, capsys, monkeypatch):
    here.write_text("a file")
    monkeypatch.setattr(tempfile, "tempdir", str(here))
    assert folder.cache_folder() is None
    assert folder.cache_folder() is None
    assert len(capsys.readouterr().err.splitlines()) == 1


@POSIX
def test_without_a_home_one_line_is_said(python):
    unknown = "import os, pwd; pwd.getpwuid = lambda user: {}[user]\n"  # as in a container, for a number of no name
    found = python(unknown + PLACE, HOME=None)
    assert found.returncode == 0
    assert found.stderr.startswith("screwsim: no home folder is known")
    assert "SCREWSIM_CACHE" in found.stderr and len(found.stderr.splitlines()) == 1


def test_a_private_folder_ends_with_its_process(python, tmp_path):
    (tmp_path / "cache").write_text("a file")
    found = python(PLACE, SCREWSIM_CACHE=str(tmp_path / "cache"), TMPDIR=str(tmp_path))
    assert Path(found.stdout.strip()).parent == tmp_path
    assert [path.name for path in tmp_path.iterdir()] == ["cache"]


WORKERS = """
import subprocess, sys, threading
from concurrent.futures import wait
from screwsim.numerics.folder import cache_folder
from screwsim.study.pool.workers import LocalPool
if {threads}:  # then they are not forked
    threading.Thread(target=threading.Event().wait, daemon=True).start()
with LocalPool(2).executor(2) as pool:
    found = {{str(pool.submit(cache_folder).result()) for _ in range(6)}}
child = subprocess.run([sys.executable, "-c", {place!r}], capture_output=True, text=True)
assert not child.stderr, child.stderr
print(len(found | {{child.stdout.strip(), str(cache_folder())}}))
"""


@pytest.mark.parametrize("threads", [False, True])
def test_workers_share_the_private_folder_of_the_process_that_started_them(python, tmp_path_factory, threads):
    folder = tmp_path_factory.mktemp("w")  # the address of a socket in it has to be short
    (folder / "cache").write_text("a file")
    text = WORKERS.format(threads=threads, place=PLACE)
    found = python(text, SCREWSIM_CACHE=str(folder / "cache"), TMPDIR=str(folder))
    assert found.stdout == "1\n", found.stderr
    assert len(found.stderr.splitlines()) == 1
    assert [path.name for path in folder.glob("screwsim-*")] == []
