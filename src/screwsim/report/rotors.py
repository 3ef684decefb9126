"""Figures of a rotor pair: mesh, sealing line in space, volume and areas over the angle, slide valve."""

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.machine.rotors.curves import Curves, closed_in, make_curves
from screwsim.machine.rotors.export import coefficients_csv, curves_csv, lobe_csv, outline_dxf, profile_csv
from screwsim.machine.rotors.pair import outlines
from screwsim.machine.rotors.rotors import Rotors
from screwsim.machine.rotors.settings import SlideValve
from screwsim.report import style
from screwsim.report.style import COLOURS, DASHES, DOUBLE, GREY, SINGLE, plain_ticks, subplots, write_all
from screwsim.results.atomic import make_folder, write_text
from screwsim.results.protection import protect_other_text

POSITIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
CM2 = 1e4  # [cm²/m²]
LEAST_TRAVEL = 1e-6  # of the travel: the slot is open, but as narrow as possible
MM = 1e3  # [mm/m]
_FILL = "#e4e4e4"


def draw_rotors(
    rotors: Rotors,
    volume_ratio: float,
    folder: str | Path,
    axial_ratio: float | None = None,
    slide: SlideValve | None = None,
) -> list[str]:
    """Write all figures (PNG, PDF) and all files (CSV, DXF) of a pair and return their paths."""
    target = Path(folder)
    curves = make_curves(rotors, volume_ratio, axial_ratio, slide)
    plans = {
        "rotors": partial(mesh_figure, rotors),
        "sealing_line": partial(sealing_figure, rotors),
        "volume": partial(volume_figure, rotors, curves),
        "areas": partial(areas_figure, curves),
    }
    if slide is not None:
        plans["slide_valve"] = partial(slide_figure, rotors, volume_ratio, axial_ratio, slide)
    male, female = outlines(rotors.pair, rotors.chain)
    texts = {
        "coefficients.csv": coefficients_csv(rotors),
        "male_lobe.csv": lobe_csv(rotors),
        "male.csv": profile_csv(*male),
        "female.csv": profile_csv(*female),
        "male.dxf": outline_dxf(*male),
        "female.dxf": outline_dxf(*female),
        **{f"curves/{name}": text for name, text in curves_csv(curves).items()},
    }
    files = {target / name: text for name, text in texts.items()}
    protect_other_text(files)
    written = write_all(plans, target)
    make_folder(target / "curves")
    return written + [write_text(path, text) for path, text in files.items()]


def mesh_figure(rotors: Rotors) -> Any:
    """Draw both rotors in their bores, with pitch circles, the line of contact, H, P and S."""
    pair, chain = rotors.pair, rotors.chain
    A, (Hx, Hy) = pair.centre_distance, pair.cusp
    figure, axes = subplots(DOUBLE, 104.0)
    (mx, my), (fx, fy) = outlines(pair, chain)
    _fill(axes, MM * mx, MM * my, _FILL)
    _fill(axes, MM * (A + fx), MM * fy, "white")
    for centre, radius, beta, side in ((0.0, pair.male_radius, pair.beta1, 1), (A, pair.female_radius, pair.beta2, -1)):
        angle = np.linspace(beta, 2.0 * math.pi - beta, 400)
        bore = MM * (centre + side * radius * np.cos(angle)), MM * radius * np.sin(angle)
        axes.plot(*bore, color=GREY, linewidth=1.6)
    turn = np.linspace(0.0, 2.0 * math.pi, 400)
    for centre, radius in ((0.0, pair.r1), (A, pair.r2)):
        circle = MM * (centre + radius * np.cos(turn)), MM * radius * np.sin(turn)
        axes.plot(*circle, color=GREY, linewidth=0.5, linestyle=(0, (6, 3)))
        axes.plot(MM * centre, 0.0, "+", color=GREY, markersize=7)
    axes.plot(MM * chain.x, MM * chain.y, color=COLOURS[2], linewidth=1.3)
    S = float(chain.x[chain.trail]), float(chain.y[chain.trail])
    for name, point, way in (("H", (Hx, Hy), (0, 9)), ("S", S, (9, 2)), ("P", (pair.r1, 0.0), (-8, -9))):
        axes.plot(MM * point[0], MM * point[1], "o", color=COLOURS[2], markersize=2.6)
        axes.annotate(name, (MM * point[0], MM * point[1]), xytext=way, textcoords="offset points", ha="center")
    axes.set(aspect="equal", xlabel="$x$ (mm)", ylabel="$y$ (mm)")
    plain_ticks(axes.xaxis, most=9)
    plain_ticks(axes.yaxis)
    points = "H cusp of the bores, P pitch point, S where contact on the trailing flank begins (blow-hole: H to S)"
    style.note(figure, f"coloured: line of contact; dashed: pitch circles; {points}")
    return figure


