"""Bearings: friction of rolling bearings of both rotors, under stated loads or those of the gas.

What: P = Σ_rotors ω_r M; `simple`: M = ½ μ_f F d; `two_term`: M = n_b M_0 + f_1 F d_m, M_0 from f_0 (ν n)^(2/3) d_m³
(M143). F: radial and axial load added as vectors; stated, or the means of the gas forces (M146).
Source: SKF, Rolling bearings (general catalogue), estimating the frictional moment: μ_f 0.0010 to 0.0020 by kind of
bearing; load-independent and load-dependent moment: A. Palmgren, Grundlagen der Wälzlagertechnik, 1957.
Assumptions: the female rotor carries `female_load` times the male's load and has bearings of the same size; no seals.
The loss heats nothing that the chamber model sees: it is dissipated at ambient temperature.
Parameters: friction, load, the loads or areas, friction_coefficient and bore, or mean_diameter, f_0, f_1, count.
"""

from dataclasses import dataclass
from math import hypot, pi

from screwsim.effects.base import Effect, Faults, PowerLoss
from screwsim.effects.oil_drag import declared_film_temperature, film_temperature
from screwsim.effects.parts.usual import FRICTION, Sized
from screwsim.inputs.declare import choice, count, number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import DIAMETER, ROTORS
from screwsim.outputs import power_figure

LEAST_FILM = 2000.0  # ν n [mm²/s · 1/min] below which M_0 no longer depends on ν n (Palmgren)
_OF_FRICTION = {"simple": ("friction_coefficient", "bore"), "two_term": ("mean_diameter", "f_0", "f_1")}
_EXAMPLES = {"friction_coefficient": "0.0018", "bore": "60 mm", "mean_diameter": "85 mm", "f_0": "2", "f_1": "0.0004"}
_OF_LOAD = {"stated": ("radial_load", "axial_load"), "gas": ("radial_area", "axial_area")}


@dataclass(frozen=True)
class Parameters:
    """Bearings of one rotor, and the loads on the male rotor."""

    friction: str = choice(
        "simple: constant coefficient of friction; two_term: load-independent and load-dependent moment",
        ("simple", "two_term"),
        "simple",
    )
    load: str = choice("stated: loads are given; gas: mean gas forces on stated areas", ("stated", "gas"), "stated")
    radial_load: float | None = quantity("force", "radial load on the male rotor (load: stated)", None, ge=0.0)
    axial_load: float | None = quantity("force", "axial load on the male rotor (load: stated)", None, ge=0.0)
    radial_area: float | None = quantity("area", "projected radial area of one chamber (load: gas)", None, ge=0.0)
    axial_area: float | None = quantity("area", "projected axial area of one chamber (load: gas)", None, ge=0.0)
    female_load: float = number(
        "load on the female rotor over that on the male", 1.0, ge=0.0, le=1e3, hardly=(None, 3.0)
    )
    friction_coefficient: float | None = number(
        "mu_f, on the bore (friction: simple)", None, ge=0.0, le=10.0, hardly=(None, 0.1)
    )
    bore: float | None = optional("length", "d: bore of the bearings (friction: simple)")
    mean_diameter: float | None = optional("length", "d_m: mean diameter (friction: two_term)")
    f_0: float | None = number(
        "f_0, of the bearing and its lubrication (friction: two_term)", None, ge=0.0, le=1e3, hardly=(None, 20.0)
    )
    f_1: float | None = number(
        "f_1, of the load-dependent moment (friction: two_term)", None, ge=0.0, le=1.0, hardly=(None, 0.01)
    )
    count: int = count("bearings of one rotor, for the load-independent moment (friction: two_term)", 4, ge=1)
    film_temperature: float | None = declared_film_temperature(
        "temperature of the lubricating oil (friction: two_term; default: as in oil_drag)"
    )


