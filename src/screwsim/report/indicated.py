"""Measured pressures of a chamber over angle or volume, to be drawn beside those of a computed cycle."""

from typing import Any

import numpy as np

from screwsim.figures.indicated import Indicated, IndicatedVolumes
from screwsim.inputs.faults import UsageError
from screwsim.report.quantities import PRESSURE, VOLUME
from screwsim.report.style import COLOURS
from screwsim.report.trace import Trace

VOLUME_SLACK = 0.02  # of the largest or smallest volume, by which a point may lie beyond it
FEWEST = 6  # points, from which shifts of angle and pressure are found
WORTH = 0.5  # part of the root mean square deviation that shifts must leave at most, to be worth a word
MANY = 120  # points, from which they are drawn as dots
ANGLE_SLACK = 5.0  # [degree] by which a point may exceed the ends of the cycle


def at_angles(points: Indicated | IndicatedVolumes, trace: Trace) -> Indicated:
    """Return the points at angles of the cycle, those over the volume at the angles at which it has theirs.

    Where the volume grows from row to row the chamber fills, where it falls the chamber is compressed or discharges.
    Raise UsageError for volumes that it does not have.
    """
    if isinstance(points, Indicated):
        check_angles(points, trace)
        return points
    volume = trace.values["volume"]
    if len(points.volume) < 2 or not np.ptp(points.volume) > 0.0:
        raise UsageError("the measured volumes are all the same (write the rows in the order of the cycle)")
    check_volumes(points, trace)
    grows, top = np.gradient(points.volume) > 0.0, int(np.argmax(volume))
    filling = np.interp(points.volume, volume[: top + 1], trace.angle[: top + 1])
    closing = np.interp(points.volume, volume[top:][::-1], trace.angle[top:][::-1])
    return Indicated(np.where(grows, filling, closing), points.pressure)


def check_volumes(points: IndicatedVolumes, trace: Trace) -> None:
    """Raise UsageError for volumes that the chamber does not have."""
    least, largest = (float(end(trace.values["volume"])) for end in (np.min, np.max))
    grooves = ", male and female groove together" if np.isfinite(trace.male_lobes) else ""
    ends = (
        (points.volume < (1.0 - VOLUME_SLACK) * least, "below its least", least, "add its dead volume"),
        (points.volume > (1.0 + VOLUME_SLACK) * largest, "above its largest", largest, f"give those of one{grooves}"),
    )
    for out, where, end, remedy in ends:
        if out.any():
            first, bound = (f"{of * VOLUME.factor:.4g} cm3" for of in (points.volume[out][0], end))
            what = f"{out.sum()} of the measured volumes, as {first}, are not of the chamber: {where}, {bound}"
            raise UsageError(f"{what} ({remedy})")


def check_angles(points: Indicated, trace: Trace) -> None:
    """Raise UsageError for points outside the life of the chamber."""
    first, last = float(trace.angle[0]), float(trace.angle[-1])
    out = points.angle[(points.angle < first - ANGLE_SLACK) | (points.angle > last + ANGLE_SLACK)]
    if len(out):
        ends = f"{first:g} to {last:g} deg"
        what = f"{len(out)} of the measured angles, as {out[0]:g} deg, lie outside the cycle's {ends}"
        raise UsageError(f"{what} (count angles from where the chamber starts to grow; docs/how-to/indicator.md)")


def deviation_in_words(points: Indicated, trace: Trace) -> str:
    """Return in words the deviation of computed from measured pressures: mean, root mean square, largest [bar]."""
    off = (np.interp(points.angle, trace.angle, trace.values["pressure"]) - points.pressure) * PRESSURE.factor
    worst = int(np.argmax(np.abs(off)))
    return (
        f"computed minus measured at {len(off)} points: mean {off.mean():+.3g} bar, root mean square "
        f"{np.sqrt(np.mean(off**2)):.3g} bar, largest {off[worst]:+.3g} bar at {points.angle[worst]:g} deg"
    )


def shift_in_words(points: Indicated, trace: Trace) -> str:
    """Return in words how far zeros of angle and pressure explain the deviation; empty where they hardly do.

    Angle and pressure are shifted so that the computed pressures fit the points best, outliers counting less.
    """
    if len(points.angle) < FEWEST:
        return ""
    from scipy.optimize import least_squares

    pressure, scale = trace.values["pressure"], float(np.ptp(points.pressure)) or 1.0

    def off(shift: np.ndarray) -> np.ndarray:
        moved = np.interp(points.angle + shift[0], trace.angle, pressure)
        return (moved - points.pressure - shift[1] * scale) / scale

    found = least_squares(off, [0.0, 0.0], x_scale=(1.0, 0.01), diff_step=(0.1, 1e-4), loss="soft_l1", f_scale=0.02)
    before, after = (float(np.sqrt(np.mean(off(x) ** 2))) * scale * PRESSURE.factor for x in (np.zeros(2), found.x))
    if not found.success or after >= WORTH * before:
        return ""
    return (
        f"points moved by {found.x[0]:+.2g} deg and {found.x[1] * scale * PRESSURE.factor:+.2g} bar would lie within "
        f"{after:.2g} bar of the computed ones (root mean square): zeros of angle and transducer may explain it"
    )


def draw_over_angle(axes: Any, points: Indicated) -> None:
    """Draw measured points over the angle."""
    _draw(axes, points.angle, points.pressure, "upper left")


def draw_over_volume(axes: Any, points: Indicated, trace: Trace) -> None:
    """Draw measured points over the chamber's volume at their angles."""
    volume = np.interp(points.angle, trace.angle, trace.values["volume"])
    _draw(axes, volume * VOLUME.factor, points.pressure, "upper right")


def look_of_measured(count: int) -> dict[str, Any]:
    """Return how so many measured points are drawn: as crosses, many as dots."""
    look = {"marker": "x", "markersize": 3.5} if count < MANY else {"marker": ".", "markersize": 1.5}
    return {"linestyle": "", "color": COLOURS[3], "label": "measured", **look}


def _draw(axes: Any, x: np.ndarray, pressure: np.ndarray, corner: str) -> None:
    y = pressure * PRESSURE.factor
    axes.plot(x, y, markeredgewidth=0.8, zorder=4, **look_of_measured(len(y)))
    axes.set_ylim(top=max(axes.get_ylim()[1], 1.06 * float(y.max())))
    axes.legend(loc=corner)
