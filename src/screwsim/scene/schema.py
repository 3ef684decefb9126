"""JSON Schema of a scene, for editors and other programs, from the declarations by which scenes are read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from screwsim.effects import catalogue
from screwsim.inputs.declare import AUTO, KINDS, Kind
from screwsim.machine.kinds import MACHINES, TWIN_SCREW
from screwsim.scene.fields import SWEEPABLE, Leaf, Section, catalogue_leaves, scene_section, section_of, varies
from screwsim.scene.model_errors import BLOCK, MODEL, stored_model_errors
from screwsim.scene.sweep import KINDS as SAMPLES
from screwsim.scene.sweep import LARGEST_SAMPLE
from screwsim.scene.tolerances import CORRELATED_KEY
from screwsim.scene.units import NUMBER
from screwsim.scene.values import limits_text, text_of

_COVERAGE = rf"(\(\s*k\s*=\s*{NUMBER}\s*\)\s*)?"  # (k=1)
# 0.7 ± 0.05
VALUE_WITH_TOLERANCE = rf"^\s*{NUMBER}\s*(±|\+/?-|[×x]/÷|\*/|x/)\s*[0-9.]+(e-?[0-9]+)?\s*%?\s*{_COVERAGE}$"
DRAFT = "https://json-schema.org/draft/2020-12/schema"
OWN_NAME = r"^[^.]+(\.[^.]+)+$"  # my_package.my_effect, my_package.my_machine
OWN_PARAMETER = r"^effects\.[^.]+(\.[^.]+){2,}$"
NO_LEAVES: Mapping[str, Leaf] = {}
_SPACING = {"enum": ["linear", "log"], "default": "linear"}
OFF_VALUES = {  # an effect may be left out: off, no, false, in upper or lower case
    "type": ["object", "null", "string", "boolean"],
    "pattern": "^([Oo][Ff][Ff]|[Nn][Oo]|[Ff][Aa][Ll][Ss][Ee])$",
    "not": {"const": True},
}
_BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}


def mapping(
    properties: Mapping[str, Any], required: Sequence[str] = (), about: str = "", kind: str | Sequence[str] = "object"
) -> dict[str, Any]:
    """Return the schema of a mapping that allows no keys other than these."""
    told = {"description": about} if about else {}
    needed = {"required": list(required)} if required else {}
    return {"type": kind, **told, "properties": properties, **needed, "additionalProperties": False}


_COLUMN = mapping({name: {"type": "string"} for name in ("file", "column", "unit")}, ["file", "column"])

_NAMES = {"type": "array", "items": {"type": "string"}, "minItems": 2}
_FRACTIONS = {"type": "array", "items": {"type": "number"}, "minItems": 2}
CORRELATED_SCHEMA = {
    "type": "array",
    "items": _NAMES,
    "description": "groups of paths whose tolerances are fully correlated",
}
_BLEND = mapping({"fluid": _NAMES, "mass_fractions": _FRACTIONS, "mole_fractions": _FRACTIONS}, ["fluid"])
_FLUIDS = {"type": "array", "items": {"anyOf": [{"type": "string"}, _BLEND]}, "minItems": 1}


def schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12). Required keys are required only in a scene without a base."""
    section = scene_section()
    effects = {name: section_of(effect.parameters) for name, effect in catalogue().items()}
    base = "file of another scene, of which this one changes some paths"
    properties: dict[str, Any] = {"base": {"type": ["string", "null"], "description": base}}
    properties |= _section(section)["properties"]
    properties["machine"] = _machine()
    properties["effects"] = {
        "type": ["object", "null"],
        "description": "effects named here are simulated, all others are not",
        "properties": {
            name: {**_section(part), **OFF_VALUES, "description": catalogue()[name].title}
            for name, part in effects.items()
        },
        "patternProperties": {OWN_NAME: {"type": ["object", "null"]}},
        "additionalProperties": False,
    }
    properties["sweep"] = sweep_schema()
    named = {
        "enum": [*stored_model_errors(), None],
        "description": "validation whose model error is reported with the other uncertainties",
    }
    properties[BLOCK] = mapping({CORRELATED_KEY: CORRELATED_SCHEMA, MODEL: named}, (), "", ["object", "null"])
    return {
        "$schema": DRAFT,
        "title": "screwsim scene",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "anyOf": [{"required": ["base"]}, {"$ref": "#/$defs/complete"}],
        "$defs": {"complete": _complete(effects), **axis_definitions()},
    }


