"""Laws of maps written for other programs: at points off their grids they are off by no more than they say.

The polynomials are read from the files as such a program reads them. `fuzz_commands.py` asks these laws beside those
of `command_laws.py`; their scenes are drawn here, as only machines between two saturation temperatures have such maps.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from asking import OK, Case, NotAsked, command, document
from command_laws import law
from file_laws import CONDENSING, EVAPORATING, ZERO_CELSIUS, terms
from fuzz_new import HALOGENATED, NATURAL

FRESH = 6  # points off the grid
BEYOND = 3.0  # times what a file says of its largest error: that is of other points
LEAST = 5e-4  # relative difference that is always allowed
POUND, BTU = 0.45359237, 1055.05585262  # [kg], [J] of the International Table
KELVIN = 100.0  # of a temperature to which a relative error refers

Model = tuple[str, Callable[[float, float], float], float]  # figure, value [SI] at both temperatures [K], told error


def scene_of(random: np.random.Generator) -> tuple[str, tuple[float, float], tuple[float, float]]:
    """Return the text of a random refrigeration machine, with ranges of both temperatures [°C]."""
    fluid = str(random.choice(HALOGENATED + NATURAL))
    low, high = (random.uniform(*ends) for ends in ((-25.0, 5.0), (30.0, 48.0)))
    cold, warm = (low, low + random.uniform(6.0, 18.0)), (high, high + random.uniform(6.0, 14.0))
    middle = f"{0.5 * sum(cold):.1f}/{0.5 * sum(warm):.1f} degC"
    size = f"{10.0 ** random.uniform(2.0, 3.2):.3g} m^3/h"
    code, text, _ = command("new", "refrigeration", "--fluid", fluid, "--condition", middle, "--displacement", size)
    if code != OK:
        raise NotAsked
    return text, cold, warm


def en12900(file: str) -> Iterator[Model]:
    """Yield the models of a table of coefficients as `export en12900` writes it, in SI or inch-pound units."""
    lines = [line for line in Path(file).read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    rows = csv.DictReader(lines[: lines.index("")] if "" in lines else lines)
    for row in rows:
        if row["table"] != "coefficients":
            continue
        factor = {"W": 1.0, "kg/s": 1.0, "Btu/h": BTU / 3600.0, "lb/h": POUND / 3600.0}[row["unit"]]
        numbers = np.array([float(row[f"C{i}"]) for i in range(1, 11)]) * factor
        fahrenheit = any("degF" in line for line in lines)
        yield row["figure"], _cubic(numbers, fahrenheit), float(row["left_out_error"] or row["largest_error"])


def _cubic(numbers: np.ndarray, fahrenheit: bool = False) -> Callable[[float, float], float]:
    def value(S: float, D: float) -> float:
        at = (each - ZERO_CELSIUS for each in (S, D))
        return float(terms(*(1.8 * each + 32.0 if fahrenheit else each for each in at)) @ numbers)

    return value


def energyplus(file: str, told: Mapping[str, Any]) -> Iterator[Model]:
    """Yield the cubics of a file for EnergyPlus, with the errors that its head states."""
    text = Path(file).read_text(encoding="utf-8")
    said = re.search(
        r"largest errors of the cubics: electrical power ([\d.e-]+) %, cooling capacity ([\d.e-]+) %", text
    )
    for each, figure, group in (("power", "electrical_power", 1), ("capacity", "cooling_capacity", 2)):
        block = re.search(rf"Curve:Bicubic,\s+\S+ {each},.*?;", text, re.DOTALL)
        if block is None or said is None:
            raise NotAsked
        c = [float(number) for number in re.findall(r"^\s+(-?[\d.e+-]+),\s+!- coef", block[0], re.MULTILINE)]
        constant, x, x2, y, y2, xy, x3, y3, x2y, xy2 = c
        yield figure, _cubic(np.array([constant, x, y, x2, xy, y2, x3, x2y, xy2, y3])), 1e-2 * float(said[group])


def modelica(file: str, told: Mapping[str, Any]) -> Iterator[Model]:
    """Yield the polynomials of a Modelica package, with the error of its map and what they are off from its tables."""
    text = Path(file).read_text(encoding="utf-8")
    head = re.search(r"written by screwsim; error ([\d.e-]+)", text)
    functions = r'function (\w+) "[^"]*off from the tables by ([\d.e-]+) at most"(.*?)end \1;'
    for name, off, body in re.findall(functions, text, re.DOTALL):
        scaled = dict(re.findall(r"Real ([uv]) = (.*?);", body))
        right = " ".join(" ".join(re.findall(r"y := (.*?);", body, re.DOTALL)).split()).replace("^", "**")

        def value(S: float, D: float, right: str = right, scaled: Mapping[str, str] = scaled) -> float:
            inputs = {"evaporating_temperature": S, "condensing_temperature": D}
            return float(eval(right, {}, {each: eval(words, {}, inputs) for each, words in scaled.items()}))

        yield name, value, float(off) + (float(head[1]) if head else 0.0)


def tespy(file: str, told: Mapping[str, Any]) -> Iterator[Model]:
    """Yield the efficiencies of a file for TESPy, as polynomials of both temperatures."""
    (one, *_) = json.loads(Path(file).read_text(encoding="utf-8"))["maps"]
    for name, key in (("isentropic_efficiency", "eta_s_poly"), ("volumetric_efficiency", "eta_vol_poly")):
        yield name, _cubic(np.array(one["attributes"][key])), one["largest_error"][name]


FORMATS: dict[str, tuple[str, Callable[..., Iterator[Model]], tuple[str, ...]]] = {
    "en12900": ("csv", lambda file, told: en12900(file), ()),
    "en12900 in inch-pound units": ("csv", lambda file, told: en12900(file), ("--ip",)),
    "energyplus": ("idf", energyplus, ()),
    "modelica": ("mo", modelica, ()),
    "tespy": ("json", tespy, ()),
}


@law
def off_the_grid(case: Case) -> Iterator[str]:
    """Polynomials of maps for other programs are off by what they say at fresh points within their ranges."""
    random = case.random
    text, cold, warm = scene_of(random)
    Path("cold.yaml").write_text(text)
    spans = {
        path: "..".join(f"{each:.3f}" for each in ends) for path, ends in ((EVAPORATING, cold), (CONDENSING, warm))
    }
    over = [part for path, span in spans.items() for part in ("--over", f"{path}={span} degC")]
    at = [(random.uniform(*cold), random.uniform(*warm)) for _ in range(FRESH)]
    runs = []
    for S, D in at:
        sets = "--set", f"{EVAPORATING}={S!r} degC", "--set", f"{CONDENSING}={D!r} degC"
        code, out, _ = command("run", "cold.yaml", *sets, "--json")
        if code == OK:
            runs.append((S + ZERO_CELSIUS, D + ZERO_CELSIUS, document(out)["performance"]))
    name = str(random.choice(list(FORMATS)))
    ending, models, more = FORMATS[name]
    told = case.json("export", name.split()[0], "cold.yaml", "-o", f"map.{ending}", *over, *more, partly=True)
    found = list(models(f"map.{ending}", told))
    if not found:
        yield f"{name}: no model is read from its file"
    for figure, value, error in found:
        for S, D, p in runs:
            if p.get(figure) is None:
                continue
            off = abs(value(S, D) - p[figure]) / (KELVIN if figure.endswith("temperature") else abs(p[figure]))
            if off > BEYOND * error + LEAST:
                where = f"{S - ZERO_CELSIUS:.2f}/{D - ZERO_CELSIUS:.2f} degC"
                words = f"off by {off:.1e}, says {error:.1e}; {text.splitlines()[0]} {spans}"
                yield f"{name}: {figure} at {where}: {value(S, D)!r}, a run {p[figure]!r}: {words}"
