"""Read FIT.yaml: the scene, the parameters, the data; each fault is reported with its line. And its JSON Schema."""

import dataclasses
import math
import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from screwsim.build import build_parts
from screwsim.figures.curves import reading_of
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.inputs.textfiles import MOST_YAML, Unreadable, read_text, shipped_name
from screwsim.scene import Scene, leaf_of, load, without_sweep
from screwsim.scene.axis import SPACING, read_fields
from screwsim.scene.fields import Leaf, catalogue_leaves
from screwsim.scene.file_kinds import other_file
from screwsim.scene.schema import DRAFT, OWN_PARAMETER, mapping, value_schema
from screwsim.scene.values import limits_text, shown, text_of, within
from screwsim.scene.yaml_tree import LocatedFaults, Node, Position, compose, join
from screwsim.study.asked.inputs import DISCRETE_KINDS, shown_range, shown_value
from screwsim.study.asked.varied import with_accuracy
from screwsim.study.calibration.data import point_faults, read_points
from screwsim.study.calibration.fit import DIFFERENCES, EXACT, Fit, Parameter, Point, Prior, Tie, prior_of

SIGNS = {  # remedy for a positive power of an expander
    "shaft_power": "write output_power, or negative values",
    "electrical_power": "write negative values",
}
LIFE_ENDS = 1e-6  # [deg] by which an angle may exceed a chamber's life: rounding
ACCURACY = 1e-4  # of the solutions of a fit, where neither the fit nor its scene asks for a better one
HEAD_FIELDS = {
    "title": Leaf("word", "what is fitted", "", {}),
    "scene": Leaf("word", "the machine: a scene's file", dataclasses.MISSING, {}),
    "data": Leaf("word", "the measured points: a CSV file", dataclasses.MISSING, {}),
    "starts": Leaf("count", "number of starts", 8, {"ge": 1, "le": 10_000}),
    "seed": Leaf("count", "seed of the starts", 1, {"ge": 0}),
    "slopes": Leaf("choice", "how derivatives are found", DIFFERENCES, {"options": (EXACT, DIFFERENCES)}),
    "accuracy": Leaf("number", "relative accuracy of each solution", None, {"gt": 1e-12, "lt": 0.1}),
}
_REMEDY = "write scene: machine.yaml, data: points.csv and parameters:"
_PARAMETER = "write {from: …, to: …}"
NOT_CONTINUOUS = ("choice", "count", "word", "fluid", "numbers", "file")  # kinds that cannot be fitted
NO_PRIOR = "none"  # prior of a parameter that does not take the scene's tolerance either


def read_fit(
    path: str | os.PathLike[str],
    *,
    scene: str | os.PathLike[str] | None = None,
    data: str | os.PathLike[str] | None = None,
    fixed: bool = True,
) -> Fit:
    """Return the fit of a YAML file; raise `SceneError` with one line per fault.

    `scene` and `data` are files in place of those that it names; with `fixed` False there may be fewer data than
    parameters.
    """
    name = shipped_name(path)
    place = Position.start_of(name)
    problems = LocatedFaults()
    root = _read(name, place, problems)
    other = {key: os.fspath(each) for key, each in (("scene", scene), ("data", data)) if each is not None}
    fit = None if root is None else _typed(root, name, other, fixed, problems)
    if problems or fit is None:
        raise problems.error()
    return fit


def _read(name: str, place: Position, problems: LocatedFaults) -> Node | None:
    try:
        text = read_text(name, MOST_YAML)
    except Unreadable as error:
        what = f"cannot be read: {error} (name an existing fit file in UTF-8)"
        problems.add(place.at(error.line, error.column), "", what)
        return None
    root = compose(text, place, problems)
    if root is None and not problems:
        problems.add(place, "", f"is empty ({_REMEDY})")
    if root is not None and not isinstance(root.value, dict):
        problems.add(root.place, "", f"is {shown(root.value)}, not a mapping ({_REMEDY})")
        return None
    other = None if root is None else other_file(root.value, name, "fit")
    if root is not None and other is not None:
        problems.add(root.place, "", other)
        return None
    return root


