"""The version follows the repository's tags, whatever a checkout has of them, and importing asks nobody for it."""

import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from packaging.version import Version

from screwsim.version import between, release, version_of

GIT = shutil.which("git")
with_git = pytest.mark.skipif(GIT is None, reason="needs git")


def git(folder: Path, *arguments: str) -> str:
    own = ("-c", "user.name=n", "-c", "user.email=n@example.invalid", "-c", "commit.gpgsign=false")
    command = [str(GIT), *own, "-C", str(folder), *arguments]
    kept = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    return subprocess.run(command, env=kept, check=True, capture_output=True, text=True).stdout.strip()


def checkout(folder: Path, coming: str) -> Path:
    """Return a folder that looks like a checkout without its repository."""
    (folder / "src" / "screwsim").mkdir(parents=True)
    (folder / "pyproject.toml").write_text("")
    (folder / "CHANGELOG.md").write_text(f"# Changelog\n\n## {coming} (unreleased)\n\n- A line.\n\n## 0.9.0\n")
    return folder


def commit(folder: Path, times: int = 1) -> str:
    git(folder, "add", "-A")
    for _ in range(times):
        git(folder, "commit", "-q", "--allow-empty", "-m", "m")
    return git(folder, "rev-parse", "--short=8", "HEAD")


@with_git
def test_a_tag_is_the_version_and_what_follows_leads_to_the_next(tmp_path):
    folder = checkout(tmp_path / "one", "1.3.0")
    git(tmp_path, "init", "-q", str(folder))
    first = commit(folder, 2)
    assert version_of(folder) == f"1.3.0.dev2+g{first}"  # no tag yet
    git(folder, "tag", "v1.2.3")
    git(folder, "tag", "nightly")  # not a release
    assert version_of(folder) == "1.2.3"
    later = commit(folder, 5)
    assert version_of(folder) == f"1.3.0.dev5+g{later}"
    (folder / "pyproject.toml").write_text("changed")
    assert version_of(folder) == f"1.3.0.dev5+g{later}.dirty"
    git(folder, "tag", "v1.3.0")
    assert version_of(folder) == f"1.3.1.dev0+g{later}.dirty"  # not what was released
    git(folder, "checkout", "-q", "--", ".")
    assert version_of(folder) == "1.3.0"
    shallow = tmp_path / "two"
    git(tmp_path, "clone", "-q", "--depth", "1", "--no-tags", folder.as_uri(), str(shallow))
    (shallow / "src" / "screwsim").mkdir(parents=True)
    assert version_of(shallow) == f"1.3.0.dev0+g{later}"


@with_git
def test_a_folder_inside_of_another_repository_is_not_that(tmp_path):
    git(tmp_path, "init", "-q")
    (tmp_path / "x").write_text("")
    commit(tmp_path)
    git(tmp_path, "tag", "v7.0.0")
    assert version_of(checkout(tmp_path / "within", "1.3.0")) == "1.3.0.dev0"


def test_without_git_metadata_or_changelog_tell_it(tmp_path, monkeypatch):
    folder = checkout(tmp_path / "one", "1.3.0")
    (folder / ".git").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path))  # no git to be found
    assert version_of(folder) == "1.3.0.dev0"
    (folder / "PKG-INFO").write_text("Metadata-Version: 2.4\nName: screwsim\nVersion: 1.2.9\n")
    assert version_of(folder) == "1.2.9"


def test_versions_are_in_the_order_of_their_commits():
    steps = [
        between("1.0.0", "", 40, "ab", False),
        between("1.0.0", "v1.0.0rc1", 0, "ab", False),
        between("1.0.0", "v1.0.0", 0, "ab", False),
        between("1.0.0", "v1.0.0", 3, "ab", False),  # nothing of the next release is noted yet
        between("1.0.1", "v1.0.0", 4, "ab", True),
        between("1.0.1", "v1.0.1", 0, "ab", False),
        between("1.1", "v1.0.1", 12, "ab", False),
        between("1.1", "v1.1", 0, "ab", False),
        between("1.1", "v1.1", 2, "ab", False),
    ]
    assert all(Version(before) < Version(after) for before, after in pairwise(steps))
    assert [str(Version(step)) for step in steps] == steps  # as it is written in names of files
    assert [release(step) for step in steps[:4]] == ["1.0.0", "1.0.0rc1", "1.0.0", "1.0.1"]


def test_importing_runs_no_git(tmp_path):
    fake = tmp_path / "git"
    fake.write_text(f"#!/bin/sh\ntouch '{tmp_path}/asked'\nexit 1\n")
    fake.chmod(0o755)
    environment = os.environ | {"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}

    def asked(code: str) -> bool:
        subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True)
        return (tmp_path / "asked").exists()

    assert not asked("import screwsim, screwsim.cli; screwsim.simulate; screwsim.cli.exit_code(['run', '--help'])")
    in_checkout = (Path(__file__).parents[2] / ".git").exists()
    assert asked("import screwsim; screwsim.__version__") == in_checkout
