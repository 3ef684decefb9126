"""YAML text as a tree of nodes that know their file, line and column.

Scalars follow YAML 1.2: `1e-3` is a number and `no` a string. Faults are collected, each with its place.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, ScalarNode, SequenceNode
from ruamel.yaml.reader import ReaderError
from ruamel.yaml.scanner import Scanner

from screwsim.inputs.faults import SceneError
from screwsim.scene.syntax import not_yaml
from screwsim.scene.units import Refused

OVERRIDE = 1_000_000  # rank of the first override, above those of all files
MOST_NODES = 1_000_000  # of one text, with all aliases written out
MOST_LEVELS = 32
MOST_DIGITS = 4000  # of a whole number; Python may refuse to read longer ones, and no float is so large
_LONGEST_PATH = 200  # characters of a path shown in a fault
_LEADING_POINT = re.compile(r"[+-]?\.[0-9]+[eE][+-]?[0-9]+")  # a YAML 1.2 number that ruamel reads as text
_LONE_SURROGATE = re.compile("[\ud800-\udfff]")
_CORE = "tag:yaml.org,2002:"  # prefix of YAML's own tags; any other tag would run a program
_KNOWN = {"str", "int", "float", "bool", "null", "map", "seq", "timestamp", "merge", "value"}


@dataclass(frozen=True, order=True)
class Position:
    """Position of a node; `rank` orders files (scene, its base, overrides), file names are relative to `folder`."""

    rank: int
    source: str
    line: int = 1
    column: int = 1
    folder: str = "."

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}" if self.line else self.source

    @classmethod
    def start_of(cls, file: str) -> Position:
        """Return the first position in a file, to whose folder the names in it are relative."""
        return cls(0, file, folder=os.path.dirname(os.path.abspath(file)))

    def at(self, line: int, column: int) -> Position:
        """Return another position in the same source."""
        return Position(self.rank, self.source, line, column, self.folder) if self.line else self

    def is_over(self, other: Position) -> bool:
        """Return whether what stands here takes the place of what stands there: a scene over its base, then overrides.

        Of two overrides the later one does.
        """
        mine, theirs = (rank if rank >= OVERRIDE else -rank for rank in (self.rank, other.rank))
        return mine > theirs


@dataclass(frozen=True)
class Node:
    """A scalar, a list of nodes or a mapping of nodes; `key` is the position of its name in the mapping."""

    value: Any
    place: Position
    key: Position | None = None

    @property
    def heading(self) -> Position:
        """Return the position to report for the node as a whole."""
        return self.key or self.place


@dataclass(frozen=True)
class LocatedFault:
    """A fault with its place."""

    place: Position
    path: str
    what: str

    def __str__(self) -> str:
        path = self.path if len(self.path) <= _LONGEST_PATH else f"{self.path[:_LONGEST_PATH]}…"
        return one_line(f"{self.place}: {path}: {self.what}" if path else f"{self.place}: {self.what}")


class LocatedFaults(list[LocatedFault]):
    """The faults found so far in what is being read."""

    def add(self, place: Position, path: str, what: str) -> None:
        """Add a fault."""
        self.append(LocatedFault(place, path, what))

    @contextmanager
    def at(self, place: Position, path: str, before: str = "") -> Iterator[None]:
        """Add what is refused within as a fault, behind the words `before`, and go on behind it."""
        try:
            yield
        except Refused as refusal:
            self.add(place, path, f"{before}{refusal}")

    def error(self) -> SceneError:
        """Return the error that lists all faults, each once, in the order of their places."""
        return SceneError([str(each) for each in sorted(dict.fromkeys(self), key=lambda each: each.place)])


def one_line(text: str) -> str:
    """Return a text without line breaks and control characters, as a fault must fit on one line."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


def join(path: str, name: str) -> str:
    """Return the dotted path of a child."""
    return f"{path}.{name}" if path else name