def _typed(root: Node, name: str, other: Mapping[str, str], fixed: bool, problems: LocatedFaults) -> Fit | None:
    head = read_fields(HEAD_FIELDS, root, "", problems, _REMEDY, also=("parameters",))
    for key, file in other.items():
        if not os.path.isfile(file):
            raise UsageError(f"--{key} {file}: is not a file (name an existing one)")
    if head is None or ("scene" not in other and not _is_file(root, "scene", head["scene"], problems)):
        return None
    scene_file = other.get("scene", os.path.join(root.place.folder, head["scene"]))
    scene = without_sweep(load(scene_file))
    accuracy = min(scene.numerics.accuracy, ACCURACY) if head["accuracy"] is None else head["accuracy"]
    scene = with_accuracy(scene, accuracy) or scene  # a tolerance that it states itself stays
    parameters = _parameters(root, scene, problems)
    if ("data" not in other and not _is_file(root, "data", head["data"], problems)) or not parameters:
        return None
    data = other.get("data", os.path.join(root.place.folder, head["data"]))
    label = os.path.normpath(other.get("data", os.path.join(os.path.dirname(name), head["data"])))
    taken = [path for parameter in parameters for path in parameter.values(parameter.low)]
    rows = read_points(data, label, scene, taken, problems)
    if problems:
        return None
    points = tuple(point for point, _ in rows)
    fit = Fit(head["title"], name, scene, scene_file, parameters, points, head["starts"], head["seed"], head["slopes"])
    _check(fit, rows, root, fixed, problems)
    return fit


def _is_file(root: Node, key: str, name: str, problems: LocatedFaults) -> bool:
    found = os.path.isfile(os.path.join(root.place.folder, name))
    if not found:
        what = f"{shown(name)} is not a file (name an existing one, relative to this file)"
        problems.add(root.value[key].place, key, what)
    return found


def _parameters(root: Node, scene: Scene, problems: LocatedFaults) -> tuple[Parameter, ...]:
    node = root.value.get("parameters")
    if node is None or not isinstance(node.value, dict) or not node.value:
        place = root.place if node is None else node.place
        what = "names nothing to fit (write e.g. effects.tip_leakage.gap: {from: 20 um, to: 80 um})"
        problems.add(place, "parameters", what)
        return ()
    found: list[Parameter] = []
    taken: set[str] = set()
    for path, child in node.value.items():
        parameter = _parameter(path, child, scene, problems)
        if parameter is None:
            continue
        for each in parameter.values(parameter.low):
            if each in taken:
                problems.add(child.heading, join("parameters", path), f"fits {each} twice (remove one)")
            taken.add(each)
        found.append(parameter)
    return tuple(found)


def _leaf(scene: Scene, path: str, place: Position, where: str, problems: LocatedFaults) -> Leaf | None:
    """Return the leaf of a continuous path; None after adding a fault."""
    try:
        leaf = leaf_of(scene, path)
    except UsageError as error:
        problems.add(place, where, str(error).removeprefix(f"{path}: "))
        return None
    if leaf.kind in DISCRETE_KINDS:
        what = f"is {DISCRETE_KINDS[leaf.kind]}; only continuous quantities can be fitted (remove it)"
        problems.add(place, where, what)
        return None
    return leaf


