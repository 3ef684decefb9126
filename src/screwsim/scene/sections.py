"""From YAML nodes to the typed parts of a scene: sections and effects, with each fault at its place."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from screwsim.effects import catalogue, find_effect
from screwsim.effects.base import Effect
from screwsim.machine.kinds import find_machine
from screwsim.scene.fields import AMBIENT, Leaf, Section, catalogue_leaves, section_of, stray_key, unknown_key
from screwsim.scene.types import STANDARD_ATMOSPHERE, ActiveEffect
from screwsim.scene.units import Refused, customary_unit
from screwsim.scene.values import convert, describe_leaf, imported, shown
from screwsim.scene.yaml_tree import LocatedFault, LocatedFaults, Node, child_of, join

OFF_WORDS = ("off", "no", "false")


def read_section(
    section: Section,
    node: Node,
    path: str,
    problems: LocatedFaults,
    also: Iterable[str] = (),
    paths: Iterable[str] = (),
) -> Any:
    """Return the dataclass of a section, or None after its faults were added.

    `also` names keys that are read elsewhere, `paths` those of the whole scene, to which an unknown key may belong.
    """
    content = {} if node.value is None else node.value
    if not isinstance(content, dict):
        options = ", ".join(section.fields) or "nothing; write {}"
        remedy = "null to leave it out, or lines" if is_off(content) and not section.required else "lines"
        what = f"{shown(content)} is not a mapping (write {remedy} NAME: value; known: {options})"
        problems.add(node.place, path, what)
        return None
    before = len(problems)
    options = [*section.fields, *also]
    for name, child in content.items():
        if name not in options:
            problems.add(child.heading, join(path, name), stray_key(name, options, paths, path))
    values = {}
    for name, item in section.fields.items():
        child = content.get(name)
        below = join(path, name)
        if child is None or child.value is None:
            _absent(item, child or node, below, problems, content)
        elif isinstance(item, Section):
            values[name] = read_section(item, child, below, problems, paths=paths)
        else:
            values[name] = read_leaf(item, child, below, problems)
    return section.type(**values) if len(problems) == before else None


def _absent(item: Leaf | Section, node: Node, path: str, problems: LocatedFaults, beside: Mapping[str, Node]) -> None:
    if isinstance(item, Section) and item.required:
        needed = [name for name, field in item.fields.items() if field.required]
        problems.add(node.heading, path, f"is missing (write it with {', '.join(needed or item.fields)})")
    others = item.otherwise if isinstance(item, Leaf) else ()
    stated = any(name in beside and beside[name].value is not None for name in others)
    if isinstance(item, Leaf) and (item.required or (others and not stated)):
        remedy = f"write {path.rpartition('.')[2]}: {_blank(item)}"
        problems.add(node.heading, path, f"is missing ({remedy}; {item.doc})")


def _blank(leaf: Leaf) -> str:
    """Return a blank form of an input's value: no example value, which users would copy although it rarely fits."""
    if leaf.dimension is not None:
        return f"… {customary_unit(leaf.dimension)}"
    return " or ".join(leaf.limits["options"]) if leaf.kind == "choice" else describe_leaf(leaf)


def read_leaf(leaf: Leaf, node: Node, path: str, problems: LocatedFaults) -> Any:
    """Return the SI value of a node, or None after its fault was added."""
    with problems.at(node.place, path):
        return convert(leaf, node.value, node.place.folder)
    return None


def read_ambient(root: Node, problems: LocatedFaults) -> tuple[Node, float]:
    """Return a scene's tree and its ambient pressure [Pa], over which gauge pressures are read.

    Where it is badly stated its fault is added, and the tree is without it: gauge pressures are not to blame.
    """
    stated = child_of(root, *AMBIENT.split("."))
    if stated is None or stated.value is None:
        return root, STANDARD_ATMOSPHERE
    found = read_leaf(catalogue_leaves()[AMBIENT], stated, AMBIENT, problems)
    if found is not None:
        return root, found
    section, _, name = AMBIENT.partition(".")
    rest = {key: child for key, child in root.value[section].value.items() if key != name}
    return replace(root, value={**root.value, section: replace(root.value[section], value=rest)}), STANDARD_ATMOSPHERE


def read_effects(node: Node | None, problems: LocatedFaults) -> dict[str, ActiveEffect]:
    """Return the active effects in the catalogue's order, then user-defined ones in the order of the file."""
    if node is None or node.value is None:
        return {}
    if not isinstance(node.value, dict):
        what = f"{shown(node.value)} is not a mapping (write NAME: with its parameters under it, or NAME: null)"
        problems.add(node.place, "effects", what)
        return {}
    rank = {name: index for index, name in enumerate(catalogue())}
    active = {}
    for name in sorted(node.value, key=lambda name: rank.get(name, len(rank))):
        child, path = node.value[name], f"effects.{name}"
        try:
            effect, section = find_effect_section(name)
        except Refused as refusal:
            problems.add(child.heading, path, str(refusal))
            continue
        if is_off(child.value):  # removes an effect that a base names
            continue
        if not isinstance(child.value, dict | None):
            known = ", ".join(section.fields) or "none"
            what = f"{shown(child.value)} is neither parameters nor off (write {name}: alone, or with parameters under "
            problems.add(child.place, path, f"{what}it: {known}; or {name}: off to leave it out)")
            continue
        before = len(problems)
        parameters = read_section(section, child, path, problems)
        if child.value is None:  # a user who writes null may mean off
            problems[before:] = [_declared_or_off(problem, name) for problem in problems[before:]]
        active[name] = ActiveEffect(effect, parameters)
    return active


def _declared_or_off(problem: LocatedFault, name: str) -> LocatedFault:
    remedy = f"; or {name}: off to leave it out)"
    return replace(problem, what=problem.what[:-1] + remedy) if problem.what.endswith(")") else problem


def is_off(value: Any) -> bool:
    """Tell whether a value switches an effect off: off, no or false, which YAML 1.2 reads as words or as a boolean."""
    return value is False or (isinstance(value, str) and value.lower() in OFF_WORDS)


def find_effect_section(name: str) -> tuple[Effect, Section]:
    """Return an effect and the description of its parameters; user-defined ones may lie in the working folder."""
    try:
        return imported(name, lambda: _declared(find_effect(name), "parameters"))
    except KeyError:
        told = unknown_key(name, catalogue())
        remedy = " (one of your own has a dotted name, e.g. my_effects.spring)" if "known here" in told else ""
        raise Refused(f"{told}{remedy}") from None


def find_kind(name: str) -> None:
    """Import a user-defined kind of machine; raise `Refused` where it lacks a required setting."""
    _, section = imported(name, lambda: _declared(find_machine(name), "settings"))
    lacking = [each for each in ("kind", "mode") if each not in section.fields]
    if lacking:
        raise Refused(f"lacks the setting {', '.join(lacking)}; fix that module")


def _declared(found: Any, part: str) -> tuple[Any, Section]:
    return found, section_of(getattr(found, part))
