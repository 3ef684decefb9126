"""The sweep of a scene: each path with its values in SI units, checked like the field that it varies."""

from collections.abc import Mapping
from dataclasses import replace

from screwsim.effects import catalogue
from screwsim.scene.designs import Axes, LeafOf, read_axes, read_sample, read_zip
from screwsim.scene.fields import Leaf, sweep_leaf
from screwsim.scene.grid import too_many
from screwsim.scene.operation import GAS_COOLER
from screwsim.scene.sections import is_off
from screwsim.scene.types import ActiveEffect, Joint
from screwsim.scene.units import Refused
from screwsim.scene.values import shown
from screwsim.scene.yaml_tree import Node, Problem, locate

DESIGNS = ("zip", "sample")  # keys of a sweep that are no path


def read_sweep(
    node: Node | None, root: Node, active: Mapping[str, ActiveEffect], kind: str, problems: list[Problem]
) -> tuple[Axes, tuple[Joint, ...]]:
    """Return {path: values in SI} in the order of the file, and which paths vary together; `kind` of machine."""
    if node is None or node.value is None:
        return {}, ()
    if not isinstance(node.value, dict):
        remedy = "null to leave it out, or e.g." if is_off(node.value) else "e.g."
        what = f"{shown(node.value)} is not a mapping (write {remedy} operation.speed: [1000 rpm, 2000 rpm])"
        problems.append(Problem(node.place, "sweep", what))
        return {}, ()
    parameters = {name: effect.effect.parameters for name, effect in active.items()}

    def leaf_of(path: str) -> Leaf:
        leaf = sweep_leaf(path, parameters, catalogue(), kind)
        _refuse_absent_section(path, root)
        return leaf

    sweep: Axes = {}
    joints: list[Joint] = []
    cases = 1
    for name, child in node.value.items():
        for joint, axes in _part(name, child, leaf_of, problems):
            for path in sweep.keys() & axes.keys():
                problems.append(Problem(child.heading, f"sweep.{path}", "is varied twice (remove one)"))
            sweep |= axes
            joints += [joint] if joint else []
            cases *= max(map(len, axes.values()), default=1) or 1
    what = too_many(cases)
    if what:
        problems.append(Problem(node.heading, "sweep", what))
    return sweep, tuple(joints)


def _part(name: str, node: Node, leaf_of: LeafOf, problems: list[Problem]) -> list[tuple[Joint | None, Axes]]:
    """Return the axes of one key of the sweep, with what joins them."""
    path = f"sweep.{name}"
    if node.value is None and name in DESIGNS:  # takes out what a base names
        return []
    if name == "zip":
        return [*read_zip(node, path, leaf_of, problems)]
    if name == "sample":
        found = read_sample(node, path, leaf_of, problems)
        return [found] if found else []
    return [(None, read_axes(replace(node, value={name: node}), "sweep", leaf_of, problems))]


def _refuse_absent_section(path: str, root: Node) -> None:
    name = path.partition(".")[0]
    parent = path.rpartition(".")[0]
    nested = name == "effects" and path.count(".") > 2 and path.split(".")[1] in catalogue()
    nested = nested or parent == GAS_COOLER
    if name in ("effects", "numerics", "output", "operation") and not nested:
        return  # checked by their names, or there by default
    node, found = locate(root, parent)
    if not found or node.value is None:
        raise Refused(f"the section {parent} is not in this scene (write it first)")
