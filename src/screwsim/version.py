"""The version of this program, from the tags of its repository: `v1.2.3`, and between tags that of the release to come.

It stands alone, on the standard library, as it also tells the version to whatever builds the package. In a checkout
git is asked, when the version is first wanted; what is installed knows it from its metadata. A version between tags
is `1.3.0.dev5+g1a2b3c4d`: five commits on from the last tag, towards what the changelog's first heading names (or,
where that is released already, the next patch); without any tag, all commits; `.dirty` where tracked files differ.
"""

import os
import re
from functools import cache
from pathlib import Path

_TAG = re.compile(r"v(\d+(?:\.\d+)*(?:(?:a|b|rc)\d+)?)")
_HEADING = re.compile(r"^## (\d+(?:\.\d+)*(?:(?:a|b|rc)\d+)?)\b", flags=re.MULTILINE)
_RELEASE = re.compile(r"\d+(?:\.\d+)*(?:(?:a|b|rc)\d+)?")
_ELSEWHERE = ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_COMMON_DIR")  # a hook's, of another repository maybe
_SECONDS = 20.0  # git may be waiting for a slow disk


@cache
def version() -> str:
    """Return the version of this package: of its checkout, else of what is installed."""
    return version_of(Path(__file__).parents[2])


def version_of(root: Path) -> str:
    """Return the version of a folder; of one that is no checkout of this program, that of what is installed."""
    changelog = root / "CHANGELOG.md"
    if not ((root / "pyproject.toml").is_file() and changelog.is_file() and (root / "src" / "screwsim").is_dir()):
        from importlib import metadata  # it, and what starts git, are as much to import as all of this package

        return metadata.version("screwsim")
    packed = root / "PKG-INFO"  # an unpacked source distribution
    if packed.is_file():
        found = re.search(r"^Version: (\S+)$", packed.read_text(encoding="utf-8"), flags=re.MULTILINE)
        if found is not None:
            return found[1]
    heading = _HEADING.search(changelog.read_text(encoding="utf-8"))
    return between(heading[1] if heading else "0", *_described(root))


def between(coming: str, tag: str, commits: int, commit: str, dirty: bool) -> str:
    """Return the version of a commit some commits after a tag ('' for none), where `coming` is to be released next."""
    last = _TAG.fullmatch(tag)
    if last is not None and commits == 0 and not dirty:
        return last[1]
    if last is not None and _order(coming) <= _order(last[1]):
        *first, patch = (*_numbers(last[1]), 0, 0)[:3]
        coming = ".".join(map(str, (*first, patch if _pre(last[1]) else patch + 1)))
    local = f"g{commit}" if commit else ""
    local += ".dirty" if commit and dirty else ""
    return f"{_numbers_text(coming)}.dev{commits}" + (f"+{local}" if local else "")


def release(version: str) -> str:
    """Return the part of a version that names its release: `1.3.0` of `1.3.0.dev5+g1a2b3c4d`."""
    found = _RELEASE.match(version)
    return found[0] if found else version


def _described(root: Path) -> tuple[str, int, str, bool]:
    """Return (last tag or '', commits since, or of all without one, commit, whether files differ) of a checkout."""
    if not (root / ".git").exists():  # not of another repository that this folder lies in
        return "", 0, "", False
    told = _git(root, "describe", "--tags", "--long", "--always", "--dirty", "--abbrev=8", "--match", "v[0-9]*")
    text, dirty = told.removesuffix("-dirty"), told.endswith("-dirty")
    parts = text.rsplit("-", 2)
    if len(parts) == 3 and _TAG.fullmatch(parts[0]):
        return parts[0], int(parts[1]), parts[2].removeprefix("g"), dirty
    if not text or _git(root, "rev-parse", "--is-shallow-repository") != "false":  # how many there are is not known
        return "", 0, parts[-1].removeprefix("g"), dirty
    return "", int(_git(root, "rev-list", "--count", "HEAD") or 0), parts[-1].removeprefix("g"), dirty


def _git(root: Path, *arguments: str) -> str:
    """Return what git says of a checkout; '' where it cannot."""
    import subprocess

    kept = {name: value for name, value in os.environ.items() if name not in _ELSEWHERE}
    try:
        done = subprocess.run(
            ["git", "-C", str(root), *arguments],
            env=kept | {"GIT_OPTIONAL_LOCKS": "0"},
            capture_output=True,
            text=True,
            check=False,
            timeout=_SECONDS,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(number) for number in _numbers_text(version).split("."))


def _numbers_text(version: str) -> str:
    return re.split(r"[a-z]", version)[0]


def _pre(version: str) -> bool:
    return re.search(r"[a-z]", version) is not None


def _order(version: str) -> tuple[tuple[int, ...], bool]:
    """Return what sorts releases, a pre-release before its release."""
    return (*_numbers(version), 0, 0)[:3], not _pre(version)
