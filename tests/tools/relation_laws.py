"""Laws that tie a random scene to others: the same machine stated otherwise, a similar one, one that gains or loses.

Each law yields pairs of results. `relations.py` asks them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import CoolProp.CoolProp as coolprop
import numpy as np
import pytest
from relating import Case, Law, Lost, NotAsked, Pair, believed, twin
from test_dimensions import SI

from screwsim.batch import simulate_courses
from screwsim.effects import catalogue
from screwsim.figures import Performance
from screwsim.fluid import transport
from screwsim.inputs.declare import is_derived
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, loads, scene_text, value_at, with_values
from screwsim.scene.fields import leaves_of
from screwsim.scene.units import _TABLE
from screwsim.simulate import simulate, simulate_many

LAWS: dict[str, Law] = {}
SOME = 2  # neutral effects of a scene, other accuracies, other ways
GAP = {"gap": "30 um", "flow_coefficient": 0}
WINDOW = {"opens": "400 deg", "closes": "500 deg", "area": "1e-6 mm^2"}
NEUTRAL: dict[str, dict[str, Any]] = {  # effects at the value at which they do nothing
    "tip_leakage": GAP,
    "interlobe_leakage": {**GAP, "length": "150 mm"},
    "end_face_leakage": {**GAP, "length": "80 mm"},
    "blow_hole": {"area": "6 mm^2", "flow_coefficient": 0},
    "bypass": {"share": 0},
    "bypass of a chamber": {"source": "chamber", "area": "0 cm^2", "opens": "400 deg", "passage": "90 deg"},
    "slide_valve": {"slot_area": "60 cm^2", "closes": "640 deg", "position": 0},
    "shaft_leakage": {"area": "0 mm^2"},
    "suction_throttle": {"pressure_ratio": 1},
    "oil_heat": {"droplet_radius": "50 um", "heat_transfer_coefficient": "0 W/(m^2 K)"},
    "wall_heat": {
        "rotor_area": "400 cm^2",
        "housing_area": "150 cm^2",
        "characteristic_length": "58 mm",
        "nusselt_factor": 0,
    },
    "plenums": {
        "discharge_volume": "1e6 m^3",
        "suction_volume": "1e6 m^3",
        "discharge_area": "15 cm^2",
        "suction_area": "40 cm^2",
    },
    "oil_pump": {"efficiency": 1, "pressure_loss": "0 bar"},
    "hydromechanical": {"acceleration_factor": 0},
    "mechanical": {"fraction": 0},
    "oil_drag": {"tip_gap": "0.1 mm", "tip_land": "3 mm", "end_gap": "0.1 mm", "end_solidity": 0.6, "film_share": 0},
    "bearings": {
        "load": "gas",
        "radial_area": "60 cm^2",
        "axial_area": "30 cm^2",
        "friction_coefficient": 0,
        "bore": "60 mm",
    },
    "motor": {"rated_power": "1 MW", "efficiency": 1},
    "gas_torque": {"male_share": 0},
    "economizer": {**WINDOW, "temperature": "285 K"},
    "liquid_injection": WINDOW,
    "separator": {},
    "ring_leakage": GAP,
    "air_package": {"rated_flow": "1e6 m^3/min", "inlet_filter": {"pressure_loss": "30 mbar"}},
    "drive": {
        "motor_inertia": "1e6 kg m^2",
        "rotor_inertia": "1e6 kg m^2",
        "coupling": {"linear": {"spring": "20000 N m/rad", "largest_twist": "1e3 deg"}, "damping": "6 N m s/rad"},
        "motor": {"law": "line", "slope": "30 N m s/rad", "torque_limit": "1e5 N m"},
    },
}
OF_SEPARATOR = "heating_capacity", "heating_cop", "electrical_heating_cop"  # with one, after gas and oil have mixed
SPLIT = {
    "tip_leakage": "tip",
    "interlobe_leakage": "interlobe",
    "end_face_leakage": "end_face",
    "blow_hole": "blow_hole",
}
LEAKS = {
    f"effects.{name}.gap": 1.3 for name in ("tip_leakage", "interlobe_leakage", "end_face_leakage", "ring_leakage")
}
LEAKS |= {f"effects.{name}.area": 1.3 for name in ("blow_hole", "shaft_leakage", "bypass")} | {
    "effects.bypass.share": 1.3
}
LOSSES = {"mechanical": "mechanical_power", "hydromechanical": "hydromechanical_power", "oil_drag": "oil_drag_power"}
LOSSES |= {"bearings": "bearing_power", "oil_pump": "oil_pump_power"}
LOOPS = "separator", "drive", "air_package"  # through which losses act on the cycle
ACCURACIES = 1e-3, 3e-4, 1e-4, 1e-5
FAR_AWAY = {"operation.speed": (0.3, 3.0), "oil_supply.ratio": (0.1, 10.0)}
ARGON = 40.0 / 24.0  # k of a gas of single atoms
RARE = 1e-4  # of the pressure: there a real gas is an ideal one within 1e-6
ALMOST = 1e-5  # relative difference that stays then
TRACE = 1e-9  # mass fraction of the second component of a blend that is nearly pure
SAME_LOBES = "isentropic_efficiency", "work_per_cycle", "discharge_temperature", "peak_pressure", "trapped_mass"


def law(asked: Law) -> Law:
    """Add a law under its name."""
    LAWS[asked.__name__] = asked
    return asked


def scaled(found: Result, factors: Mapping[str, float]) -> Result:
    """Return a result whose figures are multiplied by factors, all others left as they are."""
    about = found.performance.about
    values = {name: x if x is None else x * factors.get(name, 1.0) for name, x in found.performance.items()}
    return replace(found, performance=Performance(values, about))


def different(one: Result, other: Result) -> float:
    """Return infinity where a figure of two results differs in any bit, otherwise 0."""
    return 0.0 if dict(one.performance) == dict(other.performance) else math.inf


@law
def neutral(case: Case) -> Iterator[Pair]:
    """An effect at the value at which it does nothing changes nothing that is read without it."""
    here = case.result
    names = [name for name in NEUTRAL if name.split()[0] not in case.scene.effects]
    count = 0
    for name in case.random.permutation(names):
        effect = str(name).split()[0]
        try:
            scene = case.changed({f"effects.{effect}": NEUTRAL[str(name)]})
        except (SceneError, UsageError):
            continue
        try:
            yield Pair(f"with {name} of no size", here, twin(scene), slack=1e-6, without=OF_SEPARATOR)
        except Lost as why:
            raise Lost(f"with {name} of no size {why}") from None
        count += 1
        if count == SOME:
            return


@law
def split_gap(case: Case) -> Iterator[Pair]:
    """A gap is two gaps of half its area beside each other."""
    here = case.result
    there = [name for name in SPLIT if name in case.scene.effects]
    for name in case.random.permutation(there)[:1]:
        parameters = case.scene.effects[str(name)].parameters
        warm = "thermal_clearances" in case.scene.effects  # which widens shipped gaps alone
        if warm or parameters.model not in (None, "nozzle") or case.value("machine.volume.law") == "profile":
            raise NotAsked("a gap of another law")
        half = 0.5 * parameters.flow_coefficient
        own = f"effects.own_effects.second_{SPLIT[str(name)]}"
        tree = _tree(case.scene)
        tree["effects"][str(name)]["flow_coefficient"] = half
        tree["effects"][own.removeprefix("effects.")] = dict(tree["effects"][str(name)])
        yield Pair(f"two halves of {name}", here, twin(_read(tree, case.scene)))


def _tree(scene: Scene) -> dict[str, Any]:
    import yaml

    found: dict[str, Any] = yaml.safe_load(scene_text(scene))
    return found


def _read(tree: Mapping[str, Any], scene: Scene) -> Scene:
    import yaml

    return loads(yaml.safe_dump(dict(tree), sort_keys=False), folder=scene.folder)


@law
def written_otherwise(case: Case) -> Iterator[Pair]:
    """Effects and keys in another order, numbers in other units: the same machine."""
    here, tree = case.result, _tree(case.scene)
    tree["effects"] = {str(name): tree["effects"][str(name)] for name in case.random.permutation(list(tree["effects"]))}
    yield Pair("effects in another order", here, twin(_read(tree, case.scene)))
    values = {}
    for path, leaf in leaves_of(case.scene).items():
        units = _TABLE.get(leaf.dimension.si, {}) if leaf.dimension else {}
        value = value_at(case.scene, path) if units else None
        if isinstance(value, float) and not path.startswith("machine.displacement"):
            unit = str(case.random.choice(list(units)))
            times, over = units[unit]
            values[path] = f"{value / times * over!r} {unit}"
    yield Pair("in other units", here, twin(case.changed(values)))


@law
def similar(case: Case) -> Iterator[Pair]:
    """A machine of other lengths, times, masses and temperatures with the same numbers without dimension is similar."""
    here, scene, random = case.result, case.scene, case.random
    own = "refrigerant_solubility", "thermal_clearances"
    if any(name in scene.effects for name in own) or _has_sizes(scene):
        raise NotAsked("laws with sizes of their own")
    if scene.oil is not None and scene.oil.name:
        raise NotAsked("an oil with a temperature of its own")
    length = math.exp(random.uniform(-1.0, 1.0))
    mass = length**3
    if scene.gas.model == "ideal" and scene.gas.relative_humidity is None:
        mass = math.exp(random.uniform(-1.0, 1.0))
    factors = {"kg": mass, "m": length, "s": length}
    with pytest.MonkeyPatch.context() as patch:
        other = _in_units(scene, factors, patch)
        there = twin(other)
    about = there.performance.about
    back = {name: 1.0 / _factor(about[name].units, factors) for name in there.performance}
    yield Pair(f"similar by {length:.3g} m, {mass:.3g} kg", here, scaled(there, back), slack=1e-6)


def _has_sizes(scene: Scene) -> bool:
    """Return whether a scene has fits to gaps of a size, or motors of classes, which are listed by power."""
    parameters = [each.parameters for each in scene.effects.values()]
    fitted = any(getattr(each, "friction_fit", None) is not None for each in parameters)
    return fitted or any(getattr(each, "efficiency_class", "stated") != "stated" for each in parameters)


def _factor(unit: str, factors: Mapping[str, float]) -> float:
    """Return the factor of a quantity of an SI unit, where those of kg, m, s and K are given."""
    over, _, under = unit.partition("/")
    found = 1.0
    for part, sign in ((over, 1), (under.strip("()"), -1)):
        for name, exponent in re.findall(r"([A-Za-z]+|1)\^?(-?\d+)?", part):
            kelvins = factors.get("K", 1.0) if name in ("K", "kelvin") else 1.0
            kg, m, s = SI[name]
            found *= (factors["kg"] ** kg * factors["m"] ** m * factors["s"] ** s * kelvins) ** (
                sign * int(exponent or 1)
            )
    return found


def _in_units(scene: Scene, factors: Mapping[str, float], patch: pytest.MonkeyPatch) -> Scene:
    """Return a scene in other units, and make CoolProp's transport properties those of the same gas in them."""
    _scale_transport(patch, factors)
    found = {}
    for path, leaf in leaves_of(scene).items():
        value = None if leaf.dimension is None else value_at(scene, path)
        if value and leaf.dimension is not None and not is_derived(value):
            found[path] = value * _factor(leaf.dimension.si, factors)
    return with_values(scene, found)


