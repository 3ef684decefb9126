"""Print what effects change on a plain machine, beside what their sources say (docs/reference/effects.md).

Run: .venv/bin/python docs/tools/effects.py [NAME]… Each entry is a scene with the effect and the same without it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from screwsim.build import build_gas
from screwsim.fluid.gap_flow import flank_divisor, radial_divisor
from screwsim.outputs import Result
from screwsim.scene import load
from screwsim.scene.lines import lines
from screwsim.simulate import simulate

ROOT = Path(__file__).resolve().parents[2]
PAPER, REAL = ROOT / "configs" / "paper" / "point.yaml", ROOT / "tests" / "plain" / "r134a.yaml"


class Entry(NamedTuple):
    """One line of the table: scene, what it sets, the effect left out for comparison, source and its words, ours."""

    scene: Path
    sets: tuple[str, ...]
    without: tuple[str, ...]
    source: str
    says: str
    ours: Callable[[Result, Result], str]
    plain: tuple[str, ...] | None = None  # what the scene of comparison sets, where that is not the same


def percent(one: Result, other: Result, name: str) -> str:
    """Return by how much a figure changes."""
    return f"{100.0 * (one.performance[name] / other.performance[name] - 1.0):+.1f} %"


def percents(one: Result, other: Result, *names: str) -> str:
    """Return by how much figures change, with their names."""
    return ", ".join(f"{name.replace('_', ' ')} {percent(one, other, name)}" for name in names)


OIL_DENSITY = 960.0  # of tests/plain/r134a.yaml [kg/m³]

# ---- ports ---------------------------------------------------------------------------------------------------------

YANG = "Yang, Wang, Bai 2010"
BEST = "a best position of the port exists"


def economizer_change(one: Result, other: Result) -> str:
    """Return capacity, COP and what the port draws."""
    p = one.performance
    return (
        f"capacity {percent(one, other, 'cooling_capacity')}, COP {percent(one, other, 'cop')}, "
        f"flow {100.0 * p.economizer_flow_ratio:.1f} % of suction, draw ratio {p.economizer_draw_ratio:.2f}"
    )


COLDER = ("operation.evaporating_temperature=-10 degC", "operation.condensing_temperature=40 degC")


def economizer(condition: tuple[str, ...], temperature: float, opens: int, source: str, says: str) -> Entry:
    """Return the entry of an economizer at a condition, whose port is open over 100° [degC, °]."""
    port = f"opens: {opens} deg, closes: {opens + 100} deg, area: 1 cm^2"
    sets = (*condition, f"effects.economizer={{temperature: {temperature} degC, {port}}}")
    return Entry(REAL, sets, ("economizer",), source, says, economizer_change)


def oil_change(one: Result, other: Result) -> str:
    """Return powers and flows."""
    return percents(one, other, "oil_mass_flow", "indicated_power", "shaft_power", "gas_mass_flow")


def room_change(one: Result, other: Result) -> str:
    """Return the oil's share of the chamber where suction closes and at discharge, and powers."""
    cycle, shares = one.cycle, []
    for angle in (361, 670):  # after the injection; while the discharge port is open
        share = cycle["oil_mass"][angle] / OIL_DENSITY / cycle["volume"][angle]
        shares.append(f"{100.0 * share:.1f} % at {angle}°")
    lift = other.performance.oil_lift_power
    rise = one.performance.indicated_power - other.performance.indicated_power
    lifted = f"indicated power {rise:+.0f} W for {lift:.0f} W of lift"
    return f"oil fills {', '.join(shares)}; {lifted}; {oil_change(one, other)}"


def room_says(d: float) -> str:
    """Return what the densities of suction gas and of saturated vapour at discharge pressure make of a ratio d."""
    scene = load(REAL)
    gas, at = build_gas(scene), lines(scene)
    T_d = scene.operation.condensing_temperature or at.T_s
    shares = (d * rho / (OIL_DENSITY + d * rho) for rho in (gas.density(at.p_s, at.T_s), gas.density(at.p_d, T_d)))
    return "oil fills {:.1%} of suction, {:.1%} of discharge volume".format(*shares).replace("%", " %")


