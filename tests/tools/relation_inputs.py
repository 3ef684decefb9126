"""Laws that tie a random scene to one that states what the program has found, or that asks for the same otherwise.

Each law yields pairs of results. `relations.py` asks them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from relating import Case, NotAsked, Pair, exponent, law, read, scaled, tree_of, twin

from screwsim.figures import Performance
from screwsim.scene import Scene, with_values

OF_CYCLE = "gas_mass_flow", "indicated_power", "discharge_temperature", "peak_pressure", "trapped_mass"
CLEARANCES = {"tip_leakage": "tip_gap", "interlobe_leakage": "interlobe_gap", "end_face_leakage": "end_face_gap"}
OF_MIXTURE = "the temperature of its mixture"
HEAVY = 1e6  # times as dense: such oil takes no room
PUMPED = "oil_pump_power", "shaft_power", "shaft_torque", "specific_power"


@law
def found_values(case: Case) -> Iterator[Pair]:
    """A value that the program finds, stated, gives the same result."""
    here, p, scene = case.result, case.result.performance, case.scene
    supply, operation = scene.oil_supply, scene.operation
    if supply is not None and supply.kind == "displacement" and "oil_injection" not in scene.effects:
        values: dict[str, Any] = {"oil_supply.kind": "pump", "oil_supply.ratio": float(p.oil_ratio)}
        values |= dict.fromkeys(f"oil_supply.orifice_{key}" for key in ("diameter", "length", "count"))
        yield Pair("its oil ratio stated", here, twin(case.changed(values)))
    if "separator" in scene.effects and supply is not None and supply.temperature is None:
        values = {"oil_supply.temperature": f"{float(p.oil_supply_temperature)!r} K"}
        values["effects.separator.cooler"] = None
        apart = "oil_circuit_residual", "oil_cooler_load"
        yield Pair("its oil temperature stated", here, twin(case.changed(values)), without=apart)
    by_temperatures = p.get("evaporating_temperature") is not None and operation.evaporating_temperature is not None
    of_liquid = operation.subcooling is not None or {"economizer", "liquid_injection"} & scene.effects.keys()
    if by_temperatures and not of_liquid:
        yield Pair("its pressures stated", here, twin(_by_pressures(case)))


def _by_pressures(case: Case) -> Scene:
    p, tree = case.result.performance, tree_of(case.scene)
    for key in ("evaporating_temperature", "condensing_temperature", "superheat", "gas_cooler"):
        tree["operation"].pop(key, None)
    if "quality" in tree["operation"].get("suction", {}):
        raise NotAsked("wet")
    ends = {"pressure": f"{float(p.suction_pressure)!r} Pa", "temperature": f"{float(p.suction_temperature)!r} K"}
    kept = tree["operation"].get("discharge") or {}
    tree["operation"] |= {"suction": ends, "discharge": {**kept, "pressure": f"{float(p.discharge_pressure)!r} Pa"}}
    return read(tree, case.scene)


@law
def asked_otherwise(case: Case) -> Iterator[Pair]:
    """An input that follows from a figure, in place of the input that this figure follows from."""
    here, p, scene = case.result, case.result.performance, case.scene
    for what, values in _alternatives(scene, p):
        slack = 3.0 * scene.numerics.accuracy if what == OF_MIXTURE else 1e-6  # oil errs much more than it warms
        yield Pair(what, here, twin(case.changed(values)), slack=slack)


def _alternatives(scene: Scene, p: Performance) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield other ways to ask for the same machine: words, and values by path."""
    supply, machine, operation = scene.oil_supply, scene.machine, scene.operation
    if machine.kind == "twin_screw" and "drive" not in scene.effects:
        tips = 0.5 * machine.rotor_diameter * operation.speed
        yield "its tip speed", {"operation.speed": None, "operation.tip_speed": f"{float(tips)!r} m/s"}
        if scene.machine.volume.law == "paper" and machine.volume.min and machine.displacement is None:
            flow = {"flow": f"{float(p.displacement_flow)!r} m^3/s", "at": f"{float(operation.speed)!r} rad/s"}
            dead = f"{float(machine.volume.min)!r} m^3"
            yield (
                "its displacement",
                {"machine.displacement": flow, "machine.volume.max": None, "machine.volume.min": dead},
            )
    if supply is not None and supply.kind == "pump" and p.get("oil_flow_volume") and supply.flow is None:
        yield (
            "its oil's volume flow",
            {
                "oil_supply.ratio": None,
                "oil_supply.discharge_temperature": None,
                "oil_supply.flow": f"{float(p.oil_flow_volume)!r} m^3/s",
            },
        )
    if (
        supply is not None
        and supply.ratio is not None
        and p.get("mixture_discharge_temperature")
        and not _follows(scene)
    ):
        warm = f"{float(p.mixture_discharge_temperature)!r} K"
        yield OF_MIXTURE, {"oil_supply.ratio": None, "oil_supply.discharge_temperature": warm}
    if "economizer" in scene.effects and "economizer_pressure" in p:
        kept = scene.effects["economizer"].parameters
        if kept.temperature is not None and kept.pressure is None:
            at = {
                "effects.economizer.temperature": None,
                "effects.economizer.pressure": f"{float(p.economizer_pressure)!r} Pa",
            }
            yield "its economizer's pressure", at
    if operation.superheat is not None and p.get("suction_superheat") is not None:
        yield "its superheat as found", {"operation.superheat": f"{float(p.suction_superheat)!r} K"}


