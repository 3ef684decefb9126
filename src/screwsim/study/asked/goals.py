"""Goals and bounds of figures as people write them: 'cooling_capacity=500 kW', 'discharge_temperature<90 degC'."""

import re
from collections.abc import Iterable
from typing import NamedTuple

from screwsim.figures import declared
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.scene import Scene
from screwsim.scene.numerals import odd_number, odd_number_text
from screwsim.scene.units import NUMBER, gauge_pressures_over, parse_quantity, refused_at, tidy_unit
from screwsim.study.asked.figure_units import CELSIUS, bare_percent, quantity_of, units_of
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.varied import Varied


class Goal(NamedTuple):
    """A figure and its desired value [SI]."""

    figure: str
    value: float


class Bound(NamedTuple):
    """A figure with its upper ('<') or lower ('>') bound [SI]."""

    figure: str
    sign: str
    value: float

    def excess(self, figure: float) -> float:
        """Return by how much a figure [SI] violates the bound; negative within it."""
        return figure - self.value if self.sign == "<" else self.value - figure


def read_goals(scene: Varied, texts: Iterable[str]) -> tuple[Goal, ...]:
    """Return the goals of texts FIGURE=VALUE; raise UsageError in one line."""
    split = (_split_condition(scene, text, "--for", "=", "cooling_capacity=500 kW") for text in texts)
    found = [Goal(figure, value) for figure, _, value in split]
    refuse_twice("--for", [goal.figure for goal in found])
    if not found:
        raise UsageError("no goal is given (write --for FIGURE=VALUE, e.g. --for 'cooling_capacity=500 kW')")
    return tuple(found)


def read_bounds(scene: Varied, texts: Iterable[str], option: str = "--subject-to") -> tuple[Bound, ...]:
    """Return the bounds of texts FIGURE<VALUE or FIGURE>VALUE of an option; raise UsageError in one line."""
    example = "discharge_temperature<90 degC"
    plain = (text.replace("<=", "<").replace(">=", ">") for text in texts)
    found = [Bound(*_split_condition(scene, text, option, "<>", example)) for text in plain]
    refuse_twice(option, [f"{bound.figure}{bound.sign}" for bound in found])
    return tuple(found)


def _split_condition(scene: Varied, text: str, option: str, signs: str, example: str) -> tuple[str, str, float]:
    """Return figure, sign and value [SI] of a text."""
    match = re.fullmatch(rf"\s*([^=<>]+?)\s*([{signs}])\s*([^=<>]+?)\s*", text)
    if match is None:
        shape = " or ".join(f"FIGURE{sign}VALUE" for sign in signs)
        raise UsageError(f"{option} {text}: is not {shape} (write e.g. {option} '{example}')")
    figure = figure_of(scene, match[1], option)
    with gauge_pressures_over(of_ambient(scene)):
        return figure, match[2], read_figure(figure, match[3], f"{option} {text}")


def of_ambient(scene: Varied) -> float | None:
    """Return the ambient pressure [Pa] over which gauge pressures are read; None where two stages have two of them."""
    return scene.operation.ambient_pressure if isinstance(scene, Scene) else scene.ambient_pressure


def read_figure(figure: str, text: str, where: str, kind: str = "figure") -> float:
    """Return the value [SI] of a figure as people write it ('500 kW', '85 %', '90 degC'); raise UsageError.

    Units are those listed for it, and those in which scenes state its dimension; `kind`: figure or uncertainty of one.
    """
    units = units_of(figure)
    match = re.fullmatch(rf"({NUMBER})\s*(.*?)", text.strip())
    if match is None:
        odd = odd_number(text)
        listed = ", ".join(unit for unit in units if unit not in ("", "1"))
        remedy = f"write a number with one of {listed}" if listed else "write a number"
        what = odd_number_text(odd, "") if odd else f"is not a number with a unit ({remedy})"
        raise UsageError(f"{where}: {text!r} {what}")
    number, unit = float(match[1]), tidy_unit(match[2])
    celsius = declared(figure).units == "K"  # a difference of temperatures has no Celsius form
    if unit == CELSIUS and celsius:
        return number + ZERO_CELSIUS
    if unit in units:
        if not unit and (meant := bare_percent(figure, match[1], kind)):
            raise UsageError(f"{where}: {figure} {match[1]} {meant}")
        return number * units[unit]
    with refused_at(where):
        if quantity := quantity_of(figure, kind, unit):
            return parse_quantity(quantity, f"{match[1]} {unit}")
    offered = [each for each in (*units, *([CELSIUS, "degF"] if celsius else [])) if each]
    what = f"has no unit {match[2]!r}" if unit else f"{match[1]} has no unit"
    raise UsageError(f"{where}: {figure} {what} (write one of {', '.join(offered) or 'a plain number'})")


def refuse_twice(option: str, names: list[str]) -> None:
    """Raise UsageError where an option is given twice for one name."""
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"{option} {name}: is given twice (remove one)")
