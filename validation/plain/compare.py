"""The package against plain.py, the paper's equations written a second time, at three points."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from pathlib import Path
from typing import Any, NamedTuple

from screwsim.build import build_gas
from screwsim.scene import Scene, load
from screwsim.study.validation import Comparison, Row, equal, read_table, sibling, solved

TOLERANCE = 1e-6
ACCURACIES = (1e-3, 3e-4, 1e-4, 1e-5)
WIDTH = 1e-6  # of the regularised root, over the line's pressure: numerics.accuracy gives it
TIGHT = ("numerics.accuracy=1e-6", "numerics.rtol=1e-9", "numerics.error=none")
TITLE = "Package against the equations in plain Python"
CITATION = "validation/plain/plain.py: equations of Chernov et al. 2015, docs/model.md, integrated by scipy's LSODA"
ABOUT = (
    "plain.py shares no line with the package. Both have the stated width of the root near equal pressures, 1e-6 of "
    "the line's pressure. All figures of the paper's machine are compared; the one that differs most is shown."
)


def machine_of(scene: Scene) -> Any:
    """Return the numbers of a scene as plain.py wants them."""
    plain = sibling(Path(__file__).parent / "plain.py")
    m, gas, supply, operation = scene.machine, build_gas(scene), scene.oil_supply, scene.operation
    p = {name: active.parameters for name, active in scene.effects.items()}
    tip, lobe, end = p["tip_leakage"], p["interlobe_leakage"], p["end_face_leakage"]
    return plain.Machine(
        lobes=m.male_lobes,
        D=m.rotor_diameter,
        V_max=m.volume.max,
        V_min=1e-4 * m.volume.max,
        phi_A=degrees(m.volume.phi_A),
        S_suc=m.suction_port.area,
        phi_B=degrees(m.suction_port.phi_B),
        S_dis=m.discharge_port.area,
        phi_dis=degrees(m.discharge_port.opens),
        phi_C=degrees(m.discharge_port.phi_C),
        k=gas.k,
        R=gas.R,
        rho_oil=scene.oil.density,
        c_oil=scene.oil.heat_capacity,
        carried=scene.oil.transport == "carried",
        omega=operation.speed,
        p_s=operation.suction.pressure,
        T_s=operation.suction.temperature,
        p_d=operation.discharge.pressure,
        d=supply.ratio,
        T_inj=supply.temperature,
        mu_port=1.0,
        mu_gap=0.7,
        h_tip=tip.gap,
        h_interlobe=lobe.gap,
        l_interlobe=lobe.length,
        A_blow_hole=p["blow_hole"].area,
        h_end_face=end.gap,
        l_end_face=end.length,
        suction_share=0.25,
        r=p["oil_heat"].droplet_radius,
        alpha=p["oil_heat"].heat_transfer_coefficient,
        pump_efficiency=p["oil_pump"].efficiency,
        pump_loss=p["oil_pump"].pressure_loss,
        acceleration_factor=p["hydromechanical"].acceleration_factor,
        mechanical_fraction=p["mechanical"].fraction,
        width=WIDTH,
    )


def plain_figures(machine: Any) -> dict[str, float]:
    """Return the figures of plain.py."""
    plain = sibling(Path(__file__).parent / "plain.py")
    return plain.figures(machine, plain.close(machine))


class Point(NamedTuple):
    """A point's name, and its scene: a file and what is changed in it."""

    name: str
    asked: tuple[Path, tuple[str, ...]]


def points(here: Path) -> list[Point]:
    """Return the points of points.csv."""
    scene_file, found = here.parents[1] / "configs" / "paper" / "point.yaml", []
    for row in read_table(here / "points.csv"):
        name = f"{row['speed_rpm']} rpm, d = {row['oil_ratio']}, oil.transport: {row['transport']}"
        changes = (f"operation.speed={row['speed_rpm']} rpm", f"oil_supply.ratio={row['oil_ratio']}")
        found.append(Point(name, (scene_file, (*changes, f"oil.transport={row['transport']}", *TIGHT))))
    return found


def compared(point: Point, theirs: dict[str, float]) -> Row:
    """Return the row of the figure that differs most."""
    name, ours = point.name, dict(solved(*point.asked).performance)
    worst = max(theirs, key=lambda figure: abs(ours[figure] / theirs[figure] - 1.0))
    return equal(
        f"{name}: largest difference of {len(theirs)} figures",
        abs(ours[worst] / theirs[worst] - 1.0),
        0.0,
        TOLERANCE,
        "cross-code",
        basis="both integrated to 1e-8 or better a step",
        note=f"of {worst}; isothermal efficiency {ours['isothermal_efficiency']:.8f} here, "
        f"{theirs['isothermal_efficiency']:.8f} there",
    )


def kept_row(scene_file: Path, overrides: Sequence[str], theirs: dict[str, float], accuracy: float) -> Row:
    """Return the true error of the isothermal efficiency at an accuracy as a user asks for it."""
    asked = [each for each in overrides if not each.startswith("numerics.")]
    found = solved(scene_file, (*asked, f"numerics.accuracy={accuracy:g}"))
    size = abs(found.performance.isothermal_efficiency / theirs["isothermal_efficiency"] - 1.0)
    return equal(
        f"1000 rpm, d = 3: error of the isothermal efficiency where {accuracy:g} is asked for",
        size,
        0.0,
        accuracy,
        "cross-code",
        basis="the accuracy asked for",
        note=f"the result itself says {found.error.isothermal_efficiency:.1e}",
    )


def compare(here: Path) -> Comparison:
    """Return one row a point."""
    every = points(here)
    theirs = [plain_figures(machine_of(load(*point.asked))) for point in every]
    rows = [compared(*each) for each in zip(every, theirs, strict=True)]
    rows += [kept_row(*every[1].asked, theirs[1], accuracy) for accuracy in ACCURACIES]
    return Comparison(TITLE, CITATION, ABOUT, rows)
