"""Work-precision figure: error of the performance figures over time and over evaluations, on logarithmic axes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, journal, subplots, write

HEIGHT = 92.0  # [mm]
MARKERS = "os^Dv<>P"
FIRST = (*COLOURS, "#8a8a8a", "#a89000")  # eight methods, each with its own colour, line and marker
LINES = (*DASHES, (0, (1, 0.8)), (0, (7, 2.5)))


class Line(NamedTuple):
    """One method at several tolerances: its name, times [s], evaluations, errors."""

    name: str
    times: Sequence[float]
    evaluations: Sequence[float]
    errors: Sequence[float]


class Drawing(NamedTuple):
    """Contents of the figure; `front` has (time [s], error), `floor` is the difference of the two references."""

    lines: Sequence[Line]
    front: Sequence[tuple[float, float]]
    front_by_evaluations: Sequence[tuple[float, float]]
    floor: float
    regularisation: float | None


def draw(drawing: Drawing, folder: Path) -> list[str]:
    """Write the figure as PNG and PDF; return the paths."""
    with journal():
        return write(_figure(drawing), folder, "accuracy")


def _figure(drawing: Drawing) -> Any:
    figure, (left, right) = subplots(DOUBLE, HEIGHT, 1, 2, sharey=True)
    for axes, scale, attribute, best in (
        (left, 1e3, "times", drawing.front),
        (right, 1.0, "evaluations", drawing.front_by_evaluations),
    ):
        if best:
            x, y = zip(*best, strict=True)
            axes.plot([scale * each for each in x], y, color="#c9c9c9", linewidth=6.0, zorder=1, solid_capstyle="round")
        for index, line in enumerate(drawing.lines):
            _plot(axes, index, [scale * each for each in getattr(line, attribute)], line)
        _guides(axes, drawing)
        axes.set(xscale="log", yscale="log")
    left.set(xlabel="wall time / ms", ylabel="largest relative error of a figure")
    right.set_xlabel("evaluations of one chamber's right-hand side")
    handles, names = left.get_legend_handles_labels()
    if drawing.front:
        from matplotlib.lines import Line2D

        handles.append(Line2D([], [], color="#c9c9c9", linewidth=6.0))
        names.append("Pareto front")
    figure.legend(handles, names, loc="outside upper center", ncols=4)
    return figure


def _plot(axes: Any, index: int, x: Sequence[float], line: Line) -> None:
    colour, dashes, marker = (kinds[index % len(kinds)] for kinds in (FIRST, LINES, MARKERS))
    mark = {"marker": marker, "markersize": 4.5, "markerfacecolor": colour if index % 2 == 0 else "white"}
    axes.plot(x, line.errors, color=colour, linestyle=dashes, label=line.name, zorder=3, **mark)


def _guides(axes: Any, drawing: Drawing) -> None:
    """Draw two levels: below one the references differ, below the other regularisation dominates the error."""
    levels = ((drawing.regularisation, "regularisation", "right"), (drawing.floor, "references differ", "left"))
    for level, text, side in levels:
        if level is None or not level > 0.0:
            continue
        axes.axhline(level, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0)
        axes.annotate(
            text,
            (float(side == "right"), level),
            xycoords=("axes fraction", "data"),
            xytext=(-3 if side == "right" else 3, 2),
            textcoords="offset points",
            ha=side,
            color=GREY,
            fontsize=6.5,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4, "alpha": 0.85},
            zorder=2,
        )
