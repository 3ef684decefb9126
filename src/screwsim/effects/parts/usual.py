"""Roles of effects, what scenes of a kind of machine usually name, and how large the sizes of effects can be.

An effect declares these of itself, so that the core can ask for them without knowing an effect by name. Roles are texts
(`Effect.roles`); those that call for figures are declared beside these (`outputs.core`).
"""

from typing import NamedTuple

WAY_IN = "a path between the suction line and the chambers"
WAY_OUT = "a path between the chambers and the discharge line"
SUCTION_BACK = "what flows back to suction is taken in again"
OIL_ROOM = "oil takes up volume"
PUMPS = "power to pump the oil"
SLIDES = "position of a slide"


class Usual(NamedTuple):
    """Something that hardly any machine lacks; one effect that has it is enough. `oiled`: not for a dry machine."""

    what: str
    oiled: bool = False


LEAK = Usual("a leak")  # each leak is asked for by itself
OIL_HEAT = Usual("heat between gas and oil", oiled=True)
OIL_FRICTION = Usual("power lost in the oil", oiled=True)
FRICTION = Usual("friction of bearings and seals")
SUCTION_RETURN = Usual("flow back into the suction line")
SEPARATOR = Usual("oil separator and cooler", oiled=True)
DRIVE = Usual("the motor")
WALLS = Usual("heat of the walls")
USUAL = (OIL_HEAT, OIL_FRICTION, FRICTION, SUCTION_RETURN, SEPARATOR, DRIVE, WALLS)  # in the order of messages


class Sized(NamedTuple):
    """A size of an effect that is compared with a length scale of the machine (`machine.protocol`), where that has it.

    Size over scale must not exceed `most`, and is unusual outside `usual`.
    """

    key: str
    scale: str
    most: float
    usual: tuple[float, float]
