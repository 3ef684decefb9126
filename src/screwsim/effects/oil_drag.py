"""Oil drag: oil films in the tip and end gaps are sheared by the rotors.

What: Couette flow, P = μ(T_f) φ_o [Σ u² w z L/h + Σ ω² J/h_e], over the tip lands of both rotors (M141) and over their
discharge end faces (M142). T_f: stated, or the mean of injected and discharged oil. Where a leak through the same gap
has a warm clearance (M180), h changes by the same factor.
Source: Newton's law of viscosity between parallel walls (textbook); widths and solidity of the rotors are stated.
Assumptions: laminar, films without pressure gradient, one temperature; the gap at the suction end face is so wide that
its share is left out. The loss heats nothing that the chamber model sees: it is dissipated at ambient temperature.
Parameters: tip_gap, tip_land, end_gap, end_solidity, female_diameter, film_temperature, film_share.
"""

from dataclasses import dataclass
from math import pi
from typing import Any

from screwsim.effects.base import Effect, Faults, PowerLoss
from screwsim.effects.parts.usual import Sized
from screwsim.inputs.declare import number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import DIAMETER, LOBE, ROTORS
from screwsim.outputs import power_figure


def declared_film_temperature(what: str) -> Any:
    """Declare the temperature of an oil film."""
    return quantity("temperature", what, None, ge=150.0, le=700.0, hardly=(210.0, 500.0))


@dataclass(frozen=True)
class Parameters:
    """Gaps, lands and the temperature of the films."""

    tip_gap: float = quantity("length", "h: clearance between tips and housing", gt=0.0, hardly=(1e-6, 1e-3))
    tip_land: float = quantity("length", "w: circumferential width of the land on a lobe's tip", ge=0.0)
    end_gap: float | None = quantity(
        "length", "h_e: clearance of the discharge end faces (absent: no drag there)", None, gt=0.0, hardly=(1e-6, 2e-3)
    )
    end_solidity: float | None = number(
        "share of the rotors' outer circles that is metal on the end face (with end_gap)", None, gt=0.0, le=1.0
    )
    female_diameter: float | None = optional(
        "length", "outer diameter of the female rotor (default: machine.profile's, else the male rotor's)"
    )
    film_temperature: float | None = declared_film_temperature(
        "T_f: temperature of the films (default: mean of injected and discharged oil)"
    )
    film_share: float = number("share of the gaps filled by oil", 1.0, ge=0.0, le=1.0)


def tip_drag(speed: float, diameter: float, lobes: int, length: float, land: float, gap: float) -> float:
    """Return the drag power of a rotor's tip lands per viscosity [W/(Pa s)]: speed [rad/s], lengths [m] (M141)."""
    return (0.5 * diameter * speed) ** 2 * lobes * land * length / gap


def end_drag(speed: float, diameter: float, solidity: float, gap: float) -> float:
    """Return the drag power of a rotor's end face per viscosity [W/(Pa s)]: speed [rad/s], lengths [m] (M142)."""
    return speed**2 * solidity * pi * diameter**4 / (32.0 * gap)


def film_temperature(stated: float | None, figures) -> float:
    """Return the temperature of an oil film [K]: as stated, or the mean of injected and discharged oil."""
    if stated is not None:
        return stated
    out = figures.oil_discharge_temperature
    return figures.oil_temperature if out is None else 0.5 * (figures.oil_temperature + out)


def warm(gap: float, leak: str, figures) -> float:
    """Return a stated clearance [m] scaled as the warm one of the leak through it; unchanged where none is computed."""
    made = figures.turn.made if figures.turn is not None else {}
    return gap * made.get(f"{leak}_widening", 1.0)


def build(parameters: Parameters, machine) -> list[PowerLoss]:
    size = machine.settings
    own = size.profile.female_diameter if size.profile is not None else size.rotor_diameter
    rotors = (
        (1.0, size.rotor_diameter, size.male_lobes),
        (size.male_lobes / size.female_lobes, parameters.female_diameter or own, size.female_lobes),
    )

    def power(figures) -> float:
        """Return the drag [W] (M141, M142)."""
        T = film_temperature(parameters.film_temperature, figures)
        tip, end, total = warm(parameters.tip_gap, "tip_leakage", figures), parameters.end_gap, 0.0
        if end is not None:
            end = warm(end, "end_face_leakage", figures)
        for ratio, diameter, lobes in rotors:
            speed = ratio * figures.omega
            total += tip_drag(speed, diameter, lobes, size.rotor_length, parameters.tip_land, tip)
            if end is not None:
                total += end_drag(speed, diameter, parameters.end_solidity or 0.0, end)
        return parameters.film_share * figures.film_viscosity_at(T) * total

    return [PowerLoss("oil_drag_power", power)]


def check(parameters: Parameters, facts) -> Faults:
    if facts.oil is not None and not facts.oil.knows_viscosity:
        yield Fault("oil.viscosity", "is missing (effects.oil_drag needs it, or oil.name)")
    if parameters.end_gap is not None and parameters.end_solidity is None:
        yield Fault("effects.oil_drag.end_solidity", "is missing (end_gap needs it, e.g. end_solidity: 0.6)")
    if parameters.end_gap is None and parameters.end_solidity is not None:
        yield Fault("effects.oil_drag.end_gap", "is missing (end_solidity is used with it only, e.g. 0.1 mm)")
    if facts.machine.profile is not None and parameters.female_diameter is not None:
        what = "is given as well as machine.profile.female_diameter (remove it)"
        yield Fault("effects.oil_drag.female_diameter", what)


EFFECT = Effect(
    name="oil_drag",
    title="oil sheared in tip and end gaps",
    equations=("M140", "M141", "M142"),
    source="Couette flow (textbook)",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    check=check,
    needs=frozenset({ROTORS}),
    figures=(power_figure("oil_drag_power", "drag of oil in tip and end gaps"),),
    sizes=(
        Sized("tip_gap", LOBE, 1.0, (0.0, 0.1)),
        Sized("end_gap", LOBE, 1.0, (0.0, 0.1)),
        Sized("tip_land", DIAMETER, 1.0, (0.0, 0.2)),
        Sized("female_diameter", DIAMETER, 10.0, (0.5, 1.5)),
    ),
)
