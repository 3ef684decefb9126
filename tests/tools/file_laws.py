"""Laws of commands that write or compare files, and of two stages: the second way is numpy, CoolProp, the file itself.

`fuzz_commands.py` asks them beside those of `command_laws.py`.
"""

from __future__ import annotations

import html
import json
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import CoolProp.CoolProp as CoolProp
import numpy as np
from asking import PARTLY, Case, NotAsked, command, near, stated
from command_laws import CONFIGS, PLANT, law

import screwsim

PLAIN = Path(__file__).resolve().parents[1] / "plain" / "r134a.yaml"
EVAPORATING, CONDENSING = "operation.evaporating_temperature", "operation.condensing_temperature"
ZERO_CELSIUS, FLUID = 273.15, "R134a"
SCALES = np.array([1.0, 30.0, 50.0, 900.0, 1500.0, 2500.0, 27e3, 45e3, 75e3, 125e3])  # of the ten terms
BEYOND = (
    1.6  # times the stated error by which a map may be off at a few fresh points, as it is the largest of 32 others
)
FLOOR = 2e-4  # [of the size] that is always allowed: twice a solution's error
FRESH = 8  # points
SAME = 1e-3  # relative difference of what flows between two stages: their accuracy is 3e-4
NOT_NUMBERS = re.compile(r"\b(nan|NaN|None|inf|Traceback)\b")
UNITS = {"gas_mass_flow": "kg/s", "shaft_power": "W"}


def terms(S: Any, D: Any) -> np.ndarray:
    """Return the ten terms of AHRI 540 of temperatures in °C."""
    one = np.ones_like(S)
    return np.stack([one, S, D, S * S, S * D, D * D, S**3, D * S * S, S * D * D, D**3], axis=-1)


def swept(case: Case, axes: dict[str, list[float]], file: str) -> Any:
    """Sweep the scene over values [SI]; return the results."""
    values = {path: [stated(case.scene, path, each) for each in row] for path, row in axes.items()}
    changes = [part for path, row in values.items() for part in ("--set", f"sweep.{path}=[{', '.join(row)}]")]
    case.ask("sweep", case.file, *changes, "-o", file, "--jobs", "1", partly=True)
    return screwsim.open_results(file)


@law
def mapped(case: Case) -> Iterator[str]:
    """Coefficients and errors of `map` are those of numpy's least squares, also with each point left out."""
    random, axes = case.random, {}
    for path, low, high in ((EVAPORATING, -20.0, -2.0), (CONDENSING, 25.0, 38.0)):
        start = random.uniform(low, high)
        axes[path] = (
            ZERO_CELSIUS + np.linspace(start, start + random.uniform(8.0, 20.0), random.integers(4, 7))
        ).tolist()
    Path("plain.yaml").write_text(f"base: {PLAIN}\n")
    swept(Case("plain.yaml", random, case.told), axes, "map.h5")
    (found,), frame = case.json("map", "map.h5")["maps"], screwsim.open_results("map.h5").to_pandas().reset_index()
    frame = frame[frame["status"] == "ok"]
    names = {path: next(name for name in frame.columns if name.endswith(path.partition(".")[2])) for path in axes}
    rows = terms(*(frame[names[path]].to_numpy(float) - ZERO_CELSIUS for path in (EVAPORATING, CONDENSING)))
    for name, fit in found["fits"].items():
        values = frame[name].to_numpy(float)
        own = np.linalg.lstsq(rows / SCALES, values, rcond=None)[0]
        off = rows / SCALES @ own - values
        if np.max(np.abs(rows @ np.array(fit["coefficients"]) - values - off)) > 1e-6 * np.max(np.abs(values)):
            yield f"{name}: coefficients {fit['coefficients']}, by numpy {(own / SCALES).tolist()}"
        leverage = np.sum((rows / SCALES) * np.linalg.pinv(rows / SCALES).T, axis=1)
        errors = {"largest": np.max(np.abs(off / values)), "rms": np.sqrt(np.mean((off / values) ** 2))}
        if np.max(leverage) < 1.0 - 1e-6:
            errors["left_out"] = np.max(np.abs(off / (1.0 - leverage) / values))
        for kind, error in errors.items():
            if abs(fit[kind] - error) > 0.03 * error + 1e-8:
                yield f"{name}: {kind} error {fit[kind]}, by numpy {error}"


