"""What an effect is: a declaration of flow paths, plenums, oil ports, heat rates, walls, losses and readings.

An effect only ever adds to the rates of a chamber; it never assigns them. Each is one file, of this package or of the
user's own, with a module variable `EFFECT`. The argument names of its kernels say what they need: a parameter of the
effect itself, or one of the symbols of docs/reference/nomenclature.md (`phi`, `T`, `m`, `T_oil`, `omega`,
`rotor_diameter` …).

Source: screwsim, docs/how-to/adding-an-effect.md.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from screwsim.effects.parts.flow_kinds import GAS, NOZZLE, OIL, Bounds, FlowKind, Law, PathStream, Resistance
from screwsim.effects.parts.flows import (
    DISCHARGE,
    LINES,
    NEIGHBOUR,
    SUCTION,
    ChamberState,
    FlowPath,
    HeatRate,
    Scaled,
    Stops,
    Wall,
)
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
from screwsim.effects.parts.oil import OilContent, OilGas, OilPort, OilRoom, OilSolution, OilThinning
from screwsim.effects.parts.readings import Around, Drawn, Given, Plenum, PowerLoss, Reading, Shaft, Site
from screwsim.effects.parts.usual import Sized, Usual
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import MachineKind
from screwsim.numerics.feedback_unknowns import FeedbackUnknown
from screwsim.outputs import Figure, Trace

__all__ = [  # all that an effect's file imports
    "DISCHARGE", "GAS", "LINES", "NEIGHBOUR", "NOZZLE", "OIL", "SUCTION", "Around", "Bounds", "ChamberState",
    "CoolsOil", "Drawn", "Effect", "Faults", "FeedbackUnknown", "FlowKind", "FlowPath", "Given", "HeatRate",
    "InSeparator", "Law", "LineFlow", "LineLeak", "LosesPressure", "Made", "OilContent", "OilGas", "OilPort", "OilRoom",
    "OilSolution", "OilThinning", "Part", "PathStream", "Plenum", "PowerLoss", "PressureLosses", "Pulsation",
    "Reading", "Resistance", "Scaled", "Separator", "Shaft", "Site", "Sized", "Sought", "Span", "Stops",
    "SuctionChange", "SuctionHeat", "SuctionLine", "Turn", "Usual", "Wall",
]  # fmt: skip

Faults = Iterator[Fault]  # of an effect's `check`
Part = (
    FlowPath | Plenum | OilPort | OilGas | OilThinning | OilRoom | ChamberState | Stops | HeatRate | Wall | Made
    | Scaled | Pulsation | PowerLoss | Reading | Shaft | Separator | SuctionChange | SuctionLine | LineLeak
    | SuctionHeat
)  # fmt: skip


@dataclass(frozen=True)
class Effect:
    """One physical effect, named in a scene under `effects`.

    `figures` are the results that it gives where a scene calls for them, `traces` its curves over the angle.
    `warnings(found)` yields a text for each figure of a cycle that is hardly plausible.

    `build(parameters, machine)` returns its parts. `check(parameters, facts)` returns the faults that only the whole
    scene shows, `check_geometry(parameters, geometry)` those that only the machine's geometry shows; it is called once
    the scene has no other fault. `numbers(parameters, around)` returns values for argument names of its kernels that
    follow from the scene. `needs` is what a machine must offer (`machine.protocol`); empty: every kind of machine will
    do.

    The core never asks for an effect by name; an effect says of itself what the core wants to know. `roles` maps such a
    question (a text of `outputs` or `effects.parts.usual`) to the effect's own `.key` that answers it, or to an empty
    text where the answer is always yes. `usual` says, by what a machine offers, which usual ingredient of a scene it
    is. `sizes` are those of its keys that must fit into the machine. `in_expander`: whether an expander can have it.
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
    in_expander: Literal["always", "dry", "never"] = "always"  # dry: without oil, whose ways it would have to follow

    def fits(self, kind: MachineKind) -> bool:
        """Tell whether a kind of machine offers what this effect needs."""
        return self.needs <= kind.offers

    def suits(self, kind: MachineKind, expands: bool, oiled: bool) -> bool:
        """Tell whether a machine of a kind can have this effect, as an expander or not, with oil or without."""
        return self.fits(kind) and (
            not expands or self.in_expander == "always" or (self.in_expander == "dry" and not oiled)
        )
