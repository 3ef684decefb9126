"""Bearings of a rotor, one by one: where they are, what each carries by angle, and how long they live (M480–M484).

Two radial bearings beyond the ends, the suction and the discharge bearing, carry the radial load of M158 by the balance
of moments; the thrust is carried by an axial bearing, radially free, or by one of those two. A balance piston takes
some of it.
Assumptions: rigid shafts, bearings as points without moments of their own; the axial force that the radial load of an
inclined bearing makes in it is not included, nor is a preload.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from screwsim.effects.parts.bearing_life import MOST_SHARE, TYPES, equivalent_load, life_of_set, mean_load, rating_life
from screwsim.effects.parts.readings import Given
from screwsim.inputs.declare import choice, number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.rotors.loads import NAMES, bearing_forces
from screwsim.outputs import Figure, Trace, over

Array = np.ndarray
ENDS = ("suction", "discharge")
AXIAL = "axial"
_OF = {end: f"{end} bearing" for end in (*ENDS, AXIAL)}
SET_LIFE = "bearing_set_life"
NO_LOAD = "it carries no load, so ISO 281 has no life for it"


def _type(default: str) -> str:
    return choice("type, for the exponent of its life and for X and Y (M482)", tuple(TYPES), default)


@dataclass(frozen=True)
class Bearing:
    """A rolling bearing, or several that share its load as one of their common rating.

    Of a `…_pair`, back to back or face to face, the rating is that of both.
    """

    type: str = _type("cylindrical_roller")
    rating: float | None = optional("force", "C: basic dynamic load rating; without it no life is given")
    axial_factor: float | None = number(
        "Y, where it carries the thrust (default: of an angular_contact_ball 0.57, of a pair of them 0.93)",
        None,
        gt=0.0,
        le=10.0,
    )
    life_factor: float | None = number(
        "a_ISO, by which the rating life is multiplied (default: 1)", None, gt=0.0, le=50.0
    )


@dataclass(frozen=True)
class AxialBearing(Bearing):
    """The bearing that carries the thrust and no radial load."""

    type: str = _type("angular_contact_ball")


@dataclass(frozen=True)
class RadialBearing(Bearing):
    """A radial bearing beyond one end of the rotor."""

    distance: float = quantity("length", "from the rotor's end face to the middle of the bearing", ge=0.0)
    radial_factor: float | None = number(
        "X, where it carries the thrust (default: by its type, angular_contact_ball 0.35, a pair of them 0.57)",
        None,
        ge=0.0,
        le=1.0,
    )


@dataclass(frozen=True)
class BalancePiston:
    """A piston on the shaft that pushes the rotor towards its discharge end."""

    area: float = quantity("area", "on which its pressure acts; the lower line's acts behind it", ge=0.0)
    pressure: float | None = quantity("pressure", "absolute pressure on it (default: the higher line's)", None, gt=0.0)

    def push(self, low: float, high: float) -> float:
        """Return its force [N], from the pressures [Pa] of the lower and the higher line (M480)."""
        return self.area * ((high if self.pressure is None else self.pressure) - low)


@dataclass(frozen=True)
class RotorBearings:
    """The bearings of one rotor, with load: rotors."""

    suction: RadialBearing = field(kw_only=True)
    discharge: RadialBearing = field(kw_only=True)
    axial: AxialBearing | None = None
    thrust: str = choice("bearing that carries the thrust", (AXIAL, *ENDS), AXIAL)
    balance_piston: BalancePiston | None = None

    @property
    def each(self) -> dict[str, Bearing]:
        """The bearings that are named, by place."""
        named = {place: getattr(self, place) for place in _OF}
        return {place: each for place, each in named.items() if each is not None}

    @property
    def needs_thrust(self) -> str:
        """What is named whose figures depend on the thrust or a life, as a path below the rotor; empty if nothing."""
        rated = (f"{place}.rating" for place, each in self.each.items() if each.rating is not None)
        return AXIAL if self.axial is not None else next(rated, "")


@dataclass(frozen=True, eq=False)
class RotorLoad:
    """Loads [N] of one rotor on its bearings by angle; `axial` towards suction, `ends` of the two radial bearings."""

    radial: Array
    axial: Array
    ends: Mapping[str, Array]
    thrust: str = AXIAL

    def on(self, place: str) -> tuple[Array, Array]:
        """Return radial and axial load of one bearing."""
        none = np.zeros_like(self.axial)
        return self.ends.get(place, none), self.axial if place == self.thrust else none

    def for_friction(self) -> float:
        """Return the mean load that M143 takes: of all bearings, each by itself (M481), or of the rotor as one."""
        if not self.ends:
            return float(np.hypot(self.radial, self.axial).mean())
        places = dict.fromkeys((*self.ends, self.thrust))
        return sum(float(np.hypot(*self.on(place)).mean()) for place in places)


def carried(
    bearings: RotorBearings | None, own: Mapping[str, Array], length: float, low: float, high: float
) -> RotorLoad:
    """Return the loads of a rotor's bearings (M480) from its loads (`rotor_loads`) and length [m].

    `low` and `high` [Pa] are the pressures before the suction and behind the discharge port.
    """
    radial, axial = np.hypot(own["total_x"], own["total_y"]), -own["thrust"]
    if bearings is None:
        return RotorLoad(radial, axial, {})
    if bearings.balance_piston is not None:
        axial = axial - bearings.balance_piston.push(low, high)
    forces = bearing_forces(own, length, [getattr(bearings, end).distance for end in ENDS])
    return RotorLoad(radial, axial, {end: forces[f"{end}_bearing"] for end in ENDS}, bearings.thrust)


def _figures_of(rotor: str) -> Iterator[Figure]:
    needs = (f".{rotor}",)
    for end in ENDS:
        of = f"radial load of the {rotor} rotor's {_OF[end]}"
        load = f"{rotor}_{end}_bearing_load"
        yield Figure(load, "N", f"mean {of}", needs=needs)
        yield Figure(f"{load}_peak", "N", f"largest {of}", needs=needs, swing_of=load)
    # errors of peaks are taken for those of a swing, which is smaller
    load, what = f"{rotor}_axial_load", f"largest axial load of the {rotor} rotor on its bearings, either way"
    yield Figure(f"{load}_peak", "N", what, over("male_radial_load"), needs, swing_of=load)
    for place, bearing in _OF.items():
        own, path = f"{rotor}_{place}_bearing", f".{rotor}.{place}"
        what = f"equivalent dynamic load of the {rotor} rotor's {bearing}, by ISO 281"
        yield Figure(f"{own}_equivalent_load", "N", what, over("male_radial_load"), (path,))
        what = f"rating life of the {rotor} rotor's {bearing}, by ISO 281"
        yield Figure(f"{own}_life", "s", what, needs=(f"{path}.rating",), shown="h")


FIGURES = (
    *(figure for rotor in NAMES for figure in _figures_of(rotor)),
    Figure(SET_LIFE, "s", "life that nine of ten sets of bearings reach whole", needs=(".life_of_set",), shown="h"),
)
TRACES = tuple(
    trace
    for rotor in NAMES
    for trace in (
        *(Trace(f"{rotor}_{end}_bearing_load", "N", f"radial load of the {rotor} rotor's {_OF[end]}") for end in ENDS),
        Trace(f"{rotor}_axial_load", "N", f"axial load of the {rotor} rotor on its bearings, towards the suction end"),
    )
)


def traces_of(rotor: str, load: RotorLoad) -> dict[str, Array]:
    """Return the loads of a rotor's bearings by angle."""
    own = {f"{rotor}_{end}_bearing_load": by_angle for end, by_angle in load.ends.items()}
    return own | {f"{rotor}_axial_load": load.axial}


