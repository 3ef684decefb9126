"""The hard cases: scenes that a user could write, the status that each deserves, and why.

Each case is a set of changes (dotted paths) of the scene of `tests/laws/scenes.py`. Cases share few structures, since
each new combination of effects is compiled anew. `docs/hard-cases.md` shows this table; a test holds the two together.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from scenes import DROP

CARRIED = {"oil.transport": "carried"}
WARM = {  # a real gas and oil above its saturation at the discharge pressure
    **CARRIED,
    "gas.model": "real",
    "oil_supply.temperature": "328 K",
    "operation.suction": {"pressure": "3.1462 bar", "superheat": "10 K"},
    "operation.discharge": {"pressure": "11.6 bar"},
}
CO2 = {
    **WARM,
    "gas.fluid": "CO2",
    "operation.suction": {"pressure": "30 bar", "temperature": "288 K"},
    "operation.discharge": {"pressure": "90 bar"},
    "oil_supply.temperature": "330 K",
}
WET = {
    "gas.model": "real",
    "gas.two_phase": "equilibrium",
    "effects.oil_heat": {"droplet_radius": "20 um", "heat_transfer_coefficient": "1000 W/(m^2 K)"},
    "operation.discharge.temperature": "330 K",
}
BARE = {"effects": {"suction_port": {}, "discharge_port": {}}, "oil": DROP, "oil_supply": DROP}
FINE = {"numerics.accuracy": 1e-6}


@dataclass(frozen=True)
class Case:
    """One row of the table; `most` bounds the evaluations of the right-hand side, Jacobians' included."""

    name: str
    changes: dict[str, Any]
    why: str
    status: str = "ok"  # ok | not_closed | failed | refused
    most: int = 40_000
    says: tuple[str, ...] = field(default=())  # words of the message, warnings or fault
    radau: bool = False  # compared with a tight run of scipy's Radau
    slow: bool = False
    guess: tuple[float, float] | None = None  # factors on pressure and temperature of the first guess


def gaps(size: str) -> dict[str, Any]:
    """Return all clearances set to one size."""
    return {f"effects.{name}.gap": size for name in ("tip_leakage", "interlobe_leakage", "end_face_leakage")}


def ports(factor: float) -> dict[str, Any]:
    """Return both port areas times a factor."""
    return {
        "machine.suction_port.area": f"{40 * factor:g} cm^2",
        "machine.discharge_port.area": f"{12 * factor:g} cm^2",
    }


def lines(p_s: str, p_d: str, T_s: str = "283 K") -> dict[str, Any]:
    """Return both lines stated by pressures."""
    return {"operation.suction": {"pressure": p_s, "temperature": T_s}, "operation.discharge": {"pressure": p_d}}


def droplet(radius: str) -> dict[str, Any]:
    """Return another droplet radius."""
    return {"effects.oil_heat.droplet_radius": radius}


def speed(rpm: float) -> dict[str, Any]:
    """Return another speed."""
    return {"operation.speed": f"{rpm:g} rpm"}


CSV = {
    name: str(Path(__file__).parent / f"{name}.csv") for name in ("rough_volume", "rough_suction", "rough_discharge")
}
ROUGH = {
    "machine.volume": {"law": "table", "max": "600 cm^3", "file": CSV["rough_volume"]},
    "machine.suction_port": {"law": "table", "file": CSV["rough_suction"]},
    "machine.discharge_port": {"law": "table", "file": CSV["rough_discharge"]},
}


def _speeds() -> list[Case]:
    slow = "slow: the ports hold p to the line within a tiny share, the equations are as stiff as they get"
    leaks = "leakage exceeds the displacement: nothing is delivered, λ < 0, efficiencies have no meaning"
    fast = "fast: the ports throttle, and pressures wave over and under the lines"
    cases = []
    for rpm in (10, 50, 250, 10_000, 30_000):
        why = leaks if rpm <= 50 else (slow if rpm < 3000 else fast)
        cases.append(Case(f"paper, {rpm} rpm", speed(rpm), why))
        cases.append(Case(f"carried, {rpm} rpm", {**CARRIED, **speed(rpm)}, why))
    for rpm in (240, 250, 260):
        cases.append(Case(f"carried, {rpm} rpm, fine", {**CARRIED, **speed(rpm), **FINE}, slow))
    cases.append(Case("carried, 250 rpm, d = 0.09", {**CARRIED, **speed(250), "oil_supply.ratio": 0.09}, slow))
    return cases