def _fill(axes: Any, x: np.ndarray, y: np.ndarray, colour: str) -> None:
    """Fill an outline; `axes.fill` queries the extent of each side, which takes 0.8 s for a thousand points."""
    from matplotlib.patches import Polygon

    points = np.column_stack([x, y])
    axes.add_artist(Polygon(points, facecolor=colour, edgecolor=COLOURS[0], linewidth=0.9))
    axes.update_datalim(points)
    axes.autoscale_view()


def sealing_figure(rotors: Rotors) -> Any:
    """Draw the sealing line of one chamber in space, and its three projections as thin lines on the walls."""
    chain, pair = rotors.chain, rotors.pair
    n, trail = len(chain.psi), chain.trail
    order = np.concatenate([np.arange(trail, n), np.arange(1, trail + 1)])
    psi = chain.psi[order] - np.where(np.arange(n) < n - trail, pair.pitch, 0.0)
    x, y = MM * chain.x[order], MM * chain.y[order]
    z = MM * rotors.h * (psi.max() - psi)  # points of larger ψ mesh nearer the inlet
    figure = style.new_figure(SINGLE, 92.0, "none")
    axes = figure.add_axes((0.02, 0.06, 0.86, 0.92), projection="3d")
    walls = (x.min() - 4.0, y.max() + 4.0, z.min() - 4.0)
    for line in ((np.full(n, walls[0]), y, z), (x, np.full(n, walls[1]), z), (x, y, np.full(n, walls[2]))):
        axes.plot(*line, color=GREY, linewidth=0.6, linestyle=DASHES[1])
    axes.plot(x, y, z, color=COLOURS[0], linewidth=1.6)
    marks = (("S₋₁", 0, 2.5), ("S′₀", n - 1 - (trail - chain.lead), -5.5), ("S₀", n - 1, 2.5))
    for name, i, up in marks:
        axes.plot([x[i]], [y[i]], [z[i]], "o", color=COLOURS[2], markersize=3.5)
        axes.text(x[i] + 1.0, y[i] + 1.0, z[i] + up, name)
    axes.set(xlim=(walls[0], x.max() + 4.0), ylim=(y.min() - 4.0, walls[1]), zlim=(walls[2], z.max() + 4.0))
    axes.set_box_aspect((np.ptp(x) + 8.0, np.ptp(y) + 8.0, np.ptp(z) + 8.0), zoom=0.86)
    axes.set_xlabel("$x$ (mm)", labelpad=-2)
    axes.set_ylabel("$y$ (mm)", labelpad=0)
    axes.set_zlabel("$z$ (mm)", labelpad=-2)
    axes.tick_params(pad=-1)
    style.look_in_space(axes, 4)
    axes.view_init(elev=22.0, azim=-58.0)
    return figure


def _over_life(axes: Any, curves: Curves, named: bool) -> None:
    """Give axes the angles of a life, and mark where suction closes and discharge opens, with names above."""
    marks = math.degrees(curves.suction_closes), math.degrees(curves.discharge_opens)
    style.angle_axis(axes, 0.0, math.degrees(curves.life), marks)
    for text, at in zip(("suction closes", "discharge opens"), marks, strict=True):
        if named:
            style.name_above(axes, at, text)


def volume_figure(rotors: Rotors, curves: Curves) -> Any:
    """Draw V and dV/dφ over the chamber's own angle, and the male rotor's part of dV/dφ."""
    figure, (upper, lower) = subplots(SINGLE, 96.0, 2, 1, sharex=True)
    degrees, phi = np.degrees(curves.volume.angle), curves.volume.angle + rotors.start
    upper.plot(degrees, 1e6 * curves.volume.value, color=COLOURS[0])
    upper.set(ylabel="$V$ (cm³)", ylim=(0.0, None))
    lower.axhline(0.0, color=GREY, linewidth=0.4)
    for slope, name, i in ((rotors.volume_slope, "both rotors", 0), (rotors.male_slope, "male rotor", 1)):
        lower.plot(degrees, 1e6 * slope(phi), color=COLOURS[2 * i], linestyle=DASHES[i], label=name)
    lower.set(xlabel="angle of the chamber's life (°)", ylabel=r"$\mathrm{d}V/\mathrm{d}\varphi$ (cm³/rad)")
    lower.legend(loc="lower left")
    for axes in (upper, lower):
        plain_ticks(axes.yaxis, most=6)
        _over_life(axes, curves, axes is upper)
    return figure


