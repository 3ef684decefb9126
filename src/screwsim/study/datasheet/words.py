"""Lines and notes of sheets of several kinds: motor, oil, limits, the highest of figures, what points warn of."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from screwsim.figures.engineering import quantity, shown_name
from screwsim.scene import Scene
from screwsim.study.datasheet.bounds import motor_of, shown
from screwsim.study.datasheet.rated import Rating, celsius
from screwsim.study.datasheet.sheet import told
from screwsim.study.datasheet.tables import KW, place_of
from screwsim.study.inputs import shown_value

DUTY = "oil_cooler_duty"
Lines = Iterator[tuple[str, str]]


def machine_line(scene: Scene, found: Mapping[str, Any]) -> Lines:
    """Yield what the machine displaces, and its speed."""
    speed = shown_value(scene, "operation.speed", scene.operation.speed)
    if found:
        yield "machine", f"{quantity('m3 s-1', found['displacement_flow'])} swept at {speed}"


def power_lines(scene: Scene, found: Mapping[str, Any], gives: bool = False) -> Lines:
    """Yield what the motor, or the generator, is rated at and how far the scene's point loads it."""
    motor = motor_of(scene)
    if motor is not None:
        load = 100.0 * abs(found["shaft_power"]) / motor.rated_power if found else 0.0
        share = f", {load:.0f} % of it at the point" if found else ""
        yield "generator" if gives else "motor", f"{quantity('W', motor.rated_power)} rated at the shaft{share}"


def oil_line(scene: Scene, found: Mapping[str, Any]) -> Lines:
    """Yield where the oil comes from, how much, how warm, and the duty of its cooler."""
    if scene.oil_supply is not None:
        yield "oil", _oil(scene, found)


def limit_lines(rated: Rating, figures: Sequence[str]) -> Lines:
    """Yield the limits, and the highest of figures over the table."""
    stated = ", ".join(f"{bound.words} ({bound.source})" for bound in rated.asked.bounds)
    yield "limits", stated or "none stated (--limit 'discharge_temperature<110 degC')"
    highest = [f"{shown_name(name)} {_highest(rated, name)}" for name in figures if _highest(rated, name)]
    if highest:
        yield "highest", f"over the table: {', '.join(highest)}"


def control_line(rated: Rating) -> Lines:
    """Yield the controls of the capacity."""
    yield "control", ", ".join(control.name for control in rated.asked.controls) or "none that the scene names"


def cooled(scene: Scene) -> bool:
    """Tell whether oil is taken heat from: by a cooler, or by what states its temperature."""
    separator = scene.effects.get("separator")
    supply = scene.oil_supply
    stated = supply is not None and supply.temperature is not None
    return separator is not None and (stated or separator.parameters.cooler is not None)


def _oil(scene: Scene, found: Mapping[str, Any]) -> str:
    supply = scene.oil_supply
    assert supply is not None
    text = "from a pump" if supply.pumped else "displaced by the discharge pressure"
    if found.get("oil_flow_volume") is not None:
        text += f", {quantity('L min-1', found['oil_flow_volume'])}"
    temperature = found.get("oil_supply_temperature", supply.temperature)
    if temperature is not None:
        text += f" at {celsius(temperature):.1f} °C"
    duty = found.get(DUTY)
    if duty is None:
        return f"{text}; the duty of its cooler is not simulated (effects.separator)"
    return f"{text}; its cooler takes {KW * duty:.1f} kW" if cooled(scene) else f"{text}; no cooler"


def _highest(rated: Rating, figure: str) -> str:
    every = [(result.performance.get(figure), at) for at, result in rated.points.items() if result.status == "ok"]
    known = [(value, at) for value, at in every if value is not None]
    if not known:
        return ""
    value, (i, j) = max(known)
    return f"{shown(figure, value)} at {place_of(rated, i, j)}"


def notes_of(rated: Rating, own: str, meant: str) -> Iterator[str]:
    """Yield what points failed of or warn of, once each and where; `own` is the scene's point in words."""
    every = [(own, rated.own)]
    every += [(place_of(rated, i, j), result) for (i, j), result in rated.points.items()]
    for each in rated.loads:
        every += [(f"{each.control.name} at {100.0 * step.load:.0f} %", step.result) for step in each.steps[1:]]
    yield from told([(where, [result.told]) for where, result in every if result.status != "ok"])
    for each in rated.loads:
        if each.why:
            yield f"{each.control.name}: no part load below {100.0 * each.least:.0f} %: {each.why}"
    yield from told([(where, result.warnings) for where, result in every if result.status == "ok"])
    if "operation.speed" in {control.path for control in rated.asked.controls}:
        motor = motor_of(rated.asked.scene)
        if motor is None or not motor.inverts:
            yield "part load by speed is without the losses of an inverter (effects.motor.inverter)"
    yield meant