def _follows(scene: Scene) -> bool:
    """Return whether the separator's cooler keeps the temperature of the mixture already."""
    return scene.oil_supply is not None and scene.oil_supply.temperature is None


@law
def changed_intake(case: Case) -> Iterator[Pair]:
    """What throttles, mixes or heats the gas before the machine is another suction line."""
    here, p, scene = case.result, case.result.performance, case.scene
    names = [name for name in ("suction_throttle", "bypass", "air_package") if name in scene.effects]
    stated = case.value("operation.suction.pressure")
    if len(names) != 1 or "suction_line" in scene.effects or scene.gas.model != "ideal" or stated is None:
        raise NotAsked("nothing that changes the intake, or more than one")
    if {"plenums", "droplets"} & scene.effects.keys() or case.value("effects.motor.cooling") == "suction_gas":
        raise NotAsked("more changes the intake, or droplets meet gas as it conducts in the lines")
    if (p.gas_mass_flow or 0.0) <= 0.0 or p.get("intake_pressure") is None:
        raise NotAsked("no flow through it")
    values: dict[str, Any] = {"operation.suction.pressure": f"{float(p.intake_pressure)!r} Pa"}
    values["operation.suction.temperature"] = f"{float(p.intake_temperature)!r} K"
    values["operation.discharge.pressure"] = f"{float(p.discharge_pressure)!r} Pa"
    if scene.gas.relative_humidity is None:
        values["gas.isentropic_exponent"] = exponent(scene, here)
    there = twin(case.changed(values, names))
    share = 1.0 - (case.value("effects.bypass.share") or 0.0)
    yield Pair(f"{names[0]} as another line", here, scaled(there, {"gas_mass_flow": share}), OF_CYCLE)


@law
def warm_gaps(case: Case) -> Iterator[Pair]:
    """Gaps that grow warm are gaps of the size that they have then."""
    here, p = case.result, case.result.performance
    if "thermal_clearances" not in case.scene.effects or "oil_drag" in case.scene.effects:
        raise NotAsked("none, or oil drags in them")
    gaps = {f"effects.{name}.gap": f"{float(p[figure])!r} m" for name, figure in CLEARANCES.items() if p.get(figure)}
    yield Pair("warm gaps stated", here, twin(case.changed(gaps, ["thermal_clearances"])))


@law
def heavy_oil(case: Case) -> Iterator[Pair]:
    """Oil that is very dense, in drops as much smaller, takes no room."""
    scene = case.scene
    if "oil_volume" not in scene.effects or case.value("effects.oil_heat.droplet_radius") is None:
        raise NotAsked("no oil that takes room and heats by drops of a size")
    if case.value("oil_supply.ratio") is None or scene.oil is None or scene.oil.name:
        raise NotAsked("its oil flows by its density")
    small = case.value("effects.oil_heat.droplet_radius") / HEAVY
    values = {"oil.density": HEAVY * scene.oil.density, "effects.oil_heat.droplet_radius": small}
    without = twin(case.changed({}, ["oil_volume"]))
    yield Pair("oil of no room", without, twin(with_values(scene, values)), OF_CYCLE, slack=1e-5)


@law
def another_source(case: Case) -> Iterator[Pair]:
    """Where the oil's pump draws from changes what is pumped for, and nothing else."""
    here, scene = case.result, case.scene
    supply = scene.oil_supply
    fed = {
        "separator",
        "drive",
        "suction_line",
    } & scene.effects.keys()  # by which losses or the heat of throttling return
    if supply is None or supply.kind != "pump" or fed:
        return
    if case.value("effects.motor.cooling") == "suction_gas":
        return
    other = "suction" if supply.source == "separator" else "separator"
    yield Pair(f"oil from {other}", here, twin(case.changed({"oil_supply.source": other})), OF_CYCLE)