def areas_figure(curves: Curves) -> Any:
    """Draw ports, sealing line and tips, blow-holes and end-face lengths over the chamber's own angle."""
    figure, places = subplots(DOUBLE, 116.0, 2, 2, sharex=True)
    panels = places.ravel()
    ports = {
        f"{side} {way}": curve
        for side, both in (("suction", curves.suction), ("discharge", curves.discharge))
        for way, curve in both.items()
    }
    lines = {path.name: path for path in curves.paths}
    _panel(panels[0], {name: (c, 1e4) for name, c in ports.items()}, "port area (cm²)")
    names = {"sealing_line": "contact line", "sealing_line_over_tip": "over the male tip"}
    names |= {"male_tip": "male tip", "female_tip": "female tip"}
    _panel(panels[1], {text: (lines[name].curve, MM) for name, text in names.items()}, "length (mm)")
    holes = {"blow_hole": "discharge side", "suction_blow_hole": "suction side"}
    _panel(panels[2], {text: (lines[name].curve, 1e6) for name, text in holes.items()}, "blow-hole area (mm²)")
    faces = {
        f"{path.offset} pitch{'es' if path.offset > 1 else ''} behind": (path.curve, MM)
        for path in curves.paths
        if path.name.startswith("end_face")
    }
    _panel(panels[3], faces, "length on the end face (mm)")
    tops = max(c.value.max() for c in ports.values()) * 1e4, max(lines[n].curve.value.max() for n in holes) * 1e6
    for axes, top in zip((panels[0], panels[2]), tops, strict=True):
        axes.set(yscale="log", ylim=(0.1, 12.0 * top))
    for i, axes in enumerate(panels):
        _over_life(axes, curves, i < 2)
        if i % 2:
            plain_ticks(axes.yaxis, most=6)
            axes.set_ylim(0.0, 1.32 * axes.dataLim.y1)
    figure.supxlabel("angle of the chamber's life (°)", fontsize=8.0)
    return figure


def _panel(axes: Any, named: dict[str, tuple[Any, float]], label: str) -> None:
    for i, (name, (curve, factor)) in enumerate(named.items()):
        colour = COLOURS[(0, 2, 3, 5)[i]]
        axes.plot(np.degrees(curve.angle), factor * curve.value, color=colour, linestyle=DASHES[i], label=name)
    axes.set_ylabel(label)
    axes.legend(loc="upper center", ncols=2, columnspacing=1.2, **style.WHITE_BOX)


def slide_figure(rotors: Rotors, volume_ratio: float, axial_ratio: float | None, slide: SlideValve) -> Any:
    """Draw the slot to suction and the discharge port over the angle; volume and volume ratio over the position."""

    def curves_at(position: float) -> Curves:
        return make_curves(rotors, volume_ratio, axial_ratio, replace(slide, position=position))

    figure, (upper, lower) = subplots(DOUBLE, 118.0, 2, 2, gridspec_kw={"width_ratios": (1.7, 1.0)})
    known = [curves_at(position) for position in POSITIONS]
    for i, (x, curves) in enumerate(zip(POSITIONS, known, strict=True)):
        style = {"color": COLOURS[i], "linestyle": DASHES[i], "label": f"{100 * x:.0f} %"}
        if curves.slot is not None:
            upper[0].plot(np.degrees(curves.slot.angle), CM2 * curves.slot.value, **style)
        parts = curves.discharge
        both = CM2 * (parts["axial"].value + parts["radial"].value)
        lower[0].plot(np.degrees(parts["axial"].angle), both, **style)
    axial = known[-1].discharge["axial"]
    line = lower[0].plot(np.degrees(axial.angle), CM2 * axial.value, color=GREY, linewidth=0.6)
    closes = math.degrees(known[0].suction_closes)
    for axes, label in ((upper[0], "slot to suction (cm²)"), (lower[0], "discharge port (cm²)")):
        axes.set(xlim=(0.0, math.degrees(rotors.life)), ylim=(0.0, None), ylabel=label)
        axes.axvline(closes, color=GREY, linewidth=0.5, linestyle=(0, (1, 2)), zorder=1)
        plain_ticks(axes.yaxis, most=5)
    upper[0].annotate("largest volume", (closes, 1.02), xycoords=("data", "axes fraction"), ha="center")
    lower[0].set_xlabel("angle of the chamber's life (°)")
    upper[0].legend(title="position", loc="upper left")
    lower[0].legend(line, ["axial part alone"], loc="upper left")
    moved = np.linspace(LEAST_TRAVEL, 1.0, 21)
    found = [closed_in(rotors, curves_at(position)) for position in moved]
    full = closed_in(rotors, make_curves(rotors, volume_ratio, axial_ratio))
    labels = (100.0, "closed-in volume (% of the largest)"), (1.0, "volume ratio")
    for k, (axes, (factor, label)) in enumerate(zip((upper[1], lower[1]), labels, strict=True)):
        axes.plot(100.0 * moved, [factor * each[k] for each in found], color=COLOURS[0])
        axes.plot(0.0, factor * full[k], "o", color=COLOURS[0], markersize=3.5, label="full load, slot shut")
        axes.set(ylabel=label, xlim=(-4.0, 100.0), ylim=(0.0, None))
        plain_ticks(axes.yaxis, most=5)
    upper[1].legend(loc="lower left")
    lower[1].set_xlabel("position (% of the travel)")
    return figure
