"""What the valves of `screwsim new reciprocating` cost: losses, backflow and closing over gases, speeds and sizes.

python docs/tools/new_valves.py      the tables of docs/reference/slider-crank.md (S36, S37, S38)
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from screwsim.outputs import Result
from screwsim.scene import Scene, loads, with_values
from screwsim.simulate import simulate
from screwsim.template import new_scene, request_of, valves

SPEEDS = ("725 rpm", "1450 rpm", "2950 rpm")
GASES = (
    ("R134a", "-10/40 degC, 20 K"),
    ("R404A", "-10/40 degC, 28.3 K"),
    ("Propane", "-10/40 degC, 20 K"),
    ("Ammonia", "-10/35 degC, 10 K"),
    ("CO2", "-10/35 degC, 10 K"),
)
CASES: tuple[Mapping[str, object], ...] = (
    *({"fluid": gas, "condition": condition, "speed": speed} for gas, condition in GASES for speed in SPEEDS),
    {"displacement": "1 m^3/h", "speed": "2950 rpm"},
    {"displacement": "60 m^3/h"},
    {"condition": "5/30 degC, 10 K", "speed": "3550 rpm"},
    {"fluid": "R1233zd(E)"},
)
STARVED = "-10/40 degC, 20 K"  # of the R404A cylinder that is then put to other states
STATES = ((-20.0, 30.0), (-30.0, 40.0))  # °C
HEAVIER = (1.0, 2.0, 3.0)
VARIED: Mapping[str, object] = {"fluid": "R404A", "condition": "0/40 degC, 18.3 K", "speed": "1750 rpm"}
SPRINGS, FREQUENCIES = (1.0, 1.0 / 3.0, 3.0), (0.6, 1.6)  # over those of the rule
HEAD = ("λ %", "η_s %", "loss %", "backflow %", "shuts °")


def scene_of(stated: Mapping[str, object]) -> Scene:
    """Return a new cylinder."""
    return loads(new_scene("reciprocating", request_of(**stated)))  # type: ignore[arg-type]


def varied(scene: Scene, spring: float, frequency: float) -> Scene:
    """Return a scene whose reeds have other springs and natural frequencies, over those that they have."""
    own = vars(scene.effects["reed_valves"].parameters)
    factors = {"stiffness": spring, "mass": spring / frequency**2}
    names = [(side, name) for side in ("suction", "discharge") for name in factors]
    values = {f"effects.reed_valves.{side}_{name}": own[f"{side}_{name}"] * factors[name] for side, name in names}
    return with_values(scene, values)


def at_state(scene: Scene, state: tuple[float, float], heavier: float) -> Scene:
    """Return a scene at two saturation temperatures [degC], with a discharge reed of so many times its mass."""
    mass = "discharge_mass"
    values = {f"effects.reed_valves.{mass}": heavier * getattr(scene.effects["reed_valves"].parameters, mass)}
    names = (f"operation.{name}_temperature" for name in ("evaporating", "condensing"))
    return with_values(scene, values | {name: T + 273.15 for name, T in zip(names, state, strict=True)})


def gas_damping(scene: Scene, side: str) -> float:
    """Return the damping ratio of a reed by the gas that it displaces at its stop (S38)."""
    own, machine = scene.effects["reed_valves"].parameters, scene.machine
    area, stop, stiffness, mass = (
        getattr(own, f"{side}_{name}") for name in ("port_area", "stop", "stiffness", "mass")
    )
    velocity = machine.swept_volume * scene.operation.speed / math.pi / area
    return 0.25 * math.sqrt(stiffness / mass) * stop / velocity


def thickness(scene: Scene, side: str) -> float:
    """Return the thickness [mm] of a reed in proportion to the known one: f ∝ h/l², l as the port's diameter (S37)."""
    own = scene.effects["reed_valves"].parameters
    stop, stiffness, mass = (getattr(own, f"{side}_{name}") for name in ("stop", "stiffness", "mass"))
    frequency = math.sqrt(stiffness / mass) / (2.0 * math.pi)
    return 1e3 * valves.THICKNESS * frequency / valves.known_frequency() * (4.0 * stop / valves.PORT) ** 2


