"""A new machine from its maker's sheet: its size is found by solving the cycle, so that it delivers what is stated.

A sheet states what a machine delivers or takes, not what it displaces. Delivery is nearly proportional to size, so that
a few solutions find the displacement.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from screwsim.effects.motor import SERVICE_FACTOR, beyond_rating
from screwsim.figures.engineering import figure_text
from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.customary import HOUR, in_bar
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate
from screwsim.template import SceneRequest, kind_of, new_scene
from screwsim.template.gas import INVERTER_LOSS_SHARE
from screwsim.template.request import NORMAL, R
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
    p = found.result.performance
    if found.result.status != "ok" or DELIVERED in p:
        return p.get(DELIVERED)
    if asked.molar is not None:
        return p.gas_mass_flow * constants.gas_constant(found.scene.gas.name) / R
    return p.volumetric_efficiency * p.displacement_flow


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


def with_steady_port(text: str) -> str:
    """Return the text of a scene whose economizer's port draws what the liquid gives off, else raise UsageError."""
    text, _, result = solved_machine(text)
    _check_port(result)
    return text


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
    p, scene = found.result.performance, found.scene
    every = (active.parameters for active in scene.effects.values())
    rated = next(parameters.rated_power for parameters in every if hasattr(parameters, "rated_power"))
    load = p.shaft_power / rated
    package = DELIVERED in p
    gives, takes = next(words for name, words in IN_WORDS.items() if name in p)(found)
    shaft = f"takes {figure_text(TAKEN, p.shaft_power)} at the shaft"
    beyond = beyond_rating(load)
    carried = f"{100.0 * load:.0f} % of a motor of {1e-3 * rated:g} kW{f', {beyond}' if beyond else ''}"
    yield f"computed: {gives}, {shaft} ({carried}), {takes}"
    if asked.motor is not None and not LIGHT <= load <= SERVICE_FACTOR:
        word = "more" if load > SERVICE_FACTOR else "less"
        size = "--capacity" if COOLS in p else "--flow"
        check = f"{size}, --motor and {'--pressure' if package else '--condition'}"
        yield f"the motor carries {word} than data sheets show (check {check}, or --speed)"
    tips = 0.5 * scene.operation.speed * scene.machine.rotor_diameter
    if tips > FAST_TIP_SPEED:
        remedy = "choose a lower --speed, larger rotors"
        yield f"rotor tips run at {tips:.0f} m/s, where oil films take much power ({remedy})"
    ratio = scene.machine.built_in_volume_ratio
    assumed = [] if asked.ratio is not None else [f"built-in volume ratio {ratio:g} from the pressure ratio"]
    assumed += [] if asked.speed is not None else [rpm(scene.operation.speed)]
    rotors = 1e3 * scene.machine.rotor_diameter
    assumed += [f"rotors of family b, {rotors:.0f} mm", "clearances, shafts and bearings scaled to that size"]
    if package:
        assumed += [f"{p.oil_ratio:.2g} kg of oil per kg of air"]
        assumed += ["losses of a typical package, a fan of 4 % of the motor"]
        assumed += [f"an inverter that loses {100.0 * INVERTER_LOSS_SHARE:g} % of it"] if asked.variable else []
        at = scene.operation.ambient_pressure
        inlet = scene.operation.suction.pressure or at
        if abs(inlet - at) > ELSEWHERE * at:
            assumed += [
                f"gauge pressures over {in_bar(at)} (operation.ambient_pressure), not over the inlet's {in_bar(inlet)}"
            ]
    else:
        assumed += [f"{p.oil_ratio:.2g} kg of oil per kg of gas", "losses fitted to similar machines"]
    yield f"assumed: {', '.join(assumed)}"
    yield from (f"warning: {warning}" for warning in found.result.warnings)


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


def _booster_in_words(found: SizedMachine) -> tuple[str, str]:
    """Return, in words, what a booster delivers, and its total input."""
    p = found.result.performance
    R_gas = constants.gas_constant(found.scene.gas.name)
    normal = HOUR * p.gas_mass_flow * R_gas * NORMAL[0] / NORMAL[1]
    at_inlet = HOUR * p.volumetric_efficiency * p.displacement_flow
    ends = f"{in_bar(p.suction_pressure)} to {in_bar(p.discharge_pressure)}"
    gives = f"delivers {HOUR * p.gas_mass_flow:.5g} kg/h, {normal:.5g} Nm³/h, {at_inlet:.5g} m³/h at its inlet, {ends}"
    takes = f"{figure_text('electrical_power', p.electrical_power)} with its motor"
    return gives, f"{takes}, isentropic efficiency {100.0 * p.electrical_isentropic_efficiency:.1f} % of that"


IN_WORDS = {DELIVERED: _package_in_words, COOLS: _plant_in_words, "gas_mass_flow": _booster_in_words}