@law
def at_fresh_points(case: Case) -> Iterator[str]:
    """An FMU is off by no more than it says at points that it has never seen."""
    from fmpy import simulate_fmu

    paths = case.paths(int(case.random.integers(1, 3)))
    over = [part for path in paths for part in ("--over", f"{path}={case.span(path)}")]
    case.ask("export", "fmu", case.file, "-o", "map.fmu", "--error", "0.01", "--most-cases", "100", *over, partly=True)
    about = json.loads(zipfile.ZipFile("map.fmu").read("resources/map.json"))
    inputs, names = about["inputs"], [each["name"] for each in about["outputs"]]
    rows = []
    for _ in range(FRESH):
        at = {path: case.value(path) for path in paths}
        code, out, _ = command(
            "run", case.file, "--json", *(p for each in at.items() for p in ("--set", case.of(*each)))
        )
        start = {each["name"]: at[each["path"]] for each in inputs}
        (*_, last) = simulate_fmu("map.fmu", start_values=start, stop_time=1.0, output_interval=1.0)
        if code == 0 and last["valid"]:
            rows.append((at, json.loads(out)["performance"], last))
    for name, each in zip(names, about["outputs"], strict=True):
        known = [(at, true[name], last[name]) for at, true, last in rows if true.get(name) is not None]
        least = 0.1 * max((abs(true) for _, true, _ in known), default=0.0)
        for at, true, value in known:
            off = abs(value - true) / (100.0 if each["units"] == "K" else max(abs(true), least))
            if off > BEYOND * each["error"] + FLOOR:
                yield f"{name} at {at}: {value}, not {true}: off by {off:.1e}, stated {each['error']:.1e}"


@law
def compared(case: Case) -> Iterator[str]:
    """A file equals itself at all its points, and its page tells every failure and has no number that is none."""
    paths = case.paths(2)
    axes = {path: [case.value(path) for _ in range(2)] for path in paths}
    results = swept(case, axes, "a.h5")
    ok = int((results.status == "ok").sum())
    found = case.json("compare", "a.h5", "a.h5", "-o", "compared")
    points = found["points"]
    if (points["common"], points["compared"], found["equal"]) != (results.status.size, ok, ok > 0):
        yield f"{axes}: compared with itself {points}, equal {found['equal']}, of {results.status.size} points {ok} ok"
    case.ask("report", "a.h5", "-o", "a.html")
    page = re.sub(r"<(script|style|svg)\b.*?</\1>", "", Path("a.html").read_text(encoding="utf-8"), flags=re.DOTALL)
    words = html.unescape(re.sub("<[^>]+>", " ", page))
    for each in NOT_NUMBERS.finditer(words):
        yield f"{axes}: the page says {words[max(0, each.start() - 60) : each.end() + 40]}"
    if ok < results.status.size and not re.search(rf"\b{results.status.size - ok}\b", words):
        yield f"{axes}: the page does not tell that {results.status.size - ok} cases are not ok"


@law
def next_larger(case: Case) -> Iterator[str]:
    """The size of a catalogue that `find` takes is the smallest at which a run meets the goal."""
    figure = str(case.random.choice(list(UNITS)))
    paths = [path for path in ("machine.displacement.flow", "machine.rotor_diameter", "machine.volume.max")
             if path in case.leaves and near(case.scene, path) is not None]  # fmt: skip
    if not paths:
        raise NotAsked
    path = str(case.random.choice(paths))
    wanted = case.run()["performance"][figure] * case.random.uniform(0.7, 1.3)
    sizes = sorted(case.value(path) for _ in range(4))
    listed = ", ".join(stated(case.scene, path, each) for each in sizes)
    goal = f"{figure}={wanted!r} {UNITS[figure]}"
    row = case.json("find", case.file, "--vary", path, "--for", goal, "--catalogue", listed, partly=True)["rows"][0]
    runs = [command("run", case.file, "--set", case.of(path, each), "--json") for each in sizes]
    figures = [json.loads(out)["performance"].get(figure) if code == 0 else None for code, out, _ in runs]
    known = [(size, value) for size, value in zip(sizes, figures, strict=True) if value is not None]
    if len(known) < 2 or known[-1][1] < 1.01 * known[0][1]:
        raise NotAsked  # the figure does not grow with the size
    true = next((size for size, value in known if value >= wanted * (1.0 - 1e-4)), None)
    taken = None if row["size"] is None else row["size"]["value"]
    if (taken is None) != (true is None) or (taken and true and abs(taken / true - 1.0) > 1e-6):
        yield f"{goal} of {path}: takes {taken}, but {known}: {row['status']} {row['message']}"


