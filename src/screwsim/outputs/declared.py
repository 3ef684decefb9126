"""What is declared of each figure, curve and number of a result: its name, unit (SI, CF style) and meaning."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

DIFFERENCE = "kelvin"  # of a temperature difference, in CF's other spelling: nothing shows it in degrees Celsius


class Variable(NamedTuple):
    """Unit (SI, CF style) and meaning of one result."""

    units: str
    long_name: str


TIMES = {"": "", "ideal": "ideal_isothermal_efficiency", "filling": "volumetric_efficiency"}  # figures of factors


@dataclass(frozen=True)
class Scale:
    """What the relative error of a figure is relative to: its size, at the least `least` times the figures `of`.

    `alone`: that, whatever its size. It counts only where the figure `where` is there. `times` is a factor: 'ideal' the
    larger of 1 and the ideal isothermal efficiency; 'filling', of what passes through zero with the net gas flow,
    that by which the volumetric efficiency falls short of 0.1. `unasked`: it has none, as a residual.
    """

    least: float = 0.0
    of: tuple[str, ...] = ()
    alone: bool = False
    where: str = ""
    times: str = ""
    unasked: bool = False


ITSELF = Scale()


class Trace(NamedTuple):
    """A curve of a cycle over the angle: its name, unit (SI, CF style) and meaning."""

    name: str
    units: str
    long_name: str


def over(name: str, alone: bool = False) -> Scale:
    """Return the scale of a figure whose mean may vanish: at the least, or alone, the figure of a name."""
    return Scale(1.0, (name,), alone)


@dataclass(frozen=True)
class Figure:
    """A figure of a result: name, unit (SI, CF style), meaning, and what its estimated error is relative to.

    `needs` are keys of a scene of which one has to be there for the figure to be called for, '.key' of the effect that
    declares it, 'key: word' with that value; several joined by ' and '. `by_flow`: it errs as the net gas flow does,
    `by_oil`: as the flow of injected oil, `by_port`: as that through the port of its effect's plenum, `by_held`: as
    what the oil's dissolved gas is left open by, over what flashes. `curve`: no less than these
    amplitudes of its curve make of it.
    `shown` is the unit in which people write it (`engineering.SCALES`), where that is not the one of its SI unit.
    """

    name: str
    units: str
    long_name: str
    scale: Scale = ITSELF
    needs: tuple[str, ...] = ()
    by_flow: bool = False
    by_oil: bool = False
    by_port: bool = False
    by_held: bool = False
    curve: tuple[str, ...] = ()
    shown: str = ""


POWER = Scale(least=1.0, of=("shaft_power",), alone=True, times="ideal")
EFFICIENCY = Scale(least=0.1)
NET_FLOW = Scale(times="filling")  # of the net gas flow, and what is in proportion to it or over it
# of what enters beside the suction: what a step errs by is of all that flows
BESIDE = Scale(0.1, ("gas_mass_flow",))
BESIDE_RATIO = Scale(0.1, times="filling")
LEAST_OIL = 1e-4  # oil per gas below which its error is that of nothing


def power_figure(name: str, long_name: str, **more: Any) -> Figure:
    """Return the figure of a power [W]: its error counts over the shaft's power or the ideal one."""
    return Figure(name, "W", long_name, POWER, **more)


def efficiency(name: str, long_name: str, **more: Any) -> Figure:
    """Return the figure of an efficiency, shown in percent: its error counts over at least 0.1."""
    return Figure(name, "1", long_name, EFFICIENCY, **more)


def names_of(figures: Iterable[Figure]) -> tuple[str, ...]:
    """Return the names of figures."""
    return tuple(each.name for each in figures)