def _pressures() -> list[Case]:
    same = "hardly any pressure to work against: what is left is throttling"
    over = "compressed beyond the line, the gas leaves in a rush when the port opens"
    back = "the line's gas rushes into the chamber when the port opens"
    return [
        Case("pressure ratio 1.0001", lines("1.5 bar", "1.50015 bar"), same),
        Case("carried, pressure ratio 1.0001", {**CARRIED, **lines("1.5 bar", "1.50015 bar")}, same),
        Case("pressure ratio 1.05", lines("1.5 bar", "1.575 bar"), same),
        Case("pressure ratio 20", lines("1 bar", "20 bar"), back),
        Case("pressure ratio 60", lines("0.5 bar", "30 bar"), back),
        Case("carried, pressure ratio 60", {**CARRIED, **lines("0.5 bar", "30 bar")}, back),
        Case("over-compression", lines("3 bar", "4 bar"), over),
        Case("carried, over-compression", {**CARRIED, **lines("3 bar", "4 bar")}, over),
        Case(
            "back-flow",
            {
                **lines("1 bar", "15 bar"),
                "machine.discharge_port.opens": "500 deg",
                "machine.discharge_port.phi_C": "530 deg",
            },
            back,
        ),
        Case("equal pressures", lines("2 bar", "2 bar"), "nothing is compressed", "refused"),
        Case("discharge below suction", lines("2 bar", "1 bar"), "that is an expander", "refused"),
    ]


def _oil() -> list[Case]:
    mist = "mist: the oil follows the gas at once, a time constant far below all others"
    rain = "large drops hardly exchange heat"
    cases = []
    for radius in ("0.3 um", "3 um", "1 mm"):
        why = rain if radius == "1 mm" else mist
        cases.append(Case(f"paper, droplets {radius}", droplet(radius), why))
        cases.append(Case(f"carried, droplets {radius}", {**CARRIED, **droplet(radius)}, why))
    for d in (0, 0.01, 10, 50, 80):
        why = "no oil: the states of the oil are those of nothing" if d == 0 else "little oil" if d < 1 else "much oil"
        if d == 80:
            why = "the oil would fill the chamber; it takes no room in this model, and a warning says so"
        says = ("no room",) if d == 80 else ()
        cases.append(Case(f"paper, d = {d}", {"oil_supply.ratio": d}, why, says=says))
        cases.append(Case(f"carried, d = {d}", {**CARRIED, "oil_supply.ratio": d}, why, says=says))
    full = {**CARRIED, **lines("3.1462 bar", "12 bar")}
    cases += [
        Case("carried, d = 34, dense suction", {**full, "oil_supply.ratio": 34}, "the oil all but fills the chamber"),
        Case(
            "carried, d = 40, dense suction",
            {**full, "oil_supply.ratio": 40},
            "from d = 35 up the oil would fill the chamber; it takes no room in this model, and a warning says so",
            says=("the oil would fill 116% of the chamber", "no room", "lower oil_supply.ratio"),
        ),
    ]
    for T, word in (("363 K", "hotter"), ("203 K", "colder")):
        cases.append(Case(f"paper, oil 80 K {word}", {"oil_supply.temperature": T}, f"oil 80 K {word} than the gas"))
        cases.append(
            Case(f"carried, oil 80 K {word}", {**CARRIED, "oil_supply.temperature": T}, f"oil 80 K {word} than the gas")
        )
    return cases


