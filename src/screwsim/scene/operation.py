"""Checks of gas and operation: the fluid, that the lines are stated in exactly one way, and the fluid's limits."""

from collections.abc import Iterable, Iterator
from operator import attrgetter

from screwsim.fluid import constants, names
from screwsim.fluid.constants import Limits
from screwsim.fluid.models import condenses, find_gas_model
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import Fault, UsageError, given_twice
from screwsim.outputs.customary import in_bar, in_celsius
from screwsim.scene.fluids import fluid_faults, humidity_faults, line_faults
from screwsim.scene.lines import lines, refrigerating_effect
from screwsim.scene.types import Scene
from screwsim.scene.units import readable_quantity

SPEED, TIP_SPEED = "operation.speed", "operation.tip_speed"
EVAPORATING, CONDENSING = "operation.evaporating_temperature", "operation.condensing_temperature"
SUPERHEAT, SUBCOOLING = "operation.superheat", "operation.subcooling"
P_S, P_D = "operation.suction.pressure", "operation.discharge.pressure"
T_S, SUPERHEAT_S = "operation.suction.temperature", "operation.suction.superheat"
T_D = "operation.discharge.temperature"
GAS_COOLER = "operation.gas_cooler"
GAS_COOLER_P, GAS_COOLER_T = f"{GAS_COOLER}.pressure", f"{GAS_COOLER}.outlet_temperature"
QUALITY = "operation.suction.quality"
STATE_PATHS = ("gas.fluid", "gas.mass_fractions", "gas.mole_fractions", "operation")  # paths on which the states depend
TEMPERATURES = (EVAPORATING, CONDENSING, SUPERHEAT, SUBCOOLING, GAS_COOLER)  # one way to state the lines
PRESSURES = (P_S, P_D, T_S, SUPERHEAT_S)  # the other way
CHOSEN = SPEED, TIP_SPEED, GAS_COOLER_P  # under `operation`, yet chosen to suit conditions
COUNTERPART = {
    P_S: EVAPORATING,
    P_D: CONDENSING,
    T_S: SUPERHEAT,
    SUPERHEAT_S: SUPERHEAT,
    EVAPORATING: P_S,
    CONDENSING: P_D,
    SUPERHEAT: SUPERHEAT_S,
}


def is_condition(path: str) -> bool:
    """Tell whether a path, of a scene or of a stage, is a condition that a machine meets, not one that one chooses."""
    own = path.removeprefix("first.").removeprefix("second.")
    return own.startswith("operation.") and own not in CHOSEN


def check_operation(scene: Scene) -> list[Fault]:
    """Return the faults of gas and operation; states are checked only once the scene states them in one way."""
    faults = [*_gas(scene), *_stated_one_way(scene), *line_axis_faults(scene, scene.sweep)]
    if not any(fault.path.startswith(STATE_PATHS) for fault in faults):
        faults += _states(scene)
    return faults


def _is_given(scene: Scene, paths: tuple[str, ...]) -> list[str]:
    return [path for path in paths if attrgetter(path)(scene) is not None]


def _gas(scene: Scene) -> Iterator[Fault]:
    gas = scene.gas
    yield from fluid_faults(gas)
    yield from humidity_faults(gas, scene.operation.aftercooler_temperature)
    model = find_gas_model(gas.model)
    if model.finds_exponent and gas.isentropic_exponent is not None:
        yield Fault("gas.isentropic_exponent", "applies only to model: ideal (remove it, or write model: ideal)")
    if gas.equilibrium and not model.phases:
        yield Fault("gas.two_phase", "equilibrium needs model: real (write that, or remove two_phase)")
    elif gas.equilibrium and gas.relative_humidity is None and constants.limits(gas.name) is not None:
        why = names.why_no_dome(gas.name)
        if why is not None:
            yield Fault("gas.two_phase", why)
    if scene.operation.suction.quality is not None and not (model.phases and gas.equilibrium):
        yield Fault(QUALITY, "needs gas.model: real and gas.two_phase: equilibrium (write both, or give a superheat)")


def _stated_one_way(scene: Scene) -> Iterator[Fault]:
    """Yield what is missing, or given twice, in the way in which the lines are stated."""
    temperatures, pressures = _is_given(scene, TEMPERATURES), _is_given(scene, PRESSURES)
    if temperatures and pressures:
        remedy = "state the lines by pressures or by saturation temperatures; remove one of the two"
        for path in pressures:
            yield Fault(path, f"is given as well as {temperatures[0]} ({remedy}; null drops a base's value)")
    elif temperatures:
        yield from _temperatures_complete(scene)
    elif pressures:
        yield from _pressures_complete(scene)
    else:
        ways = "suction and discharge, or evaporating_temperature, condensing_temperature and superheat"
        yield Fault("operation", f"states neither suction nor discharge (write {ways})")


