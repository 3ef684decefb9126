"""Figures of a calibration: residuals at each point; and of its posterior: each parameter and each pair of them."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from screwsim.report import style
from screwsim.report.indicated import look_of_measured
from screwsim.report.quantities import Display
from screwsim.report.style import COLOURS, DOUBLE, GREY, SINGLE, note, plain_ticks

BINS, FINE = 40, 28  # bins of a parameter, of each of a pair
CONTOUR_SHARES = (0.5, 0.9)  # of the samples, enclosed by the contours of a pair
LEAST_PANEL = 34.0  # [mm] of a panel, at least
HEIGHT = 62.0  # [mm] of a panel
PREDICTED = " *"  # behind the name of a point that is not fitted
MOST_NAMES = 16  # most points whose names fit below an axis
ResidualPoint = tuple[int, bool, float, float]  # number of the point, fitted, residual, uncertainty


def residuals_figure(panels: Mapping[str, Sequence[ResidualPoint]], names: Sequence[str]) -> Any:
    """Draw the residuals over the points, one panel per figure."""
    columns = min(2, len(panels))
    figure, places = style.panels(len(panels), 0.0, HEIGHT, columns, DOUBLE if columns == 2 else 1.4 * SINGLE)
    for axes, (label, left) in zip(places, panels.items(), strict=True):
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        for wanted, face in ((True, COLOURS[1]), (False, "white")):
            chosen = [each for each in left if each[1] is wanted]
            if chosen:
                number, _, residual, width = zip(*chosen, strict=True)
                look = {"color": COLOURS[1], "markerfacecolor": face, "capsize": 1.5, "elinewidth": 0.6}
                axes.errorbar([each + 1 for each in number], residual, yerr=width, fmt="o", **look)
        axes.set(ylabel=label, xlim=(0.5, len(names) + 0.5))
        plain_ticks(axes.yaxis)
        if len(names) <= MOST_NAMES:
            axes.set_xticks(range(1, len(names) + 1), names, rotation=45, ha="right")
        else:
            axes.set_xlabel("point")
            plain_ticks(axes.xaxis)
    some = any(not fitted for left in panels.values() for _, fitted, _, _ in left)
    told = "filled: in the fit; open: predicted" if some else ""
    note(figure, "fitted minus measured, with the standard uncertainty of the measurement", told)
    return figure


class FittedCurve(NamedTuple):
    """Values [SI] of a point's curve over the angle [degree]: measured, their standard uncertainties, and fitted."""

    name: str
    angle: np.ndarray
    measured: np.ndarray
    uncertainty: np.ndarray
    fitted: np.ndarray


def curves_figure(shown: Display, points: Sequence[FittedCurve], left_out: int = 0) -> Any:
    """Draw the values of a curve at each point over the angle, fitted and measured; `left_out` have no panel."""
    columns = min(2, len(points))
    figure, places = style.panels(len(points), 0.0, HEIGHT, columns, DOUBLE if columns == 2 else 1.4 * SINGLE)
    for axes, each in zip(places, points, strict=True):
        axes.plot(each.angle, shown.of(each.fitted), color="black", label="fitted")
        axes.errorbar(
            each.angle,
            shown.of(each.measured),
            yerr=shown.factor * each.uncertainty,
            elinewidth=0.6,
            **look_of_measured(len(each.angle)),
        )
        axes.set(ylabel=shown.label, xlabel="angle (°)", title=each.name)
        plain_ticks(axes.xaxis, axes.yaxis)
    places[0].legend(loc="upper left")
    predicted = "*: not fitted, only predicted" if any(each.name.endswith(PREDICTED) for each in points) else ""
    note(figure, "bars: standard uncertainty", predicted, f"{left_out} more points" if left_out else "")
    return figure


class ParameterSample(NamedTuple):
    """A parameter: its label with the unit, its samples, and the ends of the stated interval, in that unit."""

    label: str
    samples: Any
    low: float
    high: float


def pairs_figure(parameters: Sequence[ParameterSample], level: float) -> Any:
    """Draw the distributions of parameters on the diagonal, and their pairs below it."""
    count = len(parameters)
    width = 0.9 * SINGLE if count == 1 else min(DOUBLE, max(1.2 * SINGLE, LEAST_PANEL * count))
    figure, cells = style.subplots(width, max(60.0, 0.9 * width), count, count, squeeze=False)
    for i, row in enumerate(cells):
        for j, axes in enumerate(row):
            if j > i:
                axes.set_axis_off()
                continue
            if i == j:
                _draw_distribution(axes, parameters[i])
            else:
                _draw_pair(axes, parameters[j], parameters[i])
                axes.set_ylim(_range(parameters[i]))
                plain_ticks(axes.yaxis, most=4)
            axes.set_xlim(_range(parameters[j]))
            plain_ticks(axes.xaxis, most=4)
            if i == count - 1:
                axes.set_xlabel(_wrapped(parameters[j].label, count))
            else:
                axes.tick_params(labelbottom=False)
            if j == 0 and i:
                axes.set_ylabel(_wrapped(parameters[i].label, count))
            else:
                axes.tick_params(labelleft=False)
    inside = " and ".join(f"{share:.0%}" for share in CONTOUR_SHARES)
    note(
        figure,
        f"posterior; dashed: {level:.0%} interval",
        f"lines in pairs plots: enclose {inside} of the samples" * (count > 1),
    )
    return figure


def _wrapped(label: str, count: int) -> str:
    """Return a label broken into lines that fit beside its panel."""
    return textwrap.fill(label, 30 if count < 3 else 16, break_long_words=False)


def _range(one: ParameterSample) -> tuple[float, float]:
    low, high = np.quantile(one.samples, (0.001, 0.999))
    margin = 0.04 * (high - low) or 1.0
    return float(low - margin), float(high + margin)


def _draw_distribution(axes: Any, one: ParameterSample) -> None:
    axes.hist(one.samples, bins=np.linspace(*_range(one), BINS + 1), color=COLOURS[5], linewidth=0)
    for end in (one.low, one.high):
        axes.axvline(end, color=GREY, linestyle="--", linewidth=0.8)
    axes.set_yticks([])


def _draw_pair(axes: Any, x: ParameterSample, y: ParameterSample) -> None:
    from scipy.ndimage import gaussian_filter

    counts, *edges = np.histogram2d(x.samples, y.samples, bins=FINE, range=[_range(x), _range(y)])
    counts = gaussian_filter(counts, 1.0)
    middles = [0.5 * (edge[1:] + edge[:-1]) for edge in edges]
    axes.plot(x.samples[::4], y.samples[::4], ".", color=COLOURS[5], markersize=0.7, rasterized=True)
    ranked = np.sort(counts.ravel())[::-1]
    held = np.cumsum(ranked) / ranked.sum()
    levels = sorted({float(ranked[np.searchsorted(held, share)]) for share in CONTOUR_SHARES})
    axes.contour(*middles, counts.T, levels=levels, colors=[COLOURS[1]], linewidths=0.8)
