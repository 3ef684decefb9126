"""Units of figures and of paths, as other tools want them: exponents of the SI's base units, customary units beside."""

import re
from typing import NamedTuple

from screwsim.outputs.display import si_unit

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_DERIVED: dict[str, dict[str, int]] = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    **{name: {name: 1} for name in BASE},
}
_PART = re.compile(r"([A-Za-z]+)\^?(-?[0-9]+)?")


class Display(NamedTuple):
    """A customary unit: a value in it is factor times that in SI, plus offset."""

    name: str
    factor: float
    offset: float = 0.0


DISPLAYS = {
    "K": (Display("degC", 1.0, -273.15),),
    "Pa": (Display("bar", 1e-5),),
    "W": (Display("kW", 1e-3),),
    "rad/s": (Display("rpm", 9.549296585513721),),
}


def plain(units: str) -> str:
    """Return a unit as people write it, '1' for numbers: 'kg s-1' is kg/s."""
    return units if "/" in units else si_unit(units) or "1"


def exponents(units: str) -> dict[str, int]:
    """Return the exponents of base units in a unit such as 'kg s-1' or 'J/(kg K)'; empty for '1'.

    Raise ValueError of a unit that is not made of the SI's.
    """
    above, _, below = units.partition("/")
    found: dict[str, int] = {}
    for text, sign in ((above, 1), (below, -1)):
        for name, power in _PART.findall(text):
            if name not in _DERIVED:
                raise ValueError(f"{units}: {name} is no unit of the SI")
            for base, exponent in _DERIVED[name].items():
                found[base] = found.get(base, 0) + sign * exponent * int(power or 1)
    return {name: power for name, power in found.items() if power}
