"""What was tried for the sign of volumetric efficiency over oil flow: changes of machine.yaml, by name."""

from __future__ import annotations

GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")
NO_PORT = "effects.oil_injection=off"
COARSE = "effects.oil_heat={droplet_radius: 50 um, heat_transfer_coefficient: 540 W/(m^2 K)}"
ROOM = "effects.oil_volume={}"
PLAIN = "shaft_diameter: null, clearance: null, model: nozzle, mixture_viscosity: null, passage: null"
NO_LINE = ("effects.shaft_leakage=off", "effects.suction_line=off")
DRY = tuple(f"effects.{each}={{gap: 40 um, model: nozzle, mixture_viscosity: null, passage: null}}" for each in GAPS)
FILM = "model: oil_film, mixture_viscosity: null, filled_from: 30, gap: 40 um"
FILMS = tuple(f"effects.{each}={{{FILM}}}" for each in GAPS)
CICCHITTI = tuple(f"effects.{each}.mixture_viscosity=cicchitti" for each in (*GAPS, "shaft_leakage"))
FRICTION = (  # as in validation/cagi/machine.yaml, for rotors of 160 mm
    "effects.mechanical=off",
    "effects.hydromechanical={acceleration_factor: 1, viscous_coefficient: 0}",
    "effects.oil_drag={tip_gap: 26.1 um, tip_land: 2 mm, end_gap: 26.1 um, end_solidity: 0.63}",
    "effects.bearings={friction: two_term, load: gas, radial_area: 18 cm^2, axial_area: 26 cm^2, "  # of M146
    "mean_diameter: 98 mm, f_0: 2, f_1: 0.0004}",
)
FIRST = (*DRY, *NO_LINE, COARSE)  # the machine as first taken, but for where its oil comes in

TRIED: dict[str, tuple[str, ...]] = {
    "dry gaps of 40 µm, no shaft leak, droplets of 50 µm, oil at the suction's closing": (*FIRST, NO_PORT),
    "the same, oil as cold as the gas": (*FIRST, NO_PORT, "oil_supply.temperature=294 K"),
    "the same, oil takes room": (*FIRST, NO_PORT, ROOM),
    "the same, oil through a port behind the closing": FIRST,
    "the same, gaps filled by oil from 30 kg/kg on, through a port": (*FILMS, *NO_LINE, COARSE),
    "the same, gaps of 26.1 µm that oil seals, at the closing": (*NO_LINE, COARSE, NO_PORT),
    "the same, sealed and through a port": (*NO_LINE, COARSE),
    "machine.yaml": (),
    "machine.yaml, oil at the suction's closing": (NO_PORT,),
    "machine.yaml, no shaft leak": ("effects.shaft_leakage=off",),
    "machine.yaml, shafts as a nozzle of 9.6 mm²": (f"effects.shaft_leakage={{{PLAIN}, area: 9.6 mm^2}}",),
    "machine.yaml, viscosity of the mixture by Cicchitti": CICCHITTI,
    "machine.yaml, oil takes room": (ROOM,),
    "machine.yaml, droplets of 50 µm": (COARSE,),
    "machine.yaml, friction by films and bearings as in validation/cagi": FRICTION,
}
