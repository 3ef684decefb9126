"""Scenes for flooded.py, and their numbers as that wants them."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, pi, sqrt
from pathlib import Path
from typing import Any

from CoolProp.CoolProp import PropsSI

from screwsim.build import WIDTH, build_gas
from screwsim.scene import Scene
from screwsim.study.validation import sibling

COMMON = (
    "operation.speed=1500 rpm",
    "oil.transport=carried",
    "effects.hydromechanical=off",
    "effects.oil_pump=off",
    "effects.oil_heat=off",
    "effects.droplets={diameter: 0.1 mm, slip: 0.1}",
    "effects.oil_injection={opens: 365 deg, closes: 455 deg}",
    "effects.oil_volume={}",
    "effects.suction_line={}",
    "effects.shaft_leakage={shaft_diameter: 70 mm, clearance: 60 um, model: oil_sealed, mixture_viscosity: mcadams, "
    "passage: 15 mm}",
    "effects.blow_hole={suction_area: 129 mm^2}",
)
FLOODED = {  # by name, changes of configs/paper/point.yaml
    "displaced oil, sealed gaps, a slide": (
        *COMMON,
        "oil_supply={kind: displacement, orifice_diameter: 5 mm, ratio: null}",
        "effects.tip_leakage={model: oil_sealed, mixture_viscosity: cicchitti, passage: 2 mm}",
        "effects.end_face_leakage={model: oil_sealed, mixture_viscosity: mcadams, passage: 10 mm}",
        "effects.interlobe_leakage={model: nozzle_friction, friction_fit: flank, passage: 10 mm, tip_length: 48 mm}",
        "effects.slide_valve={position: 0.3, slot_area: 20 cm^2, closes: 500 deg}",
    ),
    "pumped oil, gaps full of it": (
        *COMMON,
        "oil_supply.ratio=2",
        "effects.tip_leakage={model: oil_film, filled_from: 0.5, passage: 2 mm}",
        "effects.end_face_leakage={model: oil_film, filled_from: 0.5, passage: 10 mm}",
        "effects.interlobe_leakage={model: nozzle_friction, friction_fit: radial, passage: 5 mm}",
    ),
}
FULL_TIPS = 9.83  # tip length of a chamber over the diameter (M19)
WRAP, LENGTH, AXES = 300.0, 1.1, 0.8  # usual rotors of M256: wrap [degree], length and distance of the axes over D

Area = Callable[[float], float]


def gaps_of(scene: Scene, plain: Any) -> tuple[Any, ...]:
    """Return the gaps of a scene (M21, M22, M260-M263), and oil that walls drag through them (M256)."""
    lobes, D = scene.machine.male_lobes, scene.machine.rotor_diameter
    pitch, k = 360.0 / lobes, lobes / scene.machine.female_lobes
    p = {name: active.parameters for name, active in scene.effects.items()}
    tip, lobe, end, hole = p["tip_leakage"], p["interlobe_leakage"], p["end_face_leakage"], p["blow_hole"]
    ramp, smooth = plain.ramp, plain.smooth
    over_tip = lobe.tip_length or 0.0

    def tips(at: float) -> float:
        beyond = at + 0.5 * pitch
        share = beyond / 360.0 if beyond < 360.0 else max(0.0, 2.0 - beyond / 360.0)
        return 0.5 * FULL_TIPS * tip.gap * D * share * smooth(at / 20.0)

    def flanks(at: float) -> float:
        if not over_tip:
            return lobe.gap * lobe.length * max(0.0, min(1.0, at / 60.0, (360.0 - at) / 130.0))
        whole = max(0.0, min(1.0, (at + 40.0) / 100.0, (360.0 - at) / 105.0))
        return lobe.gap * (lobe.length - over_tip) * whole * smooth(at / 20.0)

    def across_tip(at: float) -> float:
        return lobe.gap * over_tip * ramp(at, 0.0, 20.0, 330.0 - pitch, 360.0 - pitch)

    def cusp(at: float) -> float:
        high = hole.area * ramp(at + pitch, 373.0, 393.0, 673.0, 693.0)
        return high + hole.suction_area * ramp(at + pitch, 340.0, 360.0, 380.0, 420.0)

    def face(ahead: int, share: float) -> Area:
        return lambda at: end.gap * end.length * share * ramp(at + ahead * pitch, 360.0, 380.0, 700.0, 720.0)

    rise = LENGTH * D * 180.0 / (pi * WRAP)
    r, near = 0.5 * D, 0.5 * k * D
    over_tips = rise * (r + near) / (r * (sqrt(r**2 + rise**2) + sqrt(near**2 + rise**2)))
    over_faces = AXES * (1.0 + k) / 2.0

    def gap(area: Area, ahead: int, of: Any, speed: float = 0.0) -> Any:
        rule = of.friction_fit or of.mixture_viscosity or ""
        filled = of.filled_from or 0.0
        return plain.Gap(area, ahead, 0.7, of.model, of.passage, of.gap, rule, filled, speed)

    return (
        gap(tips, 1, tip, over_tips),
        gap(flanks, lobes, lobe),
        gap(across_tip, lobes + 1, lobe),
        plain.Gap(cusp, 1),
        gap(face(1, 0.75), 1, end, over_faces),
        gap(face(lobes, 0.25), lobes, end),
    )


def machine_of(scene: Scene) -> Any:
    """Return the numbers of a scene as flooded.py wants them."""
    plain = sibling(Path(__file__).parent / "flooded.py")
    m, gas, supply, operation = scene.machine, build_gas(scene), scene.oil_supply, scene.operation
    p = {name: active.parameters for name, active in scene.effects.items()}
    drops, shafts, port, slide = p["droplets"], p["shaft_leakage"], p["oil_injection"], p.get("slide_valve")
    u = 0.5 * operation.speed * m.rotor_diameter
    at = ("T", max(operation.suction.temperature, supply.temperature), "P", operation.suction.pressure, scene.gas.fluid)
    conducts, mu, Pr = (PropsSI(each, *at) for each in ("L", "V", "PRANDTL"))
    d, rho_o = drops.diameter, scene.oil.density
    phi_A, phi_B = degrees(m.volume.phi_A), degrees(m.suction_port.phi_B)
    phi_dis, phi_C = degrees(m.discharge_port.opens), degrees(m.discharge_port.phi_C)
    half, phi_x = 0.5 * (720.0 - phi_dis), 360.0
    if slide is not None:
        phi_x += slide.position * (degrees(slide.closes) - 360.0)
    opens, closes = degrees(port.opens), degrees(port.closes)

    def slot(angle: float) -> float:
        if slide is None:
            return 0.0
        return slide.position * slide.slot_area * plain.ramp(angle, 300.0, 310.0, phi_x - 10.0, phi_x)

    breaks = (0.0, 20.0, 60.0, 230.0, 255.0, 315.0, phi_A, 720.0 - phi_A, phi_B, 360.0 - phi_B, phi_dis, phi_C)
    breaks += (720.0 + phi_dis - phi_C, 310.0, phi_x - 10.0, phi_x, opens, opens + 10.0, closes - 10.0, closes)
    return plain.Machine(
        lobes=m.male_lobes,
        D=m.rotor_diameter,
        V_max=m.volume.max,
        V_min=1e-4 * m.volume.max,
        phi_A=phi_A,
        suction=lambda angle: m.suction_port.area * plain.bump(angle / 180.0, phi_B / 180.0)[0],
        discharge=lambda angle: (
            m.discharge_port.area * plain.bump((angle - phi_dis) / half, (phi_C - phi_dis) / half)[0]
        ),
        slot=slot,
        gaps=gaps_of(scene, plain),
        breaks=breaks,
        k=gas.k,
        R=gas.R,
        mu_gas=mu,
        rho_o=rho_o,
        c_o=scene.oil.heat_capacity,
        mu_o=scene.oil.viscosity,
        omega=operation.speed,
        p_s=operation.suction.pressure,
        T_s=operation.suction.temperature,
        p_d=operation.discharge.pressure,
        T_inj=supply.temperature,
        bore=supply.orifice_diameter or 0.0,
        ratio=supply.ratio or 0.0,
        window=(opens, closes),
        heat=(12.0 * conducts / (d**2 * rho_o), 0.3 * sqrt(drops.slip * u * d / mu) * Pr ** (1.0 / 3.0)),
        shafts=(
            0.7 * shafts.shafts * pi * (shafts.shaft_diameter + shafts.clearance) * shafts.clearance,
            shafts.clearance,
            shafts.passage,
        ),
        mechanical_fraction=p["mechanical"].fraction,
        width=WIDTH * scene.numerics.accuracy,
    )
