"""What lies in the suction and discharge lines: throttle, mixing, leak, heat, separator and oil cooler."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from screwsim.effects.parts.flow_kinds import Resistance
from screwsim.fluid.separator import Separated, SeparatorInflow
from screwsim.fluid.settings import oil_temperature

# why a package that does not deliver lacks figures
BLOWN_OFF = "the package is unloaded: the gas that its machine moves is blown off, and nothing is delivered"


@dataclass(frozen=True)
class SuctionChange:
    """A change of state between suction line and machine (M160, M161).

    A throttle leaves `pressure_ratio` of the pressure; with `package` the pressure losses of a package apply. The share
    `returned` of the gas that the machine sucks is delivered gas, mixed in before the throttle.
    """

    pressure_ratio: float = 1.0
    returned: float = 0.0
    package: bool = False


@dataclass(frozen=True)
class SuctionLine:
    """What flows back into the suction line stays in it, mixes with the suction gas and is sucked in again (M270)."""


@dataclass(frozen=True)
class LineLeak:
    """A leak from the discharge line to the suction line beside the chambers, of an effective area [m²] (M274).

    Needs a `SuctionLine`, which takes up its gas and oil. A `resistance` lets only its share of the nozzle flow pass
    (M300; its film and drag are not used); `values` are further numbers that the share takes.
    """

    area: float
    resistance: Resistance | None = None
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SuctionHeat:
    """Heat [W] into the gas on its way to the machine, as a function of shaft power [W] and speed [rad/s] (M275).

    Needs a `SuctionLine`, into which the warmed gas flows.
    """

    power: Callable[[float, float], float]


@dataclass(frozen=True)
class Separator:
    """Where gas and oil of the discharge line meet and part, and the cooler of the returning oil (M280–M284).

    `balance(outflow, open)` returns temperatures and cooler duty for what a cycle delivers to the separator; where the
    supply temperature is open, also how far that is from closing the oil circuit.
    """

    balance: Callable[[SeparatorInflow, bool], Separated]


@dataclass(frozen=True)
class InSeparator:
    """Parameters of an effect that needs the separator's temperature: as stated, or found by effects.separator."""

    separator_temperature: float | None = oil_temperature(
        "temperature of oil and gas in the separator (absent: effects.separator finds it)"
    )


class PressureLosses(NamedTuple):
    """Pressure losses of a package [Pa]: from its inlet to the machine, and from the machine to its outlet.

    The latter may be negative where nothing passes to an outlet under pressure.
    """

    before: float = 0.0
    behind: float = 0.0


class LosesPressure:
    """Parameters of an effect that makes the scene's lines those of a package around the machine (M341, M342)."""

    @property
    def at_rated_flow(self) -> float:
        """Flow [m³/s] at the package's inlet with which the search for the losses begins."""
        raise NotImplementedError

    def losses(self, flow: float, inlet: float, outlet: float) -> PressureLosses:
        """Return the pressure losses at a flow [m³/s] at the inlet, given the pressures [Pa] of inlet and outlet."""
        raise NotImplementedError

    @property
    def delivers(self) -> bool:
        """Whether the gas that the machine moves reaches the package's outlet; else it is blown off."""
        return True

    def cooled(self, T: float, inlet: float) -> float | None:
        """Return the temperature [K] to which the package cools gas of T [K], given its inlet's; None: uncooled."""
        return None


class CoolsOil:
    """Parameters of an effect that returns the oil through a cooler, and may find the temperature of its supply.

    `outlet_key` names the parameter that prescribes the oil's temperature behind the cooler, `size_key` that of the
    cooler's size.
    """

    outlet_key = size_key = ""

    @property
    def bounded(self) -> bool:
        """Whether the cooler has a size, so that what it is to keep is not kept at any price."""
        return False

    @property
    def cooled_by_inlet(self) -> bool:
        """Whether the coolant is the air at the machine's inlet."""
        return False

    @property
    def outlet(self) -> float | None:
        """Temperature [K] of the oil behind the cooler; None where it is not prescribed."""
        return None

    @property
    def discharge(self) -> float | None:
        """Temperature [K] of gas and oil at discharge; None where it is not prescribed."""
        return None
