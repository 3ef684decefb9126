"""Warnings of what is possible but unusual in a scene.

Single values are compared with the bounds that their fields declare (`hardly=`), sizes with those of the machine
(`scene.sizes`), gas and oil with what the fluid allows and what models and data hold for. The scene is solved as it is
written.
"""

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from screwsim.effects import having
from screwsim.effects.parts.oil import oil_in_chambers
from screwsim.effects.parts.usual import SLIDES
from screwsim.fluid import constants
from screwsim.fluid.models import condenses, find_gas_model
from screwsim.fluid.oils import OILS
from screwsim.fluid.settings import GasSettings
from screwsim.inputs.declare import KINDS, UNBOUNDED, VOLUME, is_derived
from screwsim.inputs.faults import UsageError
from screwsim.machine.paper_law import TURN
from screwsim.machine.rotors.settings import Profile, unused_parameters
from screwsim.machine.settings import TwinScrew, VolumeLaw
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.numerics.spline import read_curve, slope_oscillation
from screwsim.outputs.customary import in_celsius
from screwsim.scene.fields import Leaf, Section, section_of, value_at
from screwsim.scene.lines import Lines, lines
from screwsim.scene.operation import CONDENSING, GAS_COOLER, GAS_COOLER_P, P_D, T_S
from screwsim.scene.sizes import size_warnings
from screwsim.scene.types import ActiveEffect, Scene
from screwsim.scene.units import readable_quantity

MILLIKELVIN = 1e-3  # [K]
ROUNDING = 1e-12  # relative, of a value that its unit converts: 1.1 bar are 110 000.000 000 000 01 Pa
ASK_IF_MEANT = "is that intended?"
# share of the largest volume that a table's smallest may have: the displacement is off by as much
LEAST_VOLUME_SHARE = 1e-3
MIRRORED_RATIO = 1.5  # ratio of a lobe's blow-hole areas from which it looks mirrored: asymmetric profiles have 0.1
RESCALED_DEVIATION = 0.01  # relative deviation allowed between a table's largest volume and the stated one
# over its largest slope, how far a table's slope may jump back and forth; cut-off digits give half of it
ROUGH_SLOPE = 0.25
# share of the largest volume, at the injection angle, below which a table's angles may begin elsewhere than the scene's
STILL_GROWS, HAS_FALLEN = 0.99, 0.9
LEAST_COMPRESSIBILITY = 0.8  # of a line's gas, below which it is a quarter and more denser than an ideal gas
USUAL_RATIO = 30.0  # usual pressure ratio in one machine, higher over lower, at the most
# kg of oil per kg of gas with which rotors still run on each other, without timing gears ("oil-reduced"): L. Sjöholm,
# Different operational modes for refrigeration twin-screw compressors, Purdue 1986, paper 518
LEAST_OIL_RATIO = 0.01
PLAIN_SECTIONS = ("gas", "oil", "operation", "oil_supply", "machine")


def scene_warnings(scene: Scene) -> tuple[str, ...]:
    """Return warnings about a scene that passed `cross_check`, one line each, which begins with the path."""
    of_machine = *_volume(scene), *_profile(scene), *size_warnings(scene)
    found = [*_fields(scene), *of_machine, *_lines(scene), *_oil(scene), *_films(scene)]
    return tuple(f"{path}: {what}; {ASK_IF_MEANT}" for path, what in found)


def _fields(scene: Scene) -> Iterator[tuple[str, str]]:
    for name in PLAIN_SECTIONS:
        part = getattr(scene, name)
        if part is not None:
            yield from _section_warnings(part, name)
    yield from _effect_warnings(scene.effects)


@IdentityCache
def _section_warnings(part: Any, path: str) -> tuple[tuple[str, str], ...]:
    return tuple(_outside_usual_range(part, path))


@IdentityCache
def _effect_warnings(effects: Mapping[str, ActiveEffect]) -> tuple[tuple[str, str], ...]:
    found = (_outside_usual_range(effect.parameters, f"effects.{name}") for name, effect in effects.items())
    return tuple(chain.from_iterable(found))


