"""Figures drawn into axes of one's own: of a result with its cycle, or of a sweep's file.

    figure, (left, right) = matplotlib.pyplot.subplots(1, 2)
    screwsim.plot.pressure_volume(result, ax=left)
    screwsim.plot.curves("sweep.h5", "isentropic_efficiency", ax=right)

Each returns the axes; without `ax` it draws into those of a new figure of pyplot. Whole figures as the command
`screwsim plot` writes them: `screwsim.plot.write`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from screwsim.figures.indicated import read_indicated
from screwsim.inputs.arguments import checked_arguments
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.report import cycle, entropy, families, maps, style, sweeps
from screwsim.report import plot as write
from screwsim.report.indicated import at_angles, draw_over_angle, draw_over_volume
from screwsim.report.quantities import shown_axis, shown_figure
from screwsim.report.trace import Trace, chosen_trace, trace_of
from screwsim.results import Results, open_results
from screwsim.scene.load import scene_of
from screwsim.study.asked.figures import figure_named

__all__ = [
    "contours",
    "curves",
    "mass_flows",
    "pressure",
    "pressure_volume",
    "pv",
    "temperature_entropy",
    "temperatures",
    "write",
]

_CYCLE = "cycle"  # of the line of a cycle that may have others beside it
_HIDDEN = "_cycle "  # before the name of a line that no legend tells yet: matplotlib leaves out such labels
CycleLike = Result | Results | str | os.PathLike[str]


def pressure_volume(
    result: CycleLike, ax: Any = None, *, measured: str | os.PathLike[str] | None = None, **line: Any
) -> Any:
    """Draw the pressure–volume loop with the pressures of both lines and marks; return the axes.

    `line` are properties of the loop's line (color, linestyle, label, …), to tell several in the same axes apart. A
    label gives the axes a legend, and so does a second loop; one without a label is called as its file. Marks are
    those of the first loop. Of a sweep it is the best case; `open_results(file).showing({path: value})` has another.
    `measured` is the path of a file of measured pressures over angle or volume (docs/how-to/indicator.md).
    """
    points = None if measured is None else at_angles(read_indicated(measured), _trace(result))
    axes = _drawn(cycle.draw_loop, result, ax, line)
    if points is not None:
        draw_over_volume(axes, points, _trace(result))
    return axes


pv = pressure_volume


def pressure(result: CycleLike, ax: Any = None, *, measured: str | os.PathLike[str] | None = None, **line: Any) -> Any:
    """Draw the chamber's pressure over the angle; return the axes. `measured` and `line` as of `pressure_volume`."""
    points = None if measured is None else at_angles(read_indicated(measured), _trace(result))
    axes = _drawn(cycle.draw_pressure, result, ax, line)
    if points is not None:
        draw_over_angle(axes, points)
    return axes


def temperatures(result: CycleLike, ax: Any = None) -> Any:
    """Draw the temperatures of gas and oil over the angle; return the axes."""
    return _drawn(cycle.draw_temperatures, result, ax, None)


def temperature_entropy(result: CycleLike, ax: Any = None, *, scene: Any = None, **line: Any) -> Any:
    """Draw the gas temperature over its entropy, with the isobars of both lines and the dew line; return the axes.

    The entropy counts from the gas where the chamber is largest. A file of results has its scene, and so has what
    `screwsim.simulate` returns; for another result in memory pass the `scene` that was simulated, in any form that
    `simulate` takes. `line` as of `pressure_volume`.
    """
    if isinstance(result, Result) and scene is None:
        scene = result.derivatives.scene
        if scene is None:
            what = "this result does not know its scene, of whose gas the entropy is"
            raise UsageError(f"{what} (pass what was simulated: scene=…)")
    given = entropy.scene_of_case(_results(result)) if scene is None else scene_of(scene)
    return _drawn(partial(entropy.draw_temperature_entropy, scene=given), result, ax, line)


def mass_flows(result: CycleLike, ax: Any = None) -> Any:
    """Draw the mass flow of every path that has any over the angle, both sides of a gap together; return the axes.

    Leaks that would be lines at zero beside a port's flow are drawn on an axis that is logarithmic beyond the smallest.
    """
    return _drawn(cycle.draw_flows, result, ax, None)


@checked_arguments()
def curves(results: Results | str | os.PathLike[str], figure: str | None = None, ax: Any = None, **line: Any) -> Any:
    """Draw a figure over one axis of a sweep, one curve for each value of a second; return the axes.

    The default figure is the efficiency. Further axes are held at their first values, which the title states. Of a
    sweep over one axis `line` are properties of its curve, as of `pressure_volume`, and so is the legend: several files
    in the same axes are told apart.
    """
    found = _results(results)
    whole = families.family_of(found)
    if whole is None:
        raise UsageError(f"{found.path}: has no numeric axis to draw over (sweep a path)")
    name = _figure(found, figure)
    family = next(families.slices(whole))
    drawn = families.curves_of(family, name)
    if not drawn:
        raise UsageError(f"{found.path}: has no curve of {name} (fewer than two cases have a value)")
    axes = _axes(ax)
    before = _curves_in(axes)
    if family.by is not None:
        if line:
            raise UsageError(f"{', '.join(line)}: there are {len(drawn)} curves (leave it out, or sweep one path)")
        looks = None
    else:
        looks = [{**style.line_style(len(before) % len(style.COLOURS), 1), **_of_line(line)}]
    sweeps.draw_curves(axes, drawn, optima="efficiency" in name and family.chosen, looks=looks)
    own = _curves_in(axes)[len(before) :]
    label = shown_axis(family.x_axis).label
    x = [*(each.get_xdata() for each in before), *(curve.x for curve in drawn)]
    sweeps.label_axes(axes, label, shown_figure(found, name).label, x)
    if family.by is not None:
        heading = families.curves_heading(family)
        axes.legend(own, [curve.text for curve in drawn], title=heading[0] or heading[1].partition(": ")[2])
    else:
        own[0].set_label(line.get("label", _HIDDEN + found.path.stem))
        _name_lines(axes, asked=not str(line.get("label") or "_").startswith("_"))
    told = "; ".join(text for text in (family.constant, families.band_words(found, drawn)) if text)
    if told:
        axes.set_title(told)
    return axes


