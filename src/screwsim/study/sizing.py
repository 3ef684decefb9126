"""A new machine from its maker's sheet: its size is found by solving the cycle, so that it delivers what is stated.

A sheet states what a machine delivers or takes, not what it displaces. Delivery is nearly proportional to size, so that
a few solutions find the displacement.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from screwsim.effects.motor import Parameters as Motor
from screwsim.effects.motor import beyond_rating, is_beyond
from screwsim.figures.engineering import figure_text
from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.outputs.customary import HOUR, in_bar
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate
from screwsim.template import SceneRequest, kind_of, new_scene
from screwsim.template.gas import INVERTER_LOSS_SHARE
from screwsim.template.request import NORMAL_DENSITY, R
from screwsim.template.sizes import flow_text, rounded_flow, rpm

DELIVERED, TAKEN = "free_air_delivered", "shaft_power"
COOLS, HEATS, DUTY = "cooling_capacity", "heating_capacity", "oil_cooler_duty"
NEAR, TRIES = 1e-3, 8  # relative tolerance within which the stated value is met, and number of sizes tried
FIRM, ROUNDED = 3, 5e-3  # a scene's numbers are rounded, so that sizes jump: the tolerance after so many tries
FAST_TIP_SPEED = 40.0  # [m/s] tip speed above which oil films cost points of efficiency (docs/how-to/new-machine.md)
TIGHTER_ACCURACY = 1e-4  # accuracy where the default does not suffice
UNSTEADY_PORT = (
    "--economizer: no temperature is found at which the port draws the vapour (choose a --condition with ends farther "
    "apart, another --vi, or no --economizer)"
)
ELSEWHERE = 0.01  # relative difference of a package's inlet pressure from that of its surroundings that is told
STEADY = 0.01  # departure of the draw ratio from 1 within which a port draws what the liquid gives off
ONE_STAGE = 16.0  # highest usual pressure ratio: 13 to 15 bar gauge (wiki.pneusmart.io, Two-Stage Compressors)
LIGHT = 0.6  # motor load below which sheet and machine hardly match


class SizedMachine(NamedTuple):
    """The text of a new scene, the scene, and its result."""

    text: str
    scene: Scene
    result: Result


def sized_machine(kind: str, asked: SceneRequest) -> SizedMachine:
    """Return a new machine with the stated flow or capacity, or else one that loads the motor fully.

    Raise UsageError, in one line, where no size does.
    """
    about = kind_of(kind)
    goals = (
        ("--flow", DELIVERED, asked.free_air if asked.molar is None else asked.molar),
        ("--capacity", about.cools, asked.capacity),
        ("--motor", TAKEN, asked.motor),
    )
    option, figure, wanted = next((*names, wanted) for *names, wanted in goals if wanted is not None)
    flow = rounded_flow(about.first(asked))
    for count in range(TRIES):
        found = solved_machine(_text(kind, replace(asked, flow=flow, sought=option), option))
        result = found.result
        value = _delivered(asked, found) if figure == DELIVERED else result.performance.get(figure)
        if asked.economizer and result.status == "not_closed":
            raise UsageError(UNSTEADY_PORT)
        if result.status != "ok" or not value or value <= 0.0:
            why = result.told if result.status != "ok" else f"no {figure.replace('_', ' ')}"
            what = f"the machine of {flow_text(flow)} tried for it does not run: {why}"
            raise UsageError(f"{option}: {what} (choose another {option}, --speed, --vi or --condition)")
        near = NEAR if count < FIRM else ROUNDED
        aim = wanted * (1.0 - near if figure == TAKEN else 1.0)  # a motor is loaded in full, not beyond
        if abs(value / aim - 1.0) <= near:
            if asked.economizer:
                _check_port(result)
            return _with_motor(kind, replace(asked, flow=flow, sought=option), found)
        flow = rounded_flow(flow * aim / value)
    what = f"no size was found that gives {asked.flow_text or figure_text(figure, wanted)}"
    raise UsageError(f"{option}: {what} (state one with --displacement)")


def _delivered(asked: SceneRequest, found: SizedMachine) -> float | None:
    """Return what a machine delivers: in mol/s where the flow asked for is at a standard state, else in m³/s."""
    if found.result.status != "ok" or DELIVERED in found.result.performance:
        return found.result.performance.get(DELIVERED)
    return _inlet_flow(found) if asked.molar is None else _molar_flow(found)


def _inlet_flow(found: SizedMachine) -> float:
    """Return the volume flow [m³/s] at the inlet of a machine that runs."""
    p = found.result.performance
    return p.volumetric_efficiency * p.displacement_flow


def _molar_flow(found: SizedMachine) -> float:
    """Return the molar flow [mol/s] of a machine that runs."""
    return found.result.performance.gas_mass_flow * constants.gas_constant(found.scene.gas.name) / R


def _with_motor(kind: str, asked: SceneRequest, found: SizedMachine) -> SizedMachine:
    """Return a machine sized by its flow with the motor for the load found; others as they are."""
    if asked.motor is not None or asked.sought != "--flow":
        return found
    return solved_machine(_text(kind, replace(asked, load=found.result.performance.shaft_power), asked.sought))


def solved_machine(text: str) -> SizedMachine:
    """Return a new scene with its result; with a tighter accuracy where the default leaves the cycle unclosed."""
    scene = loads(text)
    result = simulate(scene, trace=False)
    if result.status == "not_closed":
        told = "the cycle does not close at the default accuracy"
        tighter = f"{text.rstrip()}\n\nnumerics: {{accuracy: {TIGHTER_ACCURACY:g}}}    # {told}\n"
        closed = simulate(loads(tighter), trace=False)
        if closed.status == "ok":
            return SizedMachine(tighter, loads(tighter), closed)
    return SizedMachine(text, scene, result)


def stated_machine(kind: str, asked: SceneRequest) -> SizedMachine:
    """Return a new machine of the stated size, or of the kind's own; it need not run, unless it has an economizer."""
    found = solved_machine(new_scene(kind, asked))
    if asked.economizer:
        _check_port(found.result)
    return found