def _parameter(path: str, node: Node, scene: Scene, problems: LocatedFaults) -> Parameter | None:
    where, before = join("parameters", path), len(problems)
    leaf = _leaf(scene, path, node.heading, where, problems)
    if leaf is None:
        return None
    end, optional = replace(leaf, default=dataclasses.MISSING), replace(leaf, default=None)
    fields = {"from": end, "to": end, "start": optional, "spacing": SPACING}
    given = read_fields(fields, node, where, problems, _PARAMETER, also=("prior", "also"))
    if not isinstance(node.value, dict):
        return None
    stated = node.value.get("prior")
    unheld = stated is not None and stated.value == NO_PRIOR
    prior = None if unheld else _prior(leaf, stated, join(where, "prior"), problems)
    ties = _ties(leaf, node.value.get("also"), scene, join(where, "also"), problems)
    if given is None or len(problems) > before:
        return None
    low, high, start = given["from"], given["to"], given["start"]
    ends = shown_range(scene, path, low, high)
    if not low < high:
        problems.add(node.place, where, "from is not below to (swap them)")
    elif start is not None and not low <= start <= high:
        problems.add(node.value["start"].place, join(where, "start"), f"lies outside {ends} (move it)")
    elif prior is not None and not low <= prior.mean <= high:
        what = f"lies outside {ends} (move it, or widen from and to)"
        problems.add(node.value["prior"].value["mean"].place, join(where, "prior.mean"), what)
    elif given["spacing"] == "log" and not low > 0.0:
        problems.add(node.place, where, "log spacing needs bounds above zero (raise from)")
    found = Parameter(path, low, high, start, prior, given["spacing"] == "log", ties, unheld)
    _check_ties(found, leaf, node, scene, problems)
    known = prior_of(scene, found)
    if len(problems) == before and known is not None and not low <= known.mean <= high:
        what = f"is {shown_value(scene, path, known.mean)} with a tolerance in the scene, outside {ends}"
        problems.add(node.place, where, f"{what} (widen from and to, or write prior: none)")
    return found


def difference(leaf: Leaf, default: Any = dataclasses.MISSING, **limits: float) -> Leaf:
    """Return the leaf for the difference of two values of a leaf."""
    kind = f"{leaf.kind}_difference" if leaf.kind in ("temperature", "pressure") else leaf.kind
    return Leaf(kind, f"difference of {leaf.doc}", default, limits)


def _prior(leaf: Leaf, node: Node | None, where: str, problems: LocatedFaults) -> Prior | None:
    if node is None or node.value is None:
        return None
    fields = {"mean": replace(leaf, default=dataclasses.MISSING), "deviation": difference(leaf, gt=0.0)}
    given = read_fields(fields, node, where, problems, "write {mean: …, deviation: …}, or none")
    return None if given is None else Prior(given["mean"], given["deviation"])


def _ties(leaf: Leaf, node: Node | None, scene: Scene, where: str, problems: LocatedFaults) -> tuple[Tie, ...]:
    if node is None or node.value is None:
        return ()
    remedy = "write {PATH: {factor: …, offset: …}}"
    if not isinstance(node.value, dict):
        problems.add(node.place, where, f"{shown(node.value)} is not a mapping ({remedy})")
        return ()
    fields = {"factor": Leaf("number", "factor", 1.0, {}), "offset": difference(leaf, 0.0)}
    found = []
    for path, child in node.value.items():
        other = _leaf(scene, path, child.heading, join(where, path), problems)
        if other is None:
            continue
        if other.kind != leaf.kind:
            what = f"is of another kind ({other.kind.replace('_', ' ')}; it cannot follow a {leaf.kind})"
            problems.add(child.heading, join(where, path), what)
            continue
        content = replace(child, value={} if child.value is None else child.value)
        if not isinstance(content.value, dict):
            problems.add(child.place, join(where, path), f"is not a mapping ({remedy})")
            continue
        given = read_fields(fields, content, join(where, path), problems, remedy)
        if given is not None:
            found.append(Tie(path, given["factor"], given["offset"]))
    return tuple(found)


def _check_ties(parameter: Parameter, leaf: Leaf, node: Node, scene: Scene, problems: LocatedFaults) -> None:
    """Add a fault where a path follows itself, or leaves its limits."""
    where = join("parameters", parameter.path)
    for tie in parameter.ties:
        heading, named = node.value["also"].value[tie.path].heading, join(join(where, "also"), tie.path)
        if tie.path == parameter.path:
            problems.add(heading, named, "is the parameter itself (remove it)")
            continue
        other = leaf_of(scene, tie.path)
        for end in (parameter.low, parameter.high):
            follows = tie.factor * end + tie.offset
            if not within(other, follows):
                what = f"is {text_of(other, float(f'{follows:.4g}'))} where that is {text_of(leaf, end)}"
                remedy = f"it must be {limits_text(other)}; change factor, offset or the bounds"
                problems.add(heading, named, f"{what}, which is out of range ({remedy})")
                break


