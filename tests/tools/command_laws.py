"""Laws of commands about one machine: each yields what contradicts another way to the same answer.

Another way is a plain run at the point, a difference of two runs, a few points of a grid, the same scene written
otherwise. `fuzz_commands.py` asks them.
"""

from __future__ import annotations

import json
import math
import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from asking import (
    BOTH,
    FLOOR,
    OK,
    Case,
    NotAsked,
    axes,
    differences,
    document,
    near,
    nodes,
    slope,
    stated,
    turned,
    unequal,
)

from screwsim.figures.errors import relative_errors
from screwsim.outputs import Figures
from screwsim.scene import load, value_at

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
PLANT, STAGES = "two_stage/plant.stages.yaml", ("first", "second")
SLOPE = 0.03  # allowed error of a derivative, of it ...
SMALL = 0.2  # ... or of this share of 1 % per 1 %: below it flows err by the regularisation of the wanted accuracy
TRIED = 4  # points of a grid, rows of a sheet, effects left out
UNITS = {"shaft_power": " W", "gas_mass_flow": " kg/s", "discharge_temperature": " K"}
AIMS = "isentropic_efficiency", "volumetric_efficiency", *UNITS

Law = Callable[[Case], Iterator[str]]
LAWS: dict[str, Law] = {}


def law(asked: Law) -> Law:
    """Add a law under its name."""
    LAWS[asked.__name__] = asked
    return asked


@law
def written_otherwise(case: Case) -> Iterator[str]:
    """A scene gives the same bits in SI units, in another order, as JSON, by --set, and read back from its results."""
    paths = case.paths(2)
    changes = [case.of(path, case.value(path)) for path in paths]
    true = case.run(*changes)
    case.ask("run", case.file, *(part for each in changes for part in ("--set", each)), "-o", "out.h5")
    case.ask("scene", "out.h5", "-o", "stored.yaml")
    yield from unequal(case.run(file="stored.yaml"), true, "stored scene")
    tree = yaml.safe_load(Path("stored.yaml").read_text())
    Path("turned.yaml").write_text(yaml.safe_dump(turned(tree), sort_keys=False))
    yield from unequal(case.run(file="turned.yaml"), true, "keys in reverse order")
    Path("json.yaml").write_text(json.dumps(tree))
    yield from unequal(case.run(file="json.yaml"), true, "as JSON")
    nested: dict[str, Any] = {"base": case.file}
    for path, change in zip(paths, changes, strict=True):
        *above, last = path.split(".")
        below = nested
        for key in above:
            below = below.setdefault(key, {})
        below[last] = yaml.safe_load(change.partition("=")[2])
    Path("based.yaml").write_text(yaml.safe_dump(nested))
    yield from unequal(case.run(file="based.yaml"), true, f"written {nested}")
    changed = load(case.file, changes)
    kinds = {path: case.leaves[path].dimension for path in paths}
    in_si = [f"{path}={value_at(changed, path)!r} {kind.si}" for path, kind in kinds.items() if kind]
    yield from unequal(case.run(*changes, *in_si), true, f"in SI units {in_si}")


@law
def explained(case: Case) -> Iterator[str]:
    """`explain` lists exactly the effects that `run` simulates."""
    effects = case.run()["effects"]
    listed = case.ask("explain", case.file)[1].partition("\nActive effects")[2]
    found = re.findall(r"^  ([a-z_.]+) ", listed.partition("\nLeft out")[0], re.MULTILINE)
    if [name for name in found if name != "leaks"] != effects:  # a note on leaks that a scene leaves out
        yield f"explain lists {found}, run simulates {effects}"


@law
def knocked_out(case: Case) -> Iterator[str]:
    """The figures of `--knock-out` are those of `--without`."""
    out = case.json("run", case.file, "--knock-out", partly=True)
    for row in case.random.permutation(out["knock_out"])[:TRIED]:
        try:
            alone = case.json("run", case.file, "--without", row["effect"], partly=True)
        except NotAsked:
            if row["status"] == "ok":
                yield f"--without {row['effect']} is refused, but knocked out it is ok"
            continue
        closes = "failed" if row["status"] == "needed" else row["status"]  # without it no cycle closes
        if alone["status"] not in (closes, row["status"]):
            yield f"knocked out {row['effect']} is {row['status']}, without it {alone['status']}"
        elif row["status"] == "ok":
            figures = {name: row[name] for name in row.keys() & alone["performance"].keys()}
            yield from differences(figures, alone["performance"], alone["error"], f"without {row['effect']}")
            for name in figures.keys() & out["performance"].keys():
                change, other = row[f"change_of_{name}"], out["performance"][name]
                if None not in (change, other) and abs(row[name] - other - change) > 1e-9 * abs(other):
                    yield f"without {row['effect']}: {name} {row[name]} less {other} is not {change}"


