"""Recognise, by its keys, a file of another kind than the one a command expects."""

from collections.abc import Collection
from shlex import quote

STAGES = "stages"
_FIT = ("parameters", "data", "scene")


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
