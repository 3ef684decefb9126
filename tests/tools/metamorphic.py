"""Solve random scenes twice, stated in two ways that mean the same, and ask laws of them that no solver is needed for.

Run: metamorphic.py [LAW …] [--seeds 8] [--outcome FILE]. Each law draws a scene of fuzz_courses.KINDS by its seed and
returns its violation over the one that the wanted accuracy allows: at most 1 where the law holds. A scene that is not
ok, or that warns, says nothing about a law and counts as not asked. Prints a line per draw.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from fuzz_courses import KINDS, ROOT, SPEED, course

sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
from true_error import warns  # noqa: E402

from screwsim.evaluate.ledger.book import NOT_CONSERVED  # noqa: E402
from screwsim.figures.errors import relative_errors, worst  # noqa: E402
from screwsim.outputs import Result  # noqa: E402
from screwsim.results import open_results  # noqa: E402
from screwsim.scene import Scene, load, with_values  # noqa: E402
from screwsim.simulate import simulate, simulate_many  # noqa: E402
from screwsim.study.stages import run_stages  # noqa: E402
from screwsim.study.stages.axes import Intercooler  # noqa: E402
from screwsim.study.stages.chain import StageChain  # noqa: E402
from screwsim.study.sweep import run_sweep  # noqa: E402

BOTH_ERR = 2.0  # two results that are each within the wanted accuracy differ by at most twice as much
LEAST = 0.1  # volumetric efficiency below which the flow passes through zero: then its share of a filling is judged
WIDER = 1.25  # factor of a gap
GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")
UNITS = {  # of a path: functions from a number in SI to a text in another unit
    "operation.discharge.pressure": lambda p: f"{p / 6894.757293168361!r} psi",
    "operation.condensing_temperature": lambda T: f"{T * 1.8 - 459.67!r} degF",
    "operation.evaporating_temperature": lambda T: f"{T - 273.15!r} degC",
    "operation.speed": lambda w: f"{w * 30.0 / np.pi!r} rpm",
    "effects.tip_leakage.gap": lambda x: f"{x / 0.0254!r} inch",
}
SIZES = {  # of configs/paper: exponents by which inputs scale with the size of similar machines
    "machine.rotor_diameter": 1,
    "machine.rotor_length": 1,
    "machine.volume.max": 3,
    "machine.suction_port.area": 2,
    "machine.discharge_port.area": 2,
    "effects.tip_leakage.gap": 1,
    "effects.interlobe_leakage.gap": 1,
    "effects.interlobe_leakage.length": 1,
    "effects.blow_hole.area": 2,
    "effects.end_face_leakage.gap": 1,
    "effects.end_face_leakage.length": 1,
    "effects.oil_heat.heat_transfer_coefficient": -1,  # h A t scales as the mass, so do droplets' surfaces
    "operation.speed": -1,
}
DRY = ("oil=null", "oil_supply=null", *(f"effects.{name}=off" for name in ("oil_heat", "oil_pump", "hydromechanical")))
OF_STAGES = ("volumetric_efficiency", "isothermal_efficiency", "discharge_temperature", "shaft_power", "gas_mass_flow")
STAGE = 1.3, 3.0  # pressure ratio of a stage without oil
NEXT_TO_NONE = 1e-14, 1e-9  # relative humidities of air that is practically dry
BALANCES = ("mass", "energy", "oil_mass", "entropy")
OF_LEDGER = "exergy_destroyed_"
LAWLESS = f"{OF_LEDGER}{NOT_CONSERVED}"  # with `oil.transport: paper` oil leaves with another energy than it has
WALLS = ("wall_heat", "cylinder_heat")
WARMING = ("separator", "hydromechanical", "mechanical", "oil_pump", "oil_drag", "bearings", "oil_lift")
ALIKE = ("volumetric_efficiency", "isothermal_efficiency", "discharge_temperature", "peak_pressure", "specific_power")


class NotAsked(Exception):
    """The scene says nothing about the law."""


def drawn(kind: str, seed: int) -> Scene:
    """Return the first scene of a course."""
    return course(KINDS[kind], seed, 1)[0]


def solved(scene: Scene, trace: bool = False) -> Result:
    """Return the result of a scene that is ok and has no warnings of its accuracy."""
    return believed(simulate(scene, trace=trace), scene)


def believed(found: Result, scene: Scene) -> Result:
    """Return a result that claims its accuracy; raise NotAsked for any other."""
    if found.status != "ok" or warns(found, scene.numerics.accuracy):
        raise NotAsked(found.status)
    return found


def apart(one: Result, other: Result, accuracy: float) -> tuple[float, str]:
    """Return the largest difference of two results of one machine, over the allowed one, and its figure."""
    name, most = worst(relative_errors(one.performance, other.performance))
    return most / (BOTH_ERR * accuracy), name


def same(one: Mapping[str, Any], other: Mapping[str, Any]) -> tuple[float, str]:
    """Return infinity and a figure that differs in any bit; zero and '' without one."""
    names = [name for name in {**one, **other} if not _equal(one.get(name), other.get(name))]
    return (float("inf"), names[0]) if names else (0.0, "")


def _equal(one: Any, other: Any) -> bool:
    missing = [value is None or value != value for value in (one, other)]
    return all(missing) or (not any(missing) and float(one) == float(other))


def other_units(kind: str, seed: int) -> tuple[float, str]:
    """A scene in psi, degF, rpm and inch gives the same results as in SI units."""
    scene = drawn(kind, seed)
    values = {path: _value(scene, path) for path in UNITS}
    changes = [f"{path}={UNITS[path](value)}" for path, value in values.items() if value is not None]
    stated = replace(load(ROOT / "configs" / f"{KINDS[kind].file}.yaml", [*KINDS[kind].changes, *changes]), sweep={})
    ratio = _value(scene, "oil_supply.ratio")
    others = {path: _value(scene, path) for path in {**KINDS[kind].drawn, **KINDS[kind].evenly} if path not in UNITS}
    stated = with_values(stated, others | ({} if ratio is None else {"oil_supply.ratio": ratio}))
    return apart(solved(scene), solved(stated), scene.numerics.accuracy)


def sweep_in_another_order(kind: str, seed: int) -> tuple[float, str]:
    """A course run backwards gives the same points."""
    scenes = course(KINDS[kind], seed, 5)
    forth = list(simulate_many(scenes, trace=False))
    back = list(simulate_many(scenes[::-1], trace=False))[::-1]
    found = []
    for scene, one, other in zip(scenes, forth, back, strict=True):
        if one.status == other.status == "ok" and not any(warns(r, scene.numerics.accuracy) for r in (one, other)):
            found.append(apart(one, other, scene.numerics.accuracy))
    if not found:
        raise NotAsked("none of a course")
    return max(found)


def file_of_one_point(kind: str, seed: int) -> tuple[float, str]:
    """A sweep of one point, read from its file, equals the run bit for bit."""
    scene = drawn(kind, seed)
    alone = solved(scene)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "one.h5"
        run_sweep(replace(scene, sweep={"operation.speed": (scene.operation.speed,)}), path, jobs=1)
        stored = open_results(path).performance
        found = {name: np.ravel(np.asarray(stored[name]))[0] for name in alone.performance}
        return same(found, alone.performance)


def closed_otherwise(kind: str, seed: int) -> tuple[float, str]:
    """The results do not depend on the closing method."""
    scene = drawn(kind, seed)
    coupled = replace(scene, numerics=replace(scene.numerics, closing="coupled"))
    return apart(solved(scene), solved(coupled), scene.numerics.accuracy)


def wider_gap(kind: str, seed: int) -> tuple[float, str]:
    """A wider gap does not increase the flow."""
    scene = drawn(kind, seed)
    there = [f"effects.{name}.gap" for name in GAPS]
    values = {path: _value(scene, path) for path in there}
    wider = {path: WIDER * value for path, value in values.items() if isinstance(value, float)}
    if not wider:
        raise NotAsked("no gap that is a number")
    narrow, wide = (solved(each).performance["volumetric_efficiency"] for each in (scene, with_values(scene, wider)))
    if narrow is None or wide is None:
        raise NotAsked("nothing is delivered")
    gain = (wide - narrow) / max(abs(narrow), LEAST)
    return max(0.0, gain) / (BOTH_ERR * scene.numerics.accuracy), "volumetric_efficiency"


def nothing_destroys_entropy(kind: str, seed: int) -> tuple[float, str]:
    """No effect of a machine destroys entropy, and all of its balances close."""
    scene = drawn(kind, seed)
    found = solved(scene, trace=True)
    bound = scene.numerics.accuracy
    laws = {name: abs(value or 0.0) / bound for name, value in found.balance.items() if name in BALANCES}
    ledger = {name: value for name, value in found.ledger.items() if name.startswith(OF_LEDGER) and name != LAWLESS}
    ledger = {name: value for name, value in ledger.items() if not _given(scene, found, name)}
    if f"{OF_LEDGER}separator" in ledger:  # losses have booked the heat that it gets from them as dissipated (M286)
        ledger["separator and losses"] = sum(ledger.pop(f"{OF_LEDGER}{name}", None) or 0.0 for name in WARMING)
    size = abs(found.performance["shaft_power"] or 0.0) + sum(abs(value or 0.0) for value in ledger.values())
    laws |= {name: max(0.0, -(value or 0.0)) / (bound * size) for name, value in ledger.items()}
    name = max(laws, key=lambda each: laws[each])
    return laws[name], name


def _given(scene: Scene, found: Result, entry: str) -> bool:
    """Return whether an entry may be negative, as that of lines, plenums or walls held at a fixed state.

    A line or plenum receives the exergy of heat, which below T_0 is a free source of cold, and of oil, counted from
    injected oil at the pressure of its source (M54); walls supply that of the heat with which they warm the gas (M171).
    """
    name = entry.removeprefix(OF_LEDGER)
    if name in WALLS and (found.ledger[f"energy_moved_{name}"] or 0.0) > 0.0:
        return True
    return name.endswith("_plenum") or (name == "suction_line" and name not in scene.effects)


def of_another_size(kind: str, seed: int) -> tuple[float, str]:
    """Machines of one shape and tip speed perform equally: those of configs/paper, whose laws have no viscosity."""
    if kind != "paper":
        raise NotAsked("its laws know viscosity")
    scene, size = drawn(kind, seed), float(np.exp(np.random.default_rng(seed).uniform(np.log(0.5), np.log(2.0))))
    values = {path: _value(scene, path) * size**power for path, power in SIZES.items()}
    one, other = solved(scene), solved(with_values(scene, values))
    errors = relative_errors(one.performance, other.performance)
    name, most = worst({name: errors[name] for name in ALIKE})
    return most / (BOTH_ERR * scene.numerics.accuracy), name


def of_two_equal_stages(kind: str, seed: int) -> tuple[float, str]:
    """Two machines of one shape without oil, cooled to the suction gas between, share the pressure ratio equally.

    At one tip speed the flow scales as p L²: a second stage smaller by √π takes the flow of the first at π p_s.
    """
    if kind != "paper":
        raise NotAsked("its laws know viscosity")
    random = np.random.default_rng(seed)
    ratio = float(np.exp(random.uniform(*np.log(STAGE))))
    base = replace(load(ROOT / "configs" / f"{KINDS[kind].file}.yaml", DRY), sweep={})
    p_s, T_s = base.operation.suction.pressure, base.operation.suction.temperature
    first = with_values(base, {SPEED: drawn(kind, seed).operation.speed, "operation.discharge.pressure": ratio * p_s})
    inputs = {path: power for path, power in SIZES.items() if "oil_heat" not in path}
    smaller = {path: _value(first, path) * ratio ** (-0.5 * power) for path, power in inputs.items()}
    ends = {"operation.suction.pressure": ratio * p_s, "operation.discharge.pressure": ratio**2 * p_s}
    found = run_stages(
        StageChain("", first, with_values(first, smaller | ends), Intercooler(kind="cooler", outlet_temperature=T_s))
    )
    if found.status != "ok":
        raise NotAsked(found.status)
    one, other = (believed(each, first) for each in found.stages)
    errors = relative_errors(one.performance, other.performance)
    off = {name: errors[name] for name in OF_STAGES}
    off["intermediate_pressure"] = abs(found.performance.intermediate_pressure / (ratio * p_s) - 1.0)
    name, most = worst(off)
    return most / (BOTH_ERR * first.numerics.accuracy), name


def next_to_no_water(kind: str, seed: int) -> tuple[float, str]:
    """Practically dry air gives the results of dry air, by the equations of moist air."""
    if kind not in ("paper", "air"):
        raise NotAsked("no ideal gas, or one that knows more of its fluid")
    humidity = float(np.exp(np.random.default_rng(seed).uniform(*np.log(NEXT_TO_NONE))))
    dry = with_values(drawn(kind, seed), {"gas.fluid": "air"})
    one, other = (solved(each) for each in (dry, with_values(dry, {"gas.relative_humidity": humidity})))
    return apart(one, other, dry.numerics.accuracy)


def _value(scene: Scene, path: str) -> Any:
    found: Any = scene
    for name in path.split("."):
        found = found.get(name) if isinstance(found, dict) else getattr(found, name, None)
        found = getattr(found, "parameters", found)  # of an effect
    return found


LAWS: dict[str, Callable[[str, int], tuple[float, str]]] = {
    law.__name__: law
    for law in (
        other_units,
        sweep_in_another_order,
        file_of_one_point,
        closed_otherwise,
        wider_gap,
        nothing_destroys_entropy,
        of_another_size,
        of_two_equal_stages,
        next_to_no_water,
    )
}


def asked(law: str, kind: str, seed: int) -> dict[str, Any]:
    """Return the outcome of a draw: distance from the law and its figure, or why it says nothing about it."""
    row: dict[str, Any] = {"law": law, "kind": kind, "seed": seed}
    try:
        off, name = LAWS[law](kind, seed)
    except NotAsked as why:
        return row | {"not_asked": str(why)}
    return row | {"off": float(off), "in": name}


def outcome(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return for each law the counts of its draws, and those that violated it."""
    found: dict[str, Any] = {}
    for law in dict.fromkeys(row["law"] for row in rows):
        of_law = [row for row in rows if row["law"] == law]
        met = [row for row in of_law if "off" in row]
        found[law] = {
            "drawn": len(of_law),
            "asked": len(met),
            "worst": max((min(row["off"], 1e9) for row in met), default=None),
            "beyond": [row for row in met if row["off"] > 1.0],
        }
    return found


def main() -> None:
    """Draw scenes for each law and print the outcomes."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("laws", nargs="*", help=f"of {', '.join(LAWS)}; all where none is named")
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--outcome", type=Path, help="file of the summary")
    options = parser.parse_args()
    if unknown := set(options.laws) - set(LAWS):
        parser.error(f"no such law: {', '.join(sorted(unknown))}; known: {', '.join(LAWS)}")
    rows = []
    for seed in range(1, options.seeds + 1):
        for kind in KINDS:
            for law in options.laws or LAWS:
                rows.append(asked(law, kind, seed))
                print(json.dumps(rows[-1]), flush=True)
    found = outcome(rows)
    print(json.dumps(found, indent=1))
    if options.outcome:
        command = " ".join(["metamorphic.py", *options.laws, f"--seeds {options.seeds}"])
        options.outcome.write_text(json.dumps({"command": command, "laws": found}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
