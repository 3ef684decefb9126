"""The angles of one life at which steps must end because laws are not smooth there.

The package's own effects declare them. The laws of a user's effects are also sampled, whatever they declare, as they
are not known; that takes some milliseconds.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from screwsim.effects.base import FlowPath
from screwsim.model.numbers import symbols_of
from screwsim.model.parts import Parts
from screwsim.numerics.spline import LEAST, features, negligible_areas, pack_curve

Array = np.ndarray
EVERY = math.radians(0.2)  # spacing of samples: a narrower feature may be missed
PLACED = 1e-6  # rad, to which it is found where a path opens or shuts between two samples
TOGETHER = 1e-7  # rad, within which angles count as one, the injection angle before others
MET = 1e-9  # rad, within which a step ends at the injection angle (`model.network.steps`)
STATED = math.radians(0.5)  # distance from a declared breakpoint within which no other is needed


def breakpoints(parts: Parts, law: Any) -> np.ndarray:
    """Return the angles of one life at which its own or neighbours' laws are not smooth, sorted, including the ends."""
    geometry, named, port = parts.geometry, parts.all(FlowPath), parts.oil_port
    paths = [path for _, path in named]
    pitch, life = geometry.pitch, geometry.life
    own = {geometry.injection_angle, *law.breakpoints, *(() if port is None else port.breakpoints)}
    own.update(at for path in paths for at in path.breakpoints)
    shifts = {0}.union(*({path.offset, -path.offset} for path in paths))
    found = [at + shift * pitch for at in own for shift in shifts]
    found += law.own_breakpoints
    symbols = symbols_of(parts)
    for name, path in named:
        path_own = *path.own_breakpoints, *_unstated(name, path, symbols, life)
        found += [at + shift * pitch for at in path_own for shift in {0, path.offset}]
    # where a neighbour's life begins or ends
    found += [shift * pitch + edge for shift in shifts for edge in (0.0, life)]
    inside = sorted({0.0, life, *(at for at in found if 0.0 < at < life)})
    kept = [inside[0]]
    for at in inside[1:]:
        if at - kept[-1] > TOGETHER:
            kept.append(at)
        elif at == geometry.injection_angle and at - kept[-1] > MET:
            kept[-1] = at
    kept[-1] = life
    return np.array(kept)


def _unstated(name: str, path: FlowPath, symbols: Mapping[str, float], life: float) -> tuple[float, ...]:
    """Return the angles [rad] of features that a path does not declare; none for an effect of the package."""
    if "." not in name:
        return ()
    angles = np.append(np.arange(0.0, life, EVERY), life)
    areas = _areas(path, symbols, angles)
    if areas is None or not np.all(np.isfinite(areas)) or areas.max() <= 0.0:
        return ()
    stated = np.array([*path.breakpoints, *path.own_breakpoints, 0.0, life])
    found = [x for x in features(angles, areas) if np.min(np.abs(stated - x)) > STATED]
    return tuple(_placed(path, symbols, found, angles, areas))


def _placed(
    path: FlowPath, symbols: Mapping[str, float], found: list[float], angles: Array, areas: Array
) -> Iterator[float]:
    """Yield features; where a path opens or shuts, that angle: from the sample beside, a step misreads what flows.

    Tops and bottoms stay at their samples: a smooth law has no corner there.
    """
    shut = negligible_areas(areas)
    least = LEAST * float(areas.max())
    for x in found:
        i, at_edge = int(np.searchsorted(angles, x)), False
        for j in (i - 1, i + 1) if shut[i] else ():  # both, where it is shut at this sample alone
            if 0 <= j < len(angles) and not shut[j]:
                closed, is_open = float(angles[i]), float(angles[j])
                while abs(is_open - closed) > PLACED:
                    middle = 0.5 * (closed + is_open)
                    area = _areas(path, symbols, np.array([middle]))
                    closed, is_open = (middle, is_open) if area is None or area[0] <= least else (closed, middle)
                at_edge = True
                yield closed
        if not at_edge:
            yield x


def _areas(path: FlowPath, symbols: Mapping[str, float], angles: Array) -> Array | None:
    """Return the areas [m²] of a path at angles of the chamber; None where they depend on more than the angle."""
    TAB, known = np.zeros(1), {**symbols, **path.values}
    for name, curve in path.tables.items():
        known[name] = float(len(TAB))
        TAB = np.concatenate([TAB, pack_curve(*curve)])
    if not set(path.area.arguments) <= {*known, "phi", "TAB"}:
        return None
    at = angles if path.mirror is None else path.mirror - angles
    asked = [known | {"phi": phi, "TAB": TAB} for phi in at.tolist()]
    return np.array([_area(path, [named[name] for name in path.area.arguments]) for named in asked], float)


def _area(path: FlowPath, arguments: Sequence[float | Array]) -> float:
    """Return an area [m²]; NaN where Python raises an error and compiled code would continue."""
    try:
        found = path.area(*arguments)
    except (ArithmeticError, ValueError):
        return math.nan
    if not isinstance(found, Real):
        raise TypeError(f"kernel {path.area.__name__} returned {found!r}, which is no area")
    return float(found)