@law
def found(case: Case) -> Iterator[str]:
    """`find` finds a figure that a run shows to be reachable, and a run at what it gives has that figure."""
    (path,) = case.paths(1)
    figure = str(case.random.choice(AIMS))
    reached, own = case.run(case.of(path, case.value(path))), case.run()
    wanted, before = (each["performance"].get(figure) for each in (reached, own))
    if wanted is None or before is None or abs(wanted - before) < 20.0 * reached["error"][figure] * abs(wanted):
        raise NotAsked
    vary = f"{path}={case.span(path)}" if case.random.random() < 0.7 else path
    question = f"find {case.file} --vary '{vary}' --for '{figure}={wanted!r}{UNITS.get(figure, '')}'"
    out = case.json(*shlex.split(question), partly=True)
    row = out["rows"][0]
    if row["status"] != "ok":
        yield f"{question}: {row['message']}"
        return
    there = case.run(case.of(path, row["values"][path]))
    yield from differences({figure: wanted}, there["performance"], there["error"], question)
    yield from differences(row["performance"], there["performance"], there["error"], question)


@law
def best(case: Case) -> Iterator[str]:
    """No point of a grid beats the best one of `optimize` or `optimum`, whose figures are those of a run there."""
    (path,) = case.paths(1)
    low, high = near(case.scene, path) or (0.0, 0.0)
    figure, least = str(case.random.choice(AIMS)), case.random.random() < 0.5
    if case.random.random() < 0.5:
        ends = (stated(case.scene, path, each) for each in (low, high))
        question = ["optimum", case.file, "--path", path, "--figure", figure]
        question += [part for pair in zip(("--from", "--to"), ends, strict=True) for part in pair]
        row = case.json(*question, *["--minimum"] * least)["rows"][0]
        place, value = row["value"], row["figure"]
    else:
        question = [
            "optimize",
            case.file,
            "--vary",
            f"{path}={case.span(path)}",
            f"--{'minimize' if least else 'maximize'}",
        ]
        row = case.json(*question, figure)["front"][0]
        place, value = row["values"][path], row["aims"][figure]
    label = f"{shlex.join(question)} {figure}{' least' if least else ''}"
    there = case.run(case.of(path, place))
    yield from differences({figure: value}, there["performance"], there["error"], label)
    for other in np.linspace(low, high, TRIED):
        code, out = case.ask("run", case.file, "--set", case.of(path, float(other)), "--json", partly=True)
        one = document(out)
        if code != OK or one["performance"].get(figure) is None:
            continue
        off = relative_errors(Figures(one["performance"]), Figures(there["performance"]))[figure] or 0.0
        beats = (one["performance"][figure] < value) == least
        if beats and off > BOTH * (there["error"][figure] + one["error"][figure]) + FLOOR:
            yield f"{label}: {value} at {place}, but {one['performance'][figure]} at {other} (off {off:.1e})"


@law
def slopes(case: Case) -> Iterator[str]:
    """A row of `sensitivity --local` is the difference of two runs."""
    (path,) = case.paths(1)
    out = case.json("sensitivity", case.file, "--local", path)
    if not out["values"].get(path):
        raise NotAsked
    differenced, how = slope(case, path), out["method"][path]
    for name in out["derivatives"].keys() & differenced.keys():
        row, (true, noise) = out["derivatives"][name].get(path), differenced[name]
        size = abs(out["performance"][name] / out["values"][path])
        allowed = SLOPE * max(abs(true), SMALL * size) + 3.0 * noise
        if row is not None and abs(row - true) > allowed:
            yield f"{name} by {path}: {row!r} ({how}), by difference {true!r} ± {allowed:.1e}; 1 % per 1 %: {size:.1e}"


@law
def bands(case: Case) -> Iterator[str]:
    """The band of a figure is the root of the squares of derivative times tolerance."""
    paths = [path for path in case.paths(2) if value_at(case.scene, path)]
    if not paths:
        raise NotAsked
    values = {path: value_at(case.scene, path) for path in paths}
    widths = {path: 1.0 if case.is_temperature(path) else 0.02 * abs(value) for path, value in values.items()}
    with_band = [f"{case.of(path, each)} ± {'1 K' if widths[path] == 1.0 else '2 %'}" for path, each in values.items()]
    out = case.run(*with_band)
    local = case.json("sensitivity", case.file, "--local", *paths)
    for name, band in out["uncertainty"]["figures"].items():
        row = local["derivatives"].get(name, {})
        if any(row.get(path) is None for path in paths):
            continue
        true = math.sqrt(sum((row[path] * widths[path]) ** 2 for path in paths))
        size = abs(out["performance"][name] or 0.0)
        if abs(band["expanded"] - true) > SLOPE * true + 1e-4 * size:
            yield f"band of {name} for {with_band}: {band['expanded']!r}, by derivatives {true!r} (figure {size!r})"


@law
def sheet(case: Case) -> Iterator[str]:
    """A row of a data sheet is what a run gives there, in the table and at part load."""
    out = case.json("datasheet", case.file, partly=True)
    rows = [(row, axes(row, case.scene)) for row in out["points"] if row["status"] == "ok"]
    for part in out.get("part_load", ()):
        rows += [(row, {part["path"]: row["setting"]}) for row in part["loads"] if row["status"] == "ok"]
    for number in case.random.permutation(len(rows))[:TRIED]:
        row, values = rows[number]
        if None in values.values():
            continue
        changes = [case.of(path, value) for path, value in values.items()]
        there = case.run(*changes)
        figures = {name: each for name, each in row.items() if isinstance(each, float) and name in there["performance"]}
        yield from differences(figures, there["performance"], there["error"], f"datasheet at {changes}")


