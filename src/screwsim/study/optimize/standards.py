"""Seasonal figures of chillers by name: their loads, temperatures and weights, as the standards state them.

Sources: AHRI 551/591 (SI) and 550/590 for IPLV: weights 0.01, 0.42, 0.45, 0.12. Eurovent certification programme LCP-HP
for ESEER: 3, 33, 41, 23 %. EN 14825 for SEER (space cooling, water at a fixed 7 °C, average climate) and SEPR (process
cooling, water at 7 °C; Regulation (EU) 2016/2281 has the same), whose weights follow from hours at each outdoor
temperature and the load there. All of them rate a whole chiller; `points` says how they become a compressor's.
"""

from collections.abc import Mapping
from typing import NamedTuple

WATER = 7.0  # [°C] of the chilled water that leaves, in all of them

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
HOURS: Mapping[str, Mapping[int, float]] = {
    name: {first + number: float(each) for number, each in enumerate(hours)}
    for name, (first, hours) in {"SEER": _COOLING, "SEPR": _PROCESS}.items()
}


class Rating(NamedTuple):
    """One rating point: load over the full one, temperature [°C] of what comes to the condenser, weight."""

    load: float
    entering: float
    weight: float


class Standard(NamedTuple):
    """A seasonal figure: its points; `energy`: their weights are shares of the cooling energy, else of the figure."""

    name: str
    source: str
    ratings: tuple[Rating, ...]
    energy: bool


_IPLV, _ESEER = (0.01, 0.42, 0.45, 0.12), (0.03, 0.33, 0.41, 0.23)
_QUARTERS = (1.0, 0.75, 0.5, 0.25)
_OUTDOOR = {"SEER": (35.0, 30.0, 25.0, 20.0), "SEPR": (35.0, 25.0, 15.0, 5.0)}  # [°C] of the points A … D
_LOADS = {"SEER": (1.0, 0.74, 0.47, 0.21), "SEPR": (1.0, 0.93, 0.87, 0.8)}
_TABLE = {  # temperatures of air, and of water where the condenser is cooled by it
    "IPLV": ("AHRI 551/591", _QUARTERS, (35.0, 27.0, 19.0, 13.0), (30.0, 24.5, 19.0, 19.0)),
    "ESEER": ("Eurovent LCP-HP", _QUARTERS, (35.0, 30.0, 25.0, 20.0), (30.0, 26.0, 22.0, 18.0)),
    "SEER": ("EN 14825, fixed outlet", _LOADS["SEER"], _OUTDOOR["SEER"], (30.0, 26.0, 22.0, 18.0)),
    "SEPR": ("EN 14825, high temperature", _LOADS["SEPR"], _OUTDOOR["SEPR"], (30.0, 23.0, 16.0, 9.0)),
}


def energy_shares(name: str) -> tuple[float, ...]:
    """Return the share of a year's cooling energy that each rating point of SEER or SEPR stands for.

    Hours times load at each outdoor temperature, shared linearly between the two points around it; beyond the outer
    points those stand for all.
    """
    at, loads = _OUTDOOR[name][::-1], _LOADS[name][::-1]  # rising
    shares = [0.0] * len(at)
    for T, hours in HOURS[name].items():
        upper = next((i for i, each in enumerate(at) if each >= T), len(at) - 1)
        lower = max(upper - 1, 0)
        part = 1.0 if upper == lower else min(max((T - at[lower]) / (at[upper] - at[lower]), 0.0), 1.0)
        load = loads[lower] + part * (loads[upper] - loads[lower])
        if name == "SEER" and T < at[0]:  # its load goes to zero at 16 °C; that of process cooling stays
            load = (T - 16.0) / (35.0 - 16.0)
        shares[upper] += part * hours * load
        shares[lower] += (1.0 - part) * hours * load
    return tuple(share / sum(shares) for share in shares[::-1])


def standards() -> dict[str, Standard]:
    """Return the seasonal figures by name; `-water`: condensers cooled by water, else by air."""
    found = {}
    for name, (source, loads, air, water) in _TABLE.items():
        energy = name in HOURS
        weights = energy_shares(name) if energy else {"IPLV": _IPLV, "ESEER": _ESEER}[name]
        for suffix, entering in (("", air), ("-water", water)):
            ratings = tuple(map(Rating, loads, entering, weights))
            found[name + suffix] = Standard(name + suffix, source, ratings, energy)
    return found