def _scale_transport(patch: pytest.MonkeyPatch, factors: Mapping[str, float]) -> None:
    """Make CoolProp's conductivity and viscosity of a gas those of the same gas in other units."""
    pressure, conducts, viscous = (_factor(unit, factors) for unit in ("Pa", "W/(m K)", "Pa s"))
    of_both, of_one, hot = transport.transport, transport.viscosity, factors.get("K", 1.0)

    def both(fluid: Any, p: float, T: float) -> tuple[float, float, float]:
        conductivity, viscosity, prandtl = of_both(fluid, p / pressure, T / hot)
        return conducts * conductivity, viscous * viscosity, prandtl

    for module in ("parts.gas_transport", "cylinder_heat"):
        patch.setattr(f"screwsim.effects.{module}.transport", both)
    one = "screwsim.effects.parts.gap_flow.vapour_viscosity"
    patch.setattr(one, lambda fluid, p, T: viscous * of_one(fluid, p / pressure, T / hot))


@law
def hotter(case: Case) -> Iterator[Pair]:
    """An ideal gas of constant k at other temperatures is the same machine at a speed that goes with their root."""
    here, scene = case.result, case.scene
    own = {"refrigerant_solubility", "thermal_clearances", "economizer", "liquid_injection", "separator", "air_package"}
    if scene.gas.model != "ideal" or own & scene.effects.keys() or _has_sizes(scene):
        raise NotAsked("laws with temperatures of their own")
    if scene.gas.relative_humidity is not None or case.value("operation.suction.temperature") is None:
        raise NotAsked("lines by saturation")
    if scene.oil is not None and scene.oil.name:
        raise NotAsked("an oil with a temperature of its own")
    warmer = math.exp(case.random.uniform(-0.3, 0.3))
    factors = {"kg": 1.0, "m": 1.0, "s": warmer**-0.5, "K": warmer}
    k = scene.gas.isentropic_exponent
    if k is None:
        heat = coolprop.PropsSI("CP0MOLAR", "T", here.performance.suction_temperature, "P", 1e3, scene.gas.fluid)
        k = heat / (heat - coolprop.PropsSI("GAS_CONSTANT", scene.gas.fluid))
    constant = case.changed({"gas.isentropic_exponent": k})
    about = here.performance.about
    with pytest.MonkeyPatch.context() as patch:
        there = twin(_in_units(constant, factors, patch))
    back = {name: 1.0 / _factor(about[name].units, factors) for name in there.performance}
    yield Pair(f"{warmer:.3g} times as hot", here, scaled(there, back), slack=1e-6)