def compose(text: str, start: Position, problems: LocatedFaults, path: str = "") -> Node | None:
    """Return the tree of a YAML text that begins at `start`; None if empty or, after a fault was added, not YAML."""
    try:
        root, too_large = _tree(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = start if mark is None else start.at(mark.line + 1, mark.column + 1)
        problems.add(place, path, not_yaml(error, text))
        return None
    except ReaderError as error:
        before = text[: error.position]
        place = start.at(before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1)
        what = f"is not YAML: it contains the control character U+{ord(text[error.position]):04X}"
        problems.add(place, path, f"{what} (remove it, or save the file as plain text in UTF-8)")
        return None
    except YAMLError as error:
        problems.add(start, path, f"is not YAML: {str(error).splitlines()[0]} (save the file as plain text)")
        return None
    except RecursionError:
        problems.add(start, path, _TOO_DEEP)
        return None
    if root is None:
        return None
    if too_large:
        problems.add(start, path, too_large)
        return None
    return _Converter(start, problems).convert(root, path)


@lru_cache(maxsize=64)  # bases are read again with each scene on them, and ruamel takes some milliseconds per page
def _tree(text: str) -> tuple[Any, str]:
    """Return ruamel's tree of a text, which callers must not change, and what is wrong with its size (else empty)."""
    yaml = YAML(typ="safe", pure=True)
    yaml.Scanner = _Scanner
    yaml.composer.warn_double_anchors = False  # the later anchor replaces the earlier one from there on, as in YAML
    root = yaml.compose(text)
    return root, _size_fault(root)


class _Scanner(Scanner):
    """Scanner that stops at more open brackets than levels allowed: ruamel's time grows with their number squared."""

    def fetch_flow_collection_start(self, TokenClass: Any, to_push: str) -> None:
        if len(self.flow_context) >= MOST_LEVELS:
            raise RecursionError
        super().fetch_flow_collection_start(TokenClass, to_push)


_TOO_DEEP = f"is nested deeper than {MOST_LEVELS} levels (a scene has about five)"


def _size_fault(root: Any) -> str:
    """Return what is wrong with the size of ruamel's tree, all aliases written out; empty if nothing is.

    Aliases of aliases make an immense tree of a short text; here each node is visited once.
    """
    sizes: dict[int, tuple[int, int]] = {}  # number of nodes, and of levels

    def size(node: Any) -> tuple[int, int]:
        if id(node) not in sizes:
            sizes[id(node)] = 0, 0  # a node inside itself is reported where the tree is converted
            inner = [size(child) for child in _children(node)]
            sizes[id(node)] = 1 + sum(n for n, _ in inner), 1 + max((levels for _, levels in inner), default=0)
        return sizes[id(node)]

    try:
        nodes, levels = size(root)
    except RecursionError:
        return _TOO_DEEP
    if levels > MOST_LEVELS:
        return _TOO_DEEP
    if nodes > MOST_NODES:
        return f"has more than {MOST_NODES} values when its aliases are written out (write fewer)"
    return ""


def _children(node: Any) -> list[Any]:
    if isinstance(node, MappingNode):
        return [part for pair in node.value for part in pair]
    return node.value if isinstance(node, SequenceNode) else []


class _Converter:
    """Converter from ruamel's nodes to `Node`, each converted once: an alias shares the node of its anchor."""

    def __init__(self, start: Position, problems: LocatedFaults) -> None:
        self.start = start
        self.problems = problems
        self.done: dict[int, Node | None] = {}

    def convert(self, node: Any, path: str) -> Node:
        place = self.place(node)
        if id(node) not in self.done:
            self.done[id(node)] = None  # being converted: found again, the node is inside itself
            self.done[id(node)] = Node(self.value(node, path), place)
        found = self.done[id(node)]
        if found is None:
            self.problems.add(place, path, "contains itself (write the values out instead of the alias)")
            return Node(None, place)
        return found

    def place(self, node: Any) -> Position:
        return self.start.at(node.start_mark.line + 1, node.start_mark.column + 1)

    def value(self, node: Any, path: str) -> Any:
        tag = str(node.tag)
        if tag.removeprefix(_CORE) not in _KNOWN:
            what = f"has the tag {tag.replace(_CORE, '!!')[:40]}, which a scene cannot have (remove it)"
            self.problems.add(self.place(node), path, what)
        if isinstance(node, ScalarNode):
            text = self.text(node, path)
            return float(text) if node.style is None and _LEADING_POINT.fullmatch(text) else scalar(node.tag, text)
        if isinstance(node, SequenceNode):
            return [self.convert(item, path) for item in node.value]
        return dict(self.items(node, path))

    def text(self, node: ScalarNode, path: str) -> str:
        """Return the text of a scalar; half a character (a lone surrogate) or a null character is a fault."""
        text = whole_letters(node.value)
        for fault, what in (
            (_LONE_SURROGATE.search(text), "half a letter (a lone surrogate)"),
            ("\0" in text, "a null character"),
        ):
            if fault:
                self.problems.add(self.place(node), path, f"contains {what} (remove it)")
                return ""
        return text

    def items(self, node: MappingNode, path: str) -> Iterator[tuple[str, Node]]:
        seen: dict[str, Position] = {}
        for key, child in node.value:
            word = isinstance(key, ScalarNode)
            name, place = self.text(key, path) if word else "?", self.place(key)
            what = None
            if not word:
                what = "has a key that is not a word (write NAME: value)"
            elif key.tag.endswith(":merge"):
                what = "merge keys are not supported (write the keys out, or use base:)"
            elif name in seen:
                what = f"appears twice, first in line {seen[name].line} (remove one)"
            if what is not None:
                self.problems.add(place, join(path, name), what)
                continue
            seen[name] = place
            made = self.convert(child, join(path, name))
            yield name, Node(made.value, made.place, place)


def whole_letters(text: str) -> str:
    """Return a text with surrogate pairs joined: JSON escapes each character beyond 16 bits as two halves."""
    halved = _LONE_SURROGATE.search(text) is not None
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "surrogatepass") if halved else text


