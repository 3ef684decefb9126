"""Questions to commands about a random machine: its scene, random numbers of it, and what answers must keep.

An internal error, an exit code without a reason, or a number that is not finite is a `Contradiction` of any answer.
"""

from __future__ import annotations

import csv
import io
import json
import re
import shlex
import zipfile
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.cli import exit_code
from screwsim.figures.errors import relative_errors
from screwsim.outputs import Figures
from screwsim.scene import Scene, load, value_at
from screwsim.scene.fields import Leaf, leaves_of, varies
from screwsim.scene.values import text_of
from screwsim.study.asked.inputs import DISCRETE_KINDS
from screwsim.study.asked.spans import schema_range

NEAR = 1.5  # factor within which numbers are changed ...
KELVINS = 8.0  # ... and temperatures
FROM_ZERO = 0.3  # share of its range within which a number at zero is changed
BOTH = 4.0  # errors of one answer by which two may differ: each errs as much, and estimates are no bounds
FLOOR = 3e-5  # relative difference that is always allowed: a tenth of the wanted accuracy
UNREAL = "numerics.", "oil_supply.orifice_count"  # paths that are no machine's, or a whole number
STEP = 1e-3  # of a difference, relative to the value; for temperatures to 100 K
FINE = "numerics.accuracy=1e-6"  # of the runs whose difference is a derivative
OK, INTERNAL, USAGE, BAD, PARTLY = range(5)  # exit codes

Figured = dict[str, Any]


class Contradiction(Exception):
    """A command broke what every command promises."""


class NotAsked(Exception):
    """The command refused, or failed with a reason: nothing to compare."""


@dataclass
class Case:
    """A scene in a file of an own folder, and the random numbers by which it is asked about."""

    file: str
    random: np.random.Generator
    told: list[str]

    def ask(self, *arguments: str, partly: bool = False) -> tuple[int, str]:
        """Return exit code and standard output of a command; raise NotAsked where it refuses."""
        code, out, said = command(*arguments)
        if code in (OK, PARTLY) and (code == OK or partly):
            return code, out
        self.told.append(f"{code}: {shlex.join(arguments)}: {said or out[-300:]}")
        raise NotAsked

    def json(self, *arguments: str, partly: bool = False) -> dict[str, Any]:
        """Return the document that a command prints with --json."""
        return document(self.ask(*arguments, "--json", partly=partly)[1])

    def run(self, *changes: str, file: str = "") -> dict[str, Any]:
        """Return the document of a run with some numbers changed."""
        return self.json("run", file or self.file, *(part for each in changes for part in ("--set", each)))

    @cached_property
    def scene(self) -> Scene:
        """The scene."""
        return load(self.file)

    @cached_property
    def leaves(self) -> dict[str, Leaf]:
        """The inputs of the scene by path."""
        return leaves_of(self.scene)

    def is_temperature(self, path: str) -> bool:
        """Return whether a path is a temperature, whose ratios mean nothing."""
        return self.leaves[path].kind == "temperature"

    def paths(self, count: int) -> list[str]:
        """Return random paths of numbers that the scene states and that may be varied; raise NotAsked without any."""
        ranged = [path for path, leaf in self.leaves.items() if self._is_asked_about(path, leaf)]
        usual = [path for path in ranged if path.startswith(("operation.", "oil_supply."))]
        some = usual if len(usual) >= count and self.random.random() < 0.5 else ranged
        if len(some) < count:
            raise NotAsked
        return [str(path) for path in self.random.choice(some, count, replace=False)]

    def _is_asked_about(self, path: str, leaf: Leaf) -> bool:
        if path.startswith(UNREAL) or not varies(path, leaf) or leaf.kind in DISCRETE_KINDS:
            return False
        return f" {path.rpartition('.')[2]}: " in self.scene.text and near(self.scene, path) is not None

    def value(self, path: str) -> float:
        """Return a random value [SI] near that of the scene."""
        low, high = near(self.scene, path) or (0.0, 0.0)
        return float(self.random.uniform(low, high))

    def span(self, path: str) -> str:
        """Return LOW..HIGH about the scene's value."""
        return "..".join(stated(self.scene, path, each) for each in near(self.scene, path) or ())

    def of(self, path: str, value: float) -> str:
        """Return PATH=VALUE."""
        return f"{path}={stated(self.scene, path, value)}"