@law
def rare_argon(case: Case) -> Iterator[Pair]:
    """A real gas of single atoms at a low pressure is an ideal gas of k = 5/3."""
    case.result
    if case.scene.gas.model != "ideal" or case.value("operation.suction.temperature") is None:
        raise NotAsked("no ideal gas with a stated temperature")
    if {"refrigerant_solubility", "air_package", "economizer", "liquid_injection"} & case.scene.effects.keys():
        raise NotAsked("needs its own gas")
    ideal = case.changed({"gas": {"fluid": "Argon", "isentropic_exponent": 5.0 / 3.0}})
    real = case.changed({"gas": {"fluid": "Argon", "model": "real"}})
    factors = {"kg": RARE, "m": 1.0, "s": 1.0}
    with pytest.MonkeyPatch.context() as patch:
        try:
            one = twin(_in_units(ideal, factors, patch))
        except Lost as why:
            raise NotAsked(str(why)) from None
    with pytest.MonkeyPatch.context() as patch:
        other = twin(_in_units(real, factors, patch))
    yield Pair("rare argon, real", one, other, slack=ALMOST, without=("isothermal_efficiency",))


@law
def nearly_pure(case: Case) -> Iterator[Pair]:
    """A blend with next to nothing of its second component is the pure fluid."""
    case.result
    if case.scene.gas.model != "real" or case.scene.gas.two_phase != "refuse":
        raise NotAsked("no real gas of one phase")
    if {"refrigerant_solubility", "economizer", "liquid_injection"} & case.scene.effects.keys():
        raise NotAsked("needs its own gas")
    pure = case.changed({"gas": {"fluid": "R32", "model": "real"}})
    blend = case.changed({"gas": {"fluid": ["R32", "R125"], "mass_fractions": [1.0 - TRACE, TRACE], "model": "real"}})
    try:
        one = twin(pure)
    except Lost as why:
        raise NotAsked(str(why)) from None
    if any(name in case.scene.effects for name in ("cylinder_heat", "wall_heat", "droplets")):
        raise NotAsked("transport properties of blends are those of dilute gases (M318)")
    yield Pair("R32 with a trace of R125", one, twin(blend), slack=ALMOST)