@law
def mapped(case: Case) -> Iterator[str]:
    """The nodes of an exported table, and of the map in an FMU, are what a run gives there."""
    (path,) = case.paths(1)
    over = "--over", f"{path}={case.span(path)}"
    for kind in ("csv", "fmu"):
        more = ["--sources-only"] if kind == "fmu" else []
        case.ask("export", kind, case.file, "-o", f"map.{kind}", *over, *more, partly=True)
        rows = nodes(f"map.{kind}")
        for number in case.random.permutation(len(rows))[:2]:
            value, figures = rows[number]
            there = case.run(case.of(path, value))
            yield from differences(figures, there["performance"], there["error"], f"{kind} over {path} at {value!r}")


@law
def sampled(case: Case) -> Iterator[str]:
    """In narrow ranges the Sobol indices are the shares of the squares of derivative times range."""
    paths = case.paths(2)
    values = {path: value_at(case.scene, path) for path in paths}
    half = {path: 1.0 if case.is_temperature(path) else 0.03 * abs(value) for path, value in values.items()}
    if not all(half.values()):
        raise NotAsked
    question = ["sensitivity", case.file, "--samples", "16"]
    for path, value in values.items():
        ends = (stated(case.scene, path, value + sign * half[path]) for sign in (-1.0, 1.0))
        question += ["--path", f"{path}={'..'.join(ends)}"]
    out, local = case.json(*question), case.json("sensitivity", case.file, "--local", *paths)
    for name, each in out["figures"].items():
        row = local["derivatives"].get(name, {})
        parts = {path: (row[path] * half[path]) ** 2 for path in paths if path in row}
        if each["message"] or len(parts) < 2 or each["noise"] > 1e-3:
            continue
        deviation = math.sqrt(sum(parts.values()) / 3.0)
        if abs(each["standard_deviation"] - deviation) > 0.3 * deviation:
            yield f"{shlex.join(question)}: {name}: deviation {each['standard_deviation']}, by derivatives {deviation}"
        for path, index in each["indices"].items():
            true = parts[path] / sum(parts.values())
            if abs(index["total"] - true) > 2.0 * index["total_confidence"] + 0.15:
                yield f"{shlex.join(question)}: {name}: total index of {path} {index['total']}, by derivatives {true}"


@law
def drawn_rotors(case: Case) -> Iterator[str]:
    """The rotors that are drawn displace what is simulated."""
    if getattr(case.scene.machine, "profile", None) is None:
        raise NotAsked
    out, own = case.json("rotors", case.file)["coefficients"], case.run()["performance"]
    yield from differences({"displacement": out["displacement"]["value"]}, own, {}, "rotors")


@law
def started(case: Case) -> Iterator[str]:
    """A machine that is started reaches the mean speed of the closed cycle."""
    if "drive" not in case.scene.effects:
        raise NotAsked
    out, own = case.json("startup", case.file)["figures"], case.run()["performance"]
    speed = own.get("mean_speed") or case.scene.operation.speed
    if abs(out["end_speed"] - speed) > 0.01 * speed:
        yield f"startup ends at {out['end_speed']}, steady {out['steady_speed']}, the cycle has {speed}"


@law
def with_tolerances(case: Case) -> Iterator[str]:
    """The nominal figures of `tolerance` are those of a run, and its low and high ends lie about its mean."""
    if case.scene.machine.kind != "slider_crank":
        raise NotAsked
    out, own = case.json("tolerance", case.file, "--count", "8"), case.run()
    nominal = {name: each["nominal"] for name, each in out["figures"].items()}
    yield from differences(nominal, own["performance"], own["error"], "tolerance")
    for name, each in out["figures"].items():
        if not each["low"] <= each["mean"] <= each["high"]:
            yield f"tolerance: {name} {each}"


@law
def staged(case: Case) -> Iterator[str]:
    """Each of two stages, run alone as its results file states it, gives the same bits as in the plant."""
    speeds = (f"{stage}.operation.speed={case.random.uniform(1500.0, 4000.0)!r} rpm" for stage in STAGES)
    changes = [part for speed in speeds for part in ("--set", speed)]
    plant = case.json("run", str(CONFIGS / PLANT), *changes, "-o", "plant.h5", partly=True)
    for stage, true in zip(STAGES, plant["stages"], strict=True):
        case.ask("scene", "plant.h5", "--stage", stage, "-o", f"{stage}.yaml")
        yield from unequal(case.run(file=f"{stage}.yaml"), true, f"{changes}: {stage} stage")


@law
def measured_accuracy(case: Case) -> Iterator[str]:
    """`accuracy --quick` ends, and prints no number that is none."""
    if case.random.random() < 0.4:  # it takes long
        raise NotAsked
    out = case.ask("accuracy", case.file, "--quick")[1]
    if re.search(r"\b(nan|inf)\b", out):
        yield out
