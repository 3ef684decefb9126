"""Print one table of every effect, alone on the paper's machine: what its source says, what we find, where it vanishes.

Run: .venv/bin/python scripts/each_effect.py [NAME]… Each row is a scene with the effect against the same without it.
The machine is that of configs/paper/point.yaml, 1000 rpm; "carried" lets leaks carry oil, "condenser" gives it R134a as
a real gas between -21.6 and 44.7 °C, the saturation temperatures of the paper's pressures.
tests/effects/test_each_effect.py holds that each row closes, and that the effect vanishes in its limit.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

from screwsim.outputs import Result
from screwsim.scene import Scene, load
from screwsim.simulate import simulate

POINT = Path(__file__).resolve().parent.parent / "configs" / "paper" / "point.yaml"
CARRIED = ("oil.transport=carried",)
CONDENSER = (
    *CARRIED,
    "gas={model: real, two_phase: equilibrium}",
    "operation.suction=null",
    "operation.discharge=null",
    "operation.evaporating_temperature=-21.6 degC",
    "operation.condensing_temperature=44.7 degC",
    "operation.superheat=27.4 K",
    "oil_supply.temperature=325 K",
    "oil_supply.ratio=1",
)
BORE = (*CARRIED, "oil_supply={kind: displacement, ratio: null, orifice_diameter: 6 mm}", "effects.oil_pump=off")
WALLS = "effects.wall_heat={rotor_area: 400 cm^2, housing_area: 150 cm^2, characteristic_length: 58 mm}"
NO_HEAT = "effects.oil_heat=off"
TABLE_HEAD = "| effect | scene | its source says | source | ours | vanishes with | evaluations | balance over bound |"


class Row(NamedTuple):
    """One effect: what its scene sets, what the effect sets, its source, its limit, figures of its own.

    `zero` are figures that vanish in the limit beside the changes; `whole` says that leaving the effect out leaves no
    compressor, so that it has no limit.
    """

    sets: tuple[str, ...]
    scene: str
    says: str
    source: str
    limit: tuple[str, ...]
    own: tuple[str, ...] = ()
    zero: tuple[str, ...] = ()
    base: tuple[str, ...] = ()  # what both scenes set
    whole: bool = False
    plain: tuple[str, ...] | None = None  # in place of leaving the effect out: what the other scene sets beside base


PAPER, CHERNOV = "paper", "Chernov et al. 2015"
ROWS: dict[str, Row] = {
    "suction_port": Row((), PAPER, "area of M17; no number", CHERNOV, (), whole=True),
    "discharge_port": Row((), PAPER, "area of M18; no number", CHERNOV, (), whole=True),
    "tip_leakage": Row(
        (), PAPER, "leaks take flow; length 9.83 D (M19)", CHERNOV, ("effects.tip_leakage.flow_coefficient=0",)
    ),
    "tip_leakage, nozzle_friction": Row(
        ("effects.tip_leakage={model: nozzle_friction, friction_fit: radial, passage: 2 mm}",),
        PAPER,
        "of slow gas passes Re/22 050 (5 mm deep, 10 µm wide); of fast gas up to all, without the coefficient 0.7",
        "Bell et al. 2013",
        ("effects.tip_leakage.passage=1 nm",),
        plain=(),
    ),
    "tip_leakage, oil_sealed": Row(
        ("effects.tip_leakage={model: oil_sealed, mixture_viscosity: cicchitti, passage: 2 mm}",),
        "carried",
        "oil that fills the gap seals it (M192, M193)",
        "Cicchitti et al. 1960",
        ("effects.tip_leakage.passage=1 nm", "oil_supply.ratio=1e-9"),
        base=CARRIED,
        plain=(),
    ),
    "tip_leakage, oil_film": Row(
        ("effects.tip_leakage={model: oil_film, passage: 2 mm, filled_from: 0.1}",),
        "carried",
        "oil leaks as a viscous film, and no gas with it (M250, M251)",
        "Poiseuille flow",
        ("oil_supply.ratio=1e-9",),
        base=CARRIED,
        plain=(),
    ),
    "interlobe_leakage": Row(
        (), PAPER, "leaks take flow; no number", "ours", ("effects.interlobe_leakage.flow_coefficient=0",)
    ),
    "blow_hole": Row((), PAPER, "leaks take flow; no number", "ours", ("effects.blow_hole.flow_coefficient=0",)),
    "end_face_leakage": Row(
        (), PAPER, "leaks take flow; no number", "ours", ("effects.end_face_leakage.flow_coefficient=0",)
    ),
    "slide_valve": Row(
        ("effects.slide_valve={slot_area: 60 cm^2, closes: 640 deg, position: 0.5}",),
        PAPER,
        "share of power stays above share of capacity; no number",
        "Stosic, Kovacevic, Smith 1998",
        ("effects.slide_valve.position=0",),
    ),
    "bypass": Row(
        ("effects.bypass={share: 0.3}",),
        PAPER,
        "flow −30 %, and a little less as warmer gas is sucked; power of nearly all gas",
        "mixing (M161)",
        ("effects.bypass.share=0",),
    ),
    "suction_throttle": Row(
        ("effects.suction_throttle={pressure_ratio: 0.7}",),
        PAPER,
        "density of the gas −30 %",
        "throttling (M160)",
        ("effects.suction_throttle.pressure_ratio=1",),
        own=("intake_pressure",),
    ),
    "oil_heat": Row(
        (),
        PAPER,
        "oil cools the gas and raises η",
        CHERNOV,
        ("effects.oil_heat.heat_transfer_coefficient=0 W/(m^2 K)",),
    ),
    "droplets": Row(
        ("effects.droplets={diameter: 19 um, slip: 0.02}",),
        PAPER,
        "as oil_heat of 9.5 µm; Nu ≥ 2",
        "Ranz, Marshall 1952",
        ("effects.droplets.diameter=1 m", "effects.droplets.slip=0"),
        base=(NO_HEAT,),
        own=("droplet_diameter",),
    ),
    "droplets, merrington_richardson": Row(
        ("effects.droplets={size: merrington_richardson, orifice_diameter: 3 mm, jet_pressure: 5 bar}",),
        PAPER,
        "drops of a jet, 500 D^1.2 ν^0.2/u; no number for a compressor",
        "Merrington, Richardson 1947",
        ("effects.droplets.orifice_diameter=1 m",),
        base=(NO_HEAT,),
        own=("droplet_diameter",),
    ),
    "droplets, varde": Row(
        (
            "effects.droplets={size: varde, orifice_diameter: 3 mm, jet_pressure: 5 bar, "
            "surface_tension: 30 mN/m, slip: 0.1}",
        ),
        PAPER,
        "drops of a jet, 8.7 D (Re We)^−0.28: a tenth or so of the other formula",
        "Varde et al. 1984",
        ("effects.droplets.orifice_diameter=1000 m", "effects.droplets.slip=0"),
        base=(NO_HEAT,),
        own=("droplet_diameter",),
    ),
    "wall_heat": Row(
        (WALLS,),
        PAPER,
        "a wall is between the lowest and the highest gas temperature; small beside oil; no number",
        "Stosic, Smith, Kovacevic 2005",
        ("effects.wall_heat.nusselt_factor=0",),
        own=("rotor_temperature", "housing_temperature"),
    ),
    "thermal_clearances": Row(
        ("effects.thermal_clearances={axis_distance: 125 mm, bearing_distance: 50 mm}",),
        PAPER,
        "gaps change by ℓ γ (M180)",
        "linear expansion",
        (
            "effects.thermal_clearances.rotor_expansion=0 um/(m K)",
            "effects.thermal_clearances.housing_expansion=0 um/(m K)",
        ),
        base=(WALLS,),
        own=("tip_gap", "interlobe_gap", "end_face_gap"),
    ),
    "plenums": Row(
        (
            "effects.plenums={discharge_volume: 3 l, suction_volume: 8 l, discharge_area: 15 cm^2, "
            "suction_area: 40 cm^2, discharge_loss: 5}",
        ),
        PAPER,
        "pulsation at the lobe frequency and its multiples; no number",
        "D. R. Smith 2012",
        (
            "effects.plenums.discharge_volume=1e6 m^3",
            "effects.plenums.suction_volume=1e6 m^3",
            "effects.plenums.discharge_loss=0",
        ),
        own=("discharge_pulsation_harmonic_1", "suction_pulsation_harmonic_1"),
    ),
    "oil_pump": Row(
        (),
        PAPER,
        "the pump's power lowers η; no number",
        CHERNOV,
        ("effects.oil_pump={efficiency: 1, pressure_loss: 0 bar}",),
        own=("oil_pump_power",),
    ),
    "hydromechanical": Row(
        (),
        PAPER,
        "½ ṁ u² of the oil; 168 W viscous at 2900 rpm of a 677 cm³ machine",
        "Giuffrida 2016",
        ("effects.hydromechanical.acceleration_factor=0",),
        own=("hydromechanical_power",),
    ),
    "mechanical": Row(
        (),
        PAPER,
        "26.5 % of the theoretical power of a small machine; here 4.4 %",
        "Giuffrida 2016",
        ("effects.mechanical.fraction=0",),
        own=("mechanical_power",),
    ),
    "oil_drag": Row(
        ("effects.oil_drag={tip_gap: 0.1 mm, tip_land: 3 mm, end_gap: 0.1 mm, end_solidity: 0.6}",),
        PAPER,
        "∝ ω², 1/h, μ; no number",
        "Couette flow",
        ("effects.oil_drag.film_share=0",),
        own=("oil_drag_power",),
        zero=("oil_drag_power",),
    ),
    "bearings": Row(
        (
            "effects.bearings={load: gas, radial_area: 60 cm^2, axial_area: 30 cm^2, "
            "friction_coefficient: 0.0018, bore: 60 mm}",
        ),
        PAPER,
        "M = ½ μ F d, μ 0.0010 to 0.0020",
        "SKF catalogue",
        ("effects.bearings.friction_coefficient=0",),
        own=("bearing_power",),
        zero=("bearing_power",),
    ),
    "motor": Row(
        ("effects.motor={rated_power: 15 kW, efficiency: 0.921}",),
        PAPER,
        "η 92.1 % at rated power (IE3, 15 kW, four poles)",
        "IEC 60034-30-1",
        ("effects.motor.efficiency=1",),
        own=("motor_loss", "motor_efficiency"),
        zero=("motor_loss",),
    ),
    "gas_torque": Row(
        ("effects.gas_torque={male_share: 0.9}",),
        PAPER,
        "mean is P_ind/ω",
        "virtual work",
        ("effects.gas_torque.male_share=0",),
        own=("gas_torque_mean", "gas_torque_harmonic_1"),
        zero=("male_gas_torque",),
    ),
    "drive": Row(
        (
            "effects.drive={motor_inertia: 0.8 kg m^2, rotor_inertia: 0.12 kg m^2, coupling: {linear: "
            "{spring: 20000 N m/rad, largest_twist: 12 deg}, damping: 6 N m s/rad}, motor: {law: line, "
            "slope: 30 N m s/rad, torque_limit: 700 N m}}",
        ),
        PAPER,
        "ripple ∝ 1/inertia far above resonance",
        "two-mass oscillator",
        ("effects.drive.motor_inertia=1e6 kg m^2", "effects.drive.rotor_inertia=1e6 kg m^2"),
        own=("speed_ripple",),
        zero=("speed_ripple",),
    ),
    "economizer": Row(
        ("effects.economizer={temperature: 12 degC, opens: 385 deg, closes: 485 deg, area: 0.2 cm^2}",),
        "condenser",
        "capacity and COP rise, more at low evaporation; its abstract has no number",
        "Yang, Wang, Bai 2010",
        ("effects.economizer.area=1e-6 mm^2",),
        own=("economizer_flow_ratio", "economizer_draw_ratio", "economizer_capacity_gain"),
        zero=("economizer_flow_ratio",),
        base=CONDENSER,
    ),
    "liquid_injection": Row(
        ("effects.liquid_injection={opens: 500 deg, closes: 600 deg, area: 0.5 mm^2}",),
        "condenser",
        "discharge cools, power rises",
        "textbook",
        ("effects.liquid_injection.area=1e-6 mm^2",),
        own=("liquid_injection_flow_ratio",),
        zero=("liquid_injection_flow_ratio",),
        base=CONDENSER,
    ),
    "oil_injection": Row(
        ("effects.oil_injection={opens: 365 deg, closes: 455 deg}",),
        "carried, bore 6 mm",
        "less oil than under the pressure of 360°: the chamber's rises; no number",
        "Lichtarowicz et al. 1965; J & E Hall",
        ("oil_supply.orifice_diameter=1 um",),
        own=("oil_mass_flow",),
        base=BORE,
    ),
    "oil_volume": Row(
        ("effects.oil_volume={}",),
        "carried",
        "less room raises the gas's built-in ratio: a gain where it is too low; no number",
        "first law",
        ("oil_supply.ratio=1e-9",),
        own=("indicated_power",),
        base=CARRIED,
    ),
    "refrigerant_solubility": Row(
        ("effects.refrigerant_solubility={separator_temperature: 70 degC}",),
        "carried, oil 325 K",
        "at 70 °C and 11.6 bar 19.0 % of the solution is gas",
        "Grebner 1992",
        ("oil_supply.ratio=1e-9",),
        own=("dissolved_gas_ratio", "flash_flow_ratio"),
        base=(
            *CARRIED,
            "oil_supply={ratio: 1, temperature: 325 K}",
            "effects.oil_injection={opens: 365 deg, closes: 455 deg}",
        ),
    ),
}
SEEN = ("shaft_power", "indicated_power", "gas_mass_flow", "isentropic_efficiency", "discharge_temperature")


def effect_of(name: str) -> str:
    """Return the effect of a row."""
    return name.split(",")[0]


def with_it(name: str, more: tuple[str, ...] = ()) -> Scene:
    """Return a row's scene with its effect, and what more is set."""
    row = ROWS[name]
    return load(POINT, (*row.base, *row.sets, *more))


