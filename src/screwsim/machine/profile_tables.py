"""Curves of rotors as tables for the solution of the cycle: smooth between the breakpoints, where steps end.

V is the cubic spline with the rotors' V and dV/dφ at its rows; the slopes of an area are differences of its rows, taken
separately on each side of a kink. So every curve is smooth between two breakpoints, and dV/dφ is the derivative of V. A
step ends at each breakpoint where a curve bends enough to matter (docs/reference/rotors.md). Units SI, angles in rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from screwsim.machine.rotors.curves import Curve, Curves
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import Rotors
from screwsim.numerics.spline import LEAST, differences, side_slopes

DEG = math.radians(1.0)
EVERY = 2  # the tables keep every second row of the curves, which are 0.5° apart
BEYOND = 1.0 * DEG  # length of a last interval of zeros, so that a cubic's rounding does not leave an opening
BEND = 0.02  # jump of d²V/dφ² over V_max [1/rad²] below which no step ends there
KINK = 0.2  # the same for a jump of an area's slope over its largest value [1/rad]
STEEP = 8.0  # change of an area's slope between rows over its largest value [1/rad] that marks the ends of a jump


@dataclass(frozen=True, eq=False)
class Table:
    """A curve over the scene's angle [rad], its slopes at both ends of each interval, and where steps end."""

    angle: Array
    value: Array
    slope: Array
    breakpoints: tuple[float, ...]

    @property
    def ends(self) -> tuple[float, float]:
        """Where the curve begins and ends [rad]."""
        return self.breakpoints[0], self.breakpoints[-1]

    @property
    def curve(self) -> tuple[Array, Array, Array]:
        """The table as `numerics.spline.pack_curve` takes it."""
        return self.angle, self.value, self.slope

    def times(self, factor: float) -> Table:
        """Return the table multiplied."""
        return replace(self, value=factor * self.value, slope=factor * self.slope)

    def landing(self, angles: Iterable[float]) -> Table:
        """Return the table with further angles [rad] at which steps end, as far as they lie between its ends."""
        first, last = self.ends
        return replace(self, breakpoints=tuple(sorted({*self.breakpoints, *(x for x in angles if first < x < last)})))


def volume_table(curves: Curves, rotors: Rotors, born: float) -> Table:
    """Return V over the scene's angle: cubics with the rotors' V and dV/dφ at every row."""
    rows, value = curves.volume.angle[::EVERY], curves.volume.value[::EVERY].copy()
    slope = rotors.volume_slope(rows + rotors.start)
    value[[0, -1]] = slope[[0, -1]] = 0.0
    own = curves.volume.breakpoints
    seen = _bent(rows, differences(rows, slope, own), own, BEND * value.max())
    breakpoints = born, *(at + born for at in seen), born + curves.life
    return Table(rows + born, value, np.column_stack([slope[:-1], slope[1:]]), breakpoints)


def area_table(curve: Curve, born: float) -> Table:
    """Return an area (or length) over the scene's angle, exactly zero before its first row and after its last."""
    rows, value = curve.angle[::EVERY], curve.value[::EVERY]
    some = np.flatnonzero(value > LEAST * value.max())
    part = slice(max(int(some[0]) - 1, 0), min(int(some[-1]) + 2, len(value)))
    rows, value = rows[part], value[part].copy()
    value[[0, -1]] = 0.0
    end = float(rows[-1])
    inside = [at for at in curve.breakpoints if rows[0] < at < end - 1e-9]
    angle, value = np.append(rows, end + BEYOND), np.append(value, 0.0)
    slope, largest = side_slopes(angle, value, [*inside, end]), float(value.max())
    secant = np.diff(value) / np.diff(angle)
    jumps = rows[1:-1][np.abs(np.diff(secant[:-1])) > STEEP * largest]
    seen = sorted({*_bent(angle, slope, inside, KINK * largest), *(float(x) for x in jumps)})
    return Table(angle + born, value, slope, (float(rows[0]) + born, *(x + born for x in seen), end + born))


def _bent(x: Array, slope: Array, breakpoints: Sequence[float], least: float) -> list[float]:
    """Return the breakpoints between the ends at which the slope of a curve jumps by more than `least`."""
    rows = [int(i) for i in np.searchsorted(x, np.sort(breakpoints) - 1e-9) if 0 < i < len(x) - 1]
    return [float(x[i]) for i in rows if abs(slope[i, 0] - slope[i - 1, 1]) > least]
