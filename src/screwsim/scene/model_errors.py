"""What `screwsim validate` found of the model's error, by the names that a scene may give under `uncertainty.model`.

Made by docs/tools/model_errors.py; no number of it is typed.
"""

import json
import math
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any

from screwsim.inputs.near import nearest
from screwsim.scene.values import shown
from screwsim.scene.yaml_tree import Node, Problem

BLOCK, MODEL = "uncertainty", "model"
FILE = "model_errors.json"
SPEED, RATIO = "operation.speed", "pressure_ratio"
WORDS = {"machine.kind": "machine", "gas.fluid": "fluid", SPEED: "speed", RATIO: "pressure ratio"}


@cache
def stored() -> Mapping[str, Any]:
    """Return the statements by name."""
    return json.loads(resources.files("screwsim.scene").joinpath(FILE).read_text(encoding="utf-8"))


def read_model_error(block: Node | None, problems: list[Problem]) -> str:
    """Return the name of the validation whose model error a scene asks for; '' where it asks for none."""
    node = block.value.get(MODEL) if block is not None and isinstance(block.value, dict) else None
    if node is None or node.value is None:
        return ""
    known = list(stored())
    if node.value in known:
        return node.value
    near = nearest(node.value, known) if isinstance(node.value, str) else None
    hint = f"did you mean '{near}'? " if near else ""
    what = f"{shown(node.value)} is no validation that states an error of the model ({hint}known: {', '.join(known)})"
    problems.append(Problem(node.place, f"{BLOCK}.{MODEL}", what))
    return ""


def range_text(known: Mapping[str, Any]) -> str:
    """Return in words where something was validated."""
    parts = []
    for name, ends in known.items():
        texts = list(dict.fromkeys(each if isinstance(each, str) else shown_condition(name, each) for each in ends))
        parts.append(f"{WORDS[name]} {(', ' if isinstance(ends[0], str) else ' to ').join(texts)}")
    return ", ".join(parts)


def shown_condition(name: str, value: float) -> str:
    """Return a condition [SI] as people write it."""
    return f"{30.0 / math.pi * value:.4g} rpm" if name == SPEED else f"{value:.3g}"
