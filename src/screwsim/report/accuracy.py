"""Work-precision figure: error of the performance figures over time and over evaluations, on logarithmic axes."""

from functools import partial
from pathlib import Path
from typing import Any

from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, subplots, write_all

HEIGHT = 92.0  # [mm]
MARKERS = "os^Dv<>P"
FIRST = (*COLOURS, "#8a8a8a", "#a89000")  # eight methods, each with its own colour, line and marker
LINES = (*DASHES, (0, (1, 0.8)), (0, (7, 2.5)))


def draw(study: Any, folder: Path) -> list[str]:
    """Write the figure of a study (`study.accuracy.Study`) as PNG and PDF; return the paths."""
    return write_all({"accuracy": partial(_figure, study)}, folder)


def _figure(study: Any) -> Any:
    figure, (left, right) = subplots(DOUBLE, HEIGHT, 1, 2, sharey=True)
    cases = [each for each in study.comparable if each.status == "ok"]
    for axes, scale, cost in ((left, 1e3, "time"), (right, 1.0, "evaluations")):
        if best := study.front(cost):
            x, y = [scale * getattr(each, cost) for each in best], [each.error for each in best]
            axes.plot(x, y, color="#c9c9c9", linewidth=6.0, zorder=1, solid_capstyle="round")
        for index, label in enumerate(dict.fromkeys(case.label for case in cases)):
            mine = [case for case in cases if case.label == label]
            x, y = [scale * getattr(each, cost) for each in mine], [each.error for each in mine]
            colour, dashes, marker = (kinds[index % len(kinds)] for kinds in (FIRST, LINES, MARKERS))
            mark = {"marker": marker, "markersize": 4.5, "markerfacecolor": colour if index % 2 == 0 else "white"}
            name = label.replace("scipy-", "scipy ")
            axes.plot(x, y, color=colour, linestyle=dashes, label=name, zorder=3, **mark)
        _guides(axes, study)
        axes.set(xscale="log", yscale="log")
    left.set(xlabel="wall time / ms", ylabel="largest relative error of a figure")
    right.set_xlabel("evaluations of one chamber's right-hand side")
    handles, names = left.get_legend_handles_labels()
    if study.front():
        from matplotlib.lines import Line2D

        handles.append(Line2D([], [], color="#c9c9c9", linewidth=6.0))
        names.append("Pareto front")
    figure.legend(handles, names, loc="outside upper center", ncols=4)
    return figure


def _guides(axes: Any, study: Any) -> None:
    """Draw two levels: below one the references differ, below the other regularisation dominates the error."""
    levels = (
        (study.limit_of_regularisation, "regularisation", "right"),
        (study.reference.difference, "references differ", "left"),
    )
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