@law
def dry_in_two_phases(case: Case) -> Iterator[Pair]:
    """Gas that stays dry does not notice that its condensing is looked for."""
    here = case.result
    if case.scene.gas.model != "real" or case.scene.gas.two_phase != "refuse":
        raise NotAsked("no real gas of one phase")
    there = twin(case.changed({"gas.two_phase": "equilibrium"}))
    if (there.performance.get("discharge_quality") or 0.0) < 1.0:
        raise NotAsked("wet")
    yield Pair("followed in two phases", here, there)


@law
def hardly_any_oil(case: Case) -> Iterator[Pair]:
    """Next to no oil is no oil."""
    case.result
    scene = case.scene
    if scene.oil_supply is None or case.value("oil_supply.ratio") is None or "separator" in scene.effects:
        raise NotAsked("no ratio of oil")
    without = [name for name in scene.effects if _needs_oil(name)]
    drags = [name for name in without if name in LOSSES]
    none = case.changed({"oil": None, "oil_supply": None}, without)
    try:
        one = twin(none)
    except Lost as why:
        raise NotAsked(str(why)) from None
    yield Pair("1e-10 of oil", one, twin(case.changed({"oil_supply.ratio": 1e-10}, drags)), slack=1e-6)


def _needs_oil(name: str) -> bool:
    effect = catalogue().get(name)
    return effect is not None and effect.needs_oil