def backflow(result: Result, side: str) -> tuple[float, float]:
    """Return what flows back through a valve, over what passes it, and how late it shuts [degree after dead centre]."""
    cycle = {name: np.asarray(values) for name, values in result.cycle.items()}
    angle, lift, dead = cycle["angle"], cycle[f"{side}_valve_lift"], 180.0 if side == "suction" else 360.0
    after = (angle - dead) % 360.0
    step = np.diff(angle) * (lift[1:] + lift[:-1] > 0.0)
    flow = cycle["mass_flow_reed_valves"] * (1.0 if side == "suction" else -1.0)
    passed = 0.5 * (flow[1:] + flow[:-1]) * step
    shuts = after[(lift > 0.0) & (after < 90.0)]
    return float(-passed[passed < 0.0].sum() / passed.sum()), float(shuts.max(initial=0.0))


def cells(scene: Scene) -> list[str]:
    """Return what the valves of a scene cost, and how they shut."""
    result = simulate(scene)
    assert result.status == "ok", result.told
    found = result.performance
    losses = [100.0 * found[f"{side}_valve_power"] / found.indicated_power for side in ("suction", "discharge")]
    back = [backflow(result, side) for side in ("suction", "discharge")]
    return [
        f"{100.0 * found.volumetric_efficiency:.1f}",
        f"{100.0 * found.isentropic_efficiency:.1f}",
        " + ".join(f"{each:.1f}" for each in losses),
        " + ".join(f"{100.0 * each:.1f}" for each, _ in back),
        ", ".join(f"{each:.0f}" for _, each in back),
    ]


def table(first: str, rows: Iterable[tuple[str, Scene]]) -> None:
    """Print a table with what each row's scene costs."""
    print(f"| {first} |", " | ".join(HEAD), "|")
    print("|---" * (first.count("|") + 1 + len(HEAD)) + "|")
    for told, scene in rows:
        print(f"| {told} |", " | ".join(cells(scene)), "|", flush=True)
    print()


def with_ports(stated: Mapping[str, object]) -> tuple[str, Scene]:
    """Return a new cylinder after what was stated, the share of its ports, its reeds, and the gas's part of damping."""
    scene = scene_of(stated)
    own, piston = scene.effects["reed_valves"].parameters, scene.machine.piston_area
    shares = (100.0 * getattr(own, f"{side}_port_area") / piston for side in ("suction", "discharge"))
    thick, gas = ([of(scene, side) for side in ("suction", "discharge")] for of in (thickness, gas_damping))
    columns = ((shares, ".1f"), (thick, ".2f"), (gas, ".2f"))
    told = (", ".join(f"{each:{form}}" for each in some) for some, form in columns)
    return " | ".join((", ".join(map(str, stated.values())), *told)), scene


def main() -> None:
    """Print the tables."""
    table("cylinder | ports, % of the piston | reeds, mm | ζ_g", map(with_ports, CASES))
    starved = scene_of({"fluid": "R404A", "condition": STARVED})
    states = ((state, times) for state in STATES for times in HEAVIER)
    rows = (("{:g}/{:g} | {:g}".format(*state, times), at_state(starved, state, times)) for state, times in states)
    table("R404A, °C | mass of the discharge reed", rows)
    known = scene_of(VARIED)
    each_way = [(spring, 1.0) for spring in SPRINGS] + [(1.0, each) for each in FREQUENCIES]
    rows = ((f"{spring:.2f} | {times:g}", varied(known, spring, times)) for spring, times in each_way)
    table("spring | natural frequency", rows)
    valves.MACH *= 2.0
    table(
        "at a/10 | ports, % of the piston | reeds, mm | ζ_g",
        map(with_ports, ({"fluid": gas, "condition": at} for gas, at in GASES)),
    )


if __name__ == "__main__":
    main()
