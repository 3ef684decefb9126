"""Laws of what `screwsim new` says and writes: what it computed is what `run` gives of its files, of two stages, too.

`fuzz_commands.py` asks them beside those of `command_laws.py`. They draw requests of their own, by what a maker's
sheet states: flow, capacity, motor, pressure, variable speed, two stages.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import CoolProp.CoolProp as coolprop
import numpy as np
from asking import OK, Case, command, document, unequal
from command_laws import STAGES, law
from fuzz_new import HALOGENATED, NATURAL, USED

SI = {  # of a printed unit
    "": 1.0,
    "%": 1e-2,
    "W": 1.0,
    "kW": 1e3,
    "MW": 1e6,
    "kg/s": 1.0,
    "g/s": 1e-3,
    "kg/h": 1.0 / 3600.0,
    "bar": 1e5,
    "mbar": 1e2,
    "m³/min": 1.0 / 60.0,
    "L/min": 1e-3 / 60.0,
    "m³/h": 1.0 / 3600.0,
    "kW/(m³/min)": 6e4,
}
NUMBER, UNIT = r"(-?[\d.]+(?:e[-+]?\d+)?)", r"([^\s,;()]*(?:\([^)]*\))?)"
SAID = {  # of one machine: words around a number and its unit, and the figure
    "gives": rf"delivers {NUMBER} {UNIT}",
    "over": rf" at {NUMBER} (bar) over its inlet",
    "at_inlet": rf" {NUMBER} (m³/h) at its inlet",
    "cooling_capacity": rf"cools {NUMBER} {UNIT}",
    "heating_capacity": rf"and heats {NUMBER} {UNIT}",
    "oil_cooler_duty": rf"without the {NUMBER} {UNIT} of its oil cooler",
    "shaft_power": rf"(?:takes|gives) {NUMBER} {UNIT} at the shaft",
    "load": rf"\({NUMBER} (%) of a (?:motor|generator)",
    "package_input_power": rf"{NUMBER} {UNIT} with motor and fan",
    "package_specific_power": rf"with motor and fan, {NUMBER} {UNIT}",
    "electrical_power": rf"{NUMBER} {UNIT} with its motor",
    "electrical_cop": rf"COP {NUMBER}()",
    "electrical_heating_cop": rf"cooling, {NUMBER}() of heating",
    "electrical_isentropic_efficiency": rf"isentropic efficiency {NUMBER} (%) of that",
}
SAID_OF_TWO = {  # of two stages
    "free_air_delivered": SAID["gives"],
    "cooling_capacity": SAID["cooling_capacity"],
    "package_input_power": rf"takes {NUMBER} {UNIT} with motors and fan",
    "package_specific_power": rf"with motors and fan, {NUMBER} {UNIT}",
    "electrical_power": rf"takes {NUMBER} {UNIT} with its motors",
    "electrical_cop": rf"COP {NUMBER}()",
    "first_shaft_power": rf"the first stage takes {NUMBER} {UNIT}",
    "second_shaft_power": rf"the second stage takes {NUMBER} {UNIT}",
    "first_pressure_ratio": rf"pressure ratios {NUMBER}()",
    "second_pressure_ratio": rf"pressure ratios [\d.]+ and {NUMBER}()",
    "intermediate_pressure": rf"{NUMBER} {UNIT} between both",
}
GOALS = {  # an option, the figure that it asks for, and how near a size comes to it
    "flow": ("free_air_delivered", 6e-3),
    "capacity": ("cooling_capacity", 6e-3),
    "motor": ("shaft_power", 6e-3),
}
EXACT = 1e-9  # relative difference of sums of the same numbers
SAME = 1e-3  # of what flows between two stages, which is found to 3e-4
R = 8.314462618


def as_options(request: Mapping[str, Any]) -> list[str]:
    """Return a request as options of `screwsim new`."""
    stated = [(name, value) for name, value in request.items() if value is not False]
    return [part for name, value in stated for part in ((f"--{name}",) if value is True else (f"--{name}", str(value)))]


def off_by(text: str, unit: str, true: float) -> float:
    """Return by how many halves of its last digit a printed number is off from the true one [SI]."""
    mantissa, _, power = text.partition("e")
    digits = len(mantissa.partition(".")[2])
    half = 0.5 * 10.0 ** (int(power or 0) - digits)
    return abs(float(text) - true / SI[unit]) / half


def printed_wrongly(words: str, patterns: Mapping[str, str], true: Mapping[str, float | None]) -> Iterator[str]:
    """Yield the numbers of printed words that are not those of a run."""
    for name, pattern in patterns.items():
        if (found := re.search(pattern, words)) is None:
            continue
        text, unit = found.groups()
        value = true.get(name)
        if unit not in SI:
            yield f"{name}: {text} has the unit {unit!r}"
        elif value is None or off_by(text, unit, value) > 1.01:
            yield f"{name}: says {text} {unit}, a run gives {value!r}"


def by_sheet(random: np.random.Generator) -> tuple[str, dict[str, Any]]:
    """Return a random request by what a maker's sheet states."""
    kind = str(random.choice(["air", "air", "refrigeration", "heat_pump", "booster", "expander"]))
    asked: dict[str, Any] = {}
    if kind == "air":
        asked["pressure"] = f"{random.choice([5, 7, 7.5, 8.6, 10, 13])} bar(g)"
        asked["variable-speed"] = bool(random.random() < 0.3)
        size = str(random.choice(["flow", "motor", "displacement"]))
        kilowatts = random.choice([5.5, 11, 22, 45, 90, 160, 315])
        sizes = {"flow": f"{10 ** random.uniform(0, 1.6):.3g} m^3/min", "motor": f"{kilowatts} kW"}
    else:
        asked["fluid"] = str(random.choice(USED[kind]))
        size = str(random.choice(["capacity", "motor", "displacement"] if kind[-1] in "np" else ["flow", "motor"]))
        sizes = {"capacity": f"{10 ** random.uniform(1.7, 2.9):.3g} kW", "motor": f"{random.choice([30, 75, 160])} kW"}
        sizes["flow"] = f"{10 ** random.uniform(2, 3.3):.3g} m^3/h"
        if kind in ("refrigeration", "heat_pump"):
            asked["economizer"], asked["slide"] = (bool(each < 0.25) for each in random.random(2))
        if kind == "expander":
            size = "motor"
    if size == "displacement" or random.random() < 0.15:
        asked["displacement"] = f"{10.0 ** random.uniform(1.8, 3.4):.3g} m^3/h"
    else:
        asked[size] = sizes[size]
    if random.random() < 0.3:
        asked["speed"] = f"{random.uniform(1500, 4500):.0f} rpm"
    return kind, asked