def _geometry() -> list[Case]:
    cases = []
    for factor in (0.01, 0.1, 10, 100):
        why = (
            "narrow: the machine hardly breathes, and p runs far above the line"
            if factor < 1
            else ("wide: p follows the line within a tiny share of itself")
        )
        cases.append(Case(f"ports times {factor:g}", ports(factor), why))
    cases.append(Case("carried, ports times 0.01", {**CARRIED, **ports(0.01)}, cases[0].why))
    cases.append(Case("carried, ports times 100", {**CARRIED, **ports(100)}, cases[3].why))
    cases += [
        Case("gaps 0", gaps("0 um"), "a gap of nothing is left out by leaving the effect out", "refused"),
        Case("gaps 1 um", gaps("1 um"), "leaks are tiny beside the flows of the ports"),
        Case("gaps 1 mm", gaps("1 mm"), "the chambers are one: all leaks back"),
        Case("carried, gaps 1 mm", {**CARRIED, **gaps("1 mm")}, "the chambers are one: all leaks back"),
        Case("gaps 1 mm, 250 rpm", {**gaps("1 mm"), **speed(250)}, "the chambers are one, and have time"),
    ]
    for share in (1e-9, 1e-6, 1e-2, 1e-1):
        cases.append(
            Case(
                f"dead volume {share:g}",
                {"machine.volume.min": f"{600 * share:g} cm^3"},
                "V all but vanishes at both ends" if share < 1e-4 else "much gas is carried over",
            )
        )
    for share in (1e-9, 1e-1):
        cases.append(
            Case(
                f"carried, dead volume {share:g}",
                {**CARRIED, "machine.volume.min": f"{600 * share:g} cm^3"},
                "V all but vanishes at both ends" if share < 1e-4 else "much gas is carried over",
            )
        )
    ends = {
        "phi_A": ("machine.volume", "0.1 deg", "360 deg"),
        "phi_B": ("machine.suction_port", "0.1 deg", "180 deg"),
        "phi_C": ("machine.discharge_port", "600.1 deg", "660 deg"),
    }
    for name, (section, low, high) in ends.items():
        cases.append(Case(f"{name} = {low}", {f"{section}.{name}": low}, "a kink within one step"))
        cases.append(Case(f"{name} = {high}", {f"{section}.{name}": high}, "no middle branch: 0/0 in the printed law"))
    cases += [
        Case("phi_A = 0", {"machine.volume.phi_A": "0 deg"}, "the law divides by it", "refused"),
        Case("phi_A = 361", {"machine.volume.phi_A": "361 deg"}, "the branches would overlap", "refused"),
        Case(
            "opens at 361 deg",
            {"machine.discharge_port.opens": "361 deg", "machine.discharge_port.phi_C": "400 deg"},
            "the line is open all the way",
        ),
        Case(
            "opens at 719 deg",
            {"machine.discharge_port.opens": "719 deg", "machine.discharge_port.phi_C": "719.4 deg"},
            "compressed into the dead volume, and let out in one degree",
        ),
        Case(
            "carried, opens at 719 deg",
            {**CARRIED, "machine.discharge_port.opens": "719 deg", "machine.discharge_port.phi_C": "719.4 deg"},
            "compressed into the dead volume, and let out in one degree",
        ),
        Case("rough tables", ROUGH, "noisy, not monotone, coarse laws"),
        Case("carried, rough tables", {**CARRIED, **ROUGH}, "noisy, not monotone, coarse laws"),
    ]
    for lobes in (1, 2, 3, 10):
        cases.append(
            Case(
                f"{lobes} male lobe{'' if lobes == 1 else 's'}",
                {"machine.male_lobes": lobes},
                "few, or many, chambers",
                slow=True,
            )
        )
    return cases


