"""What an effect is: a declaration of flow paths, plenums, oil ports, heat rates, walls, losses, readings; kernels.

An effect adds to the rates of a chamber and never assigns. It is one file of this package, or of a user's own,
with a module variable `EFFECT`. A kernel's argument names say what it needs: a parameter of the effect itself,
or one of the symbols of docs/reference/nomenclature.md (`phi`, `T`, `m`, `T_oil`, `omega`, `rotor_diameter` …).

Source: screwsim, docs/how-to/adding-an-effect.md.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from screwsim.effects.parts.flows import DISCHARGE, LINES, NEIGHBOUR, SUCTION, FlowPath, Resistance, Scaled
from screwsim.effects.parts.lines import (
    CoolsOil,
    InSeparator,
    LineLeak,
    LosesPressure,
    PressureLosses,
    Separator,
    SuctionChange,
    SuctionHeat,
    SuctionLine,
)
from screwsim.effects.parts.made import LineFlow, Made, Pulsation, Sought, Span, Turn
from screwsim.effects.parts.oil import OilContent, OilGas, OilPort, OilRoom, OilSolution
from screwsim.effects.parts.plenums import Drawn, Plenum, Site
from screwsim.effects.parts.readings import Given, PowerLoss, Reading, Shaft
from screwsim.effects.parts.states import ChamberState, HeatRate, Stops, Wall
from screwsim.effects.parts.usual import Sized, Usual
from screwsim.fluid.settings import OilProperties
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import MachineKind
from screwsim.outputs import Figure, Trace

__all__ = [  # all that an effect's file imports
    "DISCHARGE",
    "LINES",
    "NEIGHBOUR",
    "SUCTION",
    "Around",
    "ChamberState",
    "CoolsOil",
    "Drawn",
    "Effect",
    "Faults",
    "FlowPath",
    "Given",
    "HeatRate",
    "InSeparator",
    "LineFlow",
    "LineLeak",
    "LosesPressure",
    "Made",
    "OilContent",
    "OilGas",
    "OilPort",
    "OilRoom",
    "OilSolution",
    "Part",
    "Plenum",
    "PowerLoss",
    "PressureLosses",
    "Pulsation",
    "Reading",
    "Resistance",
    "Scaled",
    "Separator",
    "Shaft",
    "Site",
    "Sized",
    "Sought",
    "Span",
    "Stops",
    "SuctionChange",
    "SuctionHeat",
    "SuctionLine",
    "Turn",
    "Usual",
    "Wall",
]

Faults = Iterator[Fault]  # of an effect's `check`
Part = (
    FlowPath | Plenum | OilPort | OilGas | OilRoom | ChamberState | Stops | HeatRate | Wall | Made | Scaled | Pulsation
    | PowerLoss | Reading | Shaft | Separator | SuctionChange | SuctionLine | LineLeak | SuctionHeat
)  # fmt: skip


class Around(NamedTuple):
    """What an effect can ask of a scene before it is composed; SI units. `oil` has density and viscosity.

    `tip_speed` is that of the male rotor, or the mean piston speed.
    """

    fluid: str
    p_s: float
    T_s: float
    p_d: float
    tip_speed: float
    T_oil: float | None = None
    oil: OilProperties | None = None


@dataclass(frozen=True)
class Effect:
    """One physical effect, named in a scene under `effects`.

    `figures` are those that it gives where a scene calls for them, `traces` its curves over the angle;
    `warnings(found)` tells from the figures of a cycle what of them hardly can be.

    `build(parameters, machine)` returns its parts; `check(parameters, facts)` returns faults that only the whole scene
    shows, `check_geometry(parameters, geometry)` those that show on the machine's geometry, of a scene that is in order
    but for these. `numbers(parameters, around)` returns numbers behind argument names of its kernels that follow from
    the scene. `needs` is what a machine must offer (`machine.protocol`), of all kinds by default.

    What the core asks for without knowing who does it, an effect says of itself: `roles` are such questions (words of
    `outputs`) with the key of its own, `.key`, by which it answers one, empty where it always does; `usual` is what it
    is in scenes of machines that offer something; `sizes` are those of its keys that must fit into the machine.
    """

    name: str
    title: str
    equations: tuple[str, ...]
    source: str
    parameters: type
    build: Callable[[Any, Any], Sequence[Part]]
    needs_oil: bool = False
    states: tuple[str, ...] = ()
    check: Callable[[Any, Any], Iterable[Fault]] | None = None
    check_geometry: Callable[[Any, Any], Iterable[Fault]] | None = None
    numbers: Callable[[Any, Around], Mapping[str, float]] | None = None
    needs: frozenset[str] = frozenset()
    figures: tuple[Figure, ...] = ()
    traces: tuple[Trace, ...] = ()
    warnings: Callable[[Mapping[str, Any]], Iterable[str]] | None = None
    roles: Mapping[str, str] = field(default_factory=dict)
    usual: Mapping[str, Usual] = field(default_factory=dict)
    sizes: tuple[Sized, ...] = ()

    def fits(self, kind: MachineKind) -> bool:
        """Tell whether a kind of machine can have this effect."""
        return self.needs <= kind.offers