def without_it(name: str, more: tuple[str, ...] = ()) -> Scene:
    """Return a row's scene without its effect, or with that in its plain form."""
    row, effect = ROWS[name], effect_of(name)
    common = tuple(each for each in more if not each.startswith(f"effects.{effect}"))
    if row.plain is not None:
        return load(POINT, (*row.base, *row.plain, *common))
    return load(POINT, (*row.base, *row.sets, *common), [effect])


def changes(one: Result, other: Result) -> str:
    """Return how figures differ that differ by more than the accuracy."""
    found = []
    for title, name in (("P", "shaft_power"), ("ṁ", "gas_mass_flow"), ("Q̇₀", "cooling_capacity"), ("COP", "cop")):
        a, b = one.performance.get(name), other.performance.get(name)
        if a is not None and b is not None:
            found.append(f"{title} {100.0 * (a / b - 1.0):+.2f} %")
    a, b = one.performance.isothermal_efficiency, other.performance.isothermal_efficiency
    if a is not None and b is not None:
        found.append(f"η {100.0 * (a - b):+.2f} points")
    found.append(f"T_d {one.performance.discharge_temperature - other.performance.discharge_temperature:+.1f} K")
    return ", ".join(found)


def line(name: str) -> str:
    """Return a row of the table."""
    row, one = ROWS[name], simulate(with_it(name))
    if one.status != "ok":
        return f"| {name} | {one.status}: {one.message} |"
    own = ", ".join(f"{each} {one.performance[each]:.4g}" for each in row.own)
    balance = one.balance
    worst = max(x for x in (balance.mass, balance.energy, balance.entropy, balance.oil_mass) if x is not None)
    other = simulate(without_it(name)) if not row.whole else None
    ours, price = "the machine's way in or out", "–"
    if other is not None:
        ours = changes(one, other) if other.status == "ok" else f"without it {other.status}"
        price = f"{100.0 * (one.numerics.rhs_evaluations / other.numerics.rhs_evaluations - 1.0):+.0f} %"
    limit = ", ".join(each.split(".", 1)[1] if each.startswith("effects.") else each for each in row.limit) or "–"
    cells = (name, row.scene, row.says, row.source, "; ".join(filter(None, (ours, own))), limit, price)
    return f"| {' | '.join(cells)} | {worst / balance.bound:.2f} |"


def main() -> None:
    """Print the rows whose names begin with those asked for, or all."""
    asked = sys.argv[1:] or [""]
    print(f"{TABLE_HEAD}\n|{'---|' * (TABLE_HEAD.count('|') - 1)}")
    for name in ROWS:
        if any(name.startswith(each) for each in asked):
            print(line(name), flush=True)


if __name__ == "__main__":
    main()