def _outside_usual_range(part: Any, path: str) -> Iterator[tuple[str, str]]:
    """Yield (path, what) of the values of a section, and of those below it, outside their usual bounds."""
    leaves, sections = _bounded(type(part))
    for name, leaf, low, high in leaves:
        value = getattr(part, name)
        if value is not None and not low - ROUNDING * abs(low) <= value <= high + ROUNDING * abs(high):
            over = value > high
            usual = f"at most {_shown(leaf, high)}" if over else f"at least {_shown(leaf, low)}"
            yield f"{path}.{name}", f"{_shown(leaf, value)} is unusual (usual: {usual})"
    for name in sections:
        inner = getattr(part, name)
        if inner is not None:
            yield from _outside_usual_range(inner, f"{path}.{name}")


@cache
def _bounded(cls: type) -> tuple[tuple[tuple[str, Leaf, float, float], ...], tuple[str, ...]]:
    """Return (name, leaf, low, high) of the fields of a section with usual bounds, and the names of its sections."""
    fields, leaves = section_of(cls).fields, []
    for name, item in fields.items():
        if isinstance(item, Leaf) and item.hardly != UNBOUNDED:
            low, high = item.hardly
            leaves.append((name, item, -math.inf if low is None else low, math.inf if high is None else high))
    return tuple(leaves), tuple(name for name, item in fields.items() if isinstance(item, Section))


def _shown(leaf: Leaf, value: float) -> str:
    return f"{value:.6g}" if leaf.dimension is None else readable_quantity(leaf.dimension, value)