def _gases() -> list[Case]:
    light = {"gas.fluid": "Hydrogen", **lines("1 bar", "5 bar", "300 K")}
    return [
        Case("hydrogen", light, "fast sound: leaks and ports carry far more volume"),
        Case("helium", {**light, "gas.fluid": "Helium"}, "fast sound, k = 5/3"),
        Case("a heavy gas", {"gas.fluid": "SF6", **lines("1 bar", "5 bar", "300 K")}, "slow sound"),
        Case(
            "a heavy gas of k near 1", {"gas.fluid": "n-Dodecane", **lines("0.1 bar", "0.5 bar", "480 K")}, "k near 1"
        ),
        Case(
            "real, superheat 1 K",
            {**WARM, "operation.suction": {"pressure": "3.1462 bar", "superheat": "1 K"}},
            "a step from the dome",
        ),
        Case(
            "real, near-critical",
            {
                **WARM,
                "operation.suction": {"pressure": "8 bar", "superheat": "10 K"},
                "operation.discharge": {"pressure": "38 bar"},
                "oil_supply.temperature": "376 K",
                "machine.volume.min": "12 cm^3",
            },
            "p_d at 94 % of the critical pressure",
        ),
        Case(
            "real, transcritical",
            {
                **WARM,
                "gas.fluid": "CO2",
                "operation.suction": {"pressure": "30 bar", "superheat": "40 K"},
                "machine.suction_port.phi_B": "20 deg",
                "operation.discharge": {"pressure": "90 bar"},
                "oil_supply.temperature": "360 K",
            },
            "p_d above the critical pressure",
        ),
        Case(
            "real, near-critical, as first written",
            {**WARM, "operation.discharge": {"pressure": "38 bar"}},
            "the equation ends at 455 K: what the closing port keeps in the dead volume is squeezed beyond; as the "
            "message says, a wider port or more dead volume would do (the two rows below)",
            "failed",
            says=("deg", "above the equation's highest temperature", "a wider discharge port", "machine.volume.min"),
        ),
        Case(
            "real, near-critical, wider port",
            {**WARM, "operation.discharge": {"pressure": "38 bar"}, "machine.discharge_port.area": "40 cm^2"},
            "p_d at 94 % of the critical pressure",
        ),
        Case(
            "real, near-critical, more dead volume",
            {**WARM, "operation.discharge": {"pressure": "38 bar"}, "machine.volume.min": "6 cm^3"},
            "p_d at 94 % of the critical pressure",
        ),
        Case(
            "real, transcritical, as first written",
            {**CO2, "machine.suction_port.phi_B": "60 deg"},
            "in the first degrees the volume grows faster than the suction port opens: the gas expands into the dome; "
            "as the message says, warmer gas would do (the row below)",
            "failed",
            says=("deg", "condenses", "use warmer oil or gas, or gas.two_phase: equilibrium"),
        ),
        Case(
            "real, transcritical, warmer suction",
            {**CO2, **lines("30 bar", "90 bar", "308 K")},
            "p_d above the critical pressure",
        ),
        Case("real, 250 rpm", {**WARM, **speed(250)}, "slow, and the equation of state"),
        Case("two phases", WET, "p follows T by 7:1 in the dome"),
        Case("two phases, 1e-5", {**WET, "numerics.accuracy": 1e-5}, "p follows T by 7:1 in the dome"),
    ]


def _shut() -> list[Case]:
    shut = "the charge comes back through the dead volume, compressed and expanded as by a spring"
    return [
        Case("ports alone", BARE, "nothing but the ports"),
        Case("a chamber that never opens", {**BARE, "effects": {}}, shut),
        Case(
            "a chamber that never opens, real",
            {**BARE, "effects": {}, "gas.model": "real"},
            "the equation of state ends long before 6000 times the density",
            "failed",
            says=("deg",),
        ),
        Case(
            "hot oil, thin hot suction",
            {**CARRIED, "oil_supply.temperature": "450 K", **lines("0.2 bar", "8 bar", "420 K")},
            "the guess of the start is far from what comes",
        ),
    ]


def _starts() -> list[Case]:
    why = "the figures are those of the usual start, within the wanted accuracy"
    bases = {"paper": {}, "carried": CARRIED, "carried, 250 rpm": {**CARRIED, **speed(250)}, "ports alone": BARE}
    cases = [
        Case(
            f"start far off, {name}, p times {p:g}, T times {T:g}",
            changes,
            why,
            most=1_000_000 if "250" in name else 130_000,
            guess=(p, T),
        )
        for name, changes in bases.items()
        for p, T in ((0.1, 0.6), (10.0, 2.0), (0.1, 2.0), (10.0, 0.6))
    ]
    return cases + [
        Case(f"start far off, real, p times {p:g}, T times {T:g}", WARM, why, guess=(p, T))
        for p, T in ((0.3, 1.45), (3.0, 1.5))
    ]