@law
def computed(case: Case) -> Iterator[str]:
    """What `new` says that it computed is what `run` gives of the scene that it writes, and what was asked for."""
    kind, asked = by_sheet(case.random)
    question = ["new", kind, *as_options(asked), "-o", f"{case.random.integers(10**9)}.yaml"]
    _, said = case.ask(*question)
    words = " ".join(said.split())
    if not words.startswith("computed:") and "computed:" not in words:
        if "does not run" not in words:
            yield f"{question}: says {words[:200]}"
        return
    code, text, why = command("run", question[-1], "--json")
    if code != OK:
        yield f"{question}: says {words[:200]}, a run: {why or text[:300]}"
        return
    p = document(text)["performance"]
    p["gives"] = p.get("free_air_delivered", p["gas_mass_flow"])
    p["at_inlet"] = (p.get("volumetric_efficiency") or 0.0) * p["displacement_flow"]
    p["over"] = p.get("package_discharge_pressure", p["discharge_pressure"]) - p["suction_pressure"]
    rated = re.search(rf"of a (?:motor|generator) of {NUMBER} kW", words)
    p["load"] = abs(p["shaft_power"]) / (1e3 * float(rated[1])) if rated else None
    p["shaft_power"] = abs(p["shaft_power"])
    for each in printed_wrongly(words, SAID, p):
        yield f"{question}: {each}"
    yield from _met(kind, asked, p, str(question))


def _met(kind: str, asked: Mapping[str, Any], p: Mapping[str, float], question: str) -> Iterator[str]:
    """Yield the goal of a request that the machine which was written does not meet."""
    for option, (figure, near) in GOALS.items():
        if option not in asked or "displacement" in asked or (option == "flow" and kind != "air"):
            continue
        if option == "motor" and {"flow", "capacity"} & asked.keys():
            continue
        name = "heating_capacity" if (option, kind) == ("capacity", "heat_pump") else figure
        number, unit = asked[option].replace("^3", "³").split()
        wanted = float(number) * SI[unit]
        if abs(p[name] / wanted - 1.0) > near + (1e-3 if option == "motor" else 0.0):
            yield f"{question}: {name} {p[name]!r}, asked for {wanted!r}"


