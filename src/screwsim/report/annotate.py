"""Labels at the ends of curves and along them, without overlaps; positions are computed on the drawn canvas."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from screwsim.report.style import GREY, SMALL

_GAP = 1.18  # line spacing over the size of the font
_MOST, _ALONG = 9, 7  # most labels at the ends of curves, and along one
_LEADER = {"arrowstyle": "-", "color": GREY, "linewidth": 0.4, "shrinkA": 1.0, "shrinkB": 2.0}
_LOOSE = 8.0  # [pt] labels farther from their point than this have a leader
Point = tuple[float, float]
Direction = tuple[int, int]  # −1, 0 or 1 to the right and up
_AROUND: tuple[Direction, ...] = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))


def spread(wanted: np.ndarray, gap: float, low: float, high: float) -> np.ndarray:
    """Return positions at least `gap` apart in [low, high], in the order of `wanted` and close to it.

    Neighbours that are too close share their mean (pool adjacent violators); raise ValueError if they do not fit.
    """
    count = len(wanted)
    if (count - 1) * gap > high - low + 1e-9:
        raise ValueError("more labels than places")
    from scipy.optimize import isotonic_regression

    order = np.argsort(wanted, kind="stable")
    steps = gap * np.arange(count)
    flat = isotonic_regression(wanted[order] - steps).x
    places = np.empty(count)
    places[order] = np.clip(flat, low, high - steps[-1]) + steps
    return places


def label_ends(panels: Sequence[tuple[Any, Sequence[Point], Sequence[str]]], heading: str) -> None:
    """Label curves to the right of their axes at the height of their ends (data coordinates), with a heading above.

    `panels` are axes of one figure, with ends and texts: the figure is laid out once for all of them. If there are more
    labels than a reader can follow, or than fit, only every second, third … is drawn.
    """
    for axes, _, _ in panels:
        if heading:
            axes.annotate(heading, (1.045, 1.02), xycoords="axes fraction", va="bottom", fontsize=SMALL)
    for axes, _, _ in panels[:1]:
        axes.figure.get_layout_engine().execute(axes.figure)  # lays out the figure without drawing its lines
    for axes, ends, texts in panels:
        _label_ends(axes, ends, texts)


def _label_ends(axes: Any, ends: Sequence[Point], texts: Sequence[str]) -> None:
    """Label the curves of axes that have been laid out."""
    figure = axes.figure
    box = axes.get_window_extent()
    gap = _GAP * SMALL * figure.dpi / 72.0 / box.height
    low, high = 0.4 * gap, 1.0 - 0.4 * gap
    stride = 1 + max(int((len(ends) - 1) * gap / (high - low)), (len(ends) - 1) // _MOST)
    kept = range(0, len(ends), stride)
    heights = (axes.transData.transform([ends[i] for i in kept])[:, 1] - box.y0) / box.height
    leader = _LEADER | {"relpos": (0.0, 0.5)}  # from the text's left edge
    look = {"textcoords": "axes fraction", "va": "center", "fontsize": SMALL, "arrowprops": leader}
    for i, height in zip(kept, spread(heights, gap, low, high), strict=True):
        axes.annotate(texts[i], ends[i], (1.045, height), **look)


def label_along(axes: Any, x: np.ndarray, y: np.ndarray, texts: Sequence[str]) -> None:
    """Label some points of a curve, evenly along its drawn length, where the text overlaps nothing."""
    axes.figure.draw_without_rendering()
    points = axes.transData.transform(np.column_stack([x, y]))
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    wanted = np.linspace(0.0, length[-1], min(_ALONG, len(points)))
    chosen = sorted({int(np.argmin(np.abs(length - place))) for place in wanted})
    label_points(axes, [((x[i], y[i]), texts[i], _AROUND) for i in chosen], points)


def label_points(axes: Any, labels: Sequence[tuple[Point, str, Sequence[Direction]]], line: np.ndarray) -> None:
    """Label points: each (x, y) has a text and directions to try first; texts avoid the line [pixel] and each other."""
    path = _dense(line[np.isfinite(line).all(axis=1)])
    taken: list[Any] = []
    for xy, text, ways in labels:
        _label_one(axes, xy, text, path, taken, (*ways, *_AROUND))


def _dense(points: np.ndarray) -> np.ndarray:
    """Return points about every pixel along a polyline; long jumps get fewer."""
    pieces = [np.linspace(a, b, 2 + min(int(np.hypot(*(b - a))), 5000)) for a, b in pairwise(points)]
    return np.concatenate(pieces) if pieces else points


def _label_one(axes: Any, xy: Point, text: str, path: np.ndarray, taken: list[Any], ways: Sequence[Direction]) -> None:
    """Place one text beside its point in the first free direction."""
    from matplotlib.text import Text

    frame = axes.get_window_extent()
    for distance in (3.5, 7.0, 11.0, 16.0):
        look = {"textcoords": "offset points", "fontsize": SMALL, "arrowprops": _LEADER if distance > _LOOSE else None}
        for right, up in ways:
            sides = {"ha": ("right", "center", "left")[right + 1], "va": ("top", "center", "bottom")[up + 1]}
            label = axes.annotate(text, xy, (right * distance, up * distance), **look, **sides)
            label.get_window_extent()  # puts it in place
            box = Text.get_window_extent(label)  # without the leader
            if _free(box, frame, path, taken, axes.figure.dpi / 72.0):
                taken.append(box)
                return
            label.remove()


def _free(box: Any, frame: Any, path: np.ndarray, taken: Sequence[Any], point: float) -> bool:
    """Tell whether a box lies inside the frame and its ticks, clear of the path and of the other boxes."""
    edge = 4.0 * point
    inside = frame.x0 + edge < box.x0 and box.x1 < frame.x1 - edge
    inside = inside and frame.y0 + edge < box.y0 and box.y1 < frame.y1 - edge
    x, y = path[:, 0], path[:, 1]
    crossed = (box.x0 - point < x) & (x < box.x1 + point) & (box.y0 - point < y) & (y < box.y1 + point)
    return bool(inside and not crossed.any() and not any(box.overlaps(other) for other in taken))