def liquid_change(one: Result, other: Result) -> str:
    """Return temperature and powers."""
    fall = one.performance.discharge_temperature - other.performance.discharge_temperature
    ratio = 100.0 * one.performance.liquid_injection_flow_ratio
    return f"{ratio:.1f} % liquid: discharge {fall:+.1f} K, shaft power {percent(one, other, 'shaft_power')}"


BORE = (
    "oil_supply.kind=displacement",
    "oil_supply.ratio=null",
    "oil_supply.orifice_diameter=8 mm",
    "effects.oil_pump=off",
)
AFTER_SEALING = "oil after sealing, by the pressure difference, no pump"


def oil_injection(opens: int, source: str, says: str) -> Entry:
    """Return the entry of oil through a port that is open over 90° [°]."""
    sets = (*BORE, f"effects.oil_injection={{opens: {opens} deg, closes: {opens + 90} deg}}")
    return Entry(REAL, sets, ("oil_injection",), source, says, oil_change)


def oil_volume(d: float) -> Entry:
    """Return the entry of the oil's room at a ratio d."""
    sets = (f"oil_supply.ratio={d:g}", "effects.oil_volume={}")
    return Entry(REAL, sets, ("oil_volume",), "M106, densities of the lines", room_says(d), room_change)


effects_ports = {
    "economizer": economizer((), 20.0, 385, "textbook", "capacity and COP rise"),
    "economizer, colder": economizer(COLDER, 12.0, 385, YANG, "gains more at lower evaporation"),
    "economizer, later port": economizer((), 20.0, 425, YANG, BEST),
    "economizer, early port": economizer((), 20.0, 330, YANG, BEST),
    "economizer, last port": economizer((), 20.0, 465, YANG, BEST),
    "liquid_injection": Entry(
        REAL,
        ("gas.two_phase=equilibrium", "effects.liquid_injection={opens: 500 deg, closes: 600 deg, area: 4 mm^2}"),
        ("liquid_injection",),
        "textbook",
        "discharge cools, power rises",
        liquid_change,
    ),
    "oil_injection": oil_injection(365, "J & E Hall, manual 2-119", AFTER_SEALING),
    "oil_injection, early": oil_injection(250, "", "before sealing the suction line gets gas and oil back"),
    "oil_volume": oil_volume(3.0),
    "oil_volume, d = 8": oil_volume(8.0),
}

# ---- flow models of gaps -------------------------------------------------------------------------------------------

GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")


def held(*words: str) -> tuple[str, ...]:
    """Return what gives all gaps with a clearance one flow model, 2 mm deep."""
    return tuple(f"effects.{gap}.{word}" for gap in GAPS for word in (*words, "passage=2 mm"))


def friction_says(divisor: Callable[[float, float, float], float]) -> str:
    """Return what a fit says of the share that passes a gap as wide and deep as those of the entries."""
    shares = (1.0 / max(1.0, divisor(reynolds, 2e-3, 40e-6)) for reynolds in (1000.0, 10_000.0))
    return "of the isentropic nozzle passes {:.0%} at Re = 1000, {:.0%} at 10 000".format(*shares).replace("%", " %")


def leak_change(one: Result, other: Result) -> str:
    """Return what the leaks move, and what that makes."""
    moved, plain = (sum(result.ledger[f"gas_moved_{gap}"] for gap in GAPS) for result in (one, other))
    figures = percents(one, other, "volumetric_efficiency", "isentropic_efficiency")
    return f"gas through these gaps {100.0 * (moved / plain - 1.0):+.0f} %, {figures}"


BELL = "Bell et al. 2013"
SLOWED, FILLED = "oil carried along slows the gas to 71 %", "oil that fills the gap seals it"
FRICTION = ("model=nozzle_friction", "flow_coefficient=1")
SEALED = "model=oil_sealed"
THIN = ("mixture_viscosity=mcadams", "mixture_friction=blasius")
effects_gaps = {
    name: Entry(REAL, held(*words), (), source, says, leak_change, ())
    for name, words, source, says in (
        ("nozzle_friction, radial", (*FRICTION, "friction_fit=radial"), BELL, friction_says(radial_divisor)),
        ("nozzle_friction, flank", (*FRICTION, "friction_fit=flank"), BELL, friction_says(flank_divisor)),
        ("oil_sealed, mcadams", (SEALED, "mixture_viscosity=mcadams"), "M192: 1/√(1 + x), x = 1", SLOWED),
        ("oil_sealed, mcadams, blasius", (SEALED, *THIN), "M192, M193", "Re above 2039: more friction than laminar"),
        ("oil_sealed, cicchitti", (SEALED, "mixture_viscosity=cicchitti"), "M192, M193", FILLED),
        ("oil_film", ("model=oil_film", "filled_from=0.1"), "M250, M251, M256", "no gas where there is oil"),
    )
}

