"""Checks that need the whole scene: ranges of angles, states of the lines, oil and its supply, effects, curve files."""

import math
import os
from collections.abc import Iterator

from screwsim.effects import having, stating
from screwsim.effects.base import CoolsOil
from screwsim.effects.parts.usual import PUMPS
from screwsim.fluid.oils import OILS
from screwsim.fluid.orifice import FITTED_SLENDERNESS, NO_FLOW
from screwsim.inputs.declare import AREA, VOLUME, FoundWithCycle
from screwsim.inputs.faults import Fault, UsageError, given_twice
from screwsim.machine.kinds import check_machine, kind_of, kinds_offering
from screwsim.machine.protocol import OIL
from screwsim.outputs.customary import in_celsius
from screwsim.scene.derived_values import stated_faults
from screwsim.scene.fields import leaves_of, value_at
from screwsim.scene.operation import check_operation
from screwsim.scene.sizes import area_fault, size_faults
from screwsim.scene.types import Scene, parameters_of_type

FLUID = "gas.fluid"
KIND = "machine.kind"
# last angle of an area table over 720 deg whose angles are written in radians
ANGLE_IN_RADIANS = math.radians(4.0 * math.pi)
ANGLE_ROUNDING = math.radians(0.01)  # tolerance on the angle of a table's last row at the end of the life
_DISPLACED = "displaced oil follows from its bore"
LEAST_SPAN = 0.5  # least share of a chamber's life that a table of its volume must cover


def cross_check(scene: Scene) -> list[Fault]:
    """Return the faults of a scene, or of one case of its grid, whose fields are each valid."""
    stated = stated_faults(scene)
    if stated:
        return stated
    machine = check_machine(scene.machine)
    if any(fault.path == KIND for fault in machine):
        return machine  # the user's own machine module is faulty: it cannot report a size or speed
    operation = check_operation(scene)
    found = [
        *machine,
        *size_faults(scene),
        *operation,
        *([] if operation else _oil_with_gas(scene)),
        *_oil_without_injection(scene),
        *oil_faults(scene),
        *_oil_supply(scene),
        *_effects(scene),
    ]
    if not found:
        return list(_on_geometry(scene))
    if all(fault.path != FLUID for fault in found):
        return found
    return [fault for fault in found if f"{FLUID}: " not in fault.what]  # drop faults that follow from an unknown fluid


def _oil_without_injection(scene: Scene) -> Iterator[Fault]:
    """Yield faults for oil stated with a machine into which no oil is injected."""
    kind = kind_of(scene.machine)
    for name in ("oil", "oil_supply") if OIL not in kind.offers else ():
        if getattr(scene, name) is not None:
            fitting = kinds_offering(frozenset({OIL}))
            what = f"applies only to machine.kind: {fitting}; no oil is injected into {kind.chamber} (remove it)"
            yield Fault(name, what)


def _oil_with_gas(scene: Scene) -> Iterator[Fault]:
    """Yield faults of the oil of an expander, which comes in with the gas (M490)."""
    supply = scene.oil_supply
    if supply is None or not scene.machine.expands:
        return
    comes = "an expander's oil comes in with its gas, in a stated ratio"
    if not supply.pumped:
        yield Fault("oil_supply.kind", f"displacement needs machine.mode: compressor ({comes}: write kind: pump)")
    remedy = "write ratio, e.g. ratio: 0.5, in its place" if supply.ratio is None else "remove it"
    for name in ("discharge_temperature", "flow"):
        if getattr(supply, name) is not None:
            yield Fault(f"oil_supply.{name}", f"needs machine.mode: compressor ({comes}: {remedy})")
    if scene.oil is not None and not scene.oil.carried:
        yield Fault("oil.transport", f"needs machine.mode: compressor ({comes}: write transport: carried)")
    cooling, pumps = _cooling(scene), having(PUMPS)
    if cooling is not None and not any(pump.removeprefix("effects.") in scene.effects for pump in pumps):
        what = f"lies behind an expander's outlet, and nothing lifts its oil to the inlet (name {' or '.join(pumps)})"
        yield Fault(f"effects.{cooling[0]}", what)
    if cooling is not None and supply.from_sump:
        what = f"effects.{cooling[0]}, from which the oil comes, lies behind an expander's outlet"
        yield Fault("oil_supply.source", f"{what} (write source: separator)")


def oil_faults(scene: Scene) -> Iterator[Fault]:
    """Yield properties of the oil that are missing, or that are given beside the name of a stored oil."""
    oil, supply = scene.oil, scene.oil_supply
    if oil is None:
        return
    for field, example in (("density", "980 kg/m^3"), ("heat_capacity", "2.0 kJ/(kg K)"), ("viscosity", "")):
        value, path = getattr(oil, field), f"oil.{field}"
        if oil.name is not None and value is not None:
            yield given_twice(path, "oil.name, which defines it")
        elif oil.name is None and value is None and example:
            remedy = f"write e.g. {field}: {example}, or the name of a stored oil, e.g. oil.name: POE_68"
            yield Fault(path, f"is missing ({remedy})")
    if oil.name is not None and supply is not None and supply.temperature is not None:
        stored = OILS[oil.name]
        if not stored.low <= supply.temperature <= stored.high:
            what = f"lies outside the range of {oil.name}, {in_celsius(stored.low)} to {in_celsius(stored.high)}"
            what = f"{in_celsius(supply.temperature)} {what}"
            yield Fault("oil_supply.temperature", f"{what} ({_into_range(scene, supply.temperature > stored.high)})")