def _check(fit: Fit, rows: list[tuple[Point, Position]], root: Node, fixed: bool, problems: LocatedFaults) -> None:
    """Add a fault where values of a point and of the first start do not fit together, or there are too few data.

    Without `fixed` one measured figure is enough.
    """
    start = fit.first_start()
    problems += point_faults((fit.at(point, start), place) for point, place in rows)
    if not problems:
        _refuse_angles_beyond_life(fit, start, rows, problems)
        _refuse_power_of_other_sign(fit, rows, problems)
    data = sum(len(point.measured) for point in fit.fitted)
    priors = sum(prior_of(fit.scene, parameter) is not None for parameter in fit.parameters)
    if not data or (fixed and data + priors < len(fit.parameters)):
        what = f"{data} measured figures and {priors} priors cannot determine {len(fit.parameters)} parameters"
        problems.add(root.value["parameters"].heading, "parameters", f"{what} (fit fewer, or add data)")


def _refuse_angles_beyond_life(
    fit: Fit, start: Mapping[str, float], rows: list[tuple[Point, Position]], problems: LocatedFaults
) -> None:
    """Add a fault where a curve was measured at an angle that no chamber of the machine has, once a point."""
    for point, place in rows:
        if not point.traced:
            continue
        try:
            life = math.degrees(build_parts(fit.at(point, start)).geometry.life)
        except UsageError:
            continue  # solving tells of it
        angles = [reading.angle for name in point.measured if (reading := reading_of(name)) is not None]
        beyond = [angle for angle in angles if angle > life + LIFE_ENDS]
        if beyond:
            number = counted(len(beyond), "angle")
            what = f"{number} beyond the {life:.6g} deg of a chamber's life (from {min(beyond):g} deg on)"
            remedy = "leave them out; angles count from where the chamber begins to grow"
            problems.add(place, point.name, f"{what} ({remedy})")


def _refuse_power_of_other_sign(fit: Fit, rows: list[tuple[Point, Position]], problems: LocatedFaults) -> None:
    """Add a fault where the powers of an expander are positive at all points, which means that it takes them."""
    for figure, remedy in SIGNS.items() if fit.scene.machine.expands else ():
        found = [(point.measured[figure].value, place) for point, place in rows if figure in point.measured]
        if found and all(value > 0.0 for value, _ in found):
            what = "is positive at every point, as of a machine that takes power; what an expander gives is negative"
            problems.add(found[0][1], figure, f"{what} ({remedy})")


def fit_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a fit."""
    leaves = catalogue_leaves()
    paths = {path: leaf for path, leaf in leaves.items() if leaf.kind not in NOT_CONTINUOUS}
    properties = {name: {"description": leaf.doc, **value_schema(leaf)} for name, leaf in HEAD_FIELDS.items()}
    properties["parameters"] = {
        "type": "object",
        "description": "the parameters to fit, by scene path, with their bounds",
        "properties": {path: _parameter_schema(leaf) for path, leaf in paths.items()},
        "patternProperties": {OWN_PARAMETER: {"type": "object"}},
        "additionalProperties": False,
        "minProperties": 1,
    }
    required = [name for name, leaf in HEAD_FIELDS.items() if leaf.required]
    head = {"$schema": DRAFT, "title": "screwsim fit"}
    return head | mapping(properties, [*required, "parameters"])


def _parameter_schema(leaf: Leaf) -> dict[str, Any]:
    value, apart = value_schema(leaf), value_schema(difference(leaf))
    prior = mapping({"mean": value, "deviation": apart}, ["mean", "deviation"])
    follows = mapping({"factor": {"type": "number"}, "offset": apart})
    names = {
        "from": value,
        "to": value,
        "start": value,
        "spacing": {"enum": ["linear", "log"], "default": "linear"},
        "prior": {"anyOf": [prior, {"const": NO_PRIOR}]},
        "also": {"type": "object", "additionalProperties": follows},
    }
    return mapping(names, ["from", "to"], leaf.doc)
