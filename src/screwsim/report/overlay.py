"""Two results files in one figure: curves of their sweeps, or cycles that they keep, A with solid lines, B dashed."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.report import families
from screwsim.report.families import Curve, Family, curves_of, slices
from screwsim.report.quantities import PRESSURE, VOLUME, shown_axis, shown_figure
from screwsim.report.style import COLOURS, DASHES, DOUBLE, note, panels, plain_ticks, subplots, write_all
from screwsim.report.sweeps import OTHER_FIGURES, label_axes, label_curves, thinned
from screwsim.report.trace import Trace, chosen_trace
from screwsim.results import Results

WIDTHS = 1.2, 0.9  # [pt] line widths of A and B
DASH = DASHES[1]
COLOUR_B = COLOURS[3]  # of the second cycle

Pair = tuple[list[Curve], list[Curve]]  # curves of A and of B


def draw_overlay(a: Results, b: Results, folder: str | Path, apart: tuple[str, str] = ("", "")) -> list[str]:
    """Write the figures that two files have in common, and return their paths; none where they share no axes.

    `apart` says in words how A's scene differs from B's, and B's from A's.
    """
    return write_all(dict(plans(a, b, apart)), folder)


def plans(a: Results, b: Results, apart: tuple[str, str] = ("", "")) -> Mapping[str, Callable[[], Any]]:
    """Return the figures that both files have data for, by name."""
    names = _names(a, b, apart)
    found: dict[str, Callable[[], Any]] = {}
    one, other = families.family_of(a), families.family_of(b)
    same = [axis.path for axis in a.axis_list] == [axis.path for axis in b.axis_list]
    if same and one is not None and other is not None and (one.x, one.by) == (other.x, other.by):
        one, other = next(slices(one)), next(slices(other))  # further axes are at their first values
        common = _common_curves(one, other)
        if common[0]:  # no figure may have two points along an axis in both
            found["comparison"] = partial(_curves, one, names, *common)
    first, second = chosen_trace(a), chosen_trace(b)
    if first is not None and second is not None:
        found["comparison_cycles"] = partial(_cycles, first, second, names, bool(a.axis_list or b.axis_list))
    return found


def _curves(family: Family, names: tuple[str, str], panels_of: Mapping[str, Pair], kept: str) -> Any:
    """Draw figures over the common axis of both sweeps, one panel each."""
    a = family.results
    figure, places = panels(len(panels_of), 22.0, 52.0)
    for axes, (name, pair) in zip(places, panels_of.items(), strict=True):
        texts = list(dict.fromkeys(curve.text for curves in pair for curve in curves))
        colours = {text: COLOURS[number % len(COLOURS)] for number, text in enumerate(texts)}
        for curves, width, dashes in zip(pair, WIDTHS, ("-", DASH), strict=True):
            for curve in curves:
                colour = colours[curve.text]
                axes.plot(curve.x, curve.y, color=colour, linestyle=dashes, linewidth=width)
                if curve.banded:
                    axes.fill_between(curve.x, curve.low, curve.high, color=colour, alpha=0.16, linewidth=0.0)
        x = [curve.x for curves in pair for curve in curves]
        label_axes(axes, shown_axis(family.x_axis).label, shown_figure(a, name).label, x)
    heading, words = families.curves_heading(family)
    _head(figure, names, family.constant, words, kept)
    if family.by is not None:
        label_curves(zip(places, (of_a for of_a, _ in panels_of.values()), strict=True), heading)
    return figure


def _common_curves(one: Family, other: Family) -> tuple[dict[str, Pair], str]:
    """Return the curves of both files by figure, B's in the units of A, and words on curves left out."""
    pairs: dict[str, Pair] = {}
    for name in filter(None, (families.efficiency_name(one.results), *OTHER_FIGURES)):
        of_a = curves_of(one, name)
        of_b = curves_of(other, name, shown=shown_figure(one.results, name)) if of_a else []
        if of_b:
            pairs[name] = of_a, of_b
    thin = [thinned(of_a) for of_a, _ in pairs.values()]
    shown = {curve.text for curves, _ in thin for curve in curves}

    def few(curves: list[Curve]) -> list[Curve]:
        return [curve for curve in curves if curve.text in shown]

    left_out = next(filter(None, (words for _, words in thin)), "")
    return {name: (few(of_a), few(of_b)) for name, (of_a, of_b) in pairs.items()}, left_out


def _cycles(one: Trace, other: Trace, names: tuple[str, str], of_sweeps: bool) -> Any:
    """Draw the pressures of both cycles over volume and over angle."""
    figure, (left, right) = subplots(DOUBLE, 78.0, 1, 2)
    for trace, colour, dashes in ((one, COLOURS[0], "-"), (other, COLOUR_B, DASH)):
        pressure = trace.values["pressure"] * PRESSURE.factor
        left.plot(trace.values["volume"] * VOLUME.factor, pressure, color=colour, linestyle=dashes)
        right.plot(trace.angle, pressure, color=colour, linestyle=dashes)
    left.set(xlabel=VOLUME.label, ylabel=PRESSURE.label)
    right.set(xlabel=one.axis.label, ylabel=PRESSURE.label)
    plain_ticks(left.xaxis, left.yaxis, right.xaxis, right.yaxis)
    _head(figure, names, *dict.fromkeys((one.title, other.title)) if of_sweeps else ())
    return figure


def _head(figure: Any, names: tuple[str, str], *words: str) -> None:
    """Write above a figure which file has solid and which dashed lines, and other remarks."""
    note(figure, f"drawn: {names[0]}", f"dashed: {names[1]}", *words)


def _names(a: Results, b: Results, apart: tuple[str, str]) -> tuple[str, str]:
    """Return what tells two files apart: their names (paths, if these are equal), titles and scenes."""
    files = [each.path.name for each in (a, b)]
    files = files if files[0] != files[1] else [str(each.path) for each in (a, b)]
    titles = [str(each.attributes.get("title", "")) for each in (a, b)]
    titles = titles if titles[0] != titles[1] else ["", ""]
    one, other = (", ".join(filter(None, parts)) for parts in zip(files, titles, apart, strict=True))
    return one, other