def _into_range(scene: Scene, hot: bool) -> str:
    """Return how oil comes into the range of its properties: its temperature is stated, or follows from its cooler."""
    cooling = _cooling(scene)
    if cooling is None or scene.oil_supply is None or not isinstance(scene.oil_supply.temperature, FoundWithCycle):
        return "choose one inside, or state the properties of the oil as numbers"
    if not hot:
        return "cool it less: colder oil takes more friction, so that no duty may suffice for a low temperature"
    name, cooler = cooling
    return f"cool the oil, e.g. effects.{name}.{cooler.outlet_key}: 60 degC, or state its properties as numbers"


def _oil_supply(scene: Scene) -> Iterator[Fault]:
    supply = scene.oil_supply
    if supply is None:
        return
    if scene.oil is None:
        yield Fault("oil", "is missing (oil_supply needs it: write density and heat_capacity, or remove oil_supply)")
    if supply.temperature is None and _cooling(scene) is None:
        remedy = f"write e.g. temperature: 325 K, or name effects.{stating(CoolsOil)}, which finds it"
        yield Fault("oil_supply.temperature", f"is missing ({remedy})")
    if not scene.machine.expands or (supply.pumped and supply.discharge_temperature is None):  # else: `_oil_with_gas`
        yield from _pump(scene) if supply.pumped else _displacement(scene)


def _cooling(scene: Scene) -> tuple[str, CoolsOil] | None:
    """Return the effect that cools the oil and may find its temperature, as (name, parameters); None without one."""
    return next(iter(parameters_of_type(scene.effects, CoolsOil).items()), None)


def _pump(scene: Scene) -> Iterator[Fault]:
    supply = scene.oil_supply
    assert supply is not None
    if supply.discharge_temperature is not None:
        yield from _sought_oil_flow(scene)
    elif supply.ratio is None and supply.flow is None:
        yield Fault("oil_supply.ratio", "is missing (kind: pump needs it, e.g. ratio: 3)")
    if supply.flow is not None:
        beside = "oil_supply.ratio" if supply.ratio is not None and not isinstance(supply.ratio, FoundWithCycle) else ""
        beside = beside or ("oil_supply.discharge_temperature" if supply.discharge_temperature is not None else "")
        if beside:
            yield given_twice("oil_supply.flow", beside)
    for name, default in (("orifice_diameter", None), ("orifice_length", None), ("orifice_count", 1.0)):
        if getattr(supply, name) != default:
            yield Fault(f"oil_supply.{name}", "applies only to kind: displacement (remove it, or change the kind)")
    if supply.line is not None:
        what = "applies to displaced oil; with kind: pump the pump overcomes the loss"
        yield Fault("oil_supply.line", f"{what} (write it under {having(PUMPS)[0]})")


def _sought_oil_flow(scene: Scene) -> Iterator[Fault]:
    """Yield faults of what cannot be combined with an oil flow sought for a discharge temperature."""
    supply, path = scene.oil_supply, "oil_supply.discharge_temperature"
    assert supply is not None and supply.discharge_temperature is not None
    cooling = _cooling(scene)
    if supply.ratio is not None and not isinstance(supply.ratio, FoundWithCycle):
        yield Fault("oil_supply.ratio", f"is given as well as {path}, which finds it (remove one of the two)")
    if cooling is None:
        yield Fault(path, f"needs effects.{stating(CoolsOil)}, where gas and oil have one temperature (name it)")
        return
    name, parameters = cooling
    cold = parameters.outlet or supply.temperature
    if cold is None or isinstance(supply.temperature, FoundWithCycle):
        what = "needs oil at a stated temperature (write oil_supply.temperature, or"
        if cold is None and parameters.bounded:
            what = "needs oil at a stated temperature, which a cooler of a stated size may not keep"
            yield Fault(path, f"{what} (remove effects.{name}.{parameters.size_key})")
        elif cold is None:
            yield Fault(path, f"{what} effects.{name}.{parameters.outlet_key}: 50 degC)")
    elif cold >= supply.discharge_temperature:
        what = f"{in_celsius(supply.discharge_temperature)} is not above the oil's {in_celsius(cold)}"
        yield Fault(path, f"{what} (raise it, or cool the oil)")


