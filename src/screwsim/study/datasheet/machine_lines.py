"""Lines of a sheet on the machine at the scene's own point (size, motor, oil), and on its limits."""

from collections.abc import Iterator, Mapping
from typing import Any

from screwsim.effects.motor import beyond_rating
from screwsim.figures import rotor_speed
from screwsim.scene import Scene
from screwsim.scene.operation import SPEED
from screwsim.study.asked.inputs import shown_value
from screwsim.study.datasheet.assumed import ABOUT, Assumed, oil_viscosity
from screwsim.study.datasheet.bounds import Limit, bound_words, motor_of
from screwsim.study.datasheet.units import METRIC, Units

DUTY = "oil_cooler_duty"
Lines = Iterator[tuple[str, str]]


def machine_line(scene: Scene, found: Mapping[str, Any], units: Units = METRIC) -> Lines:
    """Yield the displacement of the machine, and its speed."""
    if found:
        speed = shown_value(scene, SPEED, rotor_speed(found, scene.operation.speed))
        yield "machine", f"{units.quantity('m3 s-1', found['displacement_flow'])} swept at {speed}"


def load_in_words(motor: Any, power: float, omega: float, where: str) -> str:
    """Return the load of a motor by its power [W] and the rotors' speed [rad/s]; `where` says at which point."""
    share = abs(power) / motor.rated_power
    beyond = beyond_rating(abs(power) / motor.carried(omega), motor.service_factor)
    return f", {100.0 * share:.0f} % of it {where}{f', {beyond}' if beyond else ''}"


def load_at_point(scene: Scene, found: Mapping[str, Any]) -> str:
    """Return the load of a scene's motor at its own point, behind its rating."""
    speed = rotor_speed(found, scene.operation.speed)
    return load_in_words(motor_of(scene), found["shaft_power"], speed, "at the point")


def power_lines(scene: Scene, found: Mapping[str, Any], units: Units, gives: bool = False) -> Lines:
    """Yield the rating of the motor or generator, and its load at the scene's point."""
    motor = motor_of(scene)
    if motor is not None:
        share = load_at_point(scene, found) if found else ""
        yield "generator" if gives else "motor", f"{units.quantity('W', motor.rated_power)} rated at the shaft{share}"


def oil_line(scene: Scene, found: Mapping[str, Any], units: Units = METRIC) -> Lines:
    """Yield source, flow and temperature of the oil, and the duty of its cooler."""
    supply = scene.oil_supply
    if supply is None:
        return
    text = "from a pump" if supply.pumped else "displaced by the discharge pressure"
    if found.get("oil_flow_volume") is not None:
        text += f", {units.quantity('L min-1', found['oil_flow_volume'])}"
    temperature = found.get("oil_supply_temperature", supply.temperature)
    if temperature is not None:
        text += f" at {units.degrees(temperature, '.1f')}"
        if scene.oil is not None and scene.oil.name is not None:
            viscosity = oil_viscosity(scene.oil.name, temperature, found)
            text += f" ({1e6 * viscosity:.3g} mm²/s without dissolved gas)" if viscosity else ""
    duty, cooled, (factor, unit) = found.get(DUTY), is_oil_cooled(scene), units.heat
    if duty is None:
        heat = "what warms it again" if scene.machine.expands else "the duty of its cooler"
        yield "oil", f"{text}; {heat} is not simulated (effects.separator)"
    elif duty < 0.0:
        yield "oil", f"{text}; {-factor * duty:.1f} {unit} warm it again, which no efficiency counts"
    else:
        yield "oil", f"{text}; its cooler takes {factor * duty:.1f} {unit}" if cooled else f"{text}; no cooler"


def limits_in_words(bounds: Mapping[Limit, str], units: Units) -> Lines:
    """Yield the limits that are stated, and those that are assumed."""
    given = [f"{bound_words(bound, units)} ({at})" for bound, at in bounds.items() if not isinstance(bound, Assumed)]
    yield "limits", ", ".join(given) or "none stated (--limit 'discharge_temperature<110 degC')"
    assumed = [bound_words(bound, units) for bound in bounds if isinstance(bound, Assumed)]
    if assumed:
        yield "assumed", f"{', '.join(assumed)}: {ABOUT}"


def is_oil_cooled(scene: Scene) -> bool:
    """Return whether heat is taken from the oil: by a cooler, or by a stated oil temperature."""
    separator = scene.effects.get("separator")
    supply = scene.oil_supply
    stated = supply is not None and supply.temperature is not None
    return separator is not None and (stated or separator.parameters.cooler is not None)