def axis_definitions() -> dict[str, Any]:
    """Return the definitions (`$defs`) to which the axes of `sweep_schema` refer."""
    return {f"axis_{kind}": _axis(_example(kind)) for kind in sorted(SWEEPABLE - {"choice", "fluid"})}


def _machine() -> dict[str, Any]:
    kinds = {kind: _section(_machine_section(kind)) for kind in MACHINES}
    for kind, part in kinds.items():
        part["properties"]["kind"] = {**part["properties"]["kind"], "enum": [kind, None], "default": kind}
    own = {"type": "object", "properties": {"kind": {"type": "string", "pattern": OWN_NAME}}, "required": ["kind"]}
    return {"anyOf": [*kinds.values(), own]}


def _machine_section(kind: str) -> Section:
    machine = scene_section(kind).fields["machine"]
    assert isinstance(machine, Section)
    return machine


def _complete(effects: dict[str, Section]) -> dict[str, Any]:
    """Return what a scene without a base must contain; for the machine, depending on its kind."""
    demands = _demands(scene_section(), effects)
    machine = demands["properties"]["machine"]
    for kind in MACHINES:
        if kind != TWIN_SCREW:
            named = {"properties": {"kind": {"const": kind}}, "required": ["kind"]}
            machine = {"if": named, "then": _demands(_machine_section(kind)), "else": machine}
    own = {"properties": {"kind": {"type": "string", "pattern": OWN_NAME}}, "required": ["kind"]}
    machine = {"if": own, "then": {}, "else": machine}
    return {**demands, "properties": {**demands["properties"], "machine": machine}}


def _section(section: Section) -> dict[str, Any]:
    properties = {
        name: _section(item) if isinstance(item, Section) else leaf_schema(item)
        for name, item in section.fields.items()
    }
    return mapping(properties, (), section.doc, ["object", "null"])


def leaf_schema(leaf: Leaf) -> dict[str, Any]:
    """Return the schema of a field: its value, its description, and null where it may be left out."""
    limits = limits_text(leaf)
    found = {"description": f"{leaf.doc} ({limits})" if limits else leaf.doc, **value_schema(leaf)}
    if leaf.kind == "number":  # text only with a tolerance; the bounds apply to numbers
        found |= {"type": ["number", "string"], "pattern": VALUE_WITH_TOLERANCE}
    if not leaf.required and leaf.default is not None:
        found["default"] = text_of(leaf, leaf.default) if leaf.dimension else leaf.default
    if not leaf.required and "enum" in found:
        found["enum"] = [*found["enum"], None]
    elif not leaf.required:
        kinds = found["type"]
        found["type"] = [*([kinds] if isinstance(kinds, str) else kinds), "null"]
    return found


def value_schema(leaf: Leaf) -> dict[str, Any]:
    """Return the schema of one value as users write it."""
    if leaf.dimension is not None and leaf.auto:
        return {**_quantity(leaf.dimension), "pattern": rf"{_quantity(leaf.dimension)['pattern']}|^{AUTO}$"}
    if leaf.dimension is not None:
        return _quantity(leaf.dimension)
    if leaf.kind == "choice" and "own" in leaf.limits:
        return {"type": "string", "anyOf": [{"enum": list(leaf.limits["options"])}, {"pattern": OWN_NAME}]}
    if leaf.kind == "choice":
        return {"enum": list(leaf.limits["options"])}
    if leaf.kind in ("fluid", "numbers"):
        return _several(leaf)
    bounds = {_BOUNDS[name]: limit for name, limit in leaf.limits.items() if name in _BOUNDS}
    return {"type": {"number": "number", "count": "integer"}.get(leaf.kind, "string"), **bounds}


def _several(leaf: Leaf) -> dict[str, Any]:
    """Return the schema of a list, or of a list that a single name may replace."""
    items = value_schema(replace(leaf, kind="number" if leaf.kind == "numbers" else "word"))
    found = {"items": items, "minItems": 2}
    return {"type": "array", **found} if leaf.kind == "numbers" else {"type": ["string", "array"], **found}


def _quantity(kind: Kind) -> dict[str, Any]:
    return {"type": "string", "pattern": rf"^\s*{NUMBER}\s*[^\s0-9.,+-].*$", "examples": [kind.example]}