# ---- dissolved refrigerant -----------------------------------------------------------------------------------------


INJECTED = "effects.oil_injection={opens: 365 deg, closes: 455 deg}"
DEARER = ("volumetric_efficiency", "shaft_power", "isentropic_efficiency")


def flash_change(one: Result, other: Result) -> str:
    """Return what flashes, and what it costs."""
    p, figures = one.performance, percents(one, other, *DEARER)
    share = 100.0 * p.dissolved_gas_ratio / (1.0 + p.dissolved_gas_ratio)
    return f"{share:.1f} % of the solution; flash {100.0 * p.flash_flow_ratio:.1f} % of the suction gas, {figures}"


def rate_change(one: Result, other: Result) -> str:
    """Return what flashes and what stays, and what it costs."""
    p, figures = one.performance, percents(one, other, *DEARER)
    left = p.discharge_dissolved_gas_ratio / p.dissolved_gas_ratio
    return f"flash {100.0 * p.flash_flow_ratio:.1f} % of the suction gas, {left:.2f} of it leaves dissolved, {figures}"


def soluble(T_separator: str) -> Entry:
    """Return the entry of oil in equilibrium at a temperature of the separator."""
    sets = (INJECTED, f"effects.refrigerant_solubility={{separator_temperature: {T_separator}}}")
    says = "its constants, with fugacities (M195): at 70 °C and 11.6 bar 19.7 % of the solution is gas"
    says += " (15.8 % with pressures)"
    return Entry(REAL, sets, ("refrigerant_solubility",), "Grebner 1992", says, flash_change)


def over_time(times: str) -> Entry:
    """Return the entry of oil that gives gas off over time: the parameters beside the separator's temperature."""
    sets = (INJECTED, f"effects.refrigerant_solubility={{separator_temperature: 70 degC, {times}}}")
    says = "no published time: gas that comes later costs less"
    return Entry(REAL, sets, ("refrigerant_solubility",), "assumed times", says, rate_change)


DRAG = "effects.oil_drag={tip_gap: 40 um, tip_land: 2 mm, end_gap: 40 um, end_solidity: 0.63}"


def thinned_change(one: Result, other: Result) -> str:
    """Return the viscosity of the oil as it is supplied, and the drag of its films."""
    mu, power = 1e3 * one.performance.supplied_oil_viscosity, one.performance.oil_drag_power
    return f"{mu:.1f} mPa s as supplied, of 20; drag of films {power:.0f} W, {percent(one, other, 'oil_drag_power')}"


def thinned(line: str) -> Entry:
    """Return the entry of films in equilibrium with gas of a line, beside films of pure oil."""
    pure = "separator_temperature: 70 degC"
    sets = (INJECTED, DRAG, f"effects.refrigerant_solubility={{{pure}, films_at: {line}}}")
    plain = (INJECTED, DRAG, f"effects.refrigerant_solubility={{{pure}}}")
    says = "dissolved gas thins the oil (M199), more at discharge pressure"
    return Entry(REAL, sets, (), "Yokozeki 1994", says, thinned_change, plain)


effects_solubility = {
    "refrigerant_solubility": soluble("70 degC"),
    "refrigerant_solubility, warmer": soluble("90 degC"),
    "refrigerant_solubility, 0.1 ms": over_time("flash_time: 0.1 ms"),
    "refrigerant_solubility, 5 ms": over_time("flash_time: 5 ms"),
    "refrigerant_solubility, 50 ms": over_time("flash_time: 50 ms"),
    "refrigerant_solubility, 5 ms and back": over_time("flash_time: 5 ms, absorption_time: 50 ms"),
    "refrigerant_solubility, films at suction": thinned("suction"),
    "refrigerant_solubility, films at discharge": thinned("discharge"),
}
# ---- walls, gaps, plenums ------------------------------------------------------------------------------------------