def command(*arguments: str) -> tuple[int, str, str]:
    """Return exit code, standard output and error output (without progress) of a command."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        code = exit_code(arguments)
    said = " ".join(line for line in err.getvalue().splitlines() if "compil" not in line)
    if code == INTERNAL or "Traceback" in said:
        raise Contradiction(f"internal error: {shlex.join(arguments)}: {said}")
    if code in (USAGE, BAD) and not said:
        raise Contradiction(f"exit code {code} without a reason: {shlex.join(arguments)}")
    return code, out.getvalue(), said


def document(text: str) -> dict[str, Any]:
    """Return a JSON document all of whose numbers are finite."""

    def refuse(word: str) -> None:
        raise Contradiction(f"{word} in a JSON document: {text[:200]}")

    found: dict[str, Any] = json.loads(text, parse_constant=refuse)
    return found


def near(scene: Scene, path: str) -> tuple[float, float] | None:
    """Return the range [SI] of a number about that of the scene; None for one without a usual range."""
    value = value_at(scene, path)
    ends = None if value is None else schema_range(scene, path)
    if ends is None:
        return None
    if leaves_of(scene)[path].kind == "temperature":
        low, high = value - KELVINS, value + KELVINS
    elif value == 0.0:
        low, high = ends[0], ends[0] + FROM_ZERO * (ends[1] - ends[0])
    else:
        low, high = sorted((value / NEAR, value * NEAR))
    return max(low, ends[0]), min(high, ends[1])


def stated(scene: Scene, path: str, value: float) -> str:
    """Return a value [SI] as a scene states it, to its last bit."""
    return text_of(leaves_of(scene)[path], value)


def differences(found: Figured, true: Figured, errors: Figured, label: str) -> Iterator[str]:
    """Yield the figures of two answers that differ by more than their errors [relative to their scale]."""
    for name, off in relative_errors(Figures(found), Figures(true)).items():
        allowed = BOTH * 2.0 * (errors.get(name) or 0.0) + FLOOR
        if off is not None and off > allowed:
            yield f"{label}: {name} {found[name]!r}, not {true[name]!r}: off by {off:.1e}, allowed {allowed:.1e}"


def unequal(found: dict[str, Any], true: dict[str, Any], label: str) -> Iterator[str]:
    """Yield the figures of two runs that are not the same to the last bit."""
    for name in {**found["performance"], **true["performance"]}:
        one, other = (each["performance"].get(name) for each in (found, true))
        if one != other:
            yield f"{label}: {name} {one!r}, not {other!r}"


def turned(tree: Any) -> Any:
    """Return a tree with the keys of its mappings in reverse order."""
    return {key: turned(tree[key]) for key in reversed(tree)} if isinstance(tree, dict) else tree


def slope(case: Case, path: str) -> dict[str, tuple[float, float]]:
    """Return the derivative of each figure by the difference of two fine runs, and its uncertainty."""
    value = value_at(case.scene, path)
    step = STEP * (100.0 if case.is_temperature(path) else abs(value))
    low, high = (case.run(case.of(path, value + by * step), FINE) for by in (-1.0, 1.0))
    found = {}
    for name, there in high["performance"].items():
        here = low["performance"].get(name)
        if there is not None and here is not None:
            noise = sum(abs(there) * (each["error"].get(name) or 0.0) for each in (low, high))
            found[name] = (there - here) / (2.0 * step), noise / (2.0 * step)
    return found


def axes(row: dict[str, Any], scene: Scene) -> dict[str, float]:
    """Return the paths of a data sheet's row with their values [SI]."""
    if "free_air_delivered" in row:
        return {"operation.speed": row["speed"]}  # the pressure of the row is the one before the package's losses
    there = (path for path in leaves_of(scene) if path.startswith("operation."))
    known = {path.removeprefix("operation.").replace(".", "_"): path for path in there}
    found = {known[name]: value for name, value in row.items() if name in known}
    return {path: value for path, value in found.items() if value_at(scene, path) is not None}


def nodes(file: str) -> list[tuple[float, dict[str, float]]]:
    """Return the nodes of a map of one input, with its figures."""
    if file.endswith("csv"):
        head, *rows = csv.reader(line for line in Path(file).read_text().splitlines() if line[0] != "#")
        names = [name.partition(" [")[0] for name in head]
        read = [dict(zip(names, map(float, row), strict=True)) for row in rows]
        return [(row[names[0]], {n: row[n] for n in names[1:-1]}) for row in read if row["closed"]]
    inside = zipfile.ZipFile(file)
    names = [each["name"] for each in json.loads(inside.read("resources/map.json"))["outputs"]]
    text = inside.read("sources/map_data.h").decode()
    lists = re.findall(r"(\w+)\[\d+\] = \{(.*?)\}", text, re.DOTALL)
    numbers = {name: [float(each) for each in row.split(",")] for name, row in lists}
    at = np.exp(numbers["map_nodes"]) if numbers["map_logarithmic"][0] else numbers["map_nodes"]
    each_node = np.reshape(numbers["map_data"], (len(at), -1)).tolist()  # values, then slopes
    rows = zip(at, each_node, numbers["map_sound"], strict=True)
    return [(float(value), dict(zip(names, row, strict=False))) for value, row, sound in rows if sound]