def _temperatures_complete(scene: Scene) -> Iterator[Fault]:
    operation = scene.operation
    lacking = [EVAPORATING] if operation.evaporating_temperature is None else []
    lacking += [CONDENSING] if operation.condensing_temperature is None and operation.gas_cooler is None else []
    for path in lacking:
        name, example = path.removeprefix("operation."), {EVAPORATING: "2 degC", CONDENSING: "45 degC"}[path]
        remedy = f"{name}: {example}; the lines are stated by saturation temperatures"
        yield Fault(path, f"is missing (write e.g. {remedy})")
    if operation.gas_cooler is not None:
        yield from _instead_of_a_condenser(scene)
    if operation.superheat is None and operation.suction.quality is None:
        yield Fault(SUPERHEAT, "is missing (write e.g. superheat: 10 K; the state of the suction gas)")
    if operation.superheat is not None and operation.suction.quality is not None:
        yield Fault(QUALITY, "is given as well as operation.superheat (remove one of the two)")


def _instead_of_a_condenser(scene: Scene) -> Iterator[Fault]:
    """Yield faults of what cannot be combined with a gas cooler."""
    for path in _is_given(scene, (CONDENSING, SUBCOOLING)):
        yield given_twice(path, "operation.gas_cooler, which states pressure and temperature itself")
    if scene.machine.expands:
        yield Fault(GAS_COOLER, "applies only to machine.mode: compressor (state the lines by pressures, or remove it)")


def _pressures_complete(scene: Scene) -> Iterator[Fault]:
    suction = scene.operation.suction
    for path, line, example in ((P_S, suction, "2 bar"), (P_D, scene.operation.discharge, "12 bar")):
        if line.pressure is None:
            yield Fault(path, f"is missing (write e.g. pressure: {example}; the lines are stated by pressures)")
    states = [name for name in ("temperature", "superheat", "quality") if getattr(suction, name) is not None]
    if not states:
        yield Fault(T_S, "is missing (give temperature or superheat)")
    for name in states[1:]:
        yield Fault(f"operation.suction.{name}", f"is given as well as {states[0]} (remove one of the two)")


def line_axis_faults(scene: Scene, axes: Iterable[str]) -> Iterator[Fault]:
    """Yield which axes of a sweep belong to the other way of stating the lines than the scene's."""
    temperatures = _is_given(scene, TEMPERATURES)
    if bool(temperatures) == bool(_is_given(scene, PRESSURES)):
        return  # neither way, or both: reported elsewhere
    stated, other = ("saturation temperatures", PRESSURES) if temperatures else ("pressures", TEMPERATURES)
    if scene.operation.gas_cooler is not None:
        other = (*other, CONDENSING, SUBCOOLING)
    for path in (path for path in axes if path in other):
        if path in (CONDENSING, SUBCOOLING) and scene.operation.gas_cooler is not None:
            remedy = f"vary {GAS_COOLER_P} or {GAS_COOLER_T}"
            yield Fault(f"sweep.{path}", f"has no meaning with operation.gas_cooler ({remedy})")
            continue
        remedy = f"vary {COUNTERPART[path]}, or" if path in COUNTERPART else "remove this axis, or"
        yield Fault(f"sweep.{path}", f"has no meaning where the scene states {stated} ({remedy} restate the lines)")


def _states(scene: Scene) -> list[Fault]:
    """Return the faults of states that are stated in one way, of a known fluid."""
    limits = constants.limits(scene.gas.name)
    assert limits is not None
    by_temperature = scene.operation.evaporating_temperature is not None
    stated = _gas_cooler if scene.operation.gas_cooler is not None else _temperatures if by_temperature else _pressures
    faults = list(stated(scene, limits))
    if not faults and (by_temperature or scene.operation.suction.temperature is None):
        try:
            lines(scene)
            effect = refrigerating_effect(scene)
        except UsageError as error:  # CoolProp finds no state, though it lies within the limits
            where = GAS_COOLER_T if stated is _gas_cooler else EVAPORATING if by_temperature else P_S
            faults = [Fault(where, f"{error} (choose another state)")]
        else:
            faults = list(_no_cooling(scene, effect))
    if not faults and stated is _temperatures:  # the glide of a pseudo-pure fluid may reverse the order
        faults = list(_order(scene, lines(scene).p_s, lines(scene).p_d, CONDENSING))
    return faults or list(line_faults(scene.gas, lines(scene)))


