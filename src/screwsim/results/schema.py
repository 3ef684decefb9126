"""Contents of a results file beside the figures: identity of the scene, inputs, axes, versions.

Groups: inputs, performance, balance, error, numerics (one value per case on the axes of the sweep), and, if traces are
kept, cycle (traces) and ledger (one value per case). Of two stages in series the file has inputs, performance and
error, and a group of all these for each stage.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.figures import known
from screwsim.inputs.declare import KINDS, FoundWithCycle, files_in, inputs_of
from screwsim.outputs import Variable
from screwsim.outputs.display import cf_unit
from screwsim.results import identity
from screwsim.scene import grid
from screwsim.scene.fields import Leaf
from screwsim.scene.model_errors import stored_model_errors
from screwsim.scene.types import Scene
from screwsim.scene.write import relative_to
from screwsim.version import version

RELATIVE_TO = "relative_to"  # attribute of an error: its scale (`outputs.Scale`)
MODEL_ERROR = "model_error"  # attribute: the model error from the validation that the scene names, as JSON
SCHEMA = 1  # to be raised when a reader of older files would misread a newer one
_LIBRARIES = ("numpy", "scipy", "llvmlite", "CoolProp")
_SCENE_UNITS = {cf_unit(kind.si): kind.si for kind in KINDS.values()}


class Axis(NamedTuple):
    """One axis of a sweep: `values` are numbers [SI], or texts (such as names of fluids or kinds).

    Where paths vary together, `path` is the name of the dimension, `values` count its cases from 0, and `joined` holds
    the values of each path along it.
    """

    path: str
    values: np.ndarray
    units: str  # as scenes have it ("rad/s"); files have it in CF style
    long_name: str
    joined: tuple[Axis, ...] = ()

    @property
    def name(self) -> str:
        """Name of the coordinate variable."""
        return variable_name(self.path)

    @property
    def about(self) -> dict[str, str]:
        """Attributes of the coordinate variable, its unit in CF style."""
        return {"units": cf_unit(self.units), "long_name": self.long_name, "path": self.path}


def quantities_along(axes: Iterable[Axis]) -> Iterator[Axis]:
    """Yield the quantities that vary along axes, those that vary together one after the other."""
    return (each for axis in axes for each in axis.joined or (axis,))


def variable_name(path: str) -> str:
    """Return the HDF5 name of a dotted path."""
    return path.replace(".", "_")


def scene_unit(units: str) -> str:
    """Return a unit of a file (CF style) as scenes and axes have it: 'rad s-1' gives 'rad/s', others themselves."""
    return _SCENE_UNITS.get(units, units)


def axis_of(path: str, values: Sequence[Any], units: str, long_name: str) -> Axis:
    """Return an axis; values that are not all numbers are kept as texts."""
    if all(isinstance(value, int | float | np.number) for value in values):
        return Axis(path, np.array(values, float), units, long_name)
    return Axis(path, np.array([str(value) for value in values], np.str_), "1", long_name)


def axes_of(scene: Scene) -> tuple[Axis, ...]:
    """Return the axes of the scene's sweep, in its order; none for a single case."""
    return axes_along(scene, lambda path: grid.leaf_of(scene, path))


def axes_along(swept: grid.Swept, leaf_of: Callable[[str], Leaf]) -> tuple[Axis, ...]:
    """Return the axes of a sweep, in its order; `leaf_of` gives the description of a path."""

    def along(path: str) -> Axis:
        leaf = leaf_of(path)
        return axis_of(path, swept.sweep[path], grid.unit_of(leaf) or "1", leaf.doc)

    found = []
    for name, paths, size, joint in grid.dimensions(swept):
        if joint is None:
            found.append(along(name))
            continue
        about = f"number of the {name.partition('_')[0]}, from 0"
        found.append(Axis(name, np.arange(size, dtype=np.int32), "1", about, tuple(map(along, paths))))
    return tuple(found)


def numeric_inputs(scene: Scene) -> Iterator[tuple[str, Variable, float]]:
    """Yield (path, unit and meaning, value [SI]) of each numeric input; NaN where it is not given or is to be found."""
    for path, leaf, value in inputs_of(scene):
        if leaf.dimension is not None or leaf.kind in ("number", "count"):
            # what is to be found holds where the search begins
            given = None if isinstance(value, FoundWithCycle) else value
            yield path, Variable(grid.unit_of(leaf), leaf.doc), np.nan if given is None else float(given)


def digest(text: str) -> str:
    """Return the SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def named_files(scene: Scene) -> dict[str, str]:
    """Return {name relative to the scene: path} of the files that the scene names."""
    paths = [str(Path(scene.folder) / name) for name in files_in(scene)]
    return {Path(relative_to(path, scene.folder)).as_posix(): path for path in paths}


def identity_of(scene: Scene) -> dict[str, str]:
    """Return what distinguishes results (`results.identity`); the folder of the scene does not matter."""
    drawn = [repr(scene.sweep[path]) for joint in scene.joints if joint.sample for path in joint.paths]
    found = {"schema": str(SCHEMA), "values of the scene": digest(scene.text)}
    found |= {"values of the sample": digest("\0".join(drawn))} if drawn else {}
    found |= {"figures": digest(repr(known()))[:16]} | identity.code_identity(scene.own)
    return found | identity.file_identity(named_files(scene))


def _library_version(name: str) -> str:
    """Return a library's version: its own statement if loaded, since reading the metadata takes milliseconds."""
    told = getattr(sys.modules.get(name), "__version__", None)
    return identity.installed_version(name, "not installed") if told is None else told


@dataclass(frozen=True)
class Subject:
    """What results are of: a scene, or two stages in series, which have neither balances nor numerics of their own.

    `text` is its YAML, `inputs` its numbers: path, unit and meaning, value [SI]; `more` are attributes besides.
    `alone`: it is one machine.
    """

    title: str
    text: str
    identity: Mapping[str, str]
    inputs: tuple[tuple[str, Variable, float], ...]
    model_error: str | None = None
    alone: bool = True
    more: Mapping[str, str] = field(default_factory=dict)


def subject_of(scene: Scene) -> Subject:
    """Return a scene as the subject of its results."""
    inputs = tuple(numeric_inputs(scene))
    return Subject(scene.title, scene.text, identity_of(scene), inputs, scene.model_error)


def root_attributes(subject: Subject, command: str) -> dict[str, str | int]:
    """Return the attributes of the file; only `history` depends on the time of writing."""
    told = identity.packed(subject.identity)
    moment = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    attributes: dict[str, str | int] = {
        "Conventions": "CF-1.11",
        "title": subject.title or "screwsim results",
        "source": f"screwsim {version()}",
        "history": f"{moment} screwsim {version()} {command}",
        "screwsim_schema": SCHEMA,
        "screwsim_version": version(),
        "screwsim_fingerprint": digest(told),
        "screwsim_identity": told,
        "scene_yaml": subject.text,
        "scene_sha256": digest(subject.text),
        "python_version": platform.python_version(),
        "numba_version": "not used",  # replaced by LLVM, through llvmlite
    }
    if name := subject.model_error:
        attributes[MODEL_ERROR] = json.dumps({"of": name, **stored_model_errors()[name]})
    return attributes | dict(subject.more) | {f"{name.lower()}_version": _library_version(name) for name in _LIBRARIES}
