"""The sweep of a scene: the values of each path in SI units; paths may vary together, zipped or as a seeded sample."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from screwsim.effects import catalogue
from screwsim.scene.axis import OF_WORDS, SPACING, example, read_axis, read_fields
from screwsim.scene.fields import Leaf, sweep_leaf
from screwsim.scene.grid import too_many
from screwsim.scene.operation import GAS_COOLER, SPEED
from screwsim.scene.sections import is_off
from screwsim.scene.types import ActiveEffect, Joint, Sample
from screwsim.scene.units import Refused
from screwsim.scene.values import shown
from screwsim.scene.yaml_tree import LocatedFaults, Node, join, locate

Axes = dict[str, tuple[Any, ...]]
LeafOf = Callable[[str], Leaf]  # raises `Refused`
LARGEST_SAMPLE = 2**20
KINDS = ("sobol", "latin_hypercube")
_FIELDS = {
    "kind": Leaf("choice", "how the sample is drawn", dataclasses.MISSING, {"options": KINDS}),
    "count": Leaf("count", "number of points", dataclasses.MISSING, {"ge": 1, "le": LARGEST_SAMPLE}),
    "seed": Leaf("count", "seed of the random numbers", 0, {"ge": 0}),
}
DESIGNS = ("zip", "sample")  # keys of a sweep that are not paths


def read_sweep(
    node: Node | None, root: Node, active: Mapping[str, ActiveEffect], kind: str, problems: LocatedFaults
) -> tuple[Axes, tuple[Joint, ...]]:
    """Return {path: values in SI} in the order of the file, and which paths vary together; `kind` is the machine's."""
    parameters = {name: effect.effect.parameters for name, effect in active.items()}

    def leaf_of(path: str) -> Leaf:
        leaf = sweep_leaf(path, parameters, kind)
        _refuse_absent_section(path, root)
        return leaf

    return read_sweep_of(node, leaf_of, problems)


def read_sweep_of(
    node: Node | None, leaf_of: LeafOf, problems: LocatedFaults, first: str = SPEED
) -> tuple[Axes, tuple[Joint, ...]]:
    """Return the same as `read_sweep` for the inputs that `leaf_of` knows; `first` is an example of a path."""
    if node is None or node.value is None:
        return {}, ()
    if not isinstance(node.value, dict):
        remedy = "null to leave it out, or e.g." if is_off(node.value) else "e.g."
        what = f"{shown(node.value)} is not a mapping (write {remedy} {first}: [1000 rpm, 2000 rpm])"
        problems.add(node.place, "sweep", what)
        return {}, ()
    sweep: Axes = {}
    joints: list[Joint] = []
    cases = 1
    for name, child in node.value.items():
        for joint, axes in _part(name, child, leaf_of, problems, first):
            for path in sweep.keys() & axes.keys():
                problems.add(child.heading, f"sweep.{path}", "is varied twice (remove one)")
            sweep |= axes
            joints += [joint] if joint else []
            cases *= max(map(len, axes.values()), default=1) or 1
    what = too_many(cases)
    if what:
        problems.add(node.heading, "sweep", what)
    return sweep, tuple(joints)


def _part(
    name: str, node: Node, leaf_of: LeafOf, problems: LocatedFaults, first: str
) -> list[tuple[Joint | None, Axes]]:
    """Return the axes of one key of the sweep, with their joint if they vary together; `first` is an example."""
    path = f"sweep.{name}"
    if node.value is None and name in DESIGNS:  # removes what a base names
        return []
    if name == "zip":
        return [*read_zip(node, path, leaf_of, problems, first)]
    if name == "sample":
        found = read_sample(node, path, leaf_of, problems, first)
        return [found] if found else []
    return [(None, read_axes(replace(node, value={name: node}), "sweep", leaf_of, problems))]


def _refuse_absent_section(path: str, root: Node) -> None:
    name = path.partition(".")[0]
    parent = path.rpartition(".")[0]
    nested = name == "effects" and path.count(".") > 2 and path.split(".")[1] in catalogue()
    nested = nested or parent == GAS_COOLER
    if name in ("effects", "numerics", "output", "operation") and not nested:
        return  # checked by their names, or present by default
    node, found = locate(root, parent)
    if not found or node.value is None:
        raise Refused(f"the section {parent} is not in this scene (write it first)")


def read_axes(node: Node, path: str, leaf_of: LeafOf, problems: LocatedFaults, distinct: bool = True) -> Axes:
    """Return {path: values} of a mapping of axes."""
    axes: Axes = {}
    for name, child in node.value.items():
        with problems.at(child.heading, join(path, name)):
            axes[name] = read_axis(leaf_of(name), child, join(path, name), problems, distinct)
    return axes