def _pressures(scene: Scene, limits: Limits) -> Iterator[Fault]:
    suction, p_d = scene.operation.suction, scene.operation.discharge.pressure
    p_s = suction.pressure
    assert p_s is not None and p_d is not None
    yield from _order(scene, p_s, p_d, P_D)
    if suction.temperature is None and limits.gas_only:
        yield _no_saturation(QUALITY if suction.superheat is None else SUPERHEAT_S, scene.gas.name, limits)
    elif suction.temperature is None and not limits.p_triple <= p_s < limits.p_critical:
        name, limit = ("critical", limits.p_critical) if p_s > limits.p_triple else ("triple-point", limits.p_triple)
        shown, path = readable_quantity(KINDS["pressure"], p_s), QUALITY if suction.superheat is None else SUPERHEAT_S
        what = f"{scene.gas.name} has no saturation at the suction pressure {shown}: its {name} pressure is "
        yield Fault(path, f"{what}{in_bar(limit)} (give operation.suction.temperature, or another pressure)")
    yield from _no_exponent(scene, suction.temperature)
    if condenses(scene.gas):
        yield from _liquid(scene, T_S, p_s, suction.temperature)
        yield from _liquid(scene, T_D, p_d, scene.operation.discharge.temperature)


def _no_exponent(scene: Scene, T: float | None) -> Iterator[Fault]:
    """Yield a fault where the isentropic exponent is to be found at a temperature at which it is unknown."""
    gas = scene.gas
    if T is None or gas.isentropic_exponent is not None or not find_gas_model(gas.model).asks_exponent:
        return
    if not constants.has_ideal_heat_capacity(gas.name, T):
        what = f"CoolProp's heat capacity of {gas.name} as an ideal gas does not reach {T:.4g} K"
        yield Fault(T_S, f"{what} (raise it, or state gas.isentropic_exponent)")


def _liquid(scene: Scene, path: str, p: float, T: float | None) -> Iterator[Fault]:
    """Yield a fault where the real fluid is liquid at the stated temperature of a line."""
    boiling = None if T is None else constants.liquid_below(scene.gas.name, p, T)
    if T is None or boiling is None:
        return
    limits = constants.limits(scene.gas.name)
    if limits is not None and limits.gas_only:
        what = f"{scene.gas.name} is known as a gas only from {in_celsius(boiling)} on, and may condense below (M317)"
        yield Fault(path, f"{in_celsius(T)}: {what} (raise it, or leave out the component that condenses)")
        return
    what = f"{in_celsius(T)} makes {scene.gas.name} of {readable_quantity(KINDS['pressure'], p)} a liquid"
    wet = "" if path == T_D else "; for wet gas give quality instead, with gas.two_phase: equilibrium"
    yield Fault(path, f"{what}: it is a gas above {in_celsius(boiling)} (raise it, or lower the pressure{wet})")


def _order(scene: Scene, p_s: float, p_d: float, path: str) -> Iterator[Fault]:
    if path == P_D:
        low, shown = (readable_quantity(KINDS["pressure"], value) for value in (p_s, p_d))
    else:
        low, shown = in_bar(p_s), f"gives {in_bar(p_d)}, which"
    if p_s == p_d:
        equal = "equals" if path == P_D else "is"
        yield Fault(path, f"{shown} {equal} the suction pressure (nothing is compressed; choose another)")
    elif not scene.machine.expands and p_d < p_s:
        yield Fault(path, f"{shown} is below the suction pressure {low} (raise it, or write machine.mode: expander)")
    elif scene.machine.expands and p_d > p_s:
        yield Fault(path, f"{shown} is above the suction pressure {low} (lower it, or write machine.mode: compressor)")