def _found() -> list[Case]:
    """Return failures that random scenes found (`scripts/fuzz.py`), one of each kind."""
    heats = (
        "all but nothing gets out: what leaks back is compressed again and again, beyond 10 000 K, and never settles"
    )
    at_once = (
        "at 14 rpm the discharge line's oil comes and goes between turns, and a chamber of no oil (1e-9) takes it up "
        "within less than the smallest step; no refusal that physics asks for"
    )
    return [
        Case(
            "found: heats without end",
            BLOWN,
            heats,
            "not_closed",
            says=("no further try", "a wider discharge port"),
            slow=True,
        ),
        Case(
            "found: heats without end, carried",
            HELIUM,
            heats,
            "not_closed",
            says=("no further try", "a wider discharge port"),
            slow=True,
        ),
        Case(
            "found: closes only damped",
            {**BLOWN, "gas.fluid": "Hydrogen"},
            "acceleration throws the cycle about; half the way at a time reaches it",
            says=("the cycle closed only with damped closing",),
            slow=True,
        ),
        Case(
            "found: closes only with tighter steps",
            STILL,
            "p follows the lines within 1e-6 of itself at 46 rpm: the error of a step is more than what is balanced",
            says=("the cycle closed only with a tighter tolerance of the steps",),
        ),
        Case(
            "found: closes only from a faster scene",
            THROTTLED,
            "the suction port throttles, p_s is far below the line's, and the discharge line's liquid flows back",
            says=("the cycle closed only with continuation from 4 times the speed",),
            slow=True,
        ),
        Case(
            "found: entropy closes last",
            STARVED,
            "mass and energy close at once where next to no gas goes through; entropy asks for two tighter closings",
        ),
        Case("found: oil all at once", FLOODED, at_once, "failed", says=("deg", "x_oil"), slow=True),
    ]


BLOWN = {  # a hundredth of the discharge port that the speed calls for, and wide blow-holes
    "gas.fluid": "Nitrogen",
    "operation.speed": "23750 rpm",
    **lines("0.8363 bar", "23 bar", "262.4 K"),
    "machine.volume.min": "5.86 cm^3",
    "machine.volume.phi_A": "282.5 deg",
    "machine.suction_port.area": "41.75 cm^2",
    "machine.suction_port.phi_B": "64.7 deg",
    "machine.discharge_port.area": "0.3043 cm^2",
    "machine.discharge_port.opens": "579.4 deg",
    "machine.discharge_port.phi_C": "646.4 deg",
    "oil_supply.ratio": 1.45e-4,
    "oil_supply.temperature": "221.2 K",
    "effects.oil_heat.droplet_radius": "93.8 um",
    "effects.oil_heat.heat_transfer_coefficient": "200.5 W/(m^2 K)",
    "effects.tip_leakage.gap": "2.51 um",
    "effects.interlobe_leakage.gap": "13.05 um",
    "effects.end_face_leakage.gap": "2.37 um",
    "effects.blow_hole.area": "71.5 mm^2",
}
HELIUM = {
    **CARRIED,
    "gas.fluid": "Helium",
    "operation.speed": "11650 rpm",
    **lines("0.38981 bar", "0.38991 bar", "340 K"),
    "machine.volume.min": "0.0117 cm^3",
    "machine.volume.phi_A": "352 deg",
    "machine.suction_port.area": "12.7 cm^2",
    "machine.suction_port.phi_B": "59 deg",
    "machine.discharge_port.area": "0.2587 cm^2",
    "machine.discharge_port.opens": "698.5 deg",
    "machine.discharge_port.phi_C": "708.2 deg",
    "oil_supply.ratio": 0.0403,
    "oil_supply.temperature": "355 K",
    "effects.oil_heat.droplet_radius": "49 um",
    "effects.oil_heat.heat_transfer_coefficient": "97.2 W/(m^2 K)",
    "effects.tip_leakage.gap": "3.2 um",
    "effects.interlobe_leakage.gap": "32.6 um",
    "effects.end_face_leakage.gap": "18.3 um",
    "effects.blow_hole.area": "17.5 mm^2",
}
OILED = ("oil_heat", "oil_pump", "hydromechanical")
STILL = {
    "oil": DROP,
    "oil_supply": DROP,
    **{f"effects.{name}": DROP for name in (*OILED, "interlobe_leakage", "end_face_leakage")},
    "gas.fluid": "SF6",
    "operation.speed": "46.39 rpm",
    **lines("1.919 bar", "1.98 bar", "329.7 K"),
    "machine.volume.min": "0.01119 cm^3",
    "machine.volume.phi_A": "213.7 deg",
    "machine.suction_port.area": "567.3 cm^2",
    "machine.suction_port.phi_B": "5.906 deg",
    "machine.discharge_port.area": "280.5 cm^2",
    "machine.discharge_port.opens": "407.8 deg",
    "machine.discharge_port.phi_C": "415 deg",
    "effects.tip_leakage.gap": "3.871 um",
    "effects.blow_hole.area": "10.33 mm^2",
}
THROTTLED = {
    "gas.model": "real",
    "gas.two_phase": "equilibrium",
    "operation.suction": DROP,
    "operation.discharge": DROP,
    "operation.evaporating_temperature": "264 K",
    "operation.condensing_temperature": "312 K",
    "operation.superheat": "27 K",
    "operation.speed": "7200 rpm",
    "oil_supply.ratio": 1,
    "oil_supply.temperature": "307 K",
    "effects.oil_heat.droplet_radius": "0.3 um",
    "machine.suction_port.area": "4.8 cm^2",
    "machine.suction_port.phi_B": "172 deg",
    "machine.volume.min": "21 cm^3",
}
STARVED = {
    **BARE,
    "gas.fluid": "SF6",
    "operation.speed": "890.55 rpm",
    **lines("7.7347 bar", "162.19 bar", "317.875 K"),
    "machine.volume.min": "0.0161974 cm^3",
    "machine.volume.phi_A": "103.68 deg",
    "machine.suction_port.area": "0.765429 cm^2",
    "machine.suction_port.phi_B": "175.093 deg",
    "machine.discharge_port.area": "55.2703 cm^2",
    "machine.discharge_port.opens": "491.667 deg",
    "machine.discharge_port.phi_C": "601.5215 deg",
}
FLOODED = {
    **CARRIED,
    "gas.fluid": "Ammonia",
    "operation.speed": "14 rpm",
    **lines("1.24 bar", "17.5 bar", "302 K"),
    "oil_supply.ratio": 9,
    "effects.tip_leakage.gap": "670 um",
    "effects.interlobe_leakage.gap": "164 um",
}