def _demands(section: Section, effects: dict[str, Section] | None = None) -> dict[str, Any]:
    """Return only what is required, section by section."""
    required = [name for name, item in section.fields.items() if item.required]
    inner = {name: _demands(item) for name, item in section.fields.items() if isinstance(item, Section)}
    if effects:
        parts = {name: _demands(part) for name, part in effects.items()}
        there = {"type": ["object", "string", "boolean"]}  # parameters, or off
        parts = {name: {**there, **part} if part.get("required") else part for name, part in parts.items()}
        inner["effects"] = {"properties": {name: part for name, part in parts.items() if part}}
    inner = {name: part for name, part in inner.items() if part}
    either = [
        {"anyOf": [{"required": [each]} for each in (name, *item.otherwise)]}
        for name, item in section.fields.items()
        if isinstance(item, Leaf) and item.otherwise
    ]
    return {key: value for key, value in (("required", required), ("allOf", either), ("properties", inner)) if value}


def sweep_schema(
    names: Callable[[str], Sequence[str]] = lambda path: (path,),
    more: Mapping[str, Leaf] = NO_LEAVES,
    own: str = OWN_PARAMETER,
) -> dict[str, Any]:
    """Return the schema of a sweep of inputs of scenes, whose paths have `names` there, and of `more` inputs.

    `own` is the pattern of the names of own effects' inputs.
    """
    known = {path: leaf for kind in MACHINES for path, leaf in catalogue_leaves(kind).items()}
    leaves = {name: leaf for path, leaf in known.items() if varies(path, leaf) for name in names(path)}
    leaves |= more
    axes = {path: _axis_of(leaf) for path, leaf in leaves.items()}
    over = {path: _span_of(leaf) for path, leaf in leaves.items()}
    group = _paths(axes, "axes of equal length", own)
    zipped = {"description": "groups of axes whose values are combined one by one", "items": group, "minItems": 1}
    properties = {
        "kind": {"enum": list(SAMPLES)},
        "count": {"type": "integer", "minimum": 1, "maximum": LARGEST_SAMPLE},
        "seed": {"type": "integer", "minimum": 0, "default": 0},
        "over": _paths(over, "paths that vary, and their ranges", own),
    }
    designs = {
        "zip": {"type": ["array", "null"], **zipped},
        "sample": mapping(properties, (), "points drawn at random; one dimension of the sweep", ["object", "null"]),
    }
    about = "the grid is the product of all axes; a key is a complete dotted path"
    return {**_paths({**axes, **designs}, about, own), "type": ["object", "null"]}


def _paths(properties: dict[str, Any], about: str, own: str) -> dict[str, Any]:
    return {
        "type": "object",
        "description": about,
        "properties": properties,
        "patternProperties": {own: {}},
        "additionalProperties": False,
    }


def _span_of(leaf: Leaf) -> dict[str, Any]:
    """Return the schema of one path of a sample: its ends, or the values to choose from."""
    values = {"type": "array", "items": value_schema(leaf), "minItems": 1}
    if leaf.kind == "choice":
        return values
    if leaf.kind == "fluid":
        return _FLUIDS
    ends = {"from": _example(leaf.kind), "to": _example(leaf.kind), "spacing": _SPACING}
    return {"anyOf": [mapping(ends, ["from", "to"]), values]}


def _axis_of(leaf: Leaf) -> dict[str, Any]:
    if leaf.kind == "fluid":
        return {"anyOf": [_FLUIDS, _COLUMN]}
    if leaf.kind == "choice":
        values = {"type": "array", "items": {"enum": list(leaf.limits["options"])}, "minItems": 1}
        return {"anyOf": [values, _COLUMN]}
    return {"$ref": f"#/$defs/axis_{leaf.kind}"}


def _example(kind: str) -> dict[str, Any]:
    return _quantity(KINDS[kind]) if kind in KINDS else {"type": "integer" if kind == "count" else "number"}


def _axis(value: dict[str, Any]) -> dict[str, Any]:
    ends = {"from": value, "to": value, "count": {"type": "integer", "minimum": 1}, "spacing": _SPACING}
    span = mapping(ends, ["from", "to", "count"])
    return {"anyOf": [{"type": "array", "items": value, "minItems": 1}, span, _COLUMN]}