def _displacement(scene: Scene) -> Iterator[Fault]:
    supply = scene.oil_supply
    assert supply is not None
    for name, stated, why in (
        ("discharge_temperature", supply.discharge_temperature, f", whose ratio it finds; {_DISPLACED}"),
        ("ratio", supply.ratio, "; displacement finds it from the orifice"),
        ("flow", supply.flow, f"; {_DISPLACED}"),
        ("source", supply.from_sump or None, "; displacement draws from the separator"),
    ):
        if stated is not None:
            yield Fault(f"oil_supply.{name}", f"applies only to kind: pump{why} (remove it)")
    if supply.orifice_diameter is None:
        yield Fault("oil_supply.orifice_diameter", "is missing (kind: displacement needs it, e.g. 3 mm)")
    elif supply.orifice_length is not None and supply.orifice_length >= NO_FLOW * supply.orifice_diameter:
        length = supply.orifice_length / supply.orifice_diameter
        what = f"is {length:.3g} diameters: no formula covers so long a bore"
        low, high = FITTED_SLENDERNESS
        yield Fault("oil_supply.orifice_length", f"{what} (choose {low:g} to {high:g} diameters)")
    if scene.oil is not None and not scene.oil.knows_viscosity:
        yield Fault("oil.viscosity", "is missing (oil_supply.kind: displacement needs it, e.g. viscosity: 20 mPa s)")


def _effects(scene: Scene) -> Iterator[Fault]:
    lacking = [name for name in ("oil", "oil_supply") if getattr(scene, name) is None]
    kind = kind_of(scene.machine)
    for name, active in scene.effects.items():
        path = f"effects.{name}"
        if not active.effect.fits(kind):
            fitting = kinds_offering(active.effect.needs)
            fitting = f"applies only to machine.kind: {fitting}" if fitting else f"is not for a {scene.machine.kind}"
            yield Fault(path, f"{fitting} (remove the effect, or change the machine)")
            continue
        if not active.effect.suits(kind, scene.machine.expands, scene.oil_supply is not None):
            dry = ", or to an expander without oil" if active.effect.in_expander == "dry" else ""
            yield Fault(path, f"applies only to machine.mode: compressor{dry} (remove it)")
            continue
        if active.effect.needs_oil and lacking:
            what = f"needs {' and '.join(lacking)}, which this scene lacks (write that, or remove the effect)"
            yield Fault(path, what)
        elif active.effect.check is not None:
            yield from active.effect.check(active.parameters, scene)


def _on_geometry(scene: Scene) -> Iterator[Fault]:
    """Yield faults of effects on the machine's geometry; called on a scene that is otherwise in order."""
    asking = [active for active in scene.effects.values() if active.effect.check_geometry is not None]
    geometry = kind_of(scene.machine).geometry(scene.machine) if asking else None
    for active in asking:
        if active.effect.check_geometry is not None:
            yield from active.effect.check_geometry(active.parameters, geometry)


def check_files(scene: Scene) -> list[Fault]:
    """Return the faults of the curve files that a scene names: missing, unreadable, or not a curve."""
    faults = []
    curves = {path: leaf.limits["curve"] for path, leaf in leaves_of(scene).items() if "curve" in leaf.limits}
    for path, column in curves.items():  # all other files are checked where they are read
        name = value_at(scene, path)
        what = None if name is None else _curve_fault(name, column, scene)
        if what is not None:
            faults.append(Fault(path, what))
    return faults


def _curve_fault(name: str, column: str, scene: Scene) -> str | None:
    shown = repr(os.path.relpath(name, scene.folder))
    if not os.path.isfile(name):
        return f"{shown} is not a file in {scene.folder} (name an existing CSV file, relative to the scene)"
    from screwsim.numerics.spline import read_curve

    try:
        angles, values = read_curve(name, column)
    except UsageError as error:
        return f"{shown}: {str(error).removeprefix(f'{name}: ')}"
    if column == VOLUME and (odd := _span_fault(scene, float(angles[0]), float(angles[-1]))):
        return f"{shown}: {odd}"
    if column == VOLUME and not max(values) > 0.0:
        return f"{shown}: the volume is zero everywhere (write the volume of a chamber [m3] over its angle)"
    if column == VOLUME and abs(values[0] - values[-1]) > 1e-6 * max(values):
        return (
            f"{shown}: the volume must end as it begins (the volume left at 720 deg is the one that the chamber "
            "starts with)"
        )
    if column == AREA and angles[-1] <= ANGLE_IN_RADIANS:
        return f"{shown}: has no angle above {math.degrees(float(angles[-1])):.6g} deg (are the angles in degrees?)"
    beyond = area_fault(scene, float(max(values))) if column == AREA else None
    return None if beyond is None else f"{shown}: {beyond}"


def _span_fault(scene: Scene, first: float, last: float) -> str | None:
    """Return what is wrong with the first and last angle [rad] of a chamber's volume table; None if nothing is."""
    life = kind_of(scene.machine).geometry(scene.machine).life
    ends = f"goes from {math.degrees(first):.6g} to {math.degrees(last):.6g} deg"
    if first < -ANGLE_ROUNDING or last > life + ANGLE_ROUNDING:
        remedy = "write machine.volume.life, or rows from 0 deg to its end"
        return f"{ends}, beyond the chamber's life of {math.degrees(life):.6g} deg ({remedy})"
    if last - first < LEAST_SPAN * life:
        return f"{ends}, of a chamber's life of {math.degrees(life):.6g} deg (are the angles in degrees?)"
    return None
