"""The layout of P and TAB: which number of a scene is where, and which numbers kernels can ask for by name."""

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.model.parts import Parts
from screwsim.model.slots import OIL_NUMBERS, P_FIRST_OIL
from screwsim.numerics.spline import pack_curve

# kernels' names for the numbers of the injection orifice
BORE = {"viscosity": "oil_viscosity", "diameter": "bore_diameter", "length": "bore_length", "number": "bore_count"}
BORE |= {"separator_pressure": "separator_pressure"}

# names of numbers that kernels cannot ask for: the oil's supply, the time between two chambers
SUPPLY, SPAN = "oil_supply.", "pitch / omega"


@dataclass
class Numbers:
    """P and TAB while they are laid out; the head of P is filled in last."""

    values: list[float]
    tables: list[np.ndarray] = field(default_factory=list)
    named: dict[int, str] = field(default_factory=dict)  # names of the numbers in P that `operating` has
    held: dict[int, tuple[Any, str]] = field(default_factory=dict)  # holder and name of each of the others
    lost: bool = False  # whether there is a number with neither
    places: dict[str, int] = field(default_factory=dict)  # indices in P by the names in the text

    def add(
        self,
        value: float,
        label: str,
        name: str | None = None,
        of: tuple[Any, str] | None = None,
        structural: bool = False,
    ) -> str:
        """Append a number and return how the text reads it, by a name made of its label; `name` is that of `operating`.

        A number without such a name is stored in a mapping under a key or in an object as a field (`of`,
        `model.renumbering`), or it is `structural`: the same in all scenes of the structure.
        """
        self.values.append(float(value))
        at = len(self.values) - 1
        if name is not None:
            self.named[at] = name
        elif of is not None:
            self.held[at] = of
        elif not structural:
            self.lost = True
        label = first = "P_" + (label if label.isidentifier() else re.sub(r"\W", "_", label))
        again = 2
        while label in self.places:
            label, again = f"{first}_{again}", again + 1
        self.places[label] = at
        return f"P[{label}]"

    def add_table(self, curve: tuple[np.ndarray, ...], label: str) -> str:
        """Append a table and return how the text reads the index of its start in TAB."""
        start = sum(len(table) for table in self.tables)
        self.tables.append(pack_curve(*curve))
        return self.add(float(start), label, structural=True)

    def place_of(self, cell: str) -> int:
        """Return the index in P of what the text reads as `cell`."""
        return self.places[cell.removeprefix("P[").removesuffix("]")]


def symbols_of(parts: Parts) -> dict[str, float]:
    """Return the numbers of the scene that any kernel can ask for by name (docs/reference/nomenclature.md)."""
    settings = parts.geometry.settings
    found = {"omega": parts.omega, "tip_speed": settings.surface_speed(parts.omega), "pitch": parts.geometry.pitch}
    found |= settings.symbols()
    if parts.oil is not None:
        found["oil_density"] = parts.oil.density
        found["oil_heat_capacity"] = parts.oil.heat_capacity
        found["oil_room"] = 1.0 / parts.oil.density if parts.oil_room else 0.0
        found |= {BORE[name]: value for name, value in parts.oil.supply.items() if name in BORE}
    return found


def operating(parts: Parts) -> dict[str, float]:
    """Return the numbers of P, by their own names, that may change while machine, gas and effects stay."""
    found = symbols_of(parts)
    found[SPAN] = parts.geometry.pitch / parts.omega
    for name, value in parts.oil.supply.items() if parts.oil is not None else ():
        found[SUPPLY + name] = value
    return found


def oil_places(parts: Parts) -> dict[str, int]:
    """Return the indices in P of the oil's numbers, which follow the widths of the own plenums."""
    return {name: P_FIRST_OIL + len(parts.plenums) + i for i, name in enumerate(OIL_NUMBERS)}


def fixed_numbers(parts: Parts) -> list[float]:
    """Return the head of P (slots.P_OMEGA …), with a regularisation width for each own plenum."""
    oil, geometry = parts.oil, parts.geometry
    head = [parts.omega, geometry.pitch, geometry.life, geometry.injection_angle]
    *of_network, of_plenum = parts.widths
    head += [*of_network, *(of_plenum for _ in parts.plenums)]
    head += [oil.heat_capacity, oil.temperature, float("ratio" in oil.supply)] if oil is not None else [1.0, 0.0, 0.0]
    if oil is not None and (parts.oil_room or parts.oil_port is not None):
        room = 1.0 / oil.density if parts.oil_room else 0.0
        loss = parts.oil_port.loss(oil.source_pressure) if parts.oil_port is not None else 0.0
        if parts.pumped:
            loss = 0.0  # the pump pays it
        at_port = oil.temperature + room * (oil.source_pressure - loss) / oil.heat_capacity
        head += [room, oil.source_pressure, at_port]
        if parts.pumped:
            head.append(0.0)
    return head