@law
def lobes(case: Case) -> Iterator[Pair]:
    """Chambers that nothing connects work alike, however many there are."""
    case.result
    scene = case.scene
    if scene.machine.kind != "twin_screw" or case.value("machine.volume.law") != "paper":
        raise NotAsked("no screw by laws")
    keep = {"suction_port", "discharge_port", "mechanical", "gas_torque"}
    without = [name for name in scene.effects if name not in keep]
    values: dict[str, Any] = {"oil": None, "oil_supply": None} if scene.oil is not None else {}
    try:
        one = twin(case.changed(values, without))
    except Lost as why:
        raise NotAsked(str(why)) from None
    count = int(case.random.choice([3, 5, 6]))
    other = twin(case.changed(values | {"machine.male_lobes": count, "machine.female_lobes": count + 2}, without))
    own = value_at(scene, "machine.male_lobes")
    extensive = "gas_mass_flow", "indicated_power", "shaft_power", "displacement_flow", "mechanical_power"
    factors = dict.fromkeys(extensive, own / count)
    only = {*SAME_LOBES, *extensive, "volumetric_efficiency"}
    yield Pair(f"{count} lobes, not {own}", one, scaled(other, factors), only)


@law
def wider_leak(case: Case) -> Iterator[Pair]:
    """A wider leak does not increase the delivered flow."""
    here = case.result
    there = {path: by for path, by in LEAKS.items() if isinstance(case.value(path), float) and case.value(path)}
    if not there or case.scene.machine.mode == "expander" or "refrigerant_solubility" in case.scene.effects:
        raise NotAsked("no leak that is a number, or oil whose gas it may dissolve")
    path = str(case.random.choice(list(there)))
    wide = twin(with_values(case.scene, {path: there[path] * case.value(path)}))
    one, other = (each.performance.get("gas_mass_flow") for each in (here, wide))
    if one is None or other is None:
        raise NotAsked("no flow")
    may = sum(each.error.get("gas_mass_flow") or 0.0 for each in (here, wide)) + 0.05 * 3e-4
    filling = abs(one) / max(abs(here.performance.volumetric_efficiency or 0.0), 1e-12)
    gain = max(0.0, other - one) / max(abs(one), 0.1 * filling)
    yield Pair(f"wider {path}: flow {other} of {one}", here, wide, broken=gain / may)


@law
def losses_add(case: Case) -> Iterator[Pair]:
    """A loss that does not act on the cycle is what the shaft takes more."""
    here = case.result
    if any(name in case.scene.effects for name in LOOPS) or case.value("effects.motor.cooling") == "suction_gas":
        raise NotAsked("losses act on the cycle")
    if case.value("effects.mechanical.of") not in (None, "indicated_power"):
        raise NotAsked("a loss of losses")
    for name, figure in LOSSES.items():
        if name in case.scene.effects and here.performance.get(figure) is not None:
            without = twin(case.changed({}, [name]))
            left = here.performance.shaft_power - here.performance[figure]
            values = dict(without.performance) | {"shaft_power": left}
            only = ("shaft_power", "gas_mass_flow", "discharge_temperature", "indicated_power")
            expected = replace(here, performance=Performance(dict(here.performance) | values, here.performance.about))
            yield Pair(f"without {name}", expected, without, only)