def _check_port(result: Result) -> None:
    """Raise UsageError unless the economizer's port draws what the liquid gives off."""
    drawn = result.performance.get("economizer_draw_ratio") if result.status == "ok" else None
    if drawn is None or abs(drawn - 1.0) > STEADY:
        raise UsageError(UNSTEADY_PORT)


def _text(kind: str, asked: SceneRequest, option: str) -> str:
    """Return the text of a machine of some size; errors name the option that asks for it."""
    try:
        return new_scene(kind, asked)
    except UsageError as error:
        what = str(error)
        displaced = what.removeprefix("--displacement ")
        raise UsageError(what if displaced == what else f"{option}: a displacement of {displaced}") from None


def performance_lines(asked: SceneRequest, found: SizedMachine) -> Iterator[str]:
    """Yield the machine's performance, how it fits what was stated, and what was assumed, a line each."""
    p, scene, result = found.result.performance, found.scene, found.result
    if result.status == "ok":
        yield _computed(found)
        yield from _unusual(asked, found)
    else:
        yield f"warning: the machine does not run at its condition: {result.told} (choose another --condition or size)"
    yield f"assumed: {', '.join(_assumed(asked, scene, p))}"
    yield from (f"warning: {warning}" for warning in result.warnings)


def _computed(found: SizedMachine) -> str:
    """Return what the machine gives and takes, in words."""
    p, scene = found.result.performance, found.scene
    expands = scene.machine.expands
    words = _package_in_words if DELIVERED in p else _plant_in_words if COOLS in p else _gas_in_words
    gives, takes = (_expander_in_words if expands else words)(found)
    power = p.shaft_power
    carried = motor_load(power, scene)
    return f"computed: {gives}, {'gives' if power < 0.0 else 'takes'} {_power(power)} at the shaft ({carried}), {takes}"


def motor_load(power: float, scene: Scene) -> str:
    """Return the load of a scene's motor or generator by a shaft power [W], in words."""
    motor = _motor_of(scene)
    rated = motor.rated_power
    beyond = beyond_rating(abs(power) / rated, motor.service_factor)
    drive = "a generator" if scene.machine.expands else "a motor"
    return f"{100.0 * abs(power) / rated:.0f} % of {drive} of {1e-3 * rated:g} kW{f', {beyond}' if beyond else ''}"


def _motor_of(scene: Scene) -> Motor:
    """Return the scene's motor or generator."""
    every = (active.parameters for active in scene.effects.values())
    return next(parameters for parameters in every if isinstance(parameters, Motor))


def _power(power: float) -> str:
    """Return a power [W] that is taken or given, in words."""
    return figure_text(TAKEN, abs(power))


def _unusual(asked: SceneRequest, found: SizedMachine) -> Iterator[str]:
    """Yield of an outlet for two stages, how a stated motor hardly fits the machine, of fast rotors, a line each."""
    p, scene = found.result.performance, found.scene
    if DELIVERED in p and p.package_discharge_pressure > ONE_STAGE * p.suction_pressure:
        ratio = p.package_discharge_pressure / p.suction_pressure
        what = f"a pressure ratio of {ratio:.3g} in one stage: makers build one for 13 to 15 bar(g) at most"
        yield f"{what}, and two beyond (--two-stage writes them)"
    motor = _motor_of(scene)
    load = abs(p.shaft_power) / motor.rated_power
    overloaded = is_beyond(load, motor.service_factor)
    if asked.motor is not None and (overloaded or load < LIGHT):
        word = "more" if overloaded else "less"
        size = "--capacity" if COOLS in p else "--flow"
        check = f"{size}, --motor and {'--pressure' if DELIVERED in p else '--condition'}"
        yield f"the motor carries {word} than data sheets show (check {check}, or --speed)"
    if scene.oil is None or scene.machine.kind != "twin_screw":
        return
    tips = 0.5 * scene.operation.speed * scene.machine.rotor_diameter
    if tips > FAST_TIP_SPEED:
        remedy = "choose a lower --speed, larger rotors"
        yield f"rotor tips run at {tips:.0f} m/s, where oil films take much power ({remedy})"


