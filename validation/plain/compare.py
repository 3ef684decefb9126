"""The package against plain.py, chamber.py, flooded.py and cylinder.py, the equations written a second time."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi
from pathlib import Path
from typing import Any, NamedTuple

from CoolProp import CoolProp
from CoolProp.CoolProp import PropsSI

from screwsim.build import WIDTH, build_gas
from screwsim.scene import Scene, load
from screwsim.study.validation import Comparison, Row, equal, read_table, sibling, solved

TOLERANCE = 1e-6
ACCURACIES = (1e-3, 3e-4, 1e-4, 1e-5)
TIGHT = ("numerics.accuracy=1e-6", "numerics.rtol=1e-9", "numerics.error=none")
HEAT = {"annand": (0.575, 0.7, 0.0), "destoop": (0.6, 0.8, 0.6)}  # a, b, c of S30
CYLINDERS = {  # by name, changes of configs/slider_crank/air.yaml
    "reeds, rings, walls": (),
    "ideal valves, rings, walls by Destoop": (
        "effects.reed_valves=off",
        "effects.check_valves={suction_area: 52 cm^2, discharge_area: 40 cm^2}",
        "effects.cylinder_heat.correlation=destoop",
    ),
}
GAPS = ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage")
TIGHT_CHAMBER = tuple(f"effects.{each}=off" for each in GAPS)
COMPRESSING = (
    "machine.mode=compressor",
    "effects.motor=off",
    "gas.two_phase=equilibrium",
    "operation.suction=null",
    "operation.discharge=null",
    "operation.evaporating_temperature=2 degC",
    "operation.condensing_temperature=45 degC",
)
CHAMBERS = {  # by name, changes of configs/expander/point.yaml; two phases of R134a between 250 K and 360 K
    "wet suction, 90 % vapour": (*COMPRESSING, "operation.suction={quality: 0.9}"),
    "liquid injected, 10 K of superheat": (
        *COMPRESSING,
        "operation.superheat=10 K",
        "effects.liquid_injection={opens: 450 deg, closes: 550 deg, area: 2 mm^2}",
    ),
    "economizer, and gas pushed back into it": (
        *COMPRESSING,
        "operation.superheat=10 K",
        "effects.economizer={temperature: 15 degC, opens: 380 deg, closes: 560 deg, area: 6 cm^2}",
    ),
    "expander, wet at its outlet": (
        "operation.suction.temperature=70 degC",
        "operation.discharge.pressure=4 bar",
        "gas.two_phase=equilibrium",
    ),
}
PLENUMS = ("liquid_injection", "economizer")
SHOWN = ("isothermal_efficiency", "volumetric_efficiency", "isentropic_efficiency")
TITLE = "Package against the equations in plain Python"
CITATION = (
    "validation/plain/plain.py: equations of Chernov et al. 2015, docs/model.md, chamber.py: the same of "
    "a real fluid, flooded.py: of oil and gaps, and cylinder.py: docs/reference/slider-crank.md, integrated by scipy's "
    "LSODA"
)
ABOUT = (
    "plain.py, chamber.py, flooded.py and cylinder.py share no line with the package, but the numbers of the scene, k "
    "and R of an ideal gas; a real fluid is CoolProp's in one phase and at saturation, to whose equations the "
    "package's are held elsewhere, and what both phases make of it is written again. All have the stated width of the "
    "root near equal pressures. Figures of the paper's machine, of a tight chamber on R134a, of a flooded machine "
    "with models of gaps and of a cylinder of air are compared; the one that differs most is shown."
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
        width=WIDTH * scene.numerics.accuracy,
    )


def plain_figures(machine: Any) -> dict[str, float]:
    """Return the figures of plain.py."""
    plain = sibling(Path(__file__).parent / "plain.py")
    return plain.figures(machine, plain.close(machine))


def cylinder_of(scene: Scene) -> Any:
    """Return the numbers of a scene as cylinder.py wants them."""
    plain = sibling(Path(__file__).parent / "cylinder.py")
    m, gas, operation = scene.machine, build_gas(scene), scene.operation
    p = {name: active.parameters for name, active in scene.effects.items()}
    reed, ideal, ring, wall = (p.get(name) for name in ("reed_valves", "check_valves", "ring_leakage", "cylinder_heat"))
    sides = ("suction", "discharge")
    parts = ("port_area", "perimeter", "stop", "mass", "stiffness", "preload")
    made = (plain.Reed(*(getattr(reed, f"{side}_{part}") for part in parts)) for side in sides)
    p_s, T_s = operation.suction.pressure, operation.suction.temperature
    at = ("T", max(T_s, wall.wall_temperature), "P", p_s, scene.gas.fluid)
    return plain.Cylinder(
        bore=m.bore,
        crank=m.crank_radius,
        rod=m.rod_length,
        offset=m.offset,
        clearance=m.clearance,
        k=gas.k,
        R=gas.R,
        omega=operation.speed,
        p_s=p_s,
        T_s=T_s,
        p_d=operation.discharge.pressure,
        mu=(reed or ideal).flow_coefficient,
        areas=(ideal.suction_area, ideal.discharge_area) if ideal else (0.0, 0.0),
        reeds=tuple(made) if reed else None,
        damping=reed.damping_ratio if reed else 0.0,
        seat=reed.seat_restitution if reed else 0.0,
        stop=reed.stop_restitution if reed else 0.0,
        force=reed.force_coefficient if reed else 1.0,
        ring=ring.flow_coefficient * pi * m.bore * ring.gap,
        T_wall=wall.wall_temperature,
        heat=HEAT[wall.correlation],
        gas=(PropsSI("L", *at), PropsSI("V", *at), PropsSI("PRANDTL", *at)),
        mechanical_fraction=p["mechanical"].fraction,
        width=WIDTH * scene.numerics.accuracy,
    )


def cylinder_figures(machine: Any) -> dict[str, float]:
    """Return the figures of cylinder.py."""
    return sibling(Path(__file__).parent / "cylinder.py").figures(machine)


def chamber_of(scene: Scene) -> Any:
    """Return the numbers of a scene as chamber.py wants them; states by CoolProp, which it asks itself."""
    plain = sibling(Path(__file__).parent / "chamber.py")
    m, at, liquid, port = scene.machine, scene.operation, None, None
    fluid = plain.Fluid(scene.gas.fluid, 250.0, 360.0)
    if at.condensing_temperature is None:
        sucked, p_d = fluid.of(CoolProp.PT_INPUTS, at.suction.pressure, at.suction.temperature), at.discharge.pressure
    else:
        liquid = fluid.of(CoolProp.QT_INPUTS, 0.0, at.condensing_temperature)
        vapour, p_d = fluid.of(CoolProp.QT_INPUTS, 1.0, at.evaporating_temperature), liquid.p
        dry = (CoolProp.PT_INPUTS, vapour.p, at.evaporating_temperature + (at.superheat or 0.0))
        wet = (CoolProp.PQ_INPUTS, vapour.p, at.suction.quality)
        sucked = fluid.of(*(dry if at.suction.quality is None else wet))
    for name in PLENUMS:
        if name in scene.effects:
            p = scene.effects[name].parameters
            held = liquid if name == "liquid_injection" else fluid.of(CoolProp.QT_INPUTS, 1.0, p.temperature)
            port = plain.Port(p.flow_coefficient * p.area, degrees(p.opens), degrees(p.closes), held)
    return plain.Chamber(
        fluid=fluid,
        lobes=m.male_lobes,
        V_max=m.volume.max,
        V_min=1e-4 * m.volume.max,
        phi_A=degrees(m.volume.phi_A),
        suction=(m.suction_port.area, degrees(m.suction_port.phi_B)),
        discharge=(m.discharge_port.area, degrees(m.discharge_port.opens), degrees(m.discharge_port.phi_C)),
        omega=at.speed,
        sucked=sucked,
        p_d=p_d,
        mechanical_fraction=scene.effects["mechanical"].parameters.fraction,
        width=WIDTH * scene.numerics.accuracy,
        liquid=liquid,
        port=port,
        backwards=m.mode == "expander",
    )


def chamber_figures(scene: Scene) -> dict[str, float]:
    """Return the figures of chamber.py, those of its port by the name of the effect."""
    found = sibling(Path(__file__).parent / "chamber.py").figures(chamber_of(scene))
    drawn = found.pop("drawn", None)
    return found | {f"{name}_mass_flow": drawn for name in PLENUMS if name in scene.effects}


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


def cylinder_points(here: Path) -> list[Point]:
    """Return the points of a cylinder."""
    scene_file = here.parents[1] / "configs" / "slider_crank" / "air.yaml"
    return [Point(f"cylinder, {name}", (scene_file, (*changes, *TIGHT))) for name, changes in CYLINDERS.items()]


def chamber_points(here: Path) -> list[Point]:
    """Return the points of a tight chamber on a real fluid."""
    scene_file = here.parents[1] / "configs" / "expander" / "point.yaml"
    every = {f"tight chamber, {name}": (*TIGHT_CHAMBER, *changes, *TIGHT) for name, changes in CHAMBERS.items()}
    return [Point(name, (scene_file, changes)) for name, changes in every.items()]


def flooded_points(here: Path) -> list[Point]:
    """Return the points of a flooded machine."""
    scenes = sibling(here / "flooded_scenes.py")
    scene_file = here.parents[1] / "configs" / "paper" / "point.yaml"
    return [Point(f"flooded, {name}", (scene_file, (*changes, *TIGHT))) for name, changes in scenes.FLOODED.items()]


def flooded_figures(here: Path, scene: Scene) -> dict[str, float]:
    """Return the figures of flooded.py."""
    return sibling(here / "flooded.py").figures(sibling(here / "flooded_scenes.py").machine_of(scene))


def compared(point: Point, theirs: dict[str, float]) -> Row:
    """Return the row of the figure that differs most."""
    name, ours = point.name, dict(solved(*point.asked).performance)
    worst = max(theirs, key=lambda figure: abs(ours[figure] / theirs[figure] - 1.0))
    shown = next(each for each in SHOWN if each in theirs)
    return equal(
        f"{name}: largest difference of {len(theirs)} figures",
        abs(ours[worst] / theirs[worst] - 1.0),
        0.0,
        TOLERANCE,
        "cross-code",
        basis="both integrated to 1e-8 or better a step",
        note=f"of {worst}; {shown.replace('_', ' ')} {ours[shown]:.8f} here, {theirs[shown]:.8f} there",
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
    rows += [compared(each, cylinder_figures(cylinder_of(load(*each.asked)))) for each in cylinder_points(here)]
    rows += [compared(each, chamber_figures(load(*each.asked))) for each in chamber_points(here)]
    rows += [compared(each, flooded_figures(here, load(*each.asked))) for each in flooded_points(here)]
    return Comparison(TITLE, CITATION, ABOUT, rows)
