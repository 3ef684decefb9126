"""What configs/r134a/point.yaml leaves out, and how large each is at 2/45 °C, 2950 rpm: estimates, no evidence."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, log, pi
from pathlib import Path

import CoolProp.CoolProp as coolprop
from scipy.optimize import brentq

from screwsim.outputs import Figures
from screwsim.scene import Scene, load
from screwsim.study.validation import Comparison, Row, sibling, solved

TITLE = "What the validated scenes leave out"
CITATION = "Estimates by the formulas in the notes; solubility: Grebner 1992 with the Heil model"
ABOUT = (
    "Each row is the size of one thing that the scenes of this page leave out or take as given, at R134a 2/45 °C and "
    "2950 rpm. None is held against a measurement. Refrigerant in the oil, the room of the oil and heat of walls can "
    "be simulated instead: effects.refrigerant_solubility, oil_volume and wall_heat (effects.md)."
)
GAS_CONSTANT, M_R134A, M_OIL = 8.314462618, 0.102032, 0.590
WALL, CASING = 100.0, 10.0  # [W/(m² K)] gas to wall inside; outside of the casing, free convection and radiation
AMBIENT = 298.15  # [K]


def log_activity(x: float, T: float) -> float:
    """Return the logarithm of the activity of R134a in a solution with its mole fraction x (Heil)."""
    v_1 = M_R134A / coolprop.PropsSI("D", "T", T, "Q", 0, "R134a")
    v_2 = M_OIL / (16.0185 * (61.387 - 0.024138 * (1.8 * T - 459.67)))
    t_12, t_21 = 948.0 / (GAS_CONSTANT * T), 3993.0 / (GAS_CONSTANT * T)
    l_12, l_21 = v_2 / v_1 * exp(-t_12), v_1 / v_2 * exp(-t_21)
    y = 1.0 - x
    first, second = x + l_12 * y, l_21 * x + y
    gamma = -log(first) + y * (l_12 / first - l_21 / second)
    gamma += y**2 * (t_12 * (l_12 / first) ** 2 + t_21 * l_21 / second**2)
    return gamma + log(x)


def dissolved(T: float, p: float) -> float:
    """Return kg of R134a per kg of solution in equilibrium: where its chemical potential is that of the vapour."""
    saturated = coolprop.PropsSI("GMOLAR", "T", T, "Q", 1, "R134a")
    wanted = (coolprop.PropsSI("GMOLAR", "T|gas", T, "P", p, "R134a") - saturated) / (GAS_CONSTANT * T)
    x = float(brentq(lambda x: log_activity(x, T) - wanted, 1e-6, 1.0 - 1e-9))
    return x * M_R134A / (x * M_R134A + (1.0 - x) * M_OIL)


def estimate(quantity: str, size: float, unit: str, note: str) -> Row:
    """Return the row of a size."""
    return Row(quantity, size, None, "estimate", "no verdict", unit, note=note)


def flash_row(found: Figures) -> Row:
    """Return the gas that leaves the injected oil, over the gas in the chamber."""
    T, d = found.oil_supply_temperature, found.oil_ratio
    rich, lean = dissolved(T, found.discharge_pressure), dissolved(T, found.injection_pressure)
    share = d * (rich / (1.0 - rich) - lean / (1.0 - lean))
    return estimate(
        "refrigerant that flashes from the injected oil, over the gas in the chamber",
        100.0 * share,
        "%",
        f"equilibrium at {T - 273.15:.0f} °C: {rich:.3f} kg/kg of solution in the separator, {lean:.3f} at injection; "
        f"d = {d:g}; an upper bound, as flashing takes time",
    )


def oil_volume_rows(scene: Scene, found: Figures) -> list[Row]:
    """Return the room that oil would take at 360° and when the discharge port opens."""
    exact = sibling(Path(__file__).parents[1] / "exact" / "compare.py")
    assert scene.oil is not None
    volume = found.oil_ratio * found.trapped_mass / scene.oil.density
    swept, v = scene.machine.volume.max, exact.built_in_ratio(scene)
    note = f"d m/ρ_o over V, d = {found.oil_ratio:g}; three times that at d = 3"
    return [
        estimate("room the oil takes at 360°", 100.0 * volume / swept, "%", note),
        estimate("room the oil takes when the discharge port opens", 100.0 * volume * v / swept, "%", note),
    ]


def wall_rows(scene: Scene, found: Figures) -> list[Row]:
    """Return heat through the casing over shaft power, and the warming of suction gas by the rotors."""
    machine = scene.machine
    D, L, V = machine.rotor_diameter, machine.rotor_length, machine.volume.max
    casing = pi * 2.0 * D * 2.0 * L + 0.5 * pi * (2.0 * D) ** 2
    outside = CASING * casing * (found.discharge_temperature - AMBIENT)
    time = 2.0 * pi / scene.operation.speed
    inside = WALL * 6.0 * V ** (2.0 / 3.0) * (found.oil_supply_temperature - found.suction_temperature) * time
    c_p = coolprop.PropsSI("CPMASS", "T", found.suction_temperature, "P", found.suction_pressure, "R134a")
    warming = inside / (found.trapped_mass * c_p)
    return [
        estimate(
            "heat through the casing, over shaft power",
            100.0 * outside / found.shaft_power,
            "%",
            f"{CASING:g} W/(m² K) on a cylinder 2D by 2L, {casing:.2f} m², all at the discharge temperature",
        ),
        estimate(
            "volumetric efficiency lost to walls that warm the suction gas",
            -100.0 * warming / found.suction_temperature,
            "points",
            f"{WALL:g} W/(m² K) on 6 V^(2/3) for one turn, walls at the oil's temperature: {warming:.2f} K",
        ),
    ]


def change_row(name: str, file: Path, base: Figures, changes: Sequence[str], figure: str, note: str) -> Row:
    """Return by how many points an efficiency changes with another parameter."""
    other = solved(file, changes).performance
    return estimate(name, 100.0 * (other[figure] - base[figure]), "points", note)


def given_rows(file: Path, base: Figures) -> list[Row]:
    """Return what the parameters that nobody knows are worth."""
    size = f"{0.5e6 * base.droplet_diameter:.4g} um"
    jet = ("orifice_diameter", "jet_pressure", "surface_tension")
    finer = (
        *(f"effects.droplets.{name}=null" for name in jet),
        "effects.droplets.size=fixed",
        f"effects.droplets.diameter={size}",
    )
    gaps = ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage")
    tight = [f"effects.{name}.flow_coefficient=0.6" for name in gaps]
    sealed = [f"effects.{name}.flow_coefficient=1e-4" for name in gaps]
    droplets = [
        change_row(f"{figure.replace('_', ' ')}, {what}", file, base, changes, figure, note)
        for what, changes, note in (
            ("droplets half as large", finer, "their size is that of a jet, of which correlations differ tenfold"),
            ("droplets at rest in the gas", ("effects.droplets.slip=0",), "Nu = 2 instead of some 13"),
            ("droplets at a third of the tip speed", ("effects.droplets.slip=0.33",), "as fast as they fall outwards"),
        )
        for figure in ("volumetric_efficiency", "isentropic_efficiency")
    ]
    return [
        *droplets,
        change_row(
            "volumetric efficiency, gaps of 0.6 instead of 0.7",
            file,
            base,
            tight,
            "volumetric_efficiency",
            "flow coefficient of all gaps: taken, not measured",
        ),
        change_row(
            "volumetric efficiency, gaps sealed by oil altogether",
            file,
            base,
            sealed,
            "volumetric_efficiency",
            "gaps pass gas that their oil slows (M192): the most that oil could gain",
        ),
        change_row(
            "isentropic efficiency, a mechanical loss of 5 %",
            file,
            base,
            ("effects.mechanical.fraction=0.05",),
            "isentropic_efficiency",
            "instead of 9 %: fitted, within bounds of 3 to 15 %",
        ),
    ]


def nozzle_row(sealed: float) -> Row:
    """Return what the local exponent of a choked nozzle is worth in volumetric efficiency."""
    loss = 0.01 * sealed
    return estimate(
        "volumetric efficiency, real gas in choked gaps",
        0.015 * 100.0 * loss,
        "points",
        "1.5 % of the leak (docs/model.md, M48)",
    )


def compare(here: Path) -> Comparison:
    """Return all sizes."""
    file = here.parents[1] / "configs" / "r134a" / "point.yaml"
    scene = load(file)
    base = solved(file).performance
    given = given_rows(file, base)
    sealed = next(row.ours for row in given if "sealed" in row.quantity)
    assert isinstance(sealed, float)
    rows = [
        flash_row(base),
        *oil_volume_rows(scene, base),
        *wall_rows(scene, base),
        *given,
        nozzle_row(sealed),
    ]
    return Comparison(TITLE, CITATION, ABOUT, rows)
