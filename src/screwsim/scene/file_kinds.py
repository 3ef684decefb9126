"""Recognise, by its keys, a file of another kind than the one a command expects."""

import os
from collections.abc import Collection
from shlex import quote

from screwsim.inputs.textfiles import MOST_YAML, Unreadable, read_text, shipped_name
from screwsim.scene.yaml_tree import LocatedFaults, Node, Position, compose

STAGES = "stages"  # key of the files of both scenes
_FIT = ("parameters", "data", "scene")


def is_stages(path: str | os.PathLike[str]) -> bool:
    """Return whether a YAML file describes stages instead of one scene."""
    root = mapping_of(shipped_name(path), LocatedFaults())
    return root is not None and STAGES in root.value


def mapping_of(name: str, problems: LocatedFaults) -> Node | None:
    """Return the tree of a YAML file that is a mapping; None for anything else, and for a file that is missing."""
    place = Position.start_of(name)
    try:
        text = read_text(name, MOST_YAML)
    except Unreadable:
        return None  # a missing scene is reported by the reader of scenes
    root = compose(text, place, problems)
    return root if root is not None and isinstance(root.value, dict) else None


def other_file(keys: Collection[str], name: str, wanted: str = "scene") -> str | None:
    """Return what a file is that is not the `wanted` kind (scene, fit), and which command reads it; else None."""
    if STAGES in keys:
        studies = "`datasheet`, `optimum`, `optimize`, `find`, `sensitivity`"
        commands = f"`screwsim run`, `sweep`, {studies}, `explain` and `export`"
        remedy = f"run one of these on {name}, or name the scene of one stage here"
        return f"describes two stages, which only {commands} accept ({remedy})"
    fit = len([key for key in _FIT if key in keys]) >= 2 and not {"machine", "gas", "operation"} & set(keys)
    if wanted == "scene" and fit:
        return f"is a fit, not a scene (run screwsim calibrate {quote(name)})"
    if wanted == "fit" and not fit and {"machine", "gas", "operation", "base"} & set(keys):
        return f"is a scene, not a fit (run screwsim run {quote(name)}; a fit has scene:, data: and parameters:)"
    return None