def idle_moment(speed: float, kinematic_viscosity: float, mean_diameter: float, f_0: float) -> float:
    """Return the load-independent moment M_0 of one bearing [N m] (M143).

    Arguments: speed [rad/s], kinematic viscosity [m²/s], mean diameter [m], factor f_0.
    """
    film = 1e6 * kinematic_viscosity * abs(speed) * 30.0 / pi  # mm²/s · 1/min, the units of the rule
    scale = film ** (2.0 / 3.0) if film >= LEAST_FILM else LEAST_FILM ** (2.0 / 3.0)
    return 1e-7 * f_0 * scale * (1e3 * mean_diameter) ** 3 * 1e-3 if speed != 0.0 else 0.0


def load_on_male(parameters: Parameters, figures) -> float:
    """Return the load on the male rotor [N]: as stated, or the mean gas force on the stated areas (M146)."""
    if parameters.load == "stated":
        return hypot(parameters.radial_load or 0.0, parameters.axial_load or 0.0)
    pitch = figures.pitch()
    within = pitch.within()
    excess = within.mean((within.pressure - pitch.low_pressure).sum(axis=1))
    return abs(excess) * hypot(parameters.radial_area or 0.0, parameters.axial_area or 0.0)


def moment(parameters: Parameters, speed: float, load: float, figures) -> float:
    """Return the friction moment of the bearings of one rotor [N m] (M143)."""
    if parameters.friction == "simple":
        return 0.5 * (parameters.friction_coefficient or 0.0) * load * (parameters.bore or 0.0)
    T, d_m = film_temperature(parameters.film_temperature, figures), parameters.mean_diameter or 0.0
    viscosity = figures.oil_viscosity_at(T) / figures.oil_density_at(T)
    idle = idle_moment(speed, viscosity, d_m, parameters.f_0 or 0.0)
    return parameters.count * idle + (parameters.f_1 or 0.0) * load * d_m


def build(parameters: Parameters, machine) -> list[PowerLoss]:
    ratio = machine.settings.male_lobes / machine.settings.female_lobes

    def power(figures) -> float:
        """Return the friction power of all bearings [W] (M143)."""
        load, male, female = load_on_male(parameters, figures), figures.omega, ratio * figures.omega
        of_male = male * moment(parameters, male, load, figures)
        return of_male + female * moment(parameters, female, parameters.female_load * load, figures)

    return [PowerLoss("bearing_power", power, friction=True)]


def check(parameters: Parameters, facts) -> Faults:
    for chosen, table in ((parameters.friction, _OF_FRICTION), (parameters.load, _OF_LOAD)):
        for word, names in table.items():
            yield from _belonging(parameters, chosen, word, names)
    if parameters.friction == "two_term":
        if facts.oil is None or facts.oil_supply is None:
            what = "two_term needs oil and oil_supply, absent here (write those, or friction: simple)"
            yield Fault("effects.bearings.friction", what)
        elif not facts.oil.knows_viscosity:
            yield Fault("oil.viscosity", "is missing (effects.bearings.friction: two_term needs it, or oil.name)")
    elif parameters.film_temperature is not None:
        yield Fault("effects.bearings.film_temperature", "applies only to friction: two_term (remove it)")


def _belonging(parameters: Parameters, chosen: str, word: str, names: tuple[str, ...]) -> Faults:
    """Yield parameters that a choice needs and lacks, and those given that belong to the other option."""
    for name in names:
        given, path = getattr(parameters, name) is not None, f"effects.bearings.{name}"
        if word == chosen and not given:
            example = _EXAMPLES.get(name, "8 kN" if name.endswith("load") else "30 cm^2")
            yield Fault(path, f"is missing ({word} needs it, e.g. {name}: {example})")
        elif word != chosen and given:
            yield Fault(path, f"applies only to {word}, and {chosen} is chosen (remove it)")


EFFECT = Effect(
    name="bearings",
    title="friction of rolling bearings",
    equations=("M143", "M146"),
    source="SKF catalogue; Palmgren 1957",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({ROTORS}),
    figures=(power_figure("bearing_power", "friction of the bearings"),),
    usual={ROTORS: FRICTION},
    sizes=(Sized("bore", DIAMETER, 10.0, (0.05, 1.0)), Sized("mean_diameter", DIAMETER, 10.0, (0.05, 1.5))),
)