def _temperatures(scene: Scene, limits: Limits) -> Iterator[Fault]:
    """Yield faults of temperatures at which the fluid does not saturate, or whose order does not suit the machine."""
    operation, fluid = scene.operation, scene.gas.name
    T_e, T_c = operation.evaporating_temperature, operation.condensing_temperature
    assert T_e is not None and T_c is not None
    outside = [*_outside(EVAPORATING, T_e, fluid, limits), *_outside(CONDENSING, T_c, fluid, limits)]
    yield from outside
    if outside:
        return
    T_liquid = constants.condensed(fluid, T_c) - (operation.subcooling or 0.0)
    yield from _too_hot(scene, limits, T_e)
    if T_liquid < limits.T_triple:
        what = f"{fluid} freezes at {in_celsius(limits.T_triple)} (choose a smaller one)"
        yield Fault(SUBCOOLING, f"makes liquid of {in_celsius(T_liquid)}; {what}")
    elif not scene.machine.expands and operation.subcooling and T_liquid < T_e < T_c:
        what = f"colder than the evaporator of {in_celsius(T_e)}, and nothing in the plant can cool it so far"
        yield Fault(SUBCOOLING, f"makes liquid of {in_celsius(T_liquid)}: {what} (choose a smaller one)")
    compressor, shown = not scene.machine.expands, f"the evaporating temperature {in_celsius(T_e)}"
    if T_c == T_e:
        yield Fault(CONDENSING, f"{in_celsius(T_c)} equals the evaporating temperature (choose another)")
    elif compressor and T_c < T_e:
        yield Fault(CONDENSING, f"{in_celsius(T_c)} is below {shown} (raise it, or write machine.mode: expander)")
    elif not compressor and T_c > T_e:
        yield Fault(CONDENSING, f"{in_celsius(T_c)} is above {shown} (lower it, or write machine.mode: compressor)")


def _gas_cooler(scene: Scene, limits: Limits) -> Iterator[Fault]:
    """Yield faults of a plant that is stated by evaporating temperature and gas cooler (M330)."""
    operation, fluid = scene.operation, scene.gas.name
    T_e, cooler = operation.evaporating_temperature, operation.gas_cooler
    assert T_e is not None and cooler is not None
    outside = list(_outside(EVAPORATING, T_e, fluid, limits))
    yield from outside
    if outside:
        return
    yield from _too_hot(scene, limits, T_e)
    T, p_s = cooler.outlet_temperature, constants.dew_pressure(fluid, T_e)
    p, low = (readable_quantity(KINDS["pressure"], each) for each in (cooler.pressure, p_s))
    if cooler.pressure <= p_s:
        yield Fault(GAS_COOLER_P, f"{p} is not above the evaporating pressure, {low} (raise it)")
    if T < T_e:
        what = f"colder than the evaporator of {in_celsius(T_e)}, and nothing in the plant can cool it so far"
        yield Fault(GAS_COOLER_T, f"{in_celsius(T)} is {what} (raise it)")
    elif T > limits.T_max:
        yield Fault(GAS_COOLER_T, f"the equation of state of {fluid} ends at {in_celsius(limits.T_max)} (lower it)")


def _too_hot(scene: Scene, limits: Limits, T_e: float) -> Iterator[Fault]:
    """Yield a fault for a superheat beyond the range of the fluid's equation of state."""
    T_s = T_e + (scene.operation.superheat or 0.0)
    if T_s > limits.T_max:
        what = f"the equation of state of {scene.gas.name} ends at {in_celsius(limits.T_max)} (choose a smaller one)"
        yield Fault(SUPERHEAT, f"makes suction gas of {in_celsius(T_s)}; {what}")


def _no_cooling(scene: Scene, effect: float | None) -> Iterator[Fault]:
    """Yield a fault for a gas cooler after which the fluid has more enthalpy than the suction gas."""
    if scene.operation.gas_cooler is not None and effect is not None and effect <= 0.0:
        what = f"leaves no cooling: after it {scene.gas.name} has {-effect / 1e3:.4g} kJ/kg more than the suction gas"
        yield Fault(GAS_COOLER_T, f"{what} (lower it, or raise operation.gas_cooler.pressure)")


def _no_saturation(path: str, fluid: str, limits: Limits) -> Fault:
    """Return the fault of a line stated by saturation, of a blend that is known as a gas only (M317)."""
    what = f"{fluid} has no known saturation: it is known as a gas only, from {in_celsius(limits.T_triple)} on"
    return Fault(path, f"{what} (state pressures and {T_S})")


def _outside(path: str, T: float, fluid: str, limits: Limits) -> Iterator[Fault]:
    if limits.gas_only:
        yield _no_saturation(path, fluid, limits)
    elif T >= limits.T_critical:
        what = f"is not below the critical temperature of {fluid}, {in_celsius(limits.T_critical)}"
        above = "state the lines by pressures"
        if path == CONDENSING:
            above = "write operation.gas_cooler: {pressure: …, outlet_temperature: …} instead"
        yield Fault(path, f"{in_celsius(T)} {what} (lower it, or {above})")
    elif T < limits.T_triple:
        what = f"is below the triple point of {fluid}, {in_celsius(limits.T_triple)}"
        yield Fault(path, f"{in_celsius(T)} {what} (raise it)")
