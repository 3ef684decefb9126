"""Output of `screwsim rotors` for a scene: coefficients, figures, page, and tables that `law: table` reads."""

import math
import textwrap
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.inputs.declare import plain
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import TWIN_SCREW, twin_screw
from screwsim.machine.profile_law import Interface, LaidCurves, Table, laid_curves, sized_holes
from screwsim.machine.protocol import BLOW_HOLE, END_GAP, GAPS
from screwsim.machine.rotors import leakage
from screwsim.machine.rotors.curves import Curve, closed_in
from screwsim.machine.rotors.export import curve_csv
from screwsim.outputs.customary import with_printed_units
from screwsim.report.rotors import draw_rotors
from screwsim.report.rotors_page import page
from screwsim.results.atomic import make_folder, write_text
from screwsim.results.protection import protect_other_text
from screwsim.scene import scene_text, without_sweep
from screwsim.scene.types import ActiveEffect, Scene

TABLE_WIDTH = 79  # line width of the table, for a terminal
DEG = 180.0 / math.pi
SAME_ANGLE = 1e-9  # [rad] below which two angles of a table are the same
LISTED_RATIOS = (2.2, 2.6, 3.2, 4.0)  # built-in volume ratios whose angles are listed beside the scene's
_SHOWN = {"m^2": (1e6, "mm²"), "m^3": (1e6, "cm³"), "rad": (DEG, "°"), "m": (1e3, "mm"), "1": (1.0, "")}
OF_PROFILE = {  # key of an effect -> length of the profile that it takes by default
    "female_diameter": "female_diameter",
    "axis_distance": "centre_distance",
}
_TABLE_NOTE = """\
# Written by `screwsim rotors`: the machine as tables, in place of its profile. A table of an effect holds one path, so
# the contact line to the chamber z1 pitches behind is included; its part over the male tip, which leads to another
# chamber, and the end face are not, so that the machine leaks less than with its profile.
"""


def curves_of(scene: Scene) -> LaidCurves:
    """Return the curves of a scene's rotors; raise UsageError where its machine has none."""
    kind = scene.machine.kind
    if kind != TWIN_SCREW:
        raise UsageError(f"machine.kind is {kind}: there are no rotors (name a scene of a {TWIN_SCREW})")
    law = twin_screw(scene.machine).volume
    if not law.from_rotors:
        remedy = "write machine.profile and law: profile"
        raise UsageError(f"machine.volume.law is {law.law}: there are no rotors ({remedy})")
    return laid_curves(twin_screw(scene.machine))


def _volume_ratio(scene: Scene, laid: LaidCurves) -> float:
    """Return the volume ratio that the scene states, or that of a discharge port which a table opens."""
    return twin_screw(scene.machine).built_in_volume_ratio or closed_in(laid.rotors, laid.curves)[1]