SIZES = "rotor_area: 400 cm^2, housing_area: 150 cm^2, characteristic_length: 58 mm"
LINES = "discharge_area: 15 cm^2, suction_area: 40 cm^2"


def wall_change(one: Result, other: Result) -> str:
    """Return temperatures, filling and powers."""
    p = one.performance
    warm = f"rotors {p.rotor_temperature - 273.15:.1f} °C, housing {p.housing_temperature - 273.15:.1f} °C"
    fall = p.discharge_temperature - other.performance.discharge_temperature
    return (
        f"{warm}; λ {percent(one, other, 'volumetric_efficiency')}, shaft power {percent(one, other, 'shaft_power')}, "
        f"η_s {percent(one, other, 'isentropic_efficiency')}, discharge {fall:+.2f} K"
    )


def gap_change(one: Result, other: Result) -> str:
    """Return warm gaps and what they do."""
    p = one.performance
    gaps = f"tips {1e6 * p.tip_gap:.1f} µm, interlobe {1e6 * p.interlobe_gap:.1f} µm of 40"
    return (
        f"{gaps}; λ {percent(one, other, 'volumetric_efficiency')}, η_s {percent(one, other, 'isentropic_efficiency')}"
    )


def plenum_change(one: Result, other: Result) -> str:
    """Return amplitudes and powers."""
    p = one.performance
    found = []
    for line in ("discharge", "suction"):
        swing = [100.0 * p[f"{line}_pulsation_harmonic_{k}"] / p[f"{line}_pressure"] for k in (1, 2, 3)]
        found.append(f"{line} {', '.join(f'{amplitude:.2f}' for amplitude in swing)} % of p")
    powers = f"flow {percent(one, other, 'gas_mass_flow')}, shaft power {percent(one, other, 'shaft_power')}"
    return f"harmonics 1 to 3: {'; '.join(found)}; {powers}"


WALLS = f"effects.wall_heat={{{SIZES}}}"
STOSIC, BETWEEN = "Stosic, Smith, Kovacevic 2005", "a wall is between the lowest and the highest gas temperature"
AXES = "effects.thermal_clearances={axis_distance: 125 mm}"
NARROWER = "h_0 + ℓ γ (M180), narrower where rotors are as warm as the housing"
SMALL = f"effects.plenums={{discharge_volume: 3 l, suction_volume: 8 l, {LINES}}}"
LARGE = "effects.plenums={discharge_volume: 30 l, suction_volume: 80 l}"
PULSATION = "pulsation at the pocket passing frequency and its multiples"
effects_walls = {
    name: Entry(REAL, sets, (name.split(",")[0],), source, says, ours)
    for name, sets, source, says, ours in (
        ("wall_heat", (WALLS,), STOSIC, BETWEEN, wall_change),
        ("wall_heat, no oil", (WALLS, "oil_supply.ratio=0"), STOSIC, "the same, of dry rotors", wall_change),
        ("thermal_clearances", (WALLS, AXES), "linear expansion", NARROWER, gap_change),
        ("plenums", (SMALL,), "D. R. Smith 2012", PULSATION, plenum_change),
        ("plenums, tenfold", (LARGE,), "M184", "falls as 1/V", plenum_change),
    )
}
ENTRIES: dict[str, Entry] = effects_ports | effects_gaps | effects_solubility | effects_walls


def line(name: str, entry: Entry) -> str:
    """Return an entry's row of the table."""
    with_it = simulate(load(entry.scene, entry.sets))
    without = simulate(load(entry.scene, entry.sets if entry.plain is None else entry.plain, entry.without))
    bad = next((result for result in (with_it, without) if result.status != "ok"), None)
    ours = entry.ours(with_it, without) if bad is None else f"{bad.status}: {bad.message}"
    price = with_it.numerics.rhs_evaluations / max(without.numerics.rhs_evaluations, 1) - 1.0
    return f"| {name} | {entry.says} | {entry.source} | {ours} | {100.0 * price:+.0f} % |"


def main() -> None:
    """Print the table of the entries whose names begin with those asked for, or of all."""
    asked = sys.argv[1:] or [""]
    print("| effect | its source says | source | ours | evaluations |\n|---|---|---|---|---|")
    for name, entry in ENTRIES.items():
        if any(name.startswith(each) for each in asked):
            print(line(name, entry), flush=True)


if __name__ == "__main__":
    main()