@checked_arguments()
def contours(results: Results | str | os.PathLike[str], figure: str | None = None, ax: Any = None) -> Any:
    """Draw a figure as filled contours over two axes of a sweep, with a colour bar; return the axes."""
    found = _results(results)
    whole = families.family_of(found, by_fluid=False)
    if whole is None or whole.by is None:
        raise UsageError(f"{found.path}: has fewer than two numeric axes (sweep two paths)")
    name = _figure(found, figure)
    if name not in found.performance:
        raise UsageError(f"{found.path}: has no values of {name} (pass one of {', '.join(found.figures)})")
    family = next(families.slices(whole))
    axes = _axes(ax)
    maps.draw_contours(axes, family, name)
    if family.constant:
        axes.set_title(family.constant)
    return axes


def _drawn(draw: Callable[[Any, Trace], None], result: CycleLike, ax: Any, line: Mapping[str, Any] | None) -> Any:
    """Draw a cycle and return the axes; `line` are the properties of its line, None where there are several."""
    trace = _trace(result)
    _of_line(line or {})
    axes = _axes(ax)
    before = len(axes.get_lines())
    others = any(each.get_gid() == _CYCLE for each in axes.get_lines())
    draw(axes, trace._replace(marks={}) if others else trace)  # whose marks would lie on each other
    if line is not None:
        axes.get_lines()[before].set_gid(_CYCLE)
        axes.get_lines()[before].set(**{"label": _HIDDEN + _name(result), **line})
        _name_lines(axes, asked=not str(line.get("label") or "_").startswith("_"))
    return axes


def _curves_in(axes: Any) -> list[Any]:
    return [each for each in axes.get_lines() if each.get_gid() == sweeps.CURVE]


def _of_line(line: Mapping[str, Any]) -> dict[str, Any]:
    """Return properties of a line by their long names; raise AttributeError before anything is drawn."""
    from matplotlib.cbook import normalize_kwargs
    from matplotlib.lines import Line2D

    Line2D([], []).set(**line)
    return normalize_kwargs(dict(line), Line2D)


def _name_lines(axes: Any, asked: bool) -> None:
    """Give axes a legend where one is asked for, or there already, or two lines are to be told apart."""
    unnamed = [each for each in axes.get_lines() if each.get_label().startswith(_HIDDEN)]
    if not (asked or len(unnamed) > 1 or (unnamed and axes.get_legend())):
        return
    for number, each in enumerate(unnamed, 1):
        each.set_label(each.get_label().removeprefix(_HIDDEN) or f"cycle {number}")
    axes.legend()


def _name(result: CycleLike) -> str:
    """Return the name of the file of results; empty for a result in memory."""
    return "" if isinstance(result, Result) else _results(result).path.stem


def _axes(ax: Any) -> Any:
    if ax is None:
        from matplotlib import pyplot

        return pyplot.subplots()[1]
    if not hasattr(ax, "plot"):
        raise UsageError(f"ax is {type(ax).__name__} (pass axes of matplotlib, e.g. those of pyplot.subplots())")
    return ax


def _trace(result: CycleLike) -> Trace:
    """Return the cycle of a result, or of a file's best case."""
    if isinstance(result, Result):
        if "angle" not in result.cycle:
            why = f"the case {result.told}" if result.status == "failed" else "use simulate(scene, trace=True)"
            raise UsageError(f"the result has no cycle to draw ({why})")
        return trace_of(result)
    found = _results(result)
    trace = chosen_trace(found)
    if trace is None:
        raise UsageError(f"{found.path}: holds no cycle (run stores one; a sweep does with output.keep: cycle)")
    return trace


def _results(given: Any) -> Results:
    if isinstance(given, Results):
        return given
    if isinstance(given, str | os.PathLike):
        return open_results(os.fspath(given))
    raise UsageError(f"{type(given).__name__} cannot be drawn (pass a Result, or the path of a file of results)")


def _figure(results: Results, figure: str | None) -> str:
    """Return the figure that is meant; the efficiency where none is."""
    if figure is not None:
        return figure_named(figure, results.figures, results.error)
    name = families.efficiency_name(results)
    if name is None:
        raise UsageError(f"{results.path}: has no efficiency (pass one of {', '.join(results.figures)})")
    return name