def read_zip(node: Node, path: str, leaf_of: LeafOf, problems: LocatedFaults, first: str) -> list[tuple[Joint, Axes]]:
    """Return the groups of axes whose values are combined one by one, each with its joint."""
    remedy = f"write [{{{first}: […], {first.removesuffix(SPEED)}oil_supply.ratio: […]}}]"
    if not isinstance(node.value, list) or not all(isinstance(group.value, dict) for group in node.value):
        problems.add(node.place, path, f"is not a list of mappings ({remedy})")
        return []
    found = []
    for number, group in enumerate(node.value, 1):
        before = len(problems)
        axes = read_axes(group, path, leaf_of, problems, distinct=False)
        lengths = {name: len(values) for name, values in axes.items() if values}
        whole = len(problems) == before  # else an axis lacks values that cannot be read
        if whole and len(set(lengths.values())) > 1:
            told = ", ".join(f"{name} {length}" for name, length in lengths.items())
            problems.add(group.place, path, f"has axes of different lengths: {told} (make them equal)")
        elif not group.value:
            problems.add(group.place, path, f"has a group without an axis ({remedy})")
        found.append((Joint("case" if number == 1 else f"case_{number}", tuple(axes)), axes))
    return found


def read_sample(
    node: Node, path: str, leaf_of: LeafOf, problems: LocatedFaults, first: str
) -> tuple[Joint, Axes] | None:
    """Return a sample with its values, or None after faults were added."""
    remedy = f"write {{kind: sobol, count: 64, seed: 1, over: {{{first}: {{from: 1000 rpm, to: 3000 rpm}}}}}}"
    before = len(problems)
    given = read_fields(_FIELDS, node, path, problems, remedy, also=("over",))
    over = _over(node, join(path, "over"), leaf_of, problems, remedy) if isinstance(node.value, dict) else ()
    if given is None or len(problems) > before:
        return None
    if given["kind"] == "sobol" and given["count"] & (given["count"] - 1):
        better = 2 ** round(math.log2(given["count"]))
        other = f"write e.g. {better}, or kind: latin_hypercube"
        what = f"{given['count']} is not a power of two, which a Sobol sample needs ({other})"
        problems.add(node.value["count"].place, join(path, "count"), what)
        return None
    sample = Sample(given["kind"], given["count"], given["seed"], over)
    return Joint("sample", tuple(name for name, _ in over), sample), draw(sample)


def _over(
    node: Node, path: str, leaf_of: LeafOf, problems: LocatedFaults, remedy: str
) -> tuple[tuple[str, tuple[Any, ...]], ...]:
    child = node.value.get("over")
    if child is None or not isinstance(child.value, dict) or not child.value:
        place = node.heading if child is None else child.place
        problems.add(place, path, f"must name the paths that vary ({remedy})")
        return ()
    found = []
    for name, span in child.value.items():
        with problems.at(span.heading, join(path, name)):
            found.append((name, _span(leaf_of(name), span, join(path, name), problems)))
    return tuple(found)


def _span(leaf: Leaf, node: Node, path: str, problems: LocatedFaults) -> tuple[Any, ...]:
    """Return ("any", values) or ("linear" or "log", first, last); () after faults were added."""
    if isinstance(node.value, list):
        return ("any", *read_axis(leaf, node, path, problems))
    if not isinstance(node.value, dict) or leaf.kind in OF_WORDS:
        what = f"is neither {{from, to}} nor a list (write e.g. [{example(leaf)}])"
        raise Refused(OF_WORDS.get(leaf.kind, what))
    end = dataclasses.replace(leaf, default=dataclasses.MISSING)
    given = read_fields({"from": end, "to": end, "spacing": SPACING}, node, path, problems, "write {from: …, to: …}")
    if given is None:
        return ()
    first, last, spacing = given["from"], given["to"], given["spacing"]
    if not first < last:
        problems.add(node.place, path, "from is not below to (swap them)")
    elif spacing == "log" and not first > 0.0:
        problems.add(node.place, path, "log spacing needs ends above zero (choose another from)")
    return (spacing, first, last)


def draw(sample: Sample) -> Axes:
    """Return the values [SI] of a sample by path; the same seed gives the same values."""
    from scipy.stats import qmc

    d = len(sample.over)
    kinds: Mapping[str, Any] = {"sobol": qmc.Sobol, "latin_hypercube": qmc.LatinHypercube}
    points = kinds[sample.kind](d, rng=np.random.default_rng(sample.seed)).random(sample.count)
    return {path: _values(span, points[:, column]) for column, (path, span) in enumerate(sample.over)}


def _values(span: tuple[Any, ...], u: np.ndarray) -> tuple[Any, ...]:
    """Return the values of a span for numbers of [0, 1)."""
    kind, *rest = span
    if kind == "any":
        return tuple(rest[place] for place in (u * len(rest)).astype(int))
    first, last = rest
    if isinstance(first, int):
        return tuple((first + np.floor(u * (last - first + 1)).astype(int)).tolist())
    if kind == "log":
        return tuple((first * (last / first) ** u).tolist())
    return tuple((first + (last - first) * u).tolist())