@law
def two_stages(case: Case) -> Iterator[str]:
    """What `new --two-stage` computed is what `run` gives; the plant's figures are those of both stages by hand."""
    random, air = case.random, case.random.random() < 0.5
    asked: dict[str, Any] = {"two-stage": True}
    if air:
        kind, ratio = "air", random.uniform(7.0, 40.0)
        asked["pressure"] = f"{ratio - 1.0:.3g} bar(g)"
        asked["variable-speed"] = bool(random.random() < 0.3)
        size = "flow", f"{10 ** random.uniform(0.8, 1.7):.3g} m^3/min"
    else:
        kind, low = "refrigeration", random.uniform(-45.0, -15.0)
        asked["fluid"] = str(random.choice(HALOGENATED + NATURAL))
        asked["condition"] = f"{low:.0f}/{random.uniform(25.0, 45.0):.0f} degC"
        size = "capacity", f"{10 ** random.uniform(1.8, 2.7):.3g} kW"
    if random.random() < 0.6:
        asked[size[0]] = size[1]
    question = ["new", kind, *as_options(asked), "-o", f"{random.integers(10**9)}.stages.yaml"]
    _, said = case.ask(*question)
    words = " ".join(said.split())
    if "computed:" not in words:
        yield f"{question}: says {words[:300]}"
        return
    code, text, why = command("run", question[-1], "--json", "-o", "two.h5")
    if code != OK:
        yield f"{question}: a run: {why or text[:300]}"
        return
    out = document(text)
    whole, parts = out["performance"], [each["performance"] for each in out["stages"]]
    for each in printed_wrongly(words, SAID_OF_TWO, whole):
        yield f"{question}: {each}"
    for option in ("flow", "capacity"):
        if option in asked and abs(whole[GOALS[option][0]] / _si(asked[option]) - 1.0) > 0.02:
            yield f"{question}: {GOALS[option][0]} {whole[GOALS[option][0]]!r}, asked for {asked[option]}"
    for name, found, true, may in _by_hand(whole, parts, air):
        if not abs(found - true) <= may * abs(true):
            yield f"{question}: {name} {found!r}, by hand {true!r}"
    for stage, true in zip(STAGES, out["stages"], strict=True):
        case.ask("scene", "two.h5", "--stage", stage, "-o", f"{stage}.yaml")
        alone = case.run(file=f"{stage}.yaml")
        for name in [name for name, value in true["performance"].items() if value is None]:
            alone["performance"].pop(name, None)  # a second stage delivers no free air of its own
        true["performance"] = {name: value for name, value in true["performance"].items() if value is not None}
        yield from unequal(alone, true, f"{question}: {stage} stage")


def _si(text: str) -> float:
    number, unit = text.replace("^3", "³").split()
    return float(number) * SI[unit]


def _by_hand(
    whole: Mapping[str, float], parts: list[dict[str, float]], air: bool
) -> Iterator[tuple[str, Any, Any, Any]]:
    """Yield figures of two stages: name, value, that from both stages, and the allowed relative difference."""
    one, two = parts
    for name in ("shaft_power", "electrical_power"):
        yield name, whole[name], one[name] + two[name], EXACT
    yield "pressures", whole["first_pressure_ratio"], one["discharge_pressure"] / one["suction_pressure"], EXACT
    yield "pressures", whole["second_pressure_ratio"], two["discharge_pressure"] / two["suction_pressure"], EXACT
    if air:
        density = one["suction_pressure"] / (R / coolprop.PropsSI("molar_mass", "Air") * one["suction_temperature"])
        yield "free_air_delivered", whole["free_air_delivered"], whole["gas_mass_flow"] / density, SAME
        fans = sum(part.get("fan_power") or 0.0 for part in parts)
        yield "package_input_power", whole["package_input_power"], whole["electrical_power"] + fans, EXACT
        ratio = whole["package_input_power"] / whole["free_air_delivered"]
        yield "package_specific_power", whole["package_specific_power"], ratio, EXACT
        yield "flow between", two["gas_mass_flow"], one["gas_mass_flow"], SAME
    else:
        yield "electrical_cop", whole["electrical_cop"], whole["cooling_capacity"] / whole["electrical_power"], EXACT
        released = whole["heating_capacity"] / whole["electrical_power"]
        yield "electrical_heating_cop", whole["electrical_heating_cop"], released, EXACT
        vapour = whole["vapour_mass_flow"]
        yield "flow between", two["gas_mass_flow"], one["gas_mass_flow"] + vapour, SAME
