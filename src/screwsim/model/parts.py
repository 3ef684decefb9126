"""The built parts of a scene: input of the composer, and the description of what is simulated for everybody else."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from screwsim.effects import base
from screwsim.fluid.gas import Gas
from screwsim.fluid.reservoir import Reservoir
from screwsim.machine.protocol import MachineGeometry
from screwsim.model.slots import FIRST_OWN
from screwsim.numerics.frozen import fast_init
from screwsim.numerics.identity_cache import once

# regularisation widths: suction port, discharge port [Pa], gaps (share of the pressure), ports to own plenums [Pa]
Widths = tuple[float, float, float, float]


@dataclass(frozen=True)
class OilPart:
    """The oil in the model: properties [SI], whether its mass is `carried` as a state, and supply.

    `supply` is {'ratio': d} for a pump, or the orifice's density, viscosity, diameter, length, number, p_separator.
    `with_gas` is the oil per gas that comes in with the gas of the suction line (an expander, M490), else 0.
    """

    density: float
    heat_capacity: float
    temperature: float
    carried: bool
    supply: Mapping[str, float]
    source_pressure: float = 0.0
    with_gas: float = 0.0


class Effects(dict[str, Sequence[Any]]):
    """The parts of every effect by its name; the contents do not change, so lookups by kind are cached."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.found: dict[type, list[tuple[str, Any]]] = {}  # cached lookups

    def all(self, kind: type) -> list[tuple[str, Any]]:
        """Return (effect, part) of all parts of a kind, in the order of the effects."""
        found = self.found.get(kind)
        if found is None:
            found = [(name, part) for name, parts in self.items() for part in parts if isinstance(part, kind)]
            self.found[kind] = found
        return found


@fast_init
@dataclass(frozen=True)
class Parts:
    """The built parts of a scene: machine geometry, gas, operation, oil, and every effect's parts.

    `omega` [rad/s] is the mean speed; `plenums` are the reservoirs of the effects' own plenums by name, `made` the
    initial values of effects' feedback unknowns, by name.
    """

    geometry: MachineGeometry
    gas: Gas
    omega: float
    widths: Widths
    effects: Mapping[str, Sequence[Any]]
    oil: OilPart | None
    plenums: Mapping[str, Reservoir] = field(default_factory=dict)
    made: Mapping[str, float] = field(default_factory=dict)
    set_speed: float | None = None  # [rad/s] stated in the scene, where omega follows from it
    oil_content: base.OilContent | base.OilSolution | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.effects, Effects):
            object.__setattr__(self, "effects", Effects(self.effects))

    def all(self, kind: type) -> list[tuple[str, Any]]:
        """Return (effect, part) of all parts of a kind, in the order of the effects."""
        effects: Any = self.effects  # `Effects`, see above
        found = effects.found.get(kind)
        return effects.all(kind) if found is None else found

    def _only(self, kind: type, what: str) -> Any:
        """Return the part of a kind that a scene may have only once, or None."""
        found = [part for _, part in self.all(kind)]
        if len(found) > 1:
            raise TypeError(f"two effects declare {what}; a scene has one")
        return found[0] if found else None

    def number(self, to: str) -> int:
        """Return the number of the line or plenum that a flow path leads to (slots)."""
        numbers = {line: i for i, line in enumerate(base.LINES)} | {
            name: i for i, name in enumerate(self.plenums, FIRST_OWN)
        }
        if to not in numbers:
            raise TypeError(f"a flow path leads to {to!r}, which no effect declares; known: {', '.join(numbers)}")
        return numbers[to]

    @once
    def ports(self) -> list[tuple[str, base.FlowPath]]:
        """The openings to lines and plenums, with the effects that declare them."""
        return [(name, path) for name, path in self.all(base.FlowPath) if not path.between]

    @once
    def gaps(self) -> list[tuple[str, base.FlowPath]]:
        """The gaps between chambers, with the effects that declare them."""
        return [(name, path) for name, path in self.all(base.FlowPath) if path.between]

    @once
    def oil_port(self) -> base.OilPort | None:
        """The port through which the oil enters; None where it is injected at one angle."""
        return self._only(base.OilPort, "an oil port")

    @once
    def pumped(self) -> bool:
        """Whether a pump feeds the oil port."""
        return self.oil_port is not None and self.oil is not None and "ratio" in self.oil.supply

    @once
    def oil_thinning(self) -> base.OilThinning | None:
        """What dissolved gas makes of the oil's viscosity; None where it is that of pure oil."""
        return self._only(base.OilThinning, "a viscosity of the oil")

    @once
    def oil_gas(self) -> base.OilGas | None:
        """The dissolved gas that the oil brings; None where it brings none."""
        found = self._only(base.OilGas, "dissolved gas")
        if found is not None and self.oil_port is None:
            raise TypeError("dissolved gas needs an oil port, out of whose oil it flashes")
        return found

    @property
    def dissolves(self) -> bool:
        """Whether the gas dissolved in oil is a state of the chambers."""
        return isinstance(self.oil_content, base.OilSolution)

    @once
    def held_back(self) -> bool:
        """Whether a check valve prevents backflow from the discharge line, directly or by leaving it nowhere to go."""
        valved = [part.to for part in self.pulsations if part.shut is not None]
        return base.DISCHARGE in valved or bool(valved and not self.plenums)

    @once
    def suction_line(self) -> bool:
        """Whether the suction line keeps backflow."""
        return bool(self.all(base.SuctionLine))

    @once
    def oil_room(self) -> bool:
        """Whether the oil takes room."""
        return bool(self.all(base.OilRoom))

    def volume_over_gas(self, rho: Any, ratio: Any) -> Any:
        """Return the volume of gas and oil over that of gas of ρ [kg/m³] with oil per gas; 1 without room (M106)."""
        return 1.0 + ratio * rho / self.oil.density if self.oil is not None and self.oil_room else 1.0

    @property
    def arriving_oil(self) -> float:
        """Oil per gas that comes in with the gas of the suction line (an expander, M490); 0 without."""
        return 0.0 if self.oil is None else self.oil.with_gas

    @once
    def films(self) -> list[bool]:
        """For each opening to a line or plenum, then each gap between chambers: whether oil passes beside the gas."""
        flows = [path.flow for _, path in (*self.ports, *self.gaps)]
        return [flow is not base.NOZZLE and flow.with_oil() for flow in flows]

    @once
    def walls(self) -> list[tuple[str, base.Wall]]:
        """The walls that exchange heat with the gas, with the effects that declare them."""
        return self.all(base.Wall)

    @once
    def shaft(self) -> base.Shaft | None:
        """What makes the speed vary over a pitch; None where it is constant."""
        return self._only(base.Shaft, "a shaft")

    @once
    def pulsations(self) -> list[base.Pulsation]:
        """The lines whose pressure pulsates."""
        return [part for _, part in self.all(base.Pulsation)]