@dataclass(frozen=True)
class Rated:
    """One named bearing with its equivalent load [N] and its rating life [s], None where it has no rating or load."""

    bearing: Bearing
    load: float
    life: float | None


def rated(bearings: RotorBearings, load: RotorLoad, speed: float) -> dict[str, Rated]:
    """Return the named bearings of a rotor at its speed [rad/s], by place (M482, M483)."""
    found = {}
    for place, bearing in bearings.each.items():
        kind, (radial, axial) = TYPES[bearing.type], load.on(place)
        if place == load.thrust:
            X = getattr(bearing, "radial_factor", None)
            X, Y = X if X is not None else kind.radial_factor, bearing.axial_factor or kind.axial_factor
            radial = equivalent_load(radial, axial, X or 0.0, Y or 0.0, kind.at_e)
        P, life = mean_load(radial, kind.exponent), None
        if bearing.rating is not None and P > 0.0:
            life = rating_life(bearing.rating, P, kind.exponent, speed, bearing.life_factor or 1.0)
        found[place] = Rated(bearing, P, life)
    return found


def figures_of(rotor: str, load: RotorLoad, each: Mapping[str, Rated]) -> Given:
    """Return the figures of a rotor's bearings."""
    found: dict[str, float | str | None] = {f"{rotor}_axial_load_peak": float(np.abs(load.axial).max())}
    for end, by_angle in load.ends.items():
        found[f"{rotor}_{end}_bearing_load"] = float(by_angle.mean())
        found[f"{rotor}_{end}_bearing_load_peak"] = float(by_angle.max())
    for place, one in each.items():
        found[f"{rotor}_{place}_bearing_equivalent_load"] = one.load
        if one.bearing.rating is not None:
            found[f"{rotor}_{place}_bearing_life"] = NO_LOAD if one.life is None else one.life
    return found


