"""The JSON Schema of a file of two stages."""

from typing import Any

from screwsim.scene.fields import section_of
from screwsim.scene.file_kinds import STAGES
from screwsim.scene.model_errors import BLOCK
from screwsim.scene.schema import (
    CORRELATED_SCHEMA,
    DRAFT,
    OWN_PARAMETER,
    axis_definitions,
    leaf_schema,
    mapping,
    sweep_schema,
)
from screwsim.scene.tolerances import CORRELATED_KEY
from screwsim.study.stages.axes import BETWEEN, LEAVES, STAGE_NAMES, Intercooler, names_in_chain


def stages_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a file of stages; the scenes that it names have their own."""
    cooled = {"properties": {"kind": {"const": "cooler"}}, "required": ["kind"]}
    between = mapping({name: leaf_schema(leaf) for name, leaf in LEAVES.items()}, (), section_of(Intercooler).doc) | {
        "if": cooled,
        "then": {"required": ["outlet_temperature"]},
        "else": {"properties": {"outlet_temperature": {"type": "null"}}},
    }
    files = {
        "type": "array",
        "description": f"the scenes of the {' and the '.join(STAGE_NAMES)} stage, relative to this file",
        "items": {"type": "string"},
        "minItems": len(STAGE_NAMES),
        "maxItems": len(STAGE_NAMES),
    }
    more = {f"{BETWEEN}.{name}": leaf for name, leaf in LEAVES.items() if name != "kind"}
    own = OWN_PARAMETER.replace("^", f"^({'|'.join(STAGE_NAMES)})\\.", 1)
    properties = {
        "title": {"type": ["string", "null"]},
        STAGES: files,
        "intercooler": between,
        "sweep": sweep_schema(names_in_chain, more, own),
        BLOCK: mapping({CORRELATED_KEY: CORRELATED_SCHEMA}, [CORRELATED_KEY]),
    }
    schema = {"$schema": DRAFT, "title": "screwsim stages"} | mapping(properties, [STAGES])
    return schema | {"$defs": axis_definitions()}
