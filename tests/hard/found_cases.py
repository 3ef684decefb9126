"""Failures that random scenes found (`scripts/fuzz.py`), one of each kind."""

from __future__ import annotations

from case import BARE, CARRIED, Case, lines
from scenes import DROP

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
FAINT = {
    "effects.tip_leakage": DROP,
    "effects.blow_hole": DROP,
    "gas.fluid": "Helium",
    "operation.speed": "19.45 rpm",
    **lines("2.216649 bar", "2.217224 bar", "373.3 K"),
    "machine.volume.min": "2.972e-05 cm^3",
    "machine.volume.phi_A": "101.1 deg",
    "machine.suction_port.area": "0.4771 cm^2",
    "machine.suction_port.phi_B": "82.16 deg",
    "machine.discharge_port.area": "291.2 cm^2",
    "machine.discharge_port.opens": "579.2 deg",
    "machine.discharge_port.phi_C": "648.4 deg",
    "oil_supply.ratio": 0.0124,
    "oil_supply.temperature": "410.3 K",
    "effects.oil_heat.droplet_radius": "533.6 um",
    "effects.oil_heat.heat_transfer_coefficient": "92.26 W/(m^2 K)",
    "effects.interlobe_leakage.gap": "251.4 um",
    "effects.end_face_leakage.gap": "15.27 um",
    "numerics.closing": "coupled",
}
DRENCHED = {
    **CARRIED,
    "gas.fluid": "n-Dodecane",
    "operation.speed": "199.1 rpm",
    **lines("2.916704 bar", "3.028468 bar", "285 K"),
    "machine.volume.min": "1.977e-06 cm^3",
    "machine.volume.phi_A": "239.9 deg",
    "machine.suction_port.area": "399.7 cm^2",
    "machine.suction_port.phi_B": "22.24 deg",
    "machine.discharge_port.area": "1.616 cm^2",
    "machine.discharge_port.opens": "654.5 deg",
    "machine.discharge_port.phi_C": "685.7 deg",
    "oil_supply.ratio": 25.2,
    "oil_supply.temperature": "278.9 K",
    "effects.oil_heat.droplet_radius": "4.595 um",
    "effects.oil_heat.heat_transfer_coefficient": "201.4 W/(m^2 K)",
    "effects.tip_leakage.gap": "282.2 um",
    "effects.interlobe_leakage.gap": "93.86 um",
    "effects.end_face_leakage.gap": "1.121 um",
    "effects.blow_hole.area": "78.51 mm^2",
    "numerics.closing": "coupled",
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


def found_cases() -> list[Case]:
    """Return the cases."""
    heats = (
        "all but nothing gets out: what leaks back is compressed again and again, beyond 10 000 K, and never settles"
    )
    at_once = (
        "at 14 rpm the discharge line's oil comes and goes between turns, and a chamber of no oil (1e-9) takes it up "
        "within less than the smallest step"
    )
    finer = (
        "a change of the states by 1e-7 of themselves is more energy than the work of so small a pressure rise: more "
        "pitches are called for, not finer steps"
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
            "found: throttled suction",
            THROTTLED,
            "the suction port throttles, p_s is far below the line's, and the discharge line's liquid flows back",
            says=("no net gas is delivered",),
            slow=True,
        ),
        Case(
            "found: entropy closes last",
            STARVED,
            "mass and energy close at once where next to no gas goes through; entropy asks for two tighter closings",
        ),
        Case("found: oil all at once", FLOODED, at_once, "failed", "ok", says=("deg", "x_oil")),
        Case("found: tiny work, many turns", FAINT, finer, says=("no net gas is delivered",), slow=True),
        Case("found: tiny work, much oil", DRENCHED, finer, says=("the oil would fill",), slow=True),
    ]