@law
def found_values(case: Case) -> Iterator[Pair]:
    """A value that the program finds, stated, gives the same result."""
    here, p, scene = case.result, case.result.performance, case.scene
    supply = scene.oil_supply
    if supply is not None and supply.kind == "displacement" and "oil_injection" not in scene.effects:
        stated = {"kind": "pump", "ratio": p.oil_ratio, "temperature": supply.temperature}
        stated = {key: value for key, value in stated.items() if value is not None}
        stated["temperature"] = f"{supply.temperature!r} K" if supply.temperature is not None else None
        yield Pair("its oil ratio stated", here, twin(case.changed({"oil_supply": stated})))
    if "separator" in scene.effects and supply is not None and supply.temperature is None:
        values: dict[str, Any] = {"oil_supply.temperature": f"{p.oil_supply_temperature!r} K"}
        values["effects.separator.cooler"] = None
        apart = "oil_circuit_residual", "oil_cooler_load"
        yield Pair("its oil temperature stated", here, twin(case.changed(values)), without=apart)
    if "suction_throttle" in scene.effects and "suction_line" not in scene.effects and scene.gas.model == "ideal":
        suction = {"pressure": f"{p.intake_pressure!r} Pa", "temperature": f"{p.intake_temperature!r} K"}
        if {"bypass", "air_package", "plenums"} & scene.effects.keys() or case.value(
            "operation.suction.pressure"
        ) is None:
            raise NotAsked("more changes the intake")
        only = "gas_mass_flow", "indicated_power", "discharge_temperature", "peak_pressure", "trapped_mass"
        wide = case.changed({"operation.suction": suction}, ["suction_throttle"])
        yield Pair("its intake stated as suction", here, twin(wide), only)
    if p.get("evaporating_temperature") is not None and case.value("operation.evaporating_temperature") is not None:
        if case.value("operation.subcooling") is None and not {"economizer", "liquid_injection"} & scene.effects.keys():
            yield Pair("its pressures stated", here, twin(_by_pressures(case)))


def _by_pressures(case: Case) -> Scene:
    p, tree = case.result.performance, _tree(case.scene)
    for key in ("evaporating_temperature", "condensing_temperature", "superheat", "gas_cooler"):
        tree["operation"].pop(key, None)
    if "quality" in tree["operation"].get("suction", {}):
        raise NotAsked("wet")
    ends = {"pressure": f"{p.suction_pressure!r} Pa", "temperature": f"{p.suction_temperature!r} K"}
    kept = tree["operation"].get("discharge") or {}
    tree["operation"] |= {"suction": ends, "discharge": {**kept, "pressure": f"{p.discharge_pressure!r} Pa"}}
    return _read(tree, case.scene)


@law
def another_way(case: Case) -> Iterator[Pair]:
    """A point alone, in a row behind a far one, in lanes, closed otherwise: the same figures."""
    here, scene = case.result, case.scene
    far, near = _far(case), with_values(scene, {"operation.speed": 1.02 * scene.operation.speed})
    how = "coupled" if scene.numerics.closing != "coupled" else "auto"
    closed = replace(scene, numerics=replace(scene.numerics, closing=how))
    ways: dict[str, Callable[[], Result]] = {
        "behind a far point": lambda: _last([far, scene]),
        "behind a near point": lambda: _last([near, scene]),
        "in lanes": lambda: simulate_courses([[scene], [near], [far]])[0][0],
        f"closed {how}": lambda: simulate(closed, trace=False),
    }
    for way in map(str, case.random.permutation(list(ways))[:SOME]):
        yield Pair(way, here, believed_twin(ways[way](), scene))


def believed_twin(found: Result, scene: Scene) -> Result:
    """Return a result tied to one that is ok; raise Lost or NotAsked as `twin` does."""
    if found.status != "ok":
        raise Lost(f"{found.status}: {found.message}")
    return believed(found, scene)


def _last(row: list[Scene]) -> Result:
    return list(simulate_many(row, trace=False))[-1]


def _far(case: Case) -> Scene:
    values = {}
    for path, ends in FAR_AWAY.items():
        value = case.value(path)
        if isinstance(value, float) and value:
            values[path] = value * math.exp(case.random.uniform(*np.log(ends)))
    return with_values(case.scene, values)


@law
def in_threads(case: Case) -> Iterator[Pair]:
    """Threads beside each other, and a run after others, give the same bits."""
    case.result
    alone = twin(case.scene)
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda scene: simulate(scene, trace=False), [case.scene, _far(case)]))
    for each in (found[0], twin(case.scene)):
        yield Pair("bits in threads and after others", alone, each, broken=different(alone, each))


@law
def another_accuracy(case: Case) -> Iterator[Pair]:
    """Each accuracy gives the figures of the others, within the errors that both tell."""
    here, wanted = case.result, case.scene.numerics.accuracy
    for accuracy in map(float, case.random.permutation(ACCURACIES)[:SOME]):
        if accuracy != wanted:
            scene = replace(case.scene, numerics=replace(case.scene.numerics, accuracy=accuracy))
            yield Pair(f"accuracy {accuracy}, not {wanted}", here, believed_twin(simulate(scene, trace=False), scene))
