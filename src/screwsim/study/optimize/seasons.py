"""Rating points and weights of seasonal figures.

Sources: AHRI 551/591 (SI) and 550/590 for IPLV: weights 0.01, 0.42, 0.45, 0.12. Eurovent certification programme LCP-HP
for ESEER: 3, 33, 41, 23 %. EN 14825 for SEER (space cooling, water at a fixed 7 °C, average climate), SEPR (process
cooling, water at 7 °C; Regulation (EU) 2016/2281 has the same) and SCOP (space heating, average climate, water of 35 or
55 °C at −10 °C outdoors, colder in milder weather). Weights of these three follow from the hours at each outdoor
temperature and the load there, and COPs are interpolated between the points; hours times load of SCOP add up to the
2066 h at full load of Regulation (EU) 811/2013. All of them rate a whole chiller or heat pump.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

T_WATER = 7.0  # [°C] of the leaving chilled water, in all figures of cooling
T_DESIGN, T_LIMIT = -10.0, 16.0  # [°C] outdoors at which the heating load is the full one, and nothing

# EN 14825: hours a year at each outdoor temperature [°C], from the first on
_COOLING = (17, (205, 227, 225, 225, 216, 215, 218, 197, 178, 158, 137, 109, 88, 63, 39, 31, 24, 17, 13, 9, 4, 3, 1, 0))
_PROCESS = (
    -19,
    (
        *(0.08, 0.41, 0.65, 1.05, 1.74, 2.98, 3.79, 5.69, 8.94, 11.81, 17.29, 20.02, 28.73, 39.71, 56.61, 76.36),
        *(106.07, 153.22, 203.41, 247.98, 282.01, 275.91, 300.61, 310.77, 336.48, 350.48, 363.49, 368.91, 371.63),
        *(377.32, 376.53, 386.42, 389.84, 384.45, 370.45, 344.96, 328.02, 305.36, 261.87, 223.90, 196.31, 163.04),
        *(141.78, 121.93, 104.46, 85.77, 71.54, 56.57, 43.35, 31.02, 20.21, 11.85, 8.17, 3.83, 2.09, 1.21, 0.52, 0.40),
    ),
)
_HEATING = (
    -10,
    (
        *(1, 25, 23, 24, 27, 68, 91, 89, 165, 173, 240, 280, 320),
        *(357, 356, 303, 330, 326, 348, 335, 315, 215, 169, 151, 105, 74),
    ),
)
BIN_HOURS: Mapping[str, Mapping[int, float]] = {
    name: {first + number: float(each) for number, each in enumerate(hours)}
    for name, (first, hours) in {"SEER": _COOLING, "SEPR": _PROCESS, "SCOP": _HEATING}.items()
}
HEATING_WEATHER = (T_DESIGN, -7.0, 2.0, 7.0, 12.0)  # [°C] outdoors at the points of SCOP
HEATING_WATER = {35: (35.0, 34.0, 30.0, 27.0, 24.0), 55: (55.0, 52.0, 42.0, 36.0, 30.0)}  # [°C] leaving there
_GROUND = {"water": 10.0, "brine": 0.0}  # [°C] entering the evaporator in any weather
_WITHOUT_COOLING = "fans, pumps, standby"
_WITHOUT_HEATING = "fans, pumps, standby, frost, cycling, further heater"


class RatingPoint(NamedTuple):
    """One rating point: its load over the full one, the medium [°C] that evaporator and condenser see, its weight.

    That is the water that leaves towards rooms or processes, and the air, water or brine that enters at the other side.
    """

    name: str
    load: float
    cold: float
    warm: float
    weight: float


class SeasonalStandard(NamedTuple):
    """A seasonal figure: its points, full load first; with `energy` weights are shares of the energy, else of figures.

    `bins` has a row for each outdoor temperature: its share of the energy, divided between the points. Of `heating`
    loads and energies are those of heating. The media at both sides, the `conditions` and what the figure is `without`
    are in words.
    """

    name: str
    source: str
    ratings: tuple[RatingPoint, ...]
    energy: bool
    source_medium: str
    sink_medium: str
    conditions: str
    without: str = _WITHOUT_COOLING
    heating: bool = False
    bins: tuple[tuple[float, ...], ...] = ()


_WEIGHTS = {"IPLV": (0.01, 0.42, 0.45, 0.12), "ESEER": (0.03, 0.33, 0.41, 0.23)}
_QUARTERS = (1.0, 0.75, 0.5, 0.25)
_TABLE = {  # of the points A … D: loads, temperatures [°C] of air, and of water where it cools the condenser
    "IPLV": ("AHRI 551/591", _QUARTERS, (35.0, 27.0, 19.0, 13.0), (30.0, 24.5, 19.0, 19.0)),
    "ESEER": ("Eurovent LCP-HP", _QUARTERS, (35.0, 30.0, 25.0, 20.0), (30.0, 26.0, 22.0, 18.0)),
    "SEER": ("EN 14825, fixed outlet", (1.0, 0.74, 0.47, 0.21), (35.0, 30.0, 25.0, 20.0), (30.0, 26.0, 22.0, 18.0)),
    "SEPR": ("EN 14825, high temperature", (1.0, 0.93, 0.87, 0.8), (35.0, 25.0, 15.0, 5.0), (30.0, 23.0, 16.0, 9.0)),
}


def energy_shares(name: str) -> tuple[float, ...]:
    """Return the share of a year's energy that each rating point of SEER, SEPR or SCOP represents."""
    return tuple(map(sum, zip(*energy_bins(name), strict=True)))


