"""JSON Schema of a fit, for editors and other programs."""

from typing import Any

from screwsim.effects import catalogue
from screwsim.scene.fields import Leaf, leaf_paths
from screwsim.scene.schema import DRAFT, OWN_PARAMETER, mapping, value_schema
from screwsim.study.calibration.read import HEAD_FIELDS, NO_PRIOR, difference

NOT_CONTINUOUS = ("choice", "count", "word", "fluid", "numbers", "file")


def fit_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a fit."""
    leaves = leaf_paths({name: effect.parameters for name, effect in catalogue().items()})
    paths = {path: leaf for path, leaf in leaves.items() if leaf.kind not in NOT_CONTINUOUS}
    properties = {name: {"description": leaf.doc, **value_schema(leaf)} for name, leaf in HEAD_FIELDS.items()}
    properties["parameters"] = {
        "type": "object",
        "description": "the parameters to fit, by scene path, with their bounds",
        "properties": {path: _parameter(leaf) for path, leaf in paths.items()},
        "patternProperties": {OWN_PARAMETER: {"type": "object"}},
        "additionalProperties": False,
        "minProperties": 1,
    }
    required = [name for name, leaf in HEAD_FIELDS.items() if leaf.required]
    head = {"$schema": DRAFT, "title": "screwsim fit"}
    return head | mapping(properties, [*required, "parameters"])


def _parameter(leaf: Leaf) -> dict[str, Any]:
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
