"""Bearings: friction of rolling bearings of both rotors, under stated loads or those of the gas.

What: P = Σ_rotors ω_r M; `simple`: M = ½ μ_f F d; `two_term`: M = n_b M_0 + f_1 F d_m, M_0 from f_0 (ν n)^(2/3) d_m³
(M143). F: radial and axial load added as vectors; stated; the means of the gas forces on stated areas (M146), an upper
limit; or what the gas on flanks and end faces and the contact load each rotor with, of rotors with a profile (M158).
With `male` or `female` that rotor's bearings are told one by one: what each carries (M480), with its friction (M481),
and its rating life (M482–M484; `effects.parts.bearing_set`).
Source: SKF, Rolling bearings (general catalogue), estimating the frictional moment: μ_f 0.0010 to 0.0020 by kind of
bearing; load-independent and load-dependent moment: A. Palmgren, Grundlagen der Wälzlagertechnik, 1957;
rating life: ISO 281:2007.
Assumptions: without `load: rotors` the female rotor carries `female_load` times the male's load; its bearings have the
same size; no seals or weights; the bearings of a rotor that are not named one by one share its load as one, without a
balance piston.
The loss heats nothing that the chamber model sees: it is dissipated at ambient temperature.
Parameters: friction, load, the loads, areas or shaft_diameter, female_load, friction_coefficient and bore, or
mean_diameter, f_0, f_1, count; male, female, life_of_set.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, pi

import numpy as np

from screwsim.effects.base import Effect, Faults, Given, PowerLoss, Reading
from screwsim.effects.oil_drag import declared_film_temperature, film_temperature
from screwsim.effects.parts import bearing_set
from screwsim.effects.parts.usual import FRICTION, Sized
from screwsim.inputs.declare import choice, count, number, optional, quantity
from screwsim.inputs.faults import Fault, UsageError
from screwsim.machine.profile_law import LaidCurves
from screwsim.machine.protocol import DIAMETER, ROTORS
from screwsim.machine.rotors.contact import slope_at_pitch
from screwsim.machine.rotors.loads import NAMES, expanded, pressed_areas, rotor_loads, thick_shaft
from screwsim.machine.rotors.rotors import MOST_CACHED
from screwsim.outputs import Figure, names_of, over, power_figure

LEAST_FILM = 2000.0  # ν n [mm²/s · 1/min] below which M_0 no longer depends on ν n (Palmgren)
_OF_FRICTION = {"simple": ("friction_coefficient", "bore"), "two_term": ("mean_diameter", "f_0", "f_1")}
_EXAMPLES = {"friction_coefficient": "0.0018", "bore": "60 mm", "mean_diameter": "85 mm", "f_0": "2", "f_1": "0.0004"}
USUAL_COUNT = 4  # bearings of a rotor
ROTOR_LOADS = "rotors"
_OF_LOAD = {"stated": ("radial_load", "axial_load"), "gas": ("radial_area", "axial_area"), ROTOR_LOADS: ()}
_CALLED = (f".load: {ROTOR_LOADS}",)


def _loads_of(rotor: str) -> Iterator[Figure]:
    of = f"load of the {rotor} rotor on its bearings"
    yield Figure(f"{rotor}_radial_load", "N", f"mean radial {of}", needs=_CALLED)
    axial = f"mean axial {of}, towards the suction end"
    yield Figure(f"{rotor}_axial_load", "N", axial, over("male_radial_load"), _CALLED)


FIGURES = (
    power_figure("bearing_power", "friction of the bearings"),
    *(load for rotor in NAMES for load in _loads_of(rotor)),
    *bearing_set.FIGURES,
)
LOADS = names_of(FIGURES)[1:]


@dataclass(frozen=True)
class Parameters:
    """Bearings of one rotor, and the loads on the male rotor."""

    friction: str = choice(
        "simple: constant coefficient of friction; two_term: load-independent and load-dependent moment",
        ("simple", "two_term"),
        "simple",
    )
    load: str = choice(
        "stated: loads are given; gas: mean gas forces on stated areas, an upper limit; rotors: what presses on the "
        "surfaces of rotors with a profile (M158)",
        tuple(_OF_LOAD),
        "stated",
    )
    radial_load: float | None = quantity("force", "radial load on the male rotor (load: stated)", None, ge=0.0)
    axial_load: float | None = quantity("force", "axial load on the male rotor (load: stated)", None, ge=0.0)
    radial_area: float | None = quantity("area", "projected radial area of one chamber (load: gas)", None, ge=0.0)
    axial_area: float | None = quantity("area", "projected axial area of one chamber (load: gas)", None, ge=0.0)
    shaft_diameter: float | None = optional(
        "length", "of both shafts at the end faces, where no gas presses (load: rotors; default: no shaft)"
    )
    female_load: float | None = number(
        "load on the female rotor over that on the male (load: stated or gas; default: 1)",
        None,
        ge=0.0,
        le=1e3,
        hardly=(None, 3.0),
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
    count: int | None = count(
        "bearings of one rotor, for the load-independent moment, whatever male and female name (friction: two_term; "
        f"default: {USUAL_COUNT})",
        None,
        ge=1,
    )
    male: bearing_set.RotorBearings | None = None
    female: bearing_set.RotorBearings | None = None
    life_of_set: str | None = choice(
        "weibull: also the life of all bearings together, which all have a rating (M484)", ("weibull",), None
    )
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


@lru_cache(maxsize=MOST_CACHED)
def _areas_by_angle(
    laid: LaidCurves, expands: bool, shaft: float, points: int
) -> tuple[np.ndarray, list[dict[str, np.ndarray]]]:
    """Return the angles [rad] of all chambers (columns) at even points of a pitch (rows), and the areas that press.

    The angles are those of the rotors (`machine.rotors.rotors`), which an expander passes backwards (M150).
    """
    pitch = laid.rotors.pair.pitch
    angle = np.arange(points)[:, None] * (pitch / points) + pitch * np.arange(round(laid.life / pitch))
    own = laid.on_rotors(angle, expands)
    return own, [of.at(own) for of in pressed_areas(laid.rotors, (shaft, shaft))]


def loads_on_rotors(parameters: Parameters, machine, figures) -> dict[str, bearing_set.RotorLoad]:
    """Return what male and female rotor load their bearings with, by angle (M158, M480)."""
    pitch, laid, expands = figures.pitch(), machine.profile, machine.expands
    own_angle, areas = _areas_by_angle(laid, expands, parameters.shaft_diameter or 0.0, len(pitch.angle))
    life = expanded(pitch.low_pressure, laid.rotors.start, own_angle.T.ravel(), pitch.pressure.T.ravel())
    excess = life.reshape(pitch.pressure.T.shape).T - pitch.low_pressure
    high = pitch.high_pressure if expands else figures.plenum_pressure
    found, lines = rotor_loads(laid.rotors, areas, excess), (pitch.low_pressure, high)
    return {
        name: bearing_set.carried(getattr(parameters, name), own, laid.rotors.length, *lines)
        for name, own in found.items()
    }


def moment(parameters: Parameters, speed: float, load: float, figures) -> float:
    """Return the friction moment of the bearings of one rotor [N m] (M143)."""
    if parameters.friction == "simple":
        return 0.5 * (parameters.friction_coefficient or 0.0) * load * (parameters.bore or 0.0)
    T, d_m = film_temperature(parameters.film_temperature, figures), parameters.mean_diameter or 0.0
    viscosity = figures.film_viscosity_at(T) / figures.oil_density_at(T)
    idle = idle_moment(speed, viscosity, d_m, parameters.f_0 or 0.0)
    return (parameters.count or USUAL_COUNT) * idle + (parameters.f_1 or 0.0) * load * d_m


def build(parameters: Parameters, machine) -> list[PowerLoss | Reading]:
    ratio = machine.settings.male_lobes / machine.settings.female_lobes
    named = {name: each for name in NAMES if (each := getattr(parameters, name)) is not None}

    def loads(figures) -> tuple[float, float]:
        """Return the loads on male and female rotor [N]."""
        if parameters.load == ROTOR_LOADS:
            male, female = loads_on_rotors(parameters, machine, figures).values()
            return male.for_friction(), female.for_friction()
        load = load_on_male(parameters, figures)
        return load, (1.0 if parameters.female_load is None else parameters.female_load) * load

    def power(figures) -> float:
        """Return the friction power of all bearings [W] (M143)."""
        speeds = figures.omega, ratio * figures.omega
        both = zip(speeds, loads(figures), strict=True)
        return sum(speed * moment(parameters, speed, load, figures) for speed, load in both)

    def each_bearing(figures) -> tuple[dict[str, bearing_set.RotorLoad], dict[str, dict[str, bearing_set.Rated]]]:
        """Return the loads of both rotors, and the named bearings with their lives."""
        both = loads_on_rotors(parameters, machine, figures)
        speeds = {"male": figures.omega, "female": ratio * figures.omega}
        return both, {name: bearing_set.rated(each, both[name], speeds[name]) for name, each in named.items()}

    def read(figures) -> Given:
        """Return the loads of the bearings (M158, M480), and their lives (M482–M484)."""
        both, lives = each_bearing(figures)
        means = (float(load.mean()) for each in both.values() for load in (each.radial, each.axial))
        found: dict[str, float | str | None] = dict(zip(LOADS, means, strict=False))
        for name, each in lives.items():
            found |= bearing_set.figures_of(name, both[name], each)
        return found | ({} if parameters.life_of_set is None else {bearing_set.SET_LIFE: bearing_set.set_life(lives)})

    def traces(figures) -> dict[str, np.ndarray]:
        both = loads_on_rotors(parameters, machine, figures)
        return {key: values for name in named for key, values in bearing_set.traces_of(name, both[name]).items()}

    def judge(figures) -> tuple[str, tuple[str, ...]]:
        """Return no verdict, and the warnings of the bearings."""
        both, lives = each_bearing(figures)
        told = (each for name, of in lives.items() for each in bearing_set.told(name, named[name], both[name], of))
        return "", tuple(told)

    found: list[PowerLoss | Reading] = [PowerLoss("bearing_power", power, friction=True)]
    if parameters.load != ROTOR_LOADS:
        return found
    return [*found, Reading(LOADS, read, traces, judge) if named else Reading(LOADS, read)]


def check(parameters: Parameters, facts) -> Faults:
    for chosen, table in ((parameters.friction, _OF_FRICTION), (parameters.load, _OF_LOAD)):
        for word, names in table.items():
            yield from _belonging(parameters, chosen, word, names)
    yield from _of_rotors(parameters, facts.machine)
    yield from _of_each_bearing(parameters)
    if parameters.friction == "two_term":
        if facts.oil is None or facts.oil_supply is None:
            what = "two_term needs oil and oil_supply, absent here (write those, or friction: simple)"
            yield Fault("effects.bearings.friction", what)
        elif not facts.oil.knows_viscosity:
            yield Fault("oil.viscosity", "is missing (effects.bearings.friction: two_term needs it, or oil.name)")
    else:
        for name in ("film_temperature", "count"):
            if getattr(parameters, name) is not None:
                yield Fault(f"effects.bearings.{name}", "applies only to friction: two_term (remove it)")


def _of_rotors(parameters: Parameters, machine) -> Faults:
    """Yield what `load: rotors` lacks, and what is given with it or without it in vain."""
    path = "effects.bearings"
    if parameters.load != ROTOR_LOADS:
        for name in ("shaft_diameter", *NAMES):
            if getattr(parameters, name) is not None:
                yield _given_in_vain(name, ROTOR_LOADS, parameters.load)
    elif not machine.volume.from_rotors:
        what = "needs rotors with a profile (machine.volume.law: profile), absent here"
        yield Fault(f"{path}.load", f"{ROTOR_LOADS} {what} (write stated or gas)")
    elif parameters.female_load is not None:
        yield Fault(f"{path}.female_load", f"is found by load: {ROTOR_LOADS} (remove it)")


def _of_each_bearing(parameters: Parameters) -> Faults:
    """Yield what the bearings lack that are named one by one, and what they state in vain."""
    whole = parameters.life_of_set is not None
    for name in NAMES:
        bearings = getattr(parameters, name)
        if bearings is not None:
            yield from bearing_set.faults(name, bearings, whole)
        elif whole:
            yield Fault(f"effects.bearings.{name}", "is missing (life_of_set needs both rotors; write its bearings)")
    if parameters.load == ROTOR_LOADS and parameters.shaft_diameter is None:
        named = ((name, getattr(parameters, name)) for name in NAMES)
        needing = [f"{name}.{each.needs_thrust}" for name, each in named if each is not None and each.needs_thrust]
        if needing:
            what = f"is missing ({needing[0]} needs it, as no gas presses on a shaft; write shaft_diameter: … mm)"
            yield Fault("effects.bearings.shaft_diameter", what)


def check_geometry(parameters: Parameters, geometry) -> Faults:
    if parameters.load != ROTOR_LOADS or geometry.profile is None:
        return
    rotors, shaft = geometry.profile.rotors, parameters.shaft_diameter or 0.0
    if thick := thick_shaft(rotors, (shaft, shaft)):
        yield Fault("effects.bearings.shaft_diameter", thick)
    try:
        for leading in (True, False):
            slope_at_pitch(rotors, leading)
    except UsageError as error:
        yield Fault("effects.bearings.load", f"{ROTOR_LOADS}: {error} (write stated or gas)")


def _belonging(parameters: Parameters, chosen: str, word: str, names: tuple[str, ...]) -> Faults:
    """Yield parameters that a choice needs and lacks, and those given that belong to the other option."""
    for name in names:
        given, path = getattr(parameters, name) is not None, f"effects.bearings.{name}"
        if word == chosen and not given:
            example = _EXAMPLES.get(name, "8 kN" if name.endswith("load") else "30 cm^2")
            yield Fault(path, f"is missing ({word} needs it, e.g. {name}: {example})")
        elif word != chosen and given:
            yield _given_in_vain(name, word, chosen)


def _given_in_vain(name: str, word: str, chosen: str) -> Fault:
    """Return the fault of a parameter that belongs to another option than the chosen one."""
    return Fault(f"effects.bearings.{name}", f"applies only to {word}, and {chosen} is chosen (remove it)")


EFFECT = Effect(
    name="bearings",
    title="friction of rolling bearings",
    equations=("M143", "M146", "M158", "M480", "M481", "M482", "M483", "M484"),
    source="SKF catalogue; Palmgren 1957; ISO 281:2007",
    parameters=Parameters,
    build=build,
    check=check,
    check_geometry=check_geometry,
    needs=frozenset({ROTORS}),
    figures=FIGURES,
    traces=bearing_set.TRACES,
    usual={ROTORS: FRICTION},
    sizes=(
        Sized("bore", DIAMETER, 10.0, (0.05, 1.0)),
        Sized("mean_diameter", DIAMETER, 10.0, (0.05, 1.5)),
        *(Sized(f"{rotor}.{end}.distance", DIAMETER, 10.0, (0.02, 1.0)) for rotor in NAMES for end in bearing_set.ENDS),
    ),
)
