"""Inputs that a study varies: read as people write them, checked, and shown in customary units."""

import re
from collections.abc import Mapping
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import ZERO_CELSIUS, with_printed_units
from screwsim.scene import Scene
from screwsim.scene.grid import without_axes
from screwsim.scene.units import NUMBER, customary_unit, to_customary
from screwsim.study.asked.varied import Kind, Varied, case, faults_of, leaf_of, read_value, with_values

CELSIUS = "°C"
WITHOUT_ZERO = "temperature", "angle"  # quantities whose zero is a convention: a percentage of them says nothing
# kinds without a range of values
DISCRETE_KINDS = {"choice": "a choice", "count": "a whole number", "fluid": "a fluid"}


def check_continuous(scene: Varied, path: str) -> None:
    """Raise UsageError unless the input at a path is continuous."""
    what = DISCRETE_KINDS.get(leaf_of(scene, path).kind)
    if what is not None:
        raise UsageError(f"{path}: is {what}, not a continuous quantity (vary it in the scene's sweep: block)")


ISOTHERMAL, ISENTROPIC = "isothermal_efficiency", "isentropic_efficiency"


def usual_efficiency(scene: Varied) -> str:
    """Return the default figure of a study: the isentropic efficiency for a real gas, which may condense.

    Of two stages it is that of what they are for.
    """
    if not isinstance(scene, Scene):
        return scene.usual_figure
    real = "real" in (scene.gas.model, *scene.sweep.get("gas.model", ()))
    return ISENTROPIC if real else ISOTHERMAL


def efficiency_note(scene: Varied) -> str:
    """Return, in one line, why the isothermal efficiency is not the default; empty where it is."""
    if not isinstance(scene, Scene):
        return f"{scene.usual_figure} is used (choose another with --figure)"
    if usual_efficiency(scene) == ISOTHERMAL:
        return ""
    return (
        f"{ISENTROPIC} is used, because a real gas may have no isothermal one, e.g. where it would condense (choose "
        f"another with --figure)"
    )


def read_text(scene: Varied, path: str, text: str) -> float:
    """Return a value as written on the command line ('1000 rpm', '0.5') in SI; raise UsageError."""
    bare = leaf_of(scene, path).dimension is None and re.fullmatch(NUMBER, text.strip())
    return read_value(scene, path, float(text) if bare else text.strip())


def ends_of(text: str) -> tuple[str, str] | None:
    """Return both ends of LOW..HIGH; a bare LOW has the unit of HIGH. None for a text that is not a range."""
    low, dots, high = (part.strip() for part in text.partition(".."))
    if not (dots and low and high) or "..." in text or ".." in high:  # 0...5 is not taken for 0 to 0.5
        return None
    return f"{low} {unit_behind(high)}".strip() if re.fullmatch(NUMBER, low) else low, high


def unit_behind(text: str) -> str:
    """Return what follows the number with which a text begins; '' for a text that begins with none."""
    match = re.fullmatch(rf"{NUMBER}\s*(.*)", text)
    return match[1].strip() if match else ""


def check_fit(scene: Varied, values: Mapping[str, Any], where: str) -> None:
    """Raise UsageError with the first fault when values do not fit into a scene, behind `where` if they cause it."""
    faults = faults_of(with_values(scene, values))
    if faults:
        text = str(faults[0])
        theirs = not text.startswith(f"{where}: ") and text not in map(str, faults_of(scene))
        raise UsageError(f"{where}: {text}" if theirs else text)


def over_other_axes(scene: Kind, values: Mapping[str, Any]) -> Kind:
    """Return a scene with the axes of its sweep other than these paths, which a study varies.

    Raise UsageError where the values [SI] do not fit into its first point.
    """
    rest = without_axes(scene, values)
    check_fit(case(rest, 0), values, ", ".join(values))
    return rest


def shown_value(scene: Varied, path: str, value: Any, digits: int = 5) -> str:
    """Return a value [SI] of a path with its customary unit; a temperature in °C, as precise as in K."""
    unit = with_printed_units(in_customary(scene, path, value)[1])
    return f"{shown_number(scene, path, value, digits)} {unit}".strip()


def shown_range(scene: Varied, path: str, low: Any, high: Any, *, digits: int = 5) -> str:
    """Return two values [SI] of a path as `shown_value` does, with dots between them."""
    return " … ".join(shown_value(scene, path, end, digits) for end in (low, high))


def refuse_empty_range(scene: Varied, path: str, low: float, high: float, where: str) -> None:
    """Raise UsageError, behind `where`, unless the lower end [SI] of a range of a path is below the upper one."""
    if not low < high:
        raise UsageError(f"{where}: the range {shown_range(scene, path, low, high)} is empty (LOW must be below HIGH)")


def shown_number(scene: Varied, path: str, value: Any, digits: int = 4) -> str:
    """Return a value [SI] of a path as `shown_value` does, without its unit."""
    number, unit = in_customary(scene, path, value)
    if unit != CELSIUS:
        return f"{number:.{digits}g}" if isinstance(number, float) else str(number)
    text = f"{number:z.{max(digits - 3, 1)}f}"  # with the decimals of a usual temperature in K of so many digits
    return text.rstrip("0").rstrip(".") if "." in text else text


def in_customary(scene: Varied, path: str, value: Any) -> tuple[Any, str]:
    """Return a value [SI] of a path as a number in its customary unit, and that unit: °C for temperatures."""
    kind = leaf_of(scene, path).dimension
    if kind is None:
        return (float(value), "") if isinstance(value, int | float) else (value, "")
    if kind.name == "temperature":
        return round(float(value) - ZERO_CELSIUS, 9) + 0.0, CELSIUS
    return to_customary(kind, float(value)), customary_unit(kind)


def unit_of_change(scene: Varied, path: str, value: float) -> tuple[float, str]:
    """Return the factor from SI to the unit for changes of a path's value [SI], and that unit; '' for pure numbers."""
    kind = leaf_of(scene, path).dimension
    unit = "" if kind is None else "K" if kind.name == "temperature" else customary_unit(kind)
    if unit == "mm" and abs(value) < 1e-3:
        return 1e6, "um"
    return (1.0 if kind is None or unit == "K" else to_customary(kind, 1.0)), unit
