"""Labels at curves: beside their ends and along them, without overlaps. Places are computed on the drawn canvas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from screwsim.report.style import GREY, SMALL

_GAP = 1.18  # distance of two lines of text over the size of the font
_AROUND = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))


def spread(wanted: np.ndarray, gap: float, low: float, high: float) -> np.ndarray:
    """Return places at least `gap` apart in [low, high], in the order of `wanted` and close to it.

    Neighbours that are too near share their mean (pool adjacent violators); raise ValueError when they do not fit.
    """
    count = len(wanted)
    if (count - 1) * gap > high - low + 1e-9:
        raise ValueError("more labels than places")
    order = np.argsort(wanted, kind="stable")
    steps = gap * np.arange(count)
    blocks: list[tuple[float, int]] = []  # (mean, size) of wanted − steps, which must not fall
    for value in wanted[order] - steps:
        mean, size = float(value), 1
        while blocks and blocks[-1][0] > mean:
            other, more = blocks.pop()
            mean, size = (mean * size + other * more) / (size + more), size + more
        blocks.append((mean, size))
    flat = np.concatenate([np.full(size, mean) for mean, size in blocks])
    places = np.empty(count)
    places[order] = np.clip(flat, low, high - steps[-1]) + steps
    return places


def label_ends(axes: Any, ends: Sequence[tuple[float, float]], texts: Sequence[str], heading: str) -> None:
    """Label curves right of the axes at the height of their ends (data coordinates), the heading above.

    When there are more labels than lines of text, every second, third … is left out.
    """
    figure = axes.figure
    axes.annotate(heading, (1.045, 1.0), xycoords="axes fraction", va="top", fontsize=SMALL)
    figure.draw_without_rendering()
    box = axes.get_window_extent()
    gap = _GAP * SMALL * figure.dpi / 72.0 / box.height
    low, high = 0.5 * gap, 1.0 - 1.8 * gap
    stride = 1 + int((len(ends) - 1) * gap / (high - low))
    kept = range(0, len(ends), stride)
    heights = (axes.transData.transform([ends[i] for i in kept])[:, 1] - box.y0) / box.height
    for i, height in zip(kept, spread(heights, gap, low, high), strict=True):
        axes.annotate(
            texts[i],
            xy=ends[i],
            xytext=(1.045, height),
            textcoords="axes fraction",
            va="center",
            fontsize=SMALL,
            arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.4, "shrinkA": 1.0, "shrinkB": 1.5},
        )


def label_along(axes: Any, x: np.ndarray, y: np.ndarray, texts: Sequence[str], most: int = 7) -> None:
    """Label some points of a curve, evenly along its drawn length, where the text crosses nothing."""
    axes.figure.draw_without_rendering()
    points = axes.transData.transform(np.column_stack([x, y]))
    path = _dense(points)
    taken: list[Any] = []
    for i in _evenly(points, most):
        _label_one(axes, (x[i], y[i]), texts[i], path, taken)


def _evenly(points: np.ndarray, most: int) -> list[int]:
    """Return indices of points about evenly spaced along the polyline, both ends among them."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    wanted = np.linspace(0.0, length[-1], min(most, len(points)))
    return sorted({int(np.argmin(np.abs(length - place))) for place in wanted})


def _dense(points: np.ndarray) -> np.ndarray:
    """Return points every pixel or so along a polyline."""
    pieces = [np.linspace(a, b, 2 + int(np.hypot(*(b - a)))) for a, b in zip(points[:-1], points[1:], strict=True)]
    return np.concatenate(pieces) if pieces else points


def _label_one(axes: Any, xy: tuple[float, float], text: str, path: np.ndarray, taken: list[Any]) -> None:
    """Put one text beside its point in the first direction that is free; leave it out when there is none."""
    frame = axes.get_window_extent()
    for distance in (3.0, 6.0, 10.0):
        for right, up in _AROUND:
            label = axes.annotate(
                text,
                xy,
                xytext=(right * distance, up * distance),
                textcoords="offset points",
                ha=("right", "center", "left")[right + 1],
                va=("top", "center", "bottom")[up + 1],
                fontsize=SMALL,
            )
            box = label.get_window_extent()
            if _free(box, frame, path, taken):
                taken.append(box)
                return
            label.remove()


def _free(box: Any, frame: Any, path: np.ndarray, taken: Sequence[Any]) -> bool:
    """Return whether a box lies inside the frame, off the path and off the other boxes."""
    inside = frame.x0 < box.x0 - 2 and box.x1 + 2 < frame.x1 and frame.y0 < box.y0 - 2 and box.y1 + 2 < frame.y1
    x, y = path[:, 0], path[:, 1]
    crossed = (box.x0 - 2 < x) & (x < box.x1 + 2) & (box.y0 - 2 < y) & (y < box.y1 + 2)
    return bool(inside and not crossed.any() and not any(box.overlaps(other) for other in taken))
