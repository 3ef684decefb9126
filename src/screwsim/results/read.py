"""Results from HDF5: figures by name, read on demand; nothing but results is taken from a file."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.figures import declaration, unpacked
from screwsim.figures.errors import error_scale, figures_for_scale
from screwsim.inputs.arguments import FILE, checked_arguments, one_of
from screwsim.inputs.faults import UsageError
from screwsim.outputs import ITSELF, STATUSES, Figure, Variable, shown_of
from screwsim.outputs.display import About, Brief, cf_unit, value_text
from screwsim.results import stored
from screwsim.results.chosen import cases_with
from screwsim.results.group import OWN, Group, labels_of, values_of
from screwsim.results.schema import RELATIVE_TO, SCHEMA, Axis, quantities_along, scene_unit, variable_name
from screwsim.results.stored import REMEDY, MalformedFile, opened

# the first two come with traces, the next two with their studies, two with tolerances, the last on request
_ALWAYS = ("inputs", "performance", "balance", "error", "numerics")
_OPTIONAL = ("cycle", "ledger", "knock_out", "optimum", "uncertainty", "contributions", "derivatives")
ACCURACY = "numerics.accuracy"
SCENE_AT_POINT = "scene_yaml_at_point"  # attribute of a stage: its scene with the line between both as found
STAGES = ("first", "second")  # groups of results of their own, where two machines are in series
_LARGEST = 1e30  # of a coordinate, in SI units
_VERSIONS = "screwsim", "python", "numpy", "scipy", "llvmlite", "coolprop"  # whose versions a stored scene states
_TEXTS = ("title", "source", "history", "scene_yaml", "scene_sha256", "screwsim_fingerprint", "screwsim_version")


@dataclass(frozen=True, repr=False)
class Results(Brief):
    """A results file: `axes` {dotted path: values [SI] or texts}, and one mapping per group.

    That of two stages in series has the figures of both together, and in `stages` the results of each by its name.
    """

    path: Path
    attributes: Mapping[str, Any]
    axis_list: tuple[Axis, ...]
    inputs: Group
    performance: Group
    balance: Group
    error: Group
    numerics: Group
    cycle: Group  # with `angle`; empty unless the traces were kept
    ledger: Group  # empty unless the traces were kept
    knock_out: Group  # over `effect`; empty unless requested, and for one run only
    optimum: Group  # over the first axis; empty unless an optimisation wrote the file
    uncertainty: Group  # standard uncertainty of each figure by the inputs; empty unless the scene gives tolerances
    contributions: Group  # over `contributor`: change by one standard uncertainty of each input
    derivatives: Group  # over `number`: of each figure by each number of the scene; empty unless requested
    stages: Mapping[str, Results] = field(default_factory=dict, kw_only=True)  # on the same axes; empty for one machine
    stage: str = field(default="", kw_only=True)  # the name of this one of two stages
    asked: np.ndarray | None = field(default=None, kw_only=True)  # cases of which one's cycle is drawn; None: of all

    if not TYPE_CHECKING:  # to which every attribute would be known then

        def __getattr__(self, name: str) -> Any:
            if name in self.__dict__.get("performance", ()):
                dataset = "to_xarray() gives a dataset that has it as an attribute (pip install 'screwsim[xarray]')"
                raise AttributeError(f"results have no attribute {name!r}: performance[{name!r}] has it; {dataset}")
            raise AttributeError(f"results have no attribute {name!r}")

    @property
    def scene_yaml(self) -> str:
        """The scene's text, overrides included."""
        return self.attributes["scene_yaml"]

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """Values of each axis by its dotted path, in the order of the dimensions (`varied` has joined paths too)."""
        return {axis.path: axis.values for axis in self.axis_list}

    @property
    def varied(self) -> dict[str, tuple[int, np.ndarray]]:
        """Dimension, and values along it, of every path that the sweep varies, including paths that vary together."""
        found = {}
        for number, axis in enumerate(self.axis_list):
            found |= {inner.path: (number, inner.values) for inner in quantities_along([axis])}
        return found

    def along(self, path: str) -> np.ndarray:
        """Return the values of a varied path in all cases, on the axes of the results."""
        number, values = self.varied[path]
        return np.broadcast_to(values.reshape([-1 if i == number else 1 for i in range(len(self.shape))]), self.shape)

    def stated(self, path: str) -> np.ndarray:
        """Return a number of the scene [SI] in all cases, varied or not, on the axes of the results; NaN without it."""
        if path in self.varied:
            return self.along(path)
        name = variable_name(path)
        return np.broadcast_to(self.inputs.get(name, np.nan), self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values on each axis; () for one run."""
        return tuple(len(axis.values) for axis in self.axis_list)

    @cached_property
    def status(self) -> np.ndarray:
        """Status of each case as a word."""
        return np.array([*STATUSES, "not_computed"])[self.performance["status"]]

    @property
    def messages(self) -> np.ndarray:
        """Why each case failed or did not close; empty for a case that closed."""
        return self.performance["message"]

    @property
    def warnings(self) -> np.ndarray:
        """Warnings of each case, joined by line breaks; empty without any."""
        return self.performance["warnings"]

    @property
    def accuracy(self) -> np.ndarray:
        """Accuracy that the scene asks for, in each case; of two stages that of the less accurate one."""
        every = [each.stated(ACCURACY) for each in self.stages.values()] or [self.stated(ACCURACY)]
        return np.max(every, axis=0)

    def showing(self, values: Mapping[str, Any]) -> Results:
        """Return these results, of whose cycles that of the best case with these values is drawn.

        values: {dotted path: number [SI] or text with its unit}, of paths that the sweep varies.
        """
        return replace(self, asked=cases_with(self, values))

    def holder(self, name: str) -> tuple[Results, str]:
        """Return the results that have a figure, and its name there: of two stages `first_` and `second_` are each."""
        stage, _, own = name.partition("_")
        if name in self.performance or stage not in self.stages:
            return self, name
        return self.stages[stage], own

    def figure(self, name: str) -> Figure:
        """Return the declaration of a figure as the file states it; the error's scale is missing from older files."""
        of, own = self.holder(name)
        if of is not self:
            about = of.figure(own)
            return replace(about, name=name, long_name=f"{about.long_name}, {of.stage} stage")
        units, long_name = self.performance.about[name]
        here = declaration(name)
        scale = unpacked(self.error.scales.get(name, "")) or getattr(here, "scale", ITSELF)
        return Figure(name, units, long_name, scale, shown=here.shown if here and cf_unit(here.units) == units else "")

    def absolute_error(self, name: str, unknown: float | np.ndarray = np.nan) -> np.ndarray:
        """Return the estimated numerical error of a figure in each case, in its own unit [SI].

        Where none was estimated, the relative error `unknown` is used, one of all cases or of each.
        """
        of, own = self.holder(name)
        if of is not self:
            return of.absolute_error(own, unknown)
        scale = self.figure(name).scale
        asked = (each for each in figures_for_scale(name, scale) if each in self.performance)
        known = {each: np.nan_to_num(self.performance[each]) for each in asked}
        relative = np.where(np.isfinite(self.error[name]), self.error[name], unknown)
        return relative * error_scale(name, scale, known, np.maximum)

    @cached_property
    def figures(self) -> list[str]:
        """Names of the performance figures that have a value in any case."""
        names = [name for name in self.error if name in self.performance]
        self.performance.take(names)
        return [name for name in names if np.isfinite(self.performance[name]).any()]

    @checked_arguments(group=one_of(None, *_ALWAYS, *_OPTIONAL))
    def to_xarray(self, group: str | None = "performance") -> Any:
        """Return one group as an xarray.Dataset; None: all in one, with prefixes to names of groups but performance."""
        from screwsim.results.dataset import dataset

        return dataset(self, group)

    @checked_arguments(group=one_of(*_ALWAYS, *_OPTIONAL))
    def to_pandas(self, group: str = "performance") -> Any:
        """Return one group as a pandas.DataFrame, one row per case: varied inputs, then the variables, in SI units.

        Its `attrs` have the `units` and `meanings` of the columns.
        """
        from screwsim.results.dataset import frame

        return frame(self, group)

    def _about(self) -> About:
        axes = " × ".join(f"{axis.path} ({len(axis.values)})" for axis in self.axis_list) or "one run"
        words, counts = np.unique(self.status, return_counts=True)
        ended = ", ".join(f"{count} {word}" for word, count in zip(words, counts, strict=True))
        rows = [self._range(name) for name in self.figures]
        return About(f"Results of {self.path}: {axes}; {ended}", (), ("figure", "least", "most", "meaning"), rows)

    def _range(self, name: str) -> tuple[str, str, str, str]:
        about, values = self.figure(name), self.performance[name]
        least, most = (value_text(shown_of(about, float(end))) for end in (np.nanmin(values), np.nanmax(values)))
        return name, least, most, about.long_name


@checked_arguments(path=FILE)
def open_results(path: str | os.PathLike[str]) -> Results:
    """Return the results in a file; raise UsageError if it is not a valid results file of screwsim."""
    path = Path(path)
    with opened(path) as file:
        there = [name for name in STAGES if stored.has(file, name)]
        stages = {name: _results(path, stored.stage_of(file, name), name) for name in there}
        found = _results(path, file)
        if any(each.shape != found.shape for each in stages.values()):
            raise MalformedFile("is not a results file: the axes of its stages differ from its own")
        return replace(found, stages=stages)


def _results(path: Path, root: Any, stage: str = "") -> Results:
    """Return the results in a file's root, or in the group of one of two stages."""
    attributes, axes = _root(path, root), _axes(stored.member(root, "performance", dataset=False))
    groups = (_group(path, root, name, axes, stage) for name in (*_ALWAYS, *_OPTIONAL))
    return Results(path, attributes, axes, *groups, stage=stage)


def read_attributes(path: Path) -> dict[str, Any]:
    """Return only the attributes of a results file; raise UsageError as `open_results` does."""
    with opened(path) as file:
        return _root(path, file)


def stored_scene(results: Results) -> str:
    """Return the YAML text of a file's scene, below comment lines on its source, versions and the tables it needs."""
    told = results.attributes
    versions = ", ".join(f"{name} {told[f'{name}_version']}" for name in _VERSIONS if f"{name}_version" in told)
    lines = [f"# The scene of {results.path.name}, scene_sha256 {told['scene_sha256'][:16]}", f"# {versions}"]
    identity = json.loads(told["screwsim_identity"])
    tables = {name.removeprefix("file "): value for name, value in identity.items() if name.startswith("file ")}
    if tables:
        beside = ", ".join(f"{name} ({digest})" for name, digest in tables.items())
        lines.append(f"# It needs these files next to it, unchanged (first digits of their SHA-256): {beside}")
    return "\n".join(lines) + "\n" + results.scene_yaml


def stored_scenes(results: Results) -> dict[str, str]:
    """Return the text of a file's scene as `stored_scene`, under '', and those of two stages under their files."""
    return {"": stored_scene(results)} | {f"{name}.yaml": stored_scene(each) for name, each in results.stages.items()}


def stage_scene(results: Results, stage: str) -> str:
    """Return the text of one stage's scene with the line between both as it was found; raise UsageError without one."""
    if stage not in results.stages:
        named = ", ".join(results.stages) or "none"
        raise UsageError(f"{results.path}: has no stage {stage!r} (its stages: {named})")
    own = results.stages[stage]
    if SCENE_AT_POINT not in own.attributes:
        why = "is of a sweep" if results.shape else "holds no solution"
        raise UsageError(f"{results.path}: {why}, so the line between its stages is not known (run one of its points)")
    return stored_scene(replace(own, attributes={**own.attributes, "scene_yaml": own.attributes[SCENE_AT_POINT]}))


def count_statuses(path: Path) -> tuple[int, ...]:
    """Return the number of cases of a results file with each status of `outputs.STATUSES`."""
    with opened(path) as file:
        status = values_of(stored.member(file, "performance", dataset=False), "status")
    return tuple(int(np.count_nonzero(status == index)) for index in range(len(STATUSES)))


def _group(path: Path, file: Any, name: str, axes: tuple[Axis, ...], stage: str = "") -> Group:
    if name in _OPTIONAL and not stored.has(file, name):
        return Group(path, name, {}, {}, stage)
    group = stored.member(file, name, dataset=False)
    known = tuple(inner.name for axis in axes for inner in (axis, *axis.joined))
    axes = axes[:1] if name == "optimum" else axes
    if name == "inputs":
        known = tuple(each for each in known if stored.is_scale(stored.member(group, each)))
    shape = () if name == "knock_out" else tuple(len(axis.values) for axis in axes)
    about = _about_all(group, known, name, shape)
    return Group(path, name, about, dict(_scales(group, about)) if name == "error" else {}, stage)


def _scales(group: Any, names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield (name, scale as text) of the errors that state their scale."""
    for name in names:
        data = stored.member(group, name)
        if stored.has_attribute(data, RELATIVE_TO):
            yield name, stored.text_attribute(data, RELATIVE_TO)


def _own_length(group: Any, coordinate: str | None) -> tuple[int, ...]:
    """Return the shape of a group's own coordinate; () without one."""
    if coordinate is None:
        return ()
    found = stored.shape(stored.member(group, coordinate))
    if len(found) != 1 or not found[0]:
        raise MalformedFile(f"is not a results file: {group.name}/{coordinate} is not a coordinate")
    return found


def _check_shape(name: str, data: Any, group: str, axes: tuple[int, ...], own: tuple[int, ...]) -> None:
    """Raise MalformedFile for a variable that is not over the axes and the group's own coordinate, or for texts."""
    found, numbers = stored.shape(data), stored.is_numbers(data)
    if group == "inputs":
        fits = numbers and len(found) <= 1
    elif not numbers:  # a single text
        fits = len(found) == 1 and not axes and not own
    elif name in OWN.values():  # in another group it would be two things in one dataset
        fits = name == OWN.get(group) and found == own
    else:
        fits = found == (*axes, *own)
    if not fits:
        raise MalformedFile(f"is not a results file: {data.name} has the shape {found}, which does not match the axes")


def _axes(group: Any) -> tuple[Axis, ...]:
    """Return the axes of a group, with the paths that vary along each."""
    every = (stored.member(group, name) for name in stored.names(group))
    coordinates = [data for data in every if stored.has_attribute(data, "path")]
    scales = [data for data in coordinates if stored.is_scale(data)]
    joined = [(stored.scale_of(data), data) for data in coordinates if not stored.is_scale(data)]
    together = ([_axis(data) for own, data in joined if own == scale] for scale in scales)
    found = tuple(_axis(scale)._replace(joined=tuple(own)) for scale, own in zip(scales, together, strict=True))
    for axis in found:
        if any(len(inner.values) != len(axis.values) for inner in axis.joined):
            raise MalformedFile(f"is not a results file: what varies along {axis.path} differs in length")
    names = [inner.name for axis in found for inner in (axis, *axis.joined)]
    if len(set(names)) != len(coordinates):
        raise MalformedFile(f"is not a results file: the coordinates of {group.name} do not form axes")
    return found


def _about_all(group: Any, axes: tuple[str, ...], kind: str, shape: tuple[int, ...]) -> dict[str, Variable]:
    """Return unit and meaning of all variables except axes, tables of texts and bare dimensions.

    `kind` is the group's name for any stage, `shape` that of its axes.
    """
    every, own = stored.names(group), _own_length(group, OWN.get(kind))
    texts = {f"{name}_text" for name in every}
    found = {}
    for name in every:
        data = None if name in axes or name in texts else stored.member(group, name)
        if data is not None and stored.has_attribute(data, "units"):
            _check_shape(name, data, kind, shape, own)
            found[name] = _about(data)
    return found


def _about(data: Any) -> Variable:
    """Return unit (in CF style, which older files did not have everywhere) and meaning of a variable."""
    return Variable(cf_unit(stored.text_attribute(data, "units")), stored.text_attribute(data, "long_name"))


def _axis(data: Any) -> Axis:
    if len(stored.shape(data)) != 1 or not stored.is_numbers(data):
        raise MalformedFile(f"is not a results file: {data.name} is not a coordinate")
    values = labels_of(data) if stored.has_attribute(data, "labels") else stored.values(data)
    if not len(values) or (values.dtype.kind == "f" and not np.all(np.abs(values) < _LARGEST)):
        raise MalformedFile(f"is not a results file: {data.name} has values that no coordinate has")
    about = _about(data)
    axis = Axis(stored.text_attribute(data, "path"), values, scene_unit(about.units), about.long_name)
    if axis.name != data.name.rpartition("/")[2]:
        raise MalformedFile(f"is not a results file: {data.name} is the coordinate of another path")
    return axis


def _root(path: Path, file: Any) -> dict[str, Any]:
    """Return the attributes of a file; raise UsageError or MalformedFile if this version cannot read it."""
    if not stored.has_attribute(file, "screwsim_schema"):
        raise UsageError(f"{path}: is an HDF5 file of another program ({REMEDY})")
    attributes = stored.attributes(file)
    schema = attributes.get("screwsim_schema")
    if not isinstance(schema, int | np.integer):
        raise MalformedFile("is not a results file: its schema is not a whole number")
    if schema > SCHEMA:
        source = attributes.get("source", "a newer screwsim")
        raise UsageError(f"{path}: was written by {source} in schema {schema}, newer than {SCHEMA} (update screwsim)")
    for name in _TEXTS:
        if not isinstance(attributes.get(name), str):
            raise MalformedFile(f"is not a complete results file: its attribute {name} is missing")
    return attributes
