"""How far the oil coolers of packages that `screwsim new air` writes suffice: table of docs/how-to/air-package.md.

    python docs/tools/package_coolers.py

By machine: the conductance, its load as rated, the room in which its thermostat is at its end and the oil's temperature
there, and what the mixture has in a room of 40 °C, up to which packages are usually made to run.
"""

from __future__ import annotations

from collections.abc import Iterator

import screwsim
from screwsim.template import new_scene, request_of

ROOM, ZERO = "operation.suction.temperature", 273.15
SEARCHED, LOAD = (0.0, 60.0), "oil_cooler_load"  # [°C]
MACHINES = (
    {},
    {"displacement": "60 m^3/h"},
    {"displacement": "600 m^3/h", "speed": "6000 rpm"},
    {"displacement": "3000 m^3/h", "speed": "1480 rpm"},
    {"condition": "0 bar(g)/3 bar(g)"},
    {"condition": "0 bar(g)/10 bar(g)"},
    {"condition": "0 bar(g)/13 bar(g)"},
    {"condition": "0 bar(g)/7.5 bar(g), 35 degC"},
    {"condition": "0 bar(g)/13 bar(g), 50 degC"},
)
HEADS = ("options", "kW/K", "load %", "room °C", "its oil °C", "mixture at 40 °C")


def row(stated: dict[str, str]) -> Iterator[str]:
    """Yield the cells of a machine."""
    yield ", ".join(f"{name} {value}" for name, value in stated.items()) or "as it is"
    scene = screwsim.loads(new_scene("air", request_of(**stated)))  # type: ignore[arg-type]
    yield f"{1e-3 * scene.effects['separator'].parameters.cooler.conductance:.2g}"
    yield f"{100.0 * screwsim.simulate(scene).performance[LOAD]:.0f}"
    low, high = (ZERO + end for end in SEARCHED)
    found = screwsim.find(scene, {ROOM: (low, high)}, {LOAD: 1.0})
    assert found.result is not None
    yield f"{found.values[ROOM] - ZERO:.1f}"
    yield f"{found.result.performance.oil_supply_temperature - ZERO:.1f}"
    hot = screwsim.simulate(scene.with_({ROOM: "40 degC"})).performance
    yield f"{hot.mixture_discharge_temperature - ZERO:.1f}"


def main() -> None:
    """Print the table in Markdown."""
    print(f"| {' | '.join(HEADS)} |\n|{'---|' * len(HEADS)}")
    for stated in MACHINES:
        print(f"| {' | '.join(row(stated))} |", flush=True)


if __name__ == "__main__":
    main()
