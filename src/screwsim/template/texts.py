"""The texts of new scenes: template files in this folder, in which `$name` is replaced by a value."""

from collections.abc import Mapping
from importlib.resources import files
from string import Template
from typing import NamedTuple

from screwsim.fluid.composition import is_blend
from screwsim.fluid.description import describe
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.template import sizes
from screwsim.template.request import SceneRequest

UNBOUNDED_COOLER = "whatever duty that takes\n  # (conductance and coolant_temperature give the cooler a size)."
BOUNDED_COOLER = (
    "as far as its cooler\n  # suffices: by estimates of flow and heat up to a room of some {room}, beyond which "
    "both rise together.\n  # {basis}; at 40 degC, up to which packages are usually made to run,\n  # "
    "80 to 95 degC follow."
)
FOLLOWS_PHASES = "two_phase: equilibrium"  # entry of a gas that may condense
DENSE = 25e5  # [Pa] discharge pressure from which oil takes up room: 1 to 2.5 points of lambda of new screws on CO2


class OilCooler(NamedTuple):
    """An oil cooler: the warmest room [K] in which it keeps the outlet temperature, and its conductance [W/K].

    `largest`: the effectiveness, where the most that is usual does not suffice for the room aimed at.
    """

    room: float
    conductance: float
    largest: float | None


def filled(name: str, values: Mapping[str, str]) -> str:
    """Return a text with its values filled in; each name must have one."""
    text = files("screwsim.template").joinpath(f"{name}.template").read_text(encoding="utf-8")
    return Template(text).substitute(values)


def sized(flow: float, speed: float) -> sizes.Size:
    """Return the rotors that displace a flow [m³/s] at a speed [rad/s]; raise UsageError outside manufactured sizes."""
    size = sizes.size_of(flow, speed)
    if sizes.SMALLEST <= size.diameter <= sizes.LARGEST:
        return size
    ends = [sizes.displaced(diameter, speed) for diameter in (sizes.SMALLEST, sizes.LARGEST)]
    stated = f"--displacement {sizes.flow_text(flow)} at {sizes.rpm(speed)}"
    what = f"would take rotors of {sizes.mm(size.diameter)}; screws are made from {sizes.mm(sizes.SMALLEST)} to"
    usual = " to ".join(f"{float(f'{3600.0 * end:.2g}'):g} m^3/h" for end in ends)
    raise UsageError(f"{stated}: {what} {sizes.mm(sizes.LARGEST)} (choose {usual}, or another --speed)")


def machine(size: sizes.Size, asked: SceneRequest, usual: float, pressures: float, slide: str = "") -> dict[str, str]:
    """Return the section on the machine, its flow and speed; `usual` is the built-in volume ratio for the pressures.

    `slide` has the lines of a slide valve.
    """
    told = f"for a pressure ratio of {pressures:.3g}; commercial machines have 1.8 to 5"
    if asked.ratio is not None:
        told = f"as requested; a pressure ratio of {pressures:.3g} calls for about {usual:g}"
    values = {
        "size": _size(size, asked.diameter is not None),
        "ratio": f"{asked.ratio or usual:g}",
        "ratio_told": told,
        "slide": slide,
    }
    flow = size.flow if asked.diameter is None else sizes.rounded_flow(size.flow)
    return {"machine": filled("rotors", values), "flow": sizes.flow_text(flow), "speed": sizes.rpm(size.speed)}


def _size(size: sizes.Size, by_diameter: bool) -> str:
    """Return the lines on the machine's size: by its rotors, or as in catalogues."""
    flow, speed = sizes.flow_text(size.flow), sizes.rpm(size.speed)
    diameter, length = sizes.mm(size.diameter, 6 if by_diameter else 4), sizes.mm(size.length, 4)
    if by_diameter:
        return f"  rotor_diameter: {diameter}    # gives rotors {length} long, which displace {flow} at {speed}"
    told = f"  # the size as in catalogues; it gives rotors of {diameter} x {length}"
    return f"{told}\n  displacement: {{flow: {flow}, at: {speed}}}"


def ports(size: sizes.Size, viscosity: str = "") -> str:
    """Return ports and gaps of a flooded machine; `viscosity` is the entry for that of its gas."""
    lands = {name: sizes.mm(depth * size.scale, 2) for name, depth in sizes.LAND_LENGTHS.items()}
    return filled("ports", {"gap": sizes.um(sizes.GAP * size.clearance), "viscosity": viscosity, **lands})


def shafts(size: sizes.Size, viscosity: str = "") -> str:
    """Return the leak past the shafts of a flooded compressor; `viscosity` as for its gaps."""
    values = {
        "shaft": sizes.mm(sizes.SHAFT_DIAMETER * size.scale),
        "clearance": sizes.um(sizes.SHAFT_CLEARANCE * size.clearance),
        "passage": sizes.mm(sizes.SHAFT_PASSAGE * size.scale, 2),
        "viscosity": viscosity,
    }
    return filled("shafts", values)


def flooded(
    size: sizes.Size, leaves: float, cooler: OilCooler | None = None, coolant: str = "", share: str = ""
) -> str:
    """Return the entries of a flooded gas machine with an outlet temperature [K]; sizes as in configs/air.

    `coolant` is the temperature of what cools its oil, as stated in a scene, where that is not the gas at its inlet.
    `share` is the entry on the friction that heats the oil, where that is not all.
    """
    big = size.diameter / 0.240
    kept, conductance = UNBOUNDED_COOLER, ""
    if cooler is not None:
        room = f"{cooler.room - ZERO_CELSIUS:.0f} degC"
        basis = (
            f"Its effectiveness is {cooler.largest:g}, the most assumed" if cooler.largest else "That room is assumed"
        )
        kept = BOUNDED_COOLER.format(room=room, basis=basis)
        conductance = f", conductance: {1e-3 * cooler.conductance:.2g} kW/K"
        conductance += f", coolant_temperature: {coolant}" if coolant else ""
    values = {
        "ports": ports(size) + shafts(size),
        "leaves": f"{leaves - ZERO_CELSIUS:.0f} degC",
        "kept": kept,
        "conductance": conductance,
        "share": share,
        "gap": sizes.um(sizes.GAP * size.clearance),
        "shaft": sizes.mm(sizes.SHAFT_DIAMETER * size.scale),
        "bearing": sizes.mm(0.147 * big),
        "land": sizes.mm(0.003 * big, 2),
    }
    return filled("flooded", values)


def oil_room(p_d: float) -> str:
    """Return the entry by which oil takes up room, beside gas that is dense at its discharge pressure [Pa]; else ''."""
    return filled("oil_room", {"dense": f"{1e-5 * DENSE:g} bar"}) if p_d >= DENSE else ""


def two_phase(fluid: str, condenses: bool) -> str:
    """Return the entry that follows two phases of a gas that may condense; a mixture described as if pure has none."""
    return f", {FOLLOWS_PHASES}" if condenses and (is_blend(fluid) or not describe(fluid).glides) else ""