@law
def between_stages(case: Case) -> Iterator[str]:
    """Between two stages pressures, flows and enthalpies are those of CoolProp, with a cooler or a flash tank."""
    random, cooler = case.random, case.random.random() < 0.5
    kind: dict[str, Any] = {"kind": "cooler" if cooler else "economizer"}
    drop = float(round(random.uniform(0.0, 0.2), 3))
    kind |= {"pressure_drop": f"{drop} bar"} | (
        {"outlet_temperature": f"{random.uniform(5, 60)} degC"} if cooler else {}
    )
    files = [str((CONFIGS / PLANT).parent / f"{name}.yaml") for name in ("low", "high")]
    Path("own.stages.yaml").write_text(json.dumps({"stages": files, "intercooler": kind}))
    warm = float(round(random.uniform(30.0, 48.0), 1))
    speeds = {"first": random.uniform(2000.0, 3600.0), "second": random.uniform(1100.0, 2200.0)}
    changes = [f"{stage}.operation.speed={speed} rpm" for stage, speed in speeds.items()]
    changes.append(f"second.{CONDENSING}={warm} degC")
    sets = [part for each in changes for part in ("--set", each)]
    code, text, _ = command("run", "own.stages.yaml", *sets, "--json")
    out = json.loads(text) if code in (0, PARTLY) else {"status": "refused"}
    if out["status"] != "ok":
        raise NotAsked
    whole, (one, two) = out["performance"], [each["performance"] for each in out["stages"]]
    p, T = one["discharge_pressure"], one["separator_temperature"]
    h = CoolProp.PropsSI("H", "T", T, "P", p, FLUID)
    own = {
        "shaft_power": one["shaft_power"] + two["shaft_power"],
        "discharge_temperature": two["discharge_temperature"],
    }
    if cooler:
        throttled = CoolProp.PropsSI("T", "H", h, "P", p - 1e5 * drop, FLUID)
        outlet = float(kind["outlet_temperature"].split()[0]) + ZERO_CELSIUS
        flow, own["second_suction_temperature"] = one["gas_mass_flow"], min(throttled, outlet)
        told = any("the intercooler cools nothing" in each for each in out["warnings"])
        if told != (throttled < outlet):
            yield f"{kind}, {changes}: gas of {throttled} K, warnings {out['warnings']}"
    else:
        liquid, vapour = (CoolProp.PropsSI("H", "P", p, "Q", quality, FLUID) for quality in (0, 1))
        condensed = CoolProp.PropsSI("H", "T", warm + ZERO_CELSIUS, "Q", 0, FLUID)
        y = (condensed - liquid) / (vapour - condensed)
        flow = one["gas_mass_flow"] * (1.0 + y)
        mixed = (h + y * vapour) / (1.0 + y)
        own["second_suction_temperature"] = CoolProp.PropsSI("T", "H", mixed, "P", p - 1e5 * drop, FLUID)
    arrives = {"gas_mass_flow": flow, "suction_pressure": p - 1e5 * drop}
    for name, value, found in [(n, x, whole[n]) for n, x in own.items()] + [(n, x, two[n]) for n, x in arrives.items()]:
        if abs(found - value) > SAME * abs(value):
            yield f"{kind}, {changes}: {name} {found}, by CoolProp {value}"
