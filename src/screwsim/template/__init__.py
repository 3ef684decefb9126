"""New scenes: a complete, commented machine of a kind, for the requested size and duty.

Sizes scale from known machines (`template.sizes`); each number in the text has its source.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import NamedTuple

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.inputs.suggestions import joined_names, nearest, with_article
from screwsim.scene import loads
from screwsim.template import booster, economizer, expander, gas, reciprocating, refrigeration
from screwsim.template.request import SceneRequest, note_on_pressure, request_of

MOTOR, SPEEDS, CAPACITY = ("--motor",), ("--variable-speed",), ("--capacity",)
FLOW, PRESSURE = ("--flow",), ("--pressure",)
LIQUID, SLIDE = ("--economizer",), ("--slide",)
REFUSED_OPTION_MESSAGES = {  # message on options that a kind does not take
    MOTOR: "is for {takers} (remove it; the motor of {name} follows from its size)",
    CAPACITY: "is for {takers} (remove it; {name} takes --displacement)",
    FLOW: "is for {takers} (remove it; {name} takes --displacement)",
    PRESSURE: "is from the data sheet of an air package (write screwsim new {takers}; {name} takes --condition)",
    SPEEDS: "is for {takers}, from whose data sheet it comes (remove it)",
    SLIDE: "is for {takers}, which it unloads (remove it)",
    LIQUID: "is for {takers}, whose liquid it cools (remove it)",
}

KIND_SYNONYMS = {
    "chiller": "refrigeration",
    "cooling": "refrigeration",
    "heating": "heat_pump",
    "piston": "reciprocating",
}


class Kind(NamedTuple):
    """A kind of new scene: the function that writes it, and the options that it takes beside those of all kinds.

    `cools` is the figure that `--capacity` states; `first` gives the displacement [m³/s] of the first size tried when a
    size is sought.
    """

    written: Callable[[SceneRequest], str]
    takes: tuple[str, ...] = ()
    cools: str = ""
    first: Callable[[SceneRequest], float] = gas.first_flow


def _plant(plant: refrigeration.Plant, capacity: str) -> Kind:
    written, first = partial(refrigeration.scene_of, plant), partial(refrigeration.first_flow, plant)
    return Kind(written, MOTOR + CAPACITY + LIQUID + SLIDE, capacity, first)


KINDS = {
    "refrigeration": _plant(refrigeration.COOLING, "cooling_capacity"),
    "heat_pump": _plant(refrigeration.HEATING, "heating_capacity"),
    "air": Kind(gas.air, MOTOR + FLOW + PRESSURE + SPEEDS),
    "booster": Kind(booster.booster, MOTOR + FLOW, first=booster.first_flow),
    "expander": Kind(expander.expander),
    "reciprocating": Kind(reciprocating.reciprocating),
}
__all__ = ["KINDS", "SceneRequest", "kind_of", "new_scene", "note_on_pressure", "request_of"]


def kind_of(name: str, options: Iterable[str] = ()) -> Kind:
    """Return a kind by its name; raise UsageError for an unknown one, or for an option that it does not take."""
    if name not in KINDS:
        near = KIND_SYNONYMS.get(name.lower()) or nearest(name, KINDS)
        hint = f"; did you mean '{near}'?" if near else ""
        raise UsageError(f"{name}: is not a kind of new scene{hint} (known: {', '.join(KINDS)})")
    for option in options:
        takers = [each for each, kind in KINDS.items() if option in kind.takes]
        if name not in takers:
            told = next(text for options, text in REFUSED_OPTION_MESSAGES.items() if option in options)
            raise UsageError(f"{option}: {told.format(takers=joined_names(takers), name=name)}")
    return KINDS[name]


def new_scene(kind: str, asked: SceneRequest) -> str:
    """Return the text of a scene; raise UsageError, in one line, where there can be none."""
    try:
        text = kind_of(kind).written(asked)
        loads(text, f"new {kind}")
    except SceneError as error:
        place, _, what = error.lines[0].partition(": ")
        told = economizer.refused_port(what) if asked.economizer else ""
        if not told and what.startswith("machine.slide_valve."):
            told = f"--slide: {what.rpartition(' (')[0]} (choose a larger --vi, or no --slide)"
        if not told and ".gas_viscosity: " in what:
            lacks = "CoolProp has no viscosity of it, which the gaps need"
            told = f"--fluid {asked.fluid}: {lacks} (choose a similar gas)"
        raise UsageError(told or f"such {with_article(kind)} is not possible: {what or place}") from None
    return text