MOST = {  # evaluations of the right-hand side, Jacobians' included: about twice what is needed
    "1 male lobes": 20_000,
    "10 male lobes": 20_000,
    "2 male lobes": 20_000,
    "3 male lobes": 20_000,
    "a chamber that never opens": 200_000,
    "a chamber that never opens, real": 6_000_000,
    "a heavy gas": 20_000,
    "a heavy gas of k near 1": 20_000,
    "back-flow": 30_000,
    "carried, 10 rpm": 200_000,
    "carried, 10000 rpm": 30_000,
    "carried, 240 rpm, fine": 5_000_000,
    "carried, 250 rpm": 900_000,
    "carried, 250 rpm, d = 0.09": 900_000,
    "carried, 250 rpm, fine": 6_000_000,
    "carried, 260 rpm, fine": 4_000_000,
    "carried, 30000 rpm": 30_000,
    "carried, 50 rpm": 300_000,
    "carried, d = 0": 400_000,
    "carried, d = 0.01": 30_000,
    "carried, d = 10": 30_000,
    "carried, d = 50": 30_000,
    "carried, d = 80": 40_000,
    "carried, dead volume 0.1": 30_000,
    "carried, dead volume 1e-09": 40_000,
    "carried, droplets 0.3 um": 30_000,
    "carried, droplets 1 mm": 30_000,
    "carried, droplets 3 um": 30_000,
    "carried, gaps 1 mm": 300_000,
    "carried, oil 80 K colder": 40_000,
    "carried, oil 80 K hotter": 30_000,
    "carried, opens at 719 deg": 600_000,
    "carried, over-compression": 30_000,
    "carried, ports times 0.01": 300_000,
    "carried, ports times 100": 40_000,
    "carried, pressure ratio 1.0001": 50_000,
    "carried, pressure ratio 60": 200_000,
    "carried, rough tables": 70_000,
    "dead volume 0.01": 20_000,
    "dead volume 0.1": 20_000,
    "dead volume 1e-06": 20_000,
    "dead volume 1e-09": 30_000,
    "found: closes only damped": 30_000_000,
    "found: closes only from a faster scene": 20_000_000,
    "found: closes only with tighter steps": 90_000,
    "found: entropy closes last": 500_000,
    "found: heats without end": 40_000_000,
    "found: heats without end, carried": 40_000_000,
    "found: oil all at once": 600_000,
    "gaps 1 mm": 200_000,
    "gaps 1 mm, 250 rpm": 200_000,
    "gaps 1 um": 20_000,
    "helium": 2_000_000,
    "hydrogen": 2_000_000,
    "opens at 361 deg": 20_000,
    "opens at 719 deg": 600_000,
    "over-compression": 20_000,
    "paper, 10 rpm": 200_000,
    "paper, 10000 rpm": 20_000,
    "paper, 250 rpm": 60_000,
    "paper, 30000 rpm": 30_000,
    "paper, 50 rpm": 200_000,
    "paper, d = 0": 20_000,
    "paper, d = 0.01": 20_000,
    "paper, d = 10": 20_000,
    "paper, d = 50": 20_000,
    "paper, d = 80": 20_000,
    "paper, droplets 0.3 um": 20_000,
    "paper, droplets 1 mm": 20_000,
    "paper, droplets 3 um": 20_000,
    "paper, oil 80 K colder": 20_000,
    "paper, oil 80 K hotter": 20_000,
    "phi_A = 0.1 deg": 40_000,
    "phi_A = 360 deg": 30_000,
    "phi_B = 0.1 deg": 20_000,
    "phi_B = 180 deg": 20_000,
    "phi_C = 600.1 deg": 20_000,
    "phi_C = 660 deg": 20_000,
    "ports alone": 20_000,
    "ports times 0.01": 300_000,
    "ports times 0.1": 30_000,
    "ports times 10": 40_000,
    "ports times 100": 30_000,
    "pressure ratio 1.0001": 20_000,
    "pressure ratio 1.05": 20_000,
    "pressure ratio 20": 30_000,
    "pressure ratio 60": 300_000,
    "real, 250 rpm": 700_000,
    "real, near-critical": 20_000,
    "real, superheat 1 K": 20_000,
    "real, transcritical": 30_000,
    "rough tables": 40_000,
    "hot oil, thin hot suction": 80_000,
    "two phases": 30_000,
    "two phases, 1e-5": 6_000_000,
}
AGAINST_RADAU = (  # compared with coupled chambers under a tight Radau
    "paper, 10000 rpm",
    "ports alone",
    "over-compression",
    "gaps 1 um",
    "paper, 30000 rpm",
    "pressure ratio 20",
    "pressure ratio 1.05",
    "back-flow",
    "paper, droplets 0.3 um",
    "paper, droplets 1 mm",
    "paper, d = 0",
    "paper, d = 50",
    "paper, oil 80 K hotter",
    "paper, oil 80 K colder",
    "ports times 0.1",
    "ports times 10",
    "ports times 100",
    "dead volume 0.1",
    "dead volume 1e-06",
    "phi_A = 360 deg",
    "phi_A = 0.1 deg",
    "phi_B = 180 deg",
    "phi_C = 660 deg",
    "opens at 361 deg",
    "gaps 1 mm",
    "paper, 250 rpm",
    "carried, 10000 rpm",
    "carried, over-compression",
    "carried, droplets 0.3 um",
    "pressure ratio 60",
    "a heavy gas",
)
CASES = [
    replace(case, most=MOST.get(case.name, case.most), radau=case.name in AGAINST_RADAU)
    for case in (*_speeds(), *_pressures(), *_oil(), *_geometry(), *_gases(), *_shut(), *_starts(), *_found())
]


HEAD = """\
# Hard cases

Scenes that a user could write and that break simpler programs. `tests/hard` solves every one: the status is the one
below; every number of the result and of its cycle is finite (but for the oil's temperature before it is injected); p, T
and m are positive; mass and energy close within the wanted accuracy; the right-hand side is evaluated at most as often
as stated. Where *Radau* is marked, work and trapped mass equal those of coupled chambers under a tight scipy Radau
within the wanted accuracy. *refused*: a bad scene, exit code 3 with the remedy; *failed*: exit code 4 with the angle.

Where the first try does not close a cycle (`numerics.closing: auto`), a tighter tolerance of the steps, damped closing
and a continuation from four times the speed are tried, and a warning of the result says which one it took.

This page is `hard_cases.page()`; a test compares the two.

| case | status | at most | Radau | why |
|---|---|---|---|---|
"""


def page() -> str:
    """Return the text of docs/hard-cases.md."""
    rows = [
        f"| {case.name} | {case.status} | {case.most if case.status != 'refused' else '–'} | "
        f"{'yes' if case.radau else ''} | {case.why} |"
        for case in CASES
    ]
    return HEAD + "\n".join(rows) + "\n"
