"""Figures of a flexible connecting rod: its stability boundary; load, deflection and stress over rod and rotation."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.machine.slider_crank.rod import Bending, FlexibleRod, critical_gamma, largest_moment_place
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SINGLE, SMALL, plain_ticks, subplots, write_all

MM, MPA = 1e3, 1e-6  # [mm/m], [MPa/Pa]


def draw_rod(rod: FlexibleRod, bending: Bending, folder: str | Path) -> list[str]:
    """Write the figures (PNG, PDF) and return their paths."""
    figures = {"rod_stability": stability_figure, "rod_bending": bending_figure}
    return write_all({name: partial(figure, rod, bending) for name, figure in figures.items()}, folder)


def stability_figure(rod: FlexibleRod, bending: Bending) -> Any:
    """Draw the boundary γ(β), its limit at β = 1, and the rod at its largest compression."""
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
