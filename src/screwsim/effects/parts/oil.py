"""Oil that enters chambers, the volume that it takes up, and the gas that it brings dissolved."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.effects.parts.readings import Around, Site
from screwsim.numerics.kernel import Kernel


class OilContent(NamedTuple):
    """Gas that flashes [kg per kg of oil] over pressure [Pa], and the heat [J/kg] that it takes from the oil."""

    pressure: Any
    flashed: Any
    latent: float

    @property
    def begins(self) -> float:
        """The pressure [Pa] below which it flashes, and from which on none does, or no less."""
        none = [float(p) for p, share in zip(self.pressure, self.flashed, strict=True) if share <= 0.0]
        return none[0] if none else float(self.pressure[-1])


class OilSolution(NamedTuple):
    """Gas dissolved in oil that is released over time (M230–M233); SI units, per kilogram of oil or of gas.

    `entropy` is that of a kilogram of gas dissolved in oil that holds exp(`log_held`), `slope` its derivative by
    `log_held`; `rest` is the remaining entropy of all gas that the oil holds, per kilogram of that gas. Dissolved gas
    has one `enthalpy`; oil is injected with the content `supply`. `release` and `uptake` [1/s] are the rates at which
    the content approaches equilibrium.
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

    `content(site)` returns the gas that flashes from a kilogram of oil as it enters (M196), over the chamber's
    pressure, with the heat that this takes from the oil; that gas has the state of the `plenum`, which the same effect
    declares. Or it returns an `OilSolution`: the content is then a state of every chamber and travels with the oil
    (M230).
    """

    plenum: str
    content: Callable[[Site], OilContent | OilSolution]


@dataclass(frozen=True)
class OilThinning:
    """Gas dissolved in the oil makes it thinner (M199): `films(around, T, mu)` and `supply(around, T, mu)`.

    They return the viscosity [Pa s] of oil at T [K] in films, and as it is supplied, from `mu` [Pa s] of pure oil.
    """

    films: Callable[[Around, float, float], float]
    supply: Callable[[Around, float, float], float]


@dataclass(frozen=True)
class OilPort:
    """Oil that enters a chamber continuously, in place of the injection at one angle. Needs oil.transport: carried.

    `flow` returns the oil flow [kg/s] into a chamber at angle `phi` [rad] and pressure `p` [Pa], 0 where it does not
    face the port; below `width` [Pa] pressure differences may be smoothed. `pressure_loss` [Pa] lies between the oil's
    source and the bore, or `pressure` [Pa] is stated there; the injection ends at `closes` [rad]. Where a pump feeds
    the port, `pumped` returns the oil flow [kg/s] per kilogram of gas that a chamber traps, by angle alone, for an oil
    ratio of one.
    """

    flow: Kernel
    values: Mapping[str, float]
    closes: float
    breakpoints: Sequence[float] = ()
    pressure_loss: float = 0.0
    pumped: Kernel | None = None
    pressure: float | None = None

    def loss(self, source: float) -> float:
        """Return the pressure loss [Pa] between the oil's source, at `source` [Pa], and the bore."""
        return self.pressure_loss if self.pressure is None else source - self.pressure


@dataclass(frozen=True)
class OilRoom:
    """The oil takes up space in the chambers (docs/model.md M106). Needs oil.transport: carried.

    `remedy` says what to do about its effect where the oil locks a chamber.
    """

    remedy: str = ""


def oil_in_chambers(effects: Mapping[str, Any]) -> bool:
    """Return whether oil is in the chambers: whether its temperature is a state of one of a scene's effects."""
    return any("T_oil" in active.effect.states for active in effects.values())
