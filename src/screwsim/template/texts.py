"""The texts of new scenes: files beside this one, in which `$name` stands for a value."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from string import Template

from screwsim.inputs.faults import UsageError
from screwsim.template import sizes

SMALLEST, LARGEST = 0.05, 0.55  # [m] of rotors that are cut


@cache
def _template(name: str) -> Template:
    return Template(files("screwsim.template").joinpath(f"{name}.template").read_text(encoding="utf-8"))


def filled(name: str, values: Mapping[str, str]) -> str:
    """Return a text with values; each of its names must have one."""
    return _template(name).substitute(values)


def sized(flow: float, speed: float) -> sizes.Size:
    """Return the rotors that displace a flow [m³/s] at a speed [rad/s]; raise UsageError for none that are cut."""
    size = sizes.size_of(flow, speed)
    if SMALLEST <= size.diameter <= LARGEST:
        return size
    ends = [sizes.displaced(diameter, speed) for diameter in (SMALLEST, LARGEST)]
    stated = f"--displacement {sizes.flow_text(flow)} at {sizes.rpm(speed)}"
    what = f"would take rotors of {sizes.mm(size.diameter)}; screws are cut from {sizes.mm(SMALLEST)} to"
    usual = " to ".join(f"{float(f'{3600.0 * each:.2g}'):g} m^3/h" for each in ends)
    raise UsageError(f"{stated}: {what} {sizes.mm(LARGEST)} (choose {usual}, or another --speed)")


def machine(size: sizes.Size, asked: float | None, usual: float, pressures: float, flow: float, speed: float) -> str:
    """Return the section of the machine; `asked` is a built-in volume ratio, `usual` what the pressures call for."""
    told = f"for a pressure ratio of {pressures:.3g}; machines are sold with 1.8 to 5"
    if asked is not None:
        told = f"as asked; a pressure ratio of {pressures:.3g} calls for about {usual:g}"
    values = {
        "diameter": sizes.mm(size.diameter, 4),
        "length": sizes.mm(size.length, 4),
        "flow": sizes.flow_text(flow),
        "speed": sizes.rpm(speed),
        "ratio": f"{asked or usual:g}",
        "ratio_told": told,
    }
    return filled("rotors", values)


def ports(size: sizes.Size, viscosity: str = "") -> str:
    """Return ports and gaps of a flooded machine; `viscosity` states that of its gas."""
    lands = {name: sizes.mm(depth * size.scale, 2) for name, depth in sizes.LANDS.items()}
    return filled("ports", {"gap": sizes.um(sizes.GAP * size.clearance), "viscosity": viscosity, **lands})


def flooded(size: sizes.Size) -> str:
    """Return what a flooded machine on a gas has, sizes as shares of that of configs/air/fixed_speed_7.yaml."""
    big = size.diameter / 0.240
    values = {
        "ports": ports(size),
        "gap": sizes.um(sizes.GAP * size.clearance),
        "shaft": sizes.mm(0.105 * big),
        "shaft_clearance": sizes.um(42e-6 * size.clearance),
        "shaft_passage": sizes.mm(0.015 * big, 2),
        "radial_area": f"{158.0 * big**2:.3g} cm^2",
        "axial_area": f"{67.0 * big**2:.3g} cm^2",
        "bearing": sizes.mm(0.147 * big),
        "land": sizes.mm(0.003 * big, 2),
    }
    return filled("flooded", values)
