"""JSON Schema of a file of stages, for editors and other programs, from the declarations that read it."""

from typing import Any

from screwsim.scene.fields import Leaf, section_of
from screwsim.scene.schema import DRAFT, leaf_schema, mapping
from screwsim.study.stages.read import KEY, NAMES, Intercooler


def stages_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a file of stages; the scenes that it names have their own."""
    section = section_of(Intercooler)
    leaves = {name: leaf_schema(leaf) for name, leaf in section.fields.items() if isinstance(leaf, Leaf)}
    cooled = {"properties": {"kind": {"const": "cooler"}}, "required": ["kind"]}
    between = mapping(leaves, (), section.doc) | {
        "if": cooled,
        "then": {"required": ["outlet_temperature"]},
        "else": {"properties": {"outlet_temperature": {"type": "null"}}},
    }
    files = {
        "type": "array",
        "description": f"the scenes of the {' and the '.join(NAMES)} stage, relative to this file",
        "items": {"type": "string"},
        "minItems": len(NAMES),
        "maxItems": len(NAMES),
    }
    properties = {"title": {"type": ["string", "null"]}, KEY: files, "intercooler": between}
    return {"$schema": DRAFT, "title": "screwsim stages"} | mapping(properties, [KEY])
