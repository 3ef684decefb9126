"""What lies in the suction and discharge lines: throttle, mixing, leak, heat, separator and oil cooler."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from screwsim.effects.parts.flows import Resistance
from screwsim.fluid.separator import Outflow, Separated
from screwsim.fluid.settings import oil_temperature


@dataclass(frozen=True)
class SuctionChange:
    """What lies between suction line and machine (M160, M161).

    A throttle leaves `pressure_ratio` of the pressure, or what the losses of a `package` leave; of what is sucked the
    share `returned` is delivered gas, mixed in before it.
    """

    pressure_ratio: float = 1.0
    returned: float = 0.0
    package: bool = False


@dataclass(frozen=True)
class SuctionLine:
    """What flows back into the suction line stays in it, mixes with what is sucked in and comes back (M270)."""


@dataclass(frozen=True)
class LineLeak:
    """A leak from the discharge line to the suction line beside the chambers, of an effective area [m²] (M274).

    Needs a `SuctionLine`, to which its gas and oil come. With a `resistance` the share of the nozzle's flow passes that
    this lets (M300); its share alone counts, `values` are further numbers that it asks for.
    """

    area: float
    resistance: Resistance | None = None
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SuctionHeat:
    """Heat [W] that the gas takes up on its way to the machine, by shaft power [W] and speed [rad/s] (M275).

    Needs a `SuctionLine`, into which the warmed gas comes.
    """

    power: Callable[[float, float], float]


@dataclass(frozen=True)
class Separator:
    """Where gas and oil of the discharge line meet and part, and what cools the oil that goes back (M280–M284).

    `balance` returns the temperatures and the cooler's duty that follow from what a cycle gives the separator, and,
    asked whether the supply's temperature is open, how far that is from where the circuit closes.
    """

    balance: Callable[[Outflow, bool], Separated]


@dataclass(frozen=True)
class InSeparator:
    """Parameters of an effect that asks for the separator's temperature: stated, or found by effects.separator."""

    separator_temperature: float | None = oil_temperature(
        "of oil and gas in the separator (absent: effects.separator finds it)"
    )


class PressureLosses(NamedTuple):
    """What a package loses [Pa] between its inlet and the machine, and between the machine and its outlet.

    The latter is negative where nothing passes to an outlet under pressure.
    """

    before: float = 0.0
    behind: float = 0.0


class LosesPressure:
    """Parameters of an effect by which the scene's lines are those of a package around the machine (M341, M342)."""

    @property
    def at_rated_flow(self) -> float:
        """Flow [m³/s] at the package's inlet with which the search for the losses begins."""
        raise NotImplementedError

    def losses(self, flow: float, inlet: float, outlet: float) -> PressureLosses:
        """Return what a flow [m³/s] at the inlet loses, inlet and outlet of the package at pressures [Pa]."""
        raise NotImplementedError

    @property
    def delivers(self) -> bool:
        """Whether what the machine moves comes to the package's outlet; else it is blown off."""
        return True

    def cooled(self, T: float, inlet: float) -> float | None:
        """Return to which temperature [K] the package cools gas of T [K], its inlet at another; None: by nothing."""
        return None


class CoolsOil:
    """Parameters of an effect that sends the oil back through a cooler, and may find the temperature of its supply.

    `outlet_key` is the key among them that keeps the oil's temperature behind the cooler.
    """

    outlet_key = ""

    @property
    def outlet(self) -> float | None:
        """Temperature [K] of the oil behind the cooler; None where it is not kept."""
        return None

    @property
    def discharge(self) -> float | None:
        """Temperature [K] of gas and oil at discharge; None where it is not kept."""
        return None
