"""Oil that enters chambers, the room that it takes, the gas that it brings dissolved."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.effects.parts.plenums import Site
from screwsim.numerics.kernel import Kernel


class OilContent(NamedTuple):
    """What flashes [kg per kg of oil] over pressure [Pa], and the heat [J/kg] that it takes from the oil."""

    pressure: Any
    flashed: Any
    latent: float

    @property
    def begins(self) -> float:
        """The pressure [Pa] below which it flashes, and from which on none does, or no less."""
        none = [float(p) for p, share in zip(self.pressure, self.flashed, strict=True) if share <= 0.0]
        return none[0] if none else float(self.pressure[-1])


class OilSolution(NamedTuple):
    """Gas that oil holds dissolved and gives off over time (M230–M233); SI units, per kilogram of oil or of gas.

    `entropy` is that of a kilogram dissolved in oil that holds exp(`log_held`), `slope` its derivative by `log_held`,
    `rest` what all that the oil holds has beyond so much, per kilogram of it. Dissolved gas has one `enthalpy`; oil
    comes with `supply`. `release` and `uptake` [1/s] are the rates at which it approaches equilibrium.
    """

    log_held: Any
    entropy: Any
    slope: Any
    rest: Any
    enthalpy: float
    supply: float
    release: float
    uptake: float


@dataclass(frozen=True)
class OilGas:
    """Gas that oil from a port brings dissolved. Needs an oil port.

    `content(site)` returns what flashes of a kilogram of oil where it enters (M196): by the chamber's pressure, with
    what heat that takes from the oil; the gas has the state of the `plenum`, which the same effect declares. Or it
    returns a solution: what the oil holds is then a state of every chamber, and goes with the oil (M230).
    """

    plenum: str
    content: Callable[[Site], OilContent | OilSolution]


@dataclass(frozen=True)
class OilPort:
    """Oil that enters a chamber continuously, in place of the injection at one angle.

    `flow` returns oil [kg/s] into a chamber at angle `phi` [rad] and pressure `p` [Pa], 0 where it does not face the
    port; `width` [Pa] is that below which pressure differences may be smoothed. `pressure_loss` [Pa] lies between the
    oil's source and the bore, or `pressure` [Pa] is stated there; `closes` [rad] is where the injection ends. Needs
    oil.transport: carried. Where a pump feeds it, `pumped` returns the oil [kg/s] per gas [kg] that a chamber traps, by
    angle alone, for a ratio of one.
    """

    flow: Kernel
    values: Mapping[str, float]
    closes: float
    breakpoints: Sequence[float] = ()
    pressure_loss: float = 0.0
    pumped: Kernel | None = None
    pressure: float | None = None

    def loss(self, source: float) -> float:
        """Return what the oil loses [Pa] between its source at a pressure [Pa] and the bore."""
        return self.pressure_loss if self.pressure is None else source - self.pressure


@dataclass(frozen=True)
class OilRoom:
    """The oil takes room in the chambers (docs/model.md M106). Needs oil.transport: carried.

    `remedy` is what its effect can do where the oil locks a chamber.
    """

    remedy: str = ""
