"""New scenes: a complete, commented machine of a kind, of the size and for the duty that are asked for.

Sizes scale from machines that the program knows (`template.sizes`); every number of the text says where it is from.
"""

from __future__ import annotations

from collections.abc import Callable

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.inputs.near import nearest
from screwsim.scene import loads
from screwsim.template import gas, reciprocating, refrigeration
from screwsim.template.asked import Asked, asked_of

AIR = "air"  # of which sheets state what it delivers and takes
CONDENSING = ("refrigeration", "heat_pump")  # screws whose gas condenses: what cools its liquid belongs to them
KINDS: dict[str, Callable[[Asked], str]] = {
    "refrigeration": refrigeration.cooling,
    "heat_pump": refrigeration.heating,
    AIR: gas.air,
    "booster": gas.booster,
    "expander": gas.expander,
    "reciprocating": reciprocating.reciprocating,
}
__all__ = ["AIR", "CONDENSING", "KINDS", "Asked", "asked_of", "new_scene"]


def new_scene(kind: str, asked: Asked) -> str:
    """Return the text of a scene; raise UsageError, in one line, where none can be."""
    if kind not in KINDS:
        near = nearest(kind, KINDS)
        hint = f"; did you mean '{near}'?" if near else ""
        raise UsageError(f"{kind}: is no kind of new scene{hint} (there are: {', '.join(KINDS)})")
    text = KINDS[kind](asked)
    try:
        loads(text, f"new {kind}")
    except SceneError as error:
        place, _, what = error.lines[0].partition(": ")
        port = refrigeration.refused_port(what) if asked.economizer else ""
        such = f"such {'an' if kind[0] in 'aeiou' else 'a'} {kind}"
        raise UsageError(port or f"{such} cannot be: {what or place}") from None
    return text