def set_life(every: Mapping[str, Mapping[str, Rated]]) -> float | str:
    """Return the life [s] of all bearings of both rotors together (M484)."""
    each = [one for of_rotor in every.values() for one in of_rotor.values()]
    lives = [(one.life, TYPES[one.bearing.type].slope) for one in each if one.life is not None]
    return life_of_set(lives) if lives else NO_LOAD


def told(rotor: str, bearings: RotorBearings, load: RotorLoad, each: Mapping[str, Rated]) -> Iterator[str]:
    """Yield warnings of a rotor's bearings: loads beyond ISO 281, thrust that turns round in a turn or for good."""
    path = f"effects.bearings.{rotor}"
    for place, one in each.items():
        if one.bearing.rating is not None and one.load > MOST_SHARE * one.bearing.rating:
            what = f"the {rotor} rotor's {_OF[place]} has an equivalent load of {1e-3 * one.load:.4g} kN"
            yield f"{what}: above half of its rating ISO 281 does not hold (choose a larger {path}.{place}.rating)"
    piston, left = bearings.balance_piston, float(load.axial.mean())
    least, most = float(load.axial.min()), float(load.axial.max())
    holding = bearings.each.get(bearings.thrust)
    either_way = holding is not None and TYPES[holding.type].either_way
    if least < 0.0 < most and not either_way:
        what = f"the axial load of the {rotor} rotor on its bearings changes sides within a turn"
        course = f"from {1e-3 * least:.4g} to {1e-3 * most:.4g} kN towards the suction end"
        smaller = "" if piston is None else f"reduce {path}.balance_piston.area, or "
        yield f"{what}, {course}, so that no bearing of one side holds it ({smaller}use a second, opposed bearing)"
    elif piston is not None and left < 0.0:
        what = f"the balance piston of the {rotor} rotor takes {-1e-3 * left:.4g} kN more than its thrust"
        yield f"{what}, which its bearings carry towards the discharge end (reduce {path}.balance_piston.area)"


def faults(rotor: str, bearings: RotorBearings, whole: bool) -> Iterator[Fault]:
    """Yield what a rotor's bearings lack or state in vain; `whole`: the life of the set is asked for."""
    path = f"effects.bearings.{rotor}"
    if bearings.axial is not None and bearings.thrust != AXIAL:
        what = f"carries nothing, since thrust: {bearings.thrust} is chosen (remove one of the two)"
        yield Fault(f"{path}.axial", what)
    elif bearings.axial is None and bearings.thrust == AXIAL and whole:
        yield Fault(f"{path}.axial", "is missing (write its rating; life_of_set needs the bearing of the thrust)")
    for place, bearing in bearings.each.items():
        below, kind = f"{path}.{place}", TYPES[bearing.type]
        if bearing.rating is None and whole:
            yield Fault(f"{below}.rating", "is missing (write rating: … kN; life_of_set needs that of each bearing)")
        if bearing.rating is None and bearing.life_factor is not None:
            yield Fault(f"{below}.life_factor", "applies only beside a rating (add that, or remove this)")
        factors = {name: getattr(bearing, name, None) for name in ("radial_factor", "axial_factor")}
        if place != bearings.thrust:
            for name in (name for name, value in factors.items() if value is not None):
                yield Fault(f"{below}.{name}", f"applies only to thrust: {place} (remove it, or write that)")
        elif kind.radial_factor is None:
            others = ", ".join(name for name, other in TYPES.items() if other.radial_factor is not None)
            yield Fault(f"{below}.type", f"{bearing.type} carries no thrust (choose {others})")
        elif factors["axial_factor"] is None and kind.axial_factor is None:
            yield Fault(f"{below}.axial_factor", f"is missing (write Y of the {bearing.type}'s table)")