def _assumed(asked: SceneRequest, scene: Scene, p: Figures) -> Iterator[str]:
    """Yield what was assumed beside what was stated."""
    rotors = scene.machine.kind == "twin_screw"
    if rotors and asked.ratio is None:
        yield f"built-in volume ratio {scene.machine.built_in_volume_ratio:g} from the pressure ratio"
    if asked.speed is None:
        yield rpm(scene.operation.speed)
    if not rotors:
        yield f"one cylinder with a bore of {1e3 * scene.machine.bore:.0f} mm"
        yield "valves sized for the gas, clearance and losses fitted to similar cylinders"
        return
    size = "" if asked.diameter is not None else f", {1e3 * scene.machine.rotor_diameter:.0f} mm"
    yield f"rotors of family b{size}"
    yield (
        "clearances scaled to that size" if scene.oil is None else "clearances, shafts and bearings scaled to that size"
    )
    if ratio := p.get("oil_ratio"):
        yield f"{float(f'{ratio:.2g}'):g} kg of oil per kg of {'air' if DELIVERED in p else 'gas'}"
    if DELIVERED in p:
        yield from _assumed_of_package(asked, scene)
    elif COOLS in p:
        yield "losses fitted to similar machines"
    else:
        expands = scene.machine.expands
        yield "friction as a share of the indicated power" if expands else "bearings and oil films by their laws"


def _assumed_of_package(asked: SceneRequest, scene: Scene) -> Iterator[str]:
    """Yield what is assumed of an air package."""
    yield "losses of a typical package, a fan of 4 % of the motor"
    if asked.variable:
        yield f"an inverter that loses {100.0 * INVERTER_LOSS_SHARE:g} % of it"
    at = scene.operation.ambient_pressure
    inlet = scene.operation.suction.pressure or at
    if abs(inlet - at) > ELSEWHERE * at:
        yield f"gauge pressures over {in_bar(at)} (operation.ambient_pressure), not over the inlet's {in_bar(inlet)}"


def _package_in_words(found: SizedMachine) -> tuple[str, str]:
    """Return, in words, what an air package delivers, and its total input."""
    p = found.result.performance
    over = 1e-5 * (p.package_discharge_pressure - found.scene.operation.suction.pressure)
    takes = f"{figure_text('package_input_power', p.package_input_power)} with motor and fan"
    gives = f"delivers {figure_text(DELIVERED, p[DELIVERED])} at {over:.4g} bar over its inlet"
    return gives, f"{takes}, {figure_text('package_specific_power', p.package_specific_power)}"


def _plant_in_words(found: SizedMachine) -> tuple[str, str]:
    """Return, in words, the capacities of a refrigeration or heat-pump machine, and its total input."""
    p = found.result.performance
    gives = f"cools {figure_text(COOLS, p[COOLS])} and heats {figure_text(HEATS, p[HEATS])}"
    duty = p.get(DUTY)
    gives += f" (without the {figure_text(DUTY, duty)} of its oil cooler)" if duty else ""
    takes = f"{figure_text('electrical_power', p.electrical_power)} with its motor"
    return gives, f"{takes}, COP {p.electrical_cop:.3g} of cooling, {p.electrical_heating_cop:.3g} of heating"


def _expander_in_words(found: SizedMachine) -> tuple[str, str]:
    """Return, in words, the flow of an expander, and its electrical power and efficiency."""
    p = found.result.performance
    takes = f"{'takes ' if p.electrical_power > 0.0 else ''}{_power(p.electrical_power)} at its generator"
    share = f"isentropic efficiency {100.0 * p.isentropic_efficiency:.3g} %"
    return f"expands {figure_text('gas_mass_flow', p.gas_mass_flow)}", f"{takes}, {share}"


def _gas_in_words(found: SizedMachine) -> tuple[str, str]:
    """Return, in words, what a compressor of another gas delivers, and its total input."""
    p = found.result.performance
    normal, at_inlet = HOUR * _molar_flow(found) / NORMAL_DENSITY, HOUR * _inlet_flow(found)
    ends = f"{in_bar(p.suction_pressure)} to {in_bar(p.discharge_pressure)}"
    gives = f"delivers {HOUR * p.gas_mass_flow:.5g} kg/h, {normal:.5g} Nm³/h, {at_inlet:.5g} m³/h at its inlet, {ends}"
    takes = f"{figure_text('electrical_power', p.electrical_power)} with its motor"
    return gives, f"{takes}, isentropic efficiency {100.0 * p.electrical_isentropic_efficiency:.1f} % of that"