def coefficients(scene: Scene) -> dict[str, tuple[float, str, str]]:
    """Return {name: (value [SI], unit, meaning)} of the rotors, and of their position on the scene's angle axis."""
    laid = curves_of(scene)
    rotors, own = laid.rotors, laid.rotors.coefficients()
    ratio = _volume_ratio(scene, laid)
    longest = {path.name: float(path.curve.value.max()) for path in laid.curves.paths}
    own["male_tip_length"] = (longest["male_tip"], "m", "longest part of a male tip that seals on the bore at any time")
    own["female_tip_length"] = (longest["female_tip"], "m", "the same for a female tip")
    for rotor, width in zip(("male", "female"), leakage.mean_widths(rotors.pair, rotors.chain), strict=True):
        meaning = f"mean thickness of a {rotor} lobe on the end face: `passage` of that leak"
        own[f"{rotor}_lobe_thickness"] = (width, "m", meaning)
    longest_line = "longest contact line of a chamber, including the part over the tip"
    own["sealing_line_length"] = (_longest_line(laid), "m", longest_line)
    over = longest["sealing_line_over_tip"]
    own["sealing_line_over_tip"] = (over, "m", "its part over the male tip: `tip_length` of interlobe_leakage")
    for wanted in dict.fromkeys((ratio, *LISTED_RATIOS)):
        try:
            angle = rotors.discharge_angle(wanted) - rotors.start
        except UsageError:
            continue
        own[f"opens_at_{wanted:g}"] = (angle, "rad", f"of a chamber's life: the port opens for Vi = {wanted:g}")
    if laid.slot is not None:
        share, volume_ratio = closed_in(rotors, laid.curves)
        trapped = "share of the largest volume that is trapped, with the slide at its position"
        own["slide_volume_share"] = (share, "1", trapped)
        own["slide_volume_ratio"] = (volume_ratio, "1", "from there to the opening of the discharge port")
    axis = {
        "scene_life": (laid.life, "in whole pitches, as the scene counts them"),
        "scene_birth": (laid.born, "the chamber is born; idle before"),
        "scene_closing": (laid.injection, "suction closes, oil is injected"),
        "scene_opening": (laid.opens, f"the discharge port opens (Vi = {ratio:g})"),
        "scene_end": (laid.ends, "the chamber ends; idle from there"),
    }
    return own | {name: (value, "rad", meaning) for name, (value, meaning) in axis.items()}


def _longest_line(laid: LaidCurves) -> float:
    """Return the largest sum of both branches [m], over all angles of either, as their tables have different rows."""
    parts = [path.curve for path in laid.curves.paths if path.name.startswith("sealing_line")]
    angle = np.unique(np.concatenate([part.angle for part in parts]))
    return float(np.max(np.sum([np.interp(angle, part.angle, part.value) for part in parts], axis=0)))


def table_text(scene: Scene) -> str:
    """Return the coefficients as printed lines."""
    found = coefficients(scene)
    lines = [with_printed_units(scene.title), ""] if scene.title else []
    faired = curves_of(scene).rotors.chain.faired
    lines += [f"measured points: {faired}", ""] if faired else []
    for name, (value, unit, meaning) in found.items():
        factor, shown = _SHOWN[unit]
        line = f"{name.replace('_', ' '):<26}{factor * value:>11.5g} {shown:<4} {meaning}"
        lines.append(textwrap.fill(line, TABLE_WIDTH, subsequent_indent=" " * 43))
    return "\n".join(lines)


def document(scene: Scene, files: list[str]) -> dict[str, Any]:
    """Return the document printed by `--json`, in SI units."""
    faired, keys = curves_of(scene).rotors.chain.faired, ("value", "units", "long_name")
    return {
        "title": scene.title,
        **({"faired": faired} if faired else {}),
        "coefficients": {name: dict(zip(keys, row, strict=True)) for name, row in coefficients(scene).items()},
        "files": files,
    }


def write(scene: Scene, folder: Path) -> list[str]:
    """Write figures, profiles, page, and tables with their scene; return all paths."""
    laid = curves_of(scene)
    machine = twin_screw(scene.machine)
    ratio, axial = _volume_ratio(scene, laid), machine.axial_volume_ratio
    tables = folder / "table"
    texts = {folder / "rotors.html": page(laid, with_printed_units(scene.title))}
    texts |= {tables / name: text for name, text in table_files(scene, tables).items()}
    protect_other_text(texts)
    written = draw_rotors(laid.rotors, ratio, folder, axial, machine.slide_valve)
    make_folder(tables)
    return written + [write_text(path, text) for path, text in texts.items()]