def scalar(tag: str, text: str) -> Any:
    """Return the value of a YAML 1.2 scalar: None, bool, int, float or str."""
    kind = "str" if "_" in text else tag.rpartition(":")[2]  # no number of YAML 1.2 has an underscore
    try:
        if kind == "int":
            return int(text, 0) if text.lstrip("+-")[:2].lower() in ("0x", "0o", "0b") else int(text)
        if kind == "float":
            return float(text.replace(".inf", "inf").replace(".nan", "nan"))
    except ValueError:  # e.g. .Inf
        return math.inf if kind == "int" and len(text) > MOST_DIGITS else text
    if kind == "bool":
        return text.lower() == "true"
    return None if kind == "null" else text


def merge(below: Node, above: Node) -> Node:
    """Return `below` with `above` merged over it: mappings merge, anything else is replaced."""
    if not (isinstance(below.value, dict) and isinstance(above.value, dict)):
        return above
    merged = dict(below.value)
    for name, node in above.value.items():
        merged[name] = merge(merged[name], node) if name in merged else node
    return Node(merged, above.place, above.key)


def child_of(node: Node | None, *keys: str) -> Node | None:
    """Return the node below some keys, one in the other; None where there is none."""
    for key in keys:
        node = node.value.get(key) if node is not None and isinstance(node.value, dict) else None
    return node


def locate(root: Node, path: str) -> tuple[Node, bool]:
    """Return the node at a dotted path, or its nearest ancestor, and whether the path itself was found.

    Keys may contain dots themselves: the longest that begins the path is followed.
    """
    node = root
    while path:
        keys = node.value if isinstance(node.value, dict) else ()
        key = max((each for each in keys if f"{path}.".startswith(f"{each}.")), key=len, default=None)
        if key is None:
            return node, False
        node, path = node.value[key], path[len(key) + 1 :]
    return node, True


def pointer(root: Node, path: str) -> Position:
    """Return the position to report for a fault at a path: that of the value, else of the section that contains it."""
    node, found = locate(root, path)
    leaf = found and node.value is not None and not isinstance(node.value, dict)  # null has no position of its own
    return node.place if leaf else node.heading