def energy_bins(name: str) -> tuple[tuple[float, ...], ...]:
    """Return the share of a year's energy at each outdoor temperature, divided between the rating points.

    Hours times load, divided linearly between the two neighbouring points; beyond the outer points these take all.
    """
    weather = HEATING_WEATHER if name == "SCOP" else _TABLE[name][2]
    at = sorted(weather)
    total = sum(hours * load_at(name, T) for T, hours in BIN_HOURS[name].items())
    rows = []
    for T, hours in BIN_HOURS[name].items():
        parts = dict.fromkeys(at, 0.0)
        upper = next((i for i, each in enumerate(at) if each >= T), len(at) - 1)
        lower = max(upper - 1, 0)
        part = 1.0 if upper == lower else min(max((T - at[lower]) / (at[upper] - at[lower]), 0.0), 1.0)
        share = hours * load_at(name, T) / total
        parts[at[upper]] += part * share
        parts[at[lower]] += (1.0 - part) * share
        rows.append(tuple(parts[each] for each in weather))
    return tuple(rows)


def load_at(name: str, T: float) -> float:
    """Return the part load ratio at an outdoor temperature [°C].

    Space cooling is in proportion to T − 16 °C, beyond 35 °C too; process cooling goes from 0.8 at 5 °C to 1 at 35 °C;
    space heating from 1 at −10 °C to nothing at 16 °C. The loads of the rating points are these, rounded to whole
    percents.
    """
    if name == "SCOP":
        return (T_LIMIT - T) / (T_LIMIT - T_DESIGN)
    if name == "SEER":
        return (T - 16.0) / (35.0 - 16.0)
    return 0.8 + 0.2 * min(max((T - 5.0) / (35.0 - 5.0), 0.0), 1.0)


def standards() -> dict[str, SeasonalStandard]:
    """Return the seasonal figures by name; `-water`, `-brine`: of what flows through the outer side, else air."""
    found: dict[str, SeasonalStandard] = {}
    for name, (source, loads, air, water) in _TABLE.items():
        energy = name in BIN_HOURS
        weights = energy_shares(name) if energy else _WEIGHTS[name]
        bins = energy_bins(name) if energy else ()
        for medium, entering in (("air", air), ("water", water)):
            ratings = map(RatingPoint, "ABCD", loads, (T_WATER,) * len(loads), entering, weights)
            words = "water", medium, f"water leaves at {T_WATER:g} °C"
            full = _named(name, medium)
            found[full] = SeasonalStandard(full, source, tuple(ratings), energy, *words, bins=bins)
    for hottest, leaving in HEATING_WATER.items():
        for medium in ("air", *_GROUND):
            full = _named(f"SCOP-{hottest}", medium)
            entering = (_GROUND[medium],) * len(leaving) if medium in _GROUND else HEATING_WEATHER
            found[full] = _heating(full, medium, entering, leaving)
    return found


def _named(name: str, medium: str) -> str:
    return name if medium == "air" else f"{name}-{medium}"


def _heating(name: str, medium: str, entering: Sequence[float], leaving: Sequence[float]) -> SeasonalStandard:
    """Return SCOP by what enters the evaporator and the water that leaves the condenser at its points [°C]."""
    loads = (round(load_at("SCOP", T), 2) for T in HEATING_WEATHER)
    ratings = tuple(map(RatingPoint, ("full", *"ABCD"), loads, entering, leaving, energy_shares("SCOP")))
    conditions = f"water leaves at {leaving[0]:g} °C with {T_DESIGN:g} °C outdoors, at {leaving[-1]:g} with 12"
    source = "EN 14825, average climate"
    words = medium, "water", conditions, _WITHOUT_HEATING
    return SeasonalStandard(name, source, ratings, True, *words, heating=True, bins=energy_bins("SCOP"))
