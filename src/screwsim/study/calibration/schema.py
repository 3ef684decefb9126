"""JSON Schema of a fit, for editors and other programs."""

from __future__ import annotations

from typing import Any

from screwsim.effects import catalogue
from screwsim.scene.fields import Leaf, leaf_paths
from screwsim.scene.schema import OWN_PARAMETER, value_schema
from screwsim.study.calibration.read import HEAD, difference

NOT_CONTINUOUS = ("choice", "count", "word", "file")


def fit_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a fit."""
    leaves = leaf_paths({name: effect.parameters for name, effect in catalogue().items()})
    paths = {path: leaf for path, leaf in leaves.items() if leaf.kind not in NOT_CONTINUOUS}
    properties = {name: {"description": leaf.doc, **value_schema(leaf)} for name, leaf in HEAD.items()}
    properties["parameters"] = {
        "type": "object",
        "description": "what is fitted, by scene path, with its bounds",
        "properties": {path: _parameter(leaf) for path, leaf in paths.items()},
        "patternProperties": {OWN_PARAMETER: {"type": "object"}},
        "additionalProperties": False,
        "minProperties": 1,
    }
    required = [name for name, leaf in HEAD.items() if leaf.required]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "screwsim fit",
        "type": "object",
        "properties": properties,
        "required": [*required, "parameters"],
        "additionalProperties": False,
    }


def _parameter(leaf: Leaf) -> dict[str, Any]:
    value, apart = value_schema(leaf), value_schema(difference(leaf))
    prior = _mapping({"mean": value, "deviation": apart}, ["mean", "deviation"])
    follows = _mapping({"factor": {"type": "number"}, "offset": apart}, [])
    names = {
        "from": value,
        "to": value,
        "start": value,
        "spacing": {"enum": ["linear", "log"], "default": "linear"},
        "prior": prior,
        "also": {"type": "object", "additionalProperties": follows},
    }
    return {"description": leaf.doc, **_mapping(names, ["from", "to"])}


def _mapping(properties: dict[str, Any], required: list[str]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}
