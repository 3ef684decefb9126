"""What scenes of a kind of machine usually name, and how large the sizes of effects can be.

An effect says which of these it is; the core asks for them without knowing who they are.
"""

from typing import NamedTuple


class Usual(NamedTuple):
    """What hardly a machine is without; of several effects that are so one is enough. `oiled`: not a dry machine's."""

    what: str
    oiled: bool = False


LEAK = Usual("a leak")  # of these each counts
OIL_HEAT = Usual("heat between gas and oil", oiled=True)
OIL_FRICTION = Usual("power lost in the oil", oiled=True)
FRICTION = Usual("friction of bearings and seals")
SUCTION_RETURN = Usual("what flows back into the suction line")
SEPARATOR = Usual("separator and cooler of the oil", oiled=True)
DRIVE = Usual("the motor")
WALLS = Usual("heat of the walls")
USUAL = (OIL_HEAT, OIL_FRICTION, FRICTION, SUCTION_RETURN, SEPARATOR, DRIVE, WALLS)  # as they are told


class Sized(NamedTuple):
    """A size of an effect, held against a scale of the machine (`machine.protocol`) where that has it.

    Its share of that is at most `most`, and hardly outside `usual`.
    """

    key: str
    scale: str
    most: float
    usual: tuple[float, float]