def table_files(scene: Scene, folder: Path) -> dict[str, str]:
    """Return {name: text} of curves over the scene's angle, with its clearances, and of a scene that reads them."""
    laid = curves_of(scene)
    files = {
        "volume.csv": _csv(laid.volume, "m^3"),
        "suction_port.csv": _csv(laid.suction, "m^2"),
        "discharge_port.csv": _csv(laid.discharge, "m^2"),
    }
    effects = _with_own_lengths(scene)
    for name, active in effects.copy().items():
        gap = next(iter(active.effect.needs.intersection(GAPS)), None)
        if gap == END_GAP:
            effects.pop(name)
        elif gap is not None:
            changes: dict[str, Any] = {"area_file": str(folder.resolve() / f"{name}.csv")}
            paths = laid.interfaces[gap]
            if gap == BLOW_HOLE:
                paths, changes["area"] = sized_holes(paths, active.parameters.area), None
            files[f"{name}.csv"] = _path_csv(paths, getattr(active.parameters, "gap", None))
            effects[name] = replace(active, parameters=replace(active.parameters, **changes))
    if laid.slot is not None and "slide_valve" in effects and not laid.slot.value.max() > 0.0:
        del effects["slide_valve"]  # at full load there is no slot
    elif laid.slot is not None and "slide_valve" in effects:
        files["slide_valve.csv"] = _csv(laid.slot, "m^2")
        parameters = replace(effects["slide_valve"].parameters, area_file=str(folder.resolve() / "slide_valve.csv"))
        effects["slide_valve"] = replace(effects["slide_valve"], parameters=parameters)
    machine = _tabled_curves(scene, laid, folder.resolve())
    tabled = replace(without_sweep(scene), machine=machine, effects=effects, folder=str(folder.resolve()))
    return {**files, "scene.yaml": _TABLE_NOTE + scene_text(tabled)}


def _with_own_lengths(scene: Scene) -> dict[str, ActiveEffect]:
    """Return the effects of a scene with the lengths that they take from its profile, where they state none."""
    found, profile = dict(scene.effects), twin_screw(scene.machine).profile
    for name, active in scene.effects.items():
        own = {
            key: plain(getattr(profile, length))
            for key, length in OF_PROFILE.items()
            if getattr(active.parameters, key, 0.0) is None
        }
        if own:
            found[name] = replace(active, parameters=replace(active.parameters, **own))
    return found


def _csv(table: Table, unit: str) -> str:
    """Return a table up to where it ends, without the row of zero that says so to the machine's own splines."""
    inside = table.angle <= table.ends[1] + SAME_ANGLE
    return curve_csv(Curve(table.angle[inside], table.value[inside], unit, ()))


def _path_csv(interfaces: tuple[Interface, ...], gap: float | None) -> str:
    """Return the sum of all interfaces with the first one's offset (such as blow-holes at both cusps) as one table."""
    tables = [interface.table for interface in interfaces if interface.offset == interfaces[0].offset]
    angle = np.unique(np.concatenate([table.angle for table in tables]).round(9))
    angle = angle[angle <= max(table.ends[1] for table in tables) + SAME_ANGLE]
    value = np.sum([np.interp(angle, table.angle, table.value, left=0.0, right=0.0) for table in tables], axis=0)
    return curve_csv(Curve(angle, (gap or 1.0) * value, "m^2", ()))


def _tabled_curves(scene: Scene, laid: LaidCurves, folder: Path) -> Any:
    machine = twin_screw(scene.machine)
    sizes = ("rotor_diameter", "rotor_length", "male_lobes", "female_lobes")
    size = {"max": laid.swept, "min": machine.volume.dead_of(laid.swept)}
    angles = {"life": laid.life, "injection_angle": laid.injection}
    volume = replace(machine.volume, law="table", file=str(folder / "volume.csv"), **size, **angles)
    ports = {
        name: replace(port, law="table", file=str(folder / f"{name}.csv"))
        for name in ("suction_port", "discharge_port")
        if (port := getattr(machine, name)) is not None and port.from_rotors
    }
    stated = {name: plain(getattr(machine, name)) for name in sizes}
    rotors = ["profile", "displacement", "axial_volume_ratio", "slide_valve"]
    if "discharge_port" in ports:  # a table of the scene's own stays, and with it the ratio to which it is moved
        rotors.append("built_in_volume_ratio")
    more: dict[str, Any] = {**dict.fromkeys(rotors), **ports, **stated}
    return replace(machine, volume=volume, **more)
