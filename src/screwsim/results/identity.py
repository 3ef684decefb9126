"""What results depend on: scene, code, user-defined modules and files, identified by contents, not by name or date.

Only results of one identity may be in one file. It is a flat {what: digest or version}, stored with the results, so
that a refusal can name the differences.
"""

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from screwsim.numerics import sources
from screwsim.numerics.trial import import_own_module
from screwsim.scene.yaml_tree import LocatedFaults, Node, Position, compose
from screwsim.version import release, version

LIBRARIES = ("CoolProp", "llvmlite", "numpy", "scipy")
Identity = Mapping[str, str]
Files = Mapping[str, str]  # {file as named in the scene: its path}
_FILE, _MODULE, _SOURCES, _NONE = "file ", "module ", "screwsim sources", "none"
_MOST_DIFFERENCES = 3  # number of differences listed


def code_identity(own: Iterable[str]) -> dict[str, str]:
    """Return the identity of the code of this process: this package, libraries and user-defined modules.

    For this package that is its release and a digest of its sources: a version between tags changes with each commit,
    even of a documentation page, and would refuse results that are still valid.
    """
    found = {"screwsim": release(version()), _SOURCES: sources.package_digest()}
    found |= {name: installed_version(name) for name in LIBRARIES}
    for name in own:
        import_own_module(name)  # imports it, if a worker has not yet
        found |= {_MODULE + file: text for file, text in sources.recorded[name].digests.items()}
    return found


def file_identity(files: Files) -> dict[str, str]:
    """Return the contents of files; `none` for one that cannot be read."""
    return {_FILE + name: _content(path) for name, path in files.items()}


def files_of(identity: Identity) -> dict[str, str]:
    """Return the part of an identity that describes files."""
    return {name: text for name, text in identity.items() if name.startswith(_FILE)}


def packed(identity: Identity) -> str:
    """Return an identity as text."""
    return json.dumps(identity, sort_keys=True)


def unpacked(text: Any) -> Identity | None:
    """Return an identity from its text; None where there is none."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def differences(stored: Identity, wanted: Identity) -> str:
    """Return in words the differences, at most a few; '' if there are none."""
    return _first_few(list(_differences(stored, wanted)))


def changed_values(stored: Mapping[str, str], wanted: Mapping[str, str]) -> str:
    """Return which values of two scenes differ, by path, at most a few, after a comma; '' if none do."""
    none = "not there"
    changed = [path for path in dict.fromkeys((*stored, *wanted)) if stored.get(path) != wanted.get(path)]
    told = [f"{path}: {stored.get(path, none)}, now {wanted.get(path, none)}" for path in changed]
    return f", {_first_few(told)}" if told else ""


def scene_values(text: str, file: str, left_out: tuple[str, ...] = ()) -> dict[str, str]:
    """Return {dotted path: text} of a scene's canonical text from a file, without the sections `left_out`."""
    root = compose(text, Position(0, file), LocatedFaults())
    return {} if root is None else dict(_leaves(root, "", left_out))


def _leaves(node: Node, path: str, left_out: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    if isinstance(node.value, list):
        yield path, _in_a_list(node)
        return
    if not isinstance(node.value, dict):
        yield path, str(node.value)
        return
    if not node.value and path:
        yield path, "simulated" if path.startswith("effects.") else "{}"
    for name, child in node.value.items():
        if path or name not in left_out:
            yield from _leaves(child, f"{path}.{name}" if path else name, left_out)


def _in_a_list(node: Node) -> str:
    """Return the text of a value in a list, or of a list: its values alone, without their places in the file."""
    if isinstance(node.value, list):
        return f"[{', '.join(map(_in_a_list, node.value))}]"
    if isinstance(node.value, dict):
        return f"{{{', '.join(f'{name}: {_in_a_list(child)}' for name, child in node.value.items())}}}"
    return str(node.value)


def _first_few(told: list[str]) -> str:
    more = f", and {len(told) - _MOST_DIFFERENCES} more differences" if len(told) > _MOST_DIFFERENCES else ""
    return ", ".join(told[:_MOST_DIFFERENCES]) + more


def disagreement(found: Identity, wanted: Identity) -> str:
    """Return in words how a process differs from the `wanted` identity, at most a few things; '' if it does not."""
    told = []
    for name, now in wanted.items():
        here = found.get(name, _NONE)
        if here == now or (name == _SOURCES and found.get("screwsim") != wanted.get("screwsim")):
            continue
        label = name.removeprefix(_FILE).removeprefix(_MODULE)
        if label != name:
            told.append(f"lacks {label}" if here == _NONE else f"has another {label}")
        elif name == _SOURCES:
            told.append(f"has different sources of screwsim {wanted.get('screwsim')}")
        else:
            told.append(f"has {name} {here}, not {now}")
    return _first_few(told)


def _differences(stored: Identity, wanted: Identity) -> Iterator[str]:
    for name in dict.fromkeys((*stored, *wanted)):
        before, now = stored.get(name, _NONE), wanted.get(name, _NONE)
        if before == now:
            continue
        label = name.removeprefix(_FILE).removeprefix(_MODULE)
        if label != name:
            yield f"{label} {_change(before, now)}"
        elif name == _SOURCES:
            if stored.get("screwsim") == wanted.get("screwsim"):
                yield f"from different sources of screwsim {wanted.get('screwsim')}"
        elif name == "screwsim":
            yield f"from screwsim {before}, this is {now}"
        elif name in LIBRARIES:
            yield f"{name} {before} wrote it, this is {now}"
        else:
            yield f"with other {name}"


def _change(before: str, now: str) -> str:
    return "did not exist" if before == _NONE else "no longer exists" if now == _NONE else "has changed since"


def _content(path: str) -> str:
    try:
        return sources.digest(Path(path).read_bytes())
    except OSError:
        return _NONE


@cache
def installed_version(name: str, absent: str = _NONE) -> str:
    """Return the version of an installed library, or what says that it is absent."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return absent