def _volume(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings of a table of volumes that never reaches zero, is rough, is rescaled, or begins elsewhere."""
    law = getattr(scene.machine, "volume", None)  # a user-defined machine may have anything here
    if isinstance(law, VolumeLaw) and law.file is not None:
        angles, volumes = read_curve(str(law.file), VOLUME)
        yield from _of_table(angles, volumes)
        yield from _rescaled_volumes(law, float(np.max(volumes)))
        yield from _moved_volumes(law, angles, volumes)


def _moved_volumes(law: VolumeLaw, angles: np.ndarray, volumes: np.ndarray) -> Iterator[tuple[str, str]]:
    """Yield a warning where a chamber counts as closed long before or after its largest volume."""
    closed, largest = law.injection_angle or TURN, float(angles[np.argmax(volumes)])
    share = float(np.interp(closed, angles, volumes) / np.max(volumes))
    if share < (STILL_GROWS if largest > closed else HAS_FALLEN):
        what = f"the volume of the table is largest at {math.degrees(largest):.4g} deg, and {share:.1%} of that at"
        what += f" {math.degrees(closed):.4g} deg, where its gas counts as trapped and oil comes in"
        yield (
            "machine.volume.file",
            f"{what} (shift its angles and the ports', or write machine.volume.injection_angle)",
        )


def _rescaled_volumes(law: VolumeLaw, largest: float) -> Iterator[tuple[str, str]]:
    """Yield a warning where the volumes of a table are rescaled to the largest volume that the scene states."""
    if law.max is None or abs(law.max - largest) <= RESCALED_DEVIATION * largest or is_derived(law.max):
        return
    held, stated = (readable_quantity(KINDS["volume"], round(each, 12)) for each in (largest, law.max))
    what = f"a table whose largest volume is {held} is scaled to {stated} (max: {held} keeps it as it is)"
    yield "machine.volume.max", what


@IdentityCache
def _of_table(angles: np.ndarray, volumes: np.ndarray) -> tuple[tuple[str, str], ...]:
    """Return warnings about swept volumes that never reach zero (the largest counts as displacement), or jump."""
    told, least = [], float(np.min(volumes) / np.max(volumes))
    if least > LEAST_VOLUME_SHARE:
        what = f"the smallest volume of the table is {least:.2%} of its largest, which is the swept volume only if the"
        told.append(f"{what} smallest is 0 (subtract it from all rows, and write it as machine.volume.min)")
    share, at = slope_oscillation(angles, volumes)
    if share > ROUGH_SLOPE:
        what = f"the slope of the volume jumps back and forth from row to row, at {math.degrees(at):.4g} deg by"
        told.append(f"{what} {share:.0%} of the largest (use a smoother table, more digits, or fewer rows)")
    return tuple(("machine.volume.file", each) for each in told)


def _profile(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings of values of the profile that are not used, of a mirrored lobe, of a slide without its slot."""
    profile = getattr(scene.machine, "profile", None)
    if isinstance(profile, Profile):
        yield from unused_parameters(profile)
        if profile.measured and isinstance(scene.machine, TwinScrew) and scene.machine.volume.from_rotors:
            yield from _mirrored_lobe(scene.machine)
    slide = scene.machine.slide_valve if isinstance(scene.machine, TwinScrew) else None
    if slide is not None and slide.position > 0.0:
        effect = having(SLIDES)[0].rpartition(".")[0]
        if not any(f"effects.{name}" == effect for name in scene.effects):
            what = f"moves the radial port alone: the slot to suction opens with {effect}, absent here, so that the"
            yield "machine.slide_valve.position", f"{what} flow is that of full load (write {effect}: {{}})"


def _mirrored_lobe(machine: TwinScrew) -> Iterator[tuple[str, str]]:
    from screwsim.machine.profile_law import laid_curves  # imported here so that scenes without rotors start faster

    with suppress(UsageError):  # for rotors that cannot be laid out, which is reported where they are built
        rotors = laid_curves(machine).rotors
        high, low = rotors.blow_hole.area(rotors.h), rotors.suction_blow_hole.area(rotors.h)
        if high > MIRRORED_RATIO * low:
            holes = f"{1e6 * high:.4g} mm² at the high-pressure cusp, {1e6 * low:.4g} mm² at the suction cusp"
            what = f"the larger blow-hole is the high-pressure one ({holes}), as for a lobe of the opposite hand"
            yield "machine.profile.file", f"{what} (reverse the sign of its y if so)"


# ---- gas and oil ----------------------------------------------------------------------------------------------


def _lines(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings about the lines: a large pressure ratio, an ideal gas where its fluid is a liquid."""
    at = lines(scene)
    ratio = max(at.p_d / at.p_s, at.p_s / at.p_d)
    if ratio > USUAL_RATIO:
        path = next((each for each in (P_D, GAS_COOLER_P) if value_at(scene, each) is not None), CONDENSING)
        yield path, f"the pressure ratio of a single machine is {ratio:.4g} (usual: at most {USUAL_RATIO:g})"
    cooler = scene.operation.gas_cooler
    limits = None if cooler is None else constants.limits(scene.gas.name)
    if cooler is not None and (limits is None or cooler.pressure < limits.p_critical):
        T = constants.saturation_temperature(scene.gas.name, cooler.pressure)
        if cooler.outlet_temperature > T:
            here, dew = map(in_celsius, (cooler.outlet_temperature, T))
            what = f"{scene.gas.name} leaves it as a gas at {here}: it condenses below the critical pressure, at {dew}"
            yield f"{GAS_COOLER}.outlet_temperature", f"{what} (choose a colder one, or a higher pressure)"
    if find_gas_model(scene.gas.model).blind:
        boiling = constants.liquid_below(scene.gas.name, at.p_s, at.T_s)
        if boiling is not None:
            p = readable_quantity(KINDS["pressure"], at.p_s)
            here, until = map(in_celsius, (at.T_s, boiling))
            what = f"{scene.gas.name} of {p} is a liquid at {here}, and a gas above {until}"
            remedy = "use warmer gas, or gas.model: real, which refuses it"
            yield T_S, f"{what}; gas.model: ideal treats it as a gas ({remedy})"
        else:
            yield from _dense(scene.gas, at)


def _dense(gas: GasSettings, at: Lines) -> Iterator[tuple[str, str]]:
    """Yield a warning where a gas that is taken as ideal is much denser than that in one of its lines (M5).

    The denser line: that of suction, or that of discharge at the temperature of isentropic compression, where the gas
    is least dense.
    """
    limits = constants.limits(gas.name)
    if limits is None or limits.gas_only:
        return
    k = gas.isentropic_exponent or constants.isentropic_exponent(gas.name, at.T_s)
    hot = at.T_s * max(at.p_d / at.p_s, 1.0) ** ((k - 1.0) / k)
    found = {(p, T): virial_compressibility(limits, p, T) for p, T in ((at.p_s, at.T_s), (at.p_d, hot))}
    (p, T), Z = min(found.items(), key=lambda each: each[1])
    if Z < LEAST_COMPRESSIBILITY:
        state = f"{readable_quantity(KINDS['pressure'], round(p, 1))}, {in_celsius(round(T, 1))}"
        what = f"{gas.name} of {state} is about {1.0 / Z - 1.0:.0%} denser than the ideal gas as which it is taken"
        yield "gas.model", f"{what} (write gas.model: real)"


def virial_compressibility(limits: constants.Limits, p: float, T: float) -> float:
    """Return p/(ρ R T) of a gas at p [Pa], T [K] by its second virial coefficient, an estimate that is rather too high.

    Source: K. S. Pitzer's correlation in the form of M. M. Abbott, of a simple fluid: Z = 1 + (p_r/T_r)(0.083 − 0.422
    T_r^−1.6), as in J. M. Smith, H. C. Van Ness, M. M. Abbott, Chemical Engineering Thermodynamics.
    """
    T_r = T / limits.T_critical
    return max(1.0 + p / limits.p_critical / T_r * (0.083 - 0.422 * T_r**-1.6), 0.1)


def _oil(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings where there is too little oil for rotors, or where a real gas condenses on oil that is cold."""
    supply = scene.oil_supply
    ratio = None if supply is None or not isinstance(scene.machine, TwinScrew) else supply.ratio
    if ratio is not None and ratio < LEAST_OIL_RATIO:
        what = f"{ratio:.4g} kg of oil per kg of gas hardly lubricate rotors that drive each other"
        why = f"usual: at least {LEAST_OIL_RATIO:g}; lubrication is not modelled"
        yield "oil_supply.ratio", f"{what} ({why}; leave oil_supply out of a machine with timing gears)"
    if supply is None or supply.temperature is None or not condenses(scene.gas) or not oil_in_chambers(scene.effects):
        return
    at, line = lines(scene), "suction" if scene.machine.expands else "discharge"
    p = max(at.p_s, at.p_d)
    with suppress(UsageError):  # above the critical pressure
        T = constants.saturation_temperature(scene.gas.name, p)
        if supply.temperature < T - MILLIKELVIN:  # a dew point that a scene states may be off by rounding
            cold, warm = map(in_celsius, (supply.temperature, T))
            what = f"{scene.gas.name} condenses on it at the {line} pressure, {1e-5 * p:.4g} bar, below {warm}"
            yield "oil_supply.temperature", f"the oil enters at {cold}; {what} (use warmer oil)"


def _films(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield a warning for each film of a stored oil whose stated temperature lies beyond its viscosity data (M140)."""
    if scene.oil is None or scene.oil.name is None:
        return
    known = OILS[scene.oil.name]
    for name, active in scene.effects.items():
        T = getattr(active.parameters, "film_temperature", None)
        if T is not None and not known.low <= T <= known.high:
            reach = f"{in_celsius(known.low)} to {in_celsius(known.high)}"
            what = f"the viscosity of {scene.oil.name} is known from {reach}, and extrapolated to {in_celsius(T)}"
            yield f"effects.{name}.film_temperature", what
