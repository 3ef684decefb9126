"""The window of angles in which a chamber faces a hole in the housing, with C1 ramps at both ends.

Source: ours; docs/model.md M100.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import ceil, floor, pi
from typing import Any

from screwsim.effects.base import FlowPath
from screwsim.effects.parts.gap import ramp
from screwsim.inputs.declare import quantity
from screwsim.inputs.faults import Fault
from screwsim.numerics.kernel import kernel

DEGREE = pi / 180.0
HUNDREDTH = 0.01 * DEGREE  # to which messages round angles, inwards: what they print is allowed
RAMP = 10.0 * DEGREE
LOST_TOO_MUCH = 0.005  # of the shaft power: heat lost with gas pushed back through a port, above which is warned


@dataclass(frozen=True)
class WindowParameters:
    """The angles of a chamber between which it faces the hole."""

    opens: float = quantity("angle", "angle of the chamber at which it reaches the port", ge=0.0)
    closes: float = quantity("angle", "angle of the chamber at which it leaves the port", gt=0.0)


@kernel
def window_area(phi, size, opens, closes):
    """Return the open area [m²] of a hole of area `size` for a chamber at phi [rad] (M100)."""
    return size * ramp(phi, opens, opens + RAMP, closes - RAMP, closes)


def window_breakpoints(parameters) -> tuple[float, ...]:
    """Return the angles [rad] at which the window is not smooth."""
    return parameters.opens, parameters.opens + RAMP, parameters.closes - RAMP, parameters.closes


def window_path(name: str, parameters) -> FlowPath:
    """Return the flow path of an effect's window to its own plenum, which has the effect's name."""
    values = {"size": parameters.area, "opens": parameters.opens, "closes": parameters.closes}
    coefficient = parameters.flow_coefficient
    return FlowPath(name, window_area, values, window_breakpoints(parameters), flow_coefficient=coefficient)


def check_window(name: str, parameters) -> Iterator[Fault]:
    """Yield the faults of a window that do not depend on the machine."""
    if parameters.closes - parameters.opens < 2.0 * RAMP:
        yield Fault(f"effects.{name}.closes", "must lie at least 20 deg after opens (choose a later angle)")


@dataclass(frozen=True)
class CheckWithin:
    """Check of an effect's window against the geometry: an object, so that one from another process equals it."""

    name: str

    def __call__(self, parameters, geometry) -> Iterator[Fault]:
        """Yield a fault where a window extends beyond the chamber's life, or the chamber that rotors make of it."""
        if parameters.closes > geometry.life + 1e-9:
            what = f"lies beyond the chamber's life of {geometry.life / DEGREE:.5g} deg (choose an earlier angle)"
            yield Fault(f"effects.{self.name}.closes", what)
            return
        born, ends = _with_volume(geometry)
        if parameters.closes > ends + 1e-9:
            at = f"{floor(ends / HUNDREDTH) / 100.0:g} deg"
            what = f"lies beyond {at}, where the chamber's volume ends (choose an earlier angle)"
            yield Fault(f"effects.{self.name}.closes", what)
        if parameters.opens < born - 1e-9:
            at = f"{ceil(born / HUNDREDTH) / 100.0:g} deg"
            what = f"lies before {at}, where the chamber's volume begins (choose a later angle)"
            yield Fault(f"effects.{self.name}.opens", what)


def _with_volume(geometry) -> tuple[float, float]:
    """Return the angles [rad] between which a chamber has a volume; those of a profile are idle beside these."""
    laid = geometry.profile
    if laid is None:
        return 0.0, geometry.life
    return (geometry.life - laid.ends, geometry.life - laid.born) if geometry.expands else (laid.born, laid.ends)


def lost_by_backflow(found: Mapping[str, Any], figure: str, into: str, remedy: str = "") -> Iterator[str]:
    """Yield a warning where gas that chambers push back through a port loses much heat [W], a figure of that name."""
    loss, power = found.get(figure) or 0.0, abs(found.get("shaft_power") or 0.0)
    if loss > LOST_TOO_MUCH * power > 0.0:
        what = f"gas that chambers push back into {into} loses {loss:.3g} W there, {100.0 * loss / power:.2g} %"
        yield f"{what} of the shaft power (close the port earlier{remedy})"
