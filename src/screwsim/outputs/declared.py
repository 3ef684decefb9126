"""Declarations of figures, curves and other numbers of a result: name, unit (SI, CF style) and meaning."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

DIFFERENCE = "kelvin"  # unit of a temperature difference; this spelling of K is never converted to degrees Celsius


class Variable(NamedTuple):
    """Unit (SI, CF style) and meaning of one result."""

    units: str
    long_name: str


TIMES = {"": "", "ideal": "ideal_isothermal_efficiency", "filling": "volumetric_efficiency"}  # figures behind factors


@dataclass(frozen=True)
class Scale:
    """Scale of a figure's relative error: its size, but not less than `least` times the product of the figures `of`.

    `alone`: the scale is that product, whatever the size. The product counts only where the figure `where` is not zero.
    `times` is a factor: 'ideal' is the larger of 1 and the ideal isothermal efficiency; 'filling', for figures that
    pass through zero with the net gas flow, is 0.1 over the volumetric efficiency where that is below 0.1. `unasked`:
    the figure has no error, as a residual.
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
    """Return the scale of a figure whose mean may vanish: at least, or with `alone` exactly, the named figure."""
    return Scale(1.0, (name,), alone)


@dataclass(frozen=True)
class Figure:
    """A figure of a result: name, unit (SI, CF style), meaning, and the scale of its estimated error.

    `needs` are keys of a scene; the figure is called for where one of them is present. '.key' is a parameter of the
    effect that declares the figure, 'key: word' requires that value, and ' and ' joins several. The figure's error
    follows that of the net gas flow (`by_flow`), of the injected oil (`by_oil`), of the flow through the port of its
    effect's plenum (`by_port`), or of the gas that the oil holds dissolved (`by_held`), whose closing error counts over
    the gas that flashes. `curve` names the swings of its curve, with whose square it goes: its error is at least
    twice theirs. `swing_of` names the trace to whose swing it is proportional: its error is at least that of
    reading the trace at two angles. `square_of` names two traces, with the mean square of whose difference it goes.
    `shown` is the unit in which people write it (`customary.SCALES`), if not the usual one of its SI unit.
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
    swing_of: str = ""
    square_of: tuple[str, ...] = ()
    shown: str = ""


POWER = Scale(least=1.0, of=("shaft_power",), alone=True, times="ideal")
EFFICIENCY = Scale(least=0.1)
NET_FLOW = Scale(times="filling")  # of the net gas flow, and of figures proportional to it or divided by it
# of flows beside the suction: the error of a step scales with the whole flow
BESIDE = Scale(0.1, ("gas_mass_flow",))
BESIDE_RATIO = Scale(0.1, times="filling")
LEAST_OIL = 1e-4  # oil per gas below which errors are relative to this ratio instead


def power_figure(name: str, long_name: str, **more: Any) -> Figure:
    """Return the figure of a power [W], whose error is relative to the shaft power or the ideal power."""
    return Figure(name, "W", long_name, POWER, **more)


def efficiency(name: str, long_name: str, **more: Any) -> Figure:
    """Return the figure of an efficiency, shown in percent, whose error is relative to at least 0.1."""
    return Figure(name, "1", long_name, EFFICIENCY, **more)


def names_of(figures: Iterable[Figure]) -> tuple[str, ...]:
    """Return the names of figures."""
    return tuple(figure.name for figure in figures)
