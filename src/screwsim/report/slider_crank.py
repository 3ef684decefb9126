"""Figures of a slider-crank: tolerances of its lengths, and a flexible connecting rod.

Of the tolerances the three transfer functions, the surface of their deviations, the scatter of a compressor; of the rod
its stability boundary, and load, deflection and stress over rod and rotation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.figures.engineering import shown_name
from screwsim.machine.slider_crank.tolerance import FUNCTIONS, Array, Grade, Links, plane, surface
from screwsim.report import style
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SINGLE, SMALL, plain_ticks, subplots, write_all

if TYPE_CHECKING:  # scipy's solvers, which the rod needs, take longer to load than a tolerance study's figures to draw
    from screwsim.machine.slider_crank.rod import Bending, FlexibleRod

LENGTH_SHARE = 0.05  # of the lengths, on either side
SHOWN_FIGURES = ("gas_mass_flow", "shaft_power", "isentropic_efficiency")
MARKERS = "o^s"
_NAMES = {"right": "d$x$/d$α$", "printed": "formula as printed", "tabulated": "formula behind the table"}
MM, MPA = 1e3, 1e-6  # [mm/m], [MPa/Pa]


def draw_tolerance(alpha: Array, nominal: Links, points: tuple[Array, Array], folder: str | Path) -> list[str]:
    """Write the figures (PNG, PDF) and return their paths; `points` are angles and values of the printed table."""
    plans = {
        "transfer_functions": partial(functions_figure, nominal, points),
        "deviation_surface": partial(surface_figure, alpha, nominal),
        "deviation_contours": partial(contour_figure, alpha, nominal),
    }
    return write_all(plans, folder)


def functions_figure(nominal: Links, points: tuple[Array, Array]) -> Any:
    """Draw the three transfer functions over a revolution [mm/rad], the right one with ± 5 %, and the printed table."""
    figure, axes = subplots(SINGLE, 74.0)
    alpha = np.linspace(-np.pi, np.pi, 721)
    degrees = np.degrees(alpha)
    axes.axhline(0.0, color=GREY, linewidth=0.4)
    values = MM * FUNCTIONS["right"](alpha, nominal)
    axes.fill_between(degrees, (1 - LENGTH_SHARE) * values, (1 + LENGTH_SHARE) * values, color="#d8d8d8", linewidth=0.0)
    for i, (name, function) in enumerate(FUNCTIONS.items()):
        colour = COLOURS[(0, 2, 4)[i]]
        axes.plot(degrees, MM * function(alpha, nominal), color=colour, linestyle=DASHES[i], label=_NAMES[name])
    turned = (np.degrees(points[0]) + 180.0) % 360.0 - 180.0
    axes.plot(turned, MM * points[1], "o", markersize=2.6, color=COLOURS[3], label="printed table")
    plain_ticks(axes.yaxis)
    axes.set(xlim=(-180.0, 180.0), xticks=range(-180, 181, 60), ylim=(-120.0, 175.0))
    axes.set(xlabel="crank angle $α$ (°)", ylabel="transfer function (mm/rad)")
    axes.legend(loc="upper center", ncols=2, columnspacing=0.8, handlelength=1.8)
    return figure


def surface_figure(alpha: Array, nominal: Links) -> Any:
    """Draw the standard deviation over ± 5 % of both lengths with the 5 % plane, right and as tabulated."""
    figure = style.new_figure(DOUBLE, 82.0, "none")
    for i, name in enumerate(("right", "tabulated")):
        title = f"({'ab'[i]}) {_NAMES[name]}"
        axes = _surface(figure, 0.01 + 0.49 * i, title, FUNCTIONS[name], alpha, nominal)
        axes.set_zlim(0.0, 5.5)
    return figure


def _surface(figure: Any, left: float, title: str, function: Any, alpha: Array, nominal: Links) -> Any:
    """Draw one surface of deviations and its plane into axes from `left` on, which are returned."""
    axes: Any = figure.add_axes((left, 0.0, 0.46, 0.97), projection="3d", computed_zorder=False)
    errors = np.linspace(-LENGTH_SHARE, LENGTH_SHARE, 41)
    rods, cranks = np.meshgrid(100.0 * errors, 100.0 * errors)
    found, level = MM * surface(function, alpha, nominal, errors), MM * plane(function, alpha, nominal, LENGTH_SHARE)
    look = {"cmap": "viridis", "linewidth": 0.0, "vmin": 0.0, "vmax": found.max(), "rcount": 41, "ccount": 41}
    axes.plot_surface(cranks, rods, np.minimum(found, level), zorder=1, **look)
    axes.plot_surface(cranks, rods, np.full_like(found, level), color=GREY, alpha=0.35, linewidth=0.0, zorder=2)
    axes.plot_surface(cranks, rods, _part_above(found, level), zorder=3, **look)
    axes.set_xlabel("error of the crank (%)", labelpad=-3)
    axes.set_ylabel("error of the rod (%)", labelpad=-3)
    axes.set_zlabel("standard deviation (mm/rad)", labelpad=-3)
    axes.tick_params(pad=-2)
    axes.set_box_aspect((1.0, 1.0, 0.8), zoom=0.9)
    axes.view_init(elev=22.0, azim=-62.0)
    style.look_in_space(axes, 5)
    axes.set_title(f"{title}; plane: 5 % of it", y=0.97)
    return axes


def _part_above(found: Array, level: float) -> Array:
    """Return the part above a level with the cells that it cuts; the rest is NaN and so not drawn."""
    high = np.pad(found > level, 1)
    near = high[1:-1, 1:-1] | high[:-2, 1:-1] | high[2:, 1:-1] | high[1:-1, :-2] | high[1:-1, 2:]
    return np.where(near, np.maximum(found, level), np.nan)


def contour_figure(alpha: Array, nominal: Links) -> Any:
    """Draw lines of equal deviation, in per cent of the law, over errors of both lengths; 5 % is thick."""
    figure, panels = subplots(DOUBLE, 84.0, 1, 2, sharey=True)
    for i, name in enumerate(("right", "tabulated")):
        _contours(panels[i], FUNCTIONS[name], alpha, nominal)
        panels[i].set_title(f"({'ab'[i]}) {_NAMES[name]}")
    panels[0].set_ylabel("error of the crank (%)")
    return figure


def _contours(axes: Any, function: Any, alpha: Array, nominal: Links) -> None:
    """Draw the contours of one function."""
    errors = 1.1 * np.linspace(-LENGTH_SHARE, LENGTH_SHARE, 81)
    share = 100.0 * surface(function, alpha, nominal, errors) / plane(function, alpha, nominal, 1.0)
    for levels, width in (((1, 2, 3, 4, 6, 7, 8, 9), 0.8), ((100 * LENGTH_SHARE,), 1.8)):
        at = 100 * errors
        lines = axes.contour(at, at, share, levels=levels, colors=COLOURS[1 if width < 1 else 0], linewidths=width)
        axes.clabel(lines, fmt="%g %%", fontsize=SMALL)
    axes.set_xlabel("error of the rod (%)")
    plain_ticks(axes.xaxis, axes.yaxis)


def draw_machine(nominal: Links, drawn: tuple[Sequence[Grade], Array, Mapping[str, Array]], folder: Path) -> list[str]:
    """Write the law of motion of one machine and the scatter of the sampled ones (PNG, PDF); return the paths."""
    plans = {"law_of_motion": partial(law_figure, nominal), "tolerance": partial(spread_figure, *drawn)}
    return write_all(plans, folder)


def law_figure(nominal: Links) -> Any:
    """Draw the standard deviation of dx/dα over ± 5 % of both lengths: surface with the 5 % plane, and contours."""
    figure = style.new_figure(DOUBLE, 82.0, "none")
    alpha, right = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False), FUNCTIONS["right"]
    _surface(figure, 0.01, f"(a) {_NAMES['right']}", right, alpha, nominal)
    flat = figure.add_axes((0.6, 0.15, 0.37, 0.72))
    _contours(flat, right, alpha, nominal)
    flat.set(title="(b) the same, relative to the law", ylabel="error of the crank (%)")
    return figure


def spread_figure(table: Sequence[Grade], shifts: np.ndarray, deviations: Mapping[str, np.ndarray]) -> Any:
    """Draw errors of the law and shifts of the dead centre by grades, and relative deviations of figures by shifts."""
    figure, (left, right) = subplots(DOUBLE, 78.0, 1, 2)
    numbers = [row.crank for row in table]
    left.semilogy(numbers, [100.0 * row.error for row in table], color=COLOURS[0], label="error of the law (%)")
    heads = [1e3 * row.head for row in table]
    left.semilogy(numbers, heads, color=COLOURS[1], linestyle=DASHES[1], label="dead centre, ± (mm)")
    left.set_xticks(numbers[::2], [f"IT{number}" for number in numbers[::2]])
    left.set(xlabel="grade of crank and rod", title="(a) law of motion")
    left.legend(loc="upper left")
    right.axhline(0.0, color=GREY, linewidth=0.4)
    for i, name in enumerate(name for name in SHOWN_FIGURES if name in deviations):
        style = {"color": COLOURS[i], "markersize": 2.4, "label": shown_name(name)}
        right.plot(1e3 * shifts, 100.0 * deviations[name], MARKERS[i], **style)
    low, high = right.get_ylim()
    right.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    right.set(xlabel="shift of the top dead centre (mm)", ylabel="deviation from the nominal machine (%)")
    right.set_title("(b) machines drawn")
    right.legend(loc="upper left", ncols=2)
    plain_ticks(right.xaxis, right.yaxis)
    return figure


def draw_rod(rod: FlexibleRod, bending: Bending, folder: str | Path) -> list[str]:
    """Write the figures (PNG, PDF) and return their paths."""
    figures = {"rod_stability": stability_figure, "rod_bending": bending_figure}
    return write_all({name: partial(figure, rod, bending) for name, figure in figures.items()}, folder)


def stability_figure(rod: FlexibleRod, bending: Bending) -> Any:
    """Draw the boundary γ(β), its limit at β = 1, and the rod at its largest compression."""
    from screwsim.machine.slider_crank.rod import critical_gamma

    figure, axes = subplots(SINGLE, 66.0)
    beta = np.linspace(0.25, 1.0, 200)
    axes.plot(beta, [critical_gamma(float(x)) for x in beta], color=COLOURS[0])
    axes.axhline(critical_gamma(1.0), color=GREY, linewidth=0.5, linestyle=DASHES[1])
    axes.annotate(f"{critical_gamma(1.0):.4g}", (0.27, critical_gamma(1.0)), xytext=(0, 3), textcoords="offset points")
    point = rod.beta, rod.gamma(min(float(bending.load.min()), 0.0))
    axes.plot(*point, "o", color=COLOURS[2])
    text = "rod at its largest\ncompression"
    axes.annotate(text, point, xytext=(0, -8), textcoords="offset points", fontsize=SMALL, va="top", ha="center")
    axes.annotate("buckles", (0.72, 8.0), ha="center")
    axes.annotate("stable", (0.72, 2.0), ha="center")
    plain_ticks(axes.xaxis, axes.yaxis)
    axes.set(xlim=(0.25, 1.0), ylim=(0.0, 14.0))
    axes.set(xlabel=r"flexible share $β = l/L$", ylabel=r"$γ = L\,\sqrt{|P|/(E I)}$")
    return figure


def bending_figure(rod: FlexibleRod, bending: Bending) -> Any:
    """Draw the load over one revolution; deflection, bending moment and stress of one face over rod and angle."""
    from screwsim.machine.slider_crank.rod import largest_moment_place

    figure, places = subplots(DOUBLE, 124.0, 2, 2, sharex=True)
    panels = places.ravel()
    degrees, z = np.degrees(bending.alpha), MM * bending.z
    panels[0].axhline(0.0, color=GREY, linewidth=0.4)
    panels[0].plot(degrees, bending.load, color=COLOURS[0])
    panels[0].set_ylabel("axial load $P$ (N), tension +")
    fields = (
        (MM * bending.deflection, "deflection $V$ (mm)"),
        (MM * bending.moment, "bending moment $M$ (N mm)"),
        (MPA * bending.stress[0], "stress of the face $+h/2$ (MPa)"),
    )
    for axes, (field, label) in zip(panels[1:], fields, strict=True):
        drawn = axes.contourf(degrees, z, field.T, levels=16, cmap="viridis")
        axes.contour(degrees, z, field.T, levels=[0.0], colors="white", linewidths=0.8)
        bar = figure.colorbar(drawn, ax=axes, pad=0.02)
        bar.ax.tick_params(labelsize=SMALL)
        axes.set(title=label, ylabel="$z$ from the piston (mm)")
    places = np.array([MM * largest_moment_place(rod, float(load)) for load in bending.load])
    panels[2].plot(degrees, places, color=COLOURS[3], linestyle=DASHES[1], linewidth=1.4, label="$z_M$")
    panels[2].legend(loc="upper right", labelcolor="white")
    for axes in panels:
        axes.set(xlim=(degrees[0], 360.0), xticks=range(0, 361, 60))
    for axes in panels[2:]:
        axes.set_xlabel("crank angle $α$ (°)")
    return figure
