"""How often does `screwsim diagnose` name the right fault? Machines with one known fault, measured with noise.

    python benchmarks/diagnosis_hits.py [--machine r134a|air] [--draws 4] [--jobs N] [-o FILE]
    python benchmarks/diagnosis_hits.py --table FILE

Each machine has six parameters that may have changed. In turn one of five has: by a share, drawn at random, of the
way from what it was to a bound. The sixth never has, and may be taken for another; in one draw of six nothing has
changed. Measured are the flow, the power and the discharge temperature at six points of speed and
discharge pressure, with normal noise of the standard deviations that the diagnosis is told (0.5 % of flow and power,
0.5 K). `-o` adds the outcome of a machine to a file of such, `--table` prints the table of the docs from one.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np

import screwsim
from screwsim.scene import Scene, load, with_values
from screwsim.scene.fields import value_at
from screwsim.simulate import simulate
from screwsim.study.asked.inputs import read_text

ROOT = Path(__file__).resolve().parent.parent
FIGURES = {"gas_mass_flow": "kg/s", "shaft_power": "W", "discharge_temperature": "degC"}
SHARE, KELVIN, ZERO_CELSIUS = 0.005, 0.5, 273.15  # noise: of flow and power, of the temperature [K]
SHARES = (0.3, 0.8)  # of the way to the bound, range of a fault's size
ROUGH = ("numerics.error=none",)
NOTHING = "nothing"
MACHINES = {  # scene, speeds [rpm], discharge, {parameter: both bounds in its unit, direction of a fault}
    "r134a": (
        ROOT / "tests" / "plain" / "r134a.yaml",
        (1500.0, 2950.0, 4500.0),
        ("operation.condensing_temperature", "degC", (35.0, 50.0)),
        {
            "effects.tip_leakage.gap": (30.0, 100.0, "up"),
            "effects.interlobe_leakage.gap": (30.0, 100.0, ""),
            "effects.end_face_leakage.gap": (30.0, 100.0, "up"),
            "oil_supply.ratio": (0.3, 2.0, "down"),
            "effects.mechanical.fraction": (0.0, 0.15, "up"),
            "effects.suction_port.flow_coefficient": (0.15, 1.0, "down"),
        },
    ),
    "air": (
        ROOT / "configs" / "slider_crank" / "air.yaml",
        (500.0, 720.0, 900.0),
        ("operation.discharge.pressure", "bar", (3.0, 4.5)),
        {
            "effects.ring_leakage.gap": (1.0, 20.0, "up"),
            "effects.reed_valves.suction_port_area": (15.0, 60.0, "down"),
            "effects.reed_valves.discharge_port_area": (15.0, 60.0, ""),
            "effects.reed_valves.discharge_stiffness": (5e3, 1e5, "up"),
            "effects.cylinder_heat.wall_temperature": (320.0, 450.0, "up"),
            "effects.mechanical.fraction": (0.0, 0.2, "up"),
        },
    ),
}
UNITS = {
    "gap": "um",
    "suction_port_area": "cm^2",
    "discharge_port_area": "cm^2",
    "discharge_stiffness": "N/m",
    "wall_temperature": "K",
}


def text_of(path: str, value: float) -> str:
    """Return a bound as written in a scene."""
    return f"{value:g} {UNITS.get(path.rpartition('.')[2], '')}".strip()


def measured(scene: Scene, machine: str, random: np.random.Generator) -> str:
    """Return the measurements of a machine as a fit's data file."""
    _, speeds, (path, unit, ends), _ = MACHINES[machine]
    heads = [f"operation.speed [rpm],{path} [{unit}]"]
    heads += [f"{name} [{u}],{name}_uncertainty [{'K' if u == 'degC' else u}]" for name, u in FIGURES.items()]
    lines = [",".join(heads)]
    for speed in speeds:
        for end in ends:
            at = {"operation.speed": f"{speed:g} rpm", path: f"{end:g} {unit}"}
            point = with_values(scene, {name: read_text(scene, name, text) for name, text in at.items()})
            found = simulate(point, trace=False)
            if found.status != "ok":
                raise SystemExit(f"{machine}: {at}: {found.told}")
            cells = [f"{speed:g}", f"{end:g}"]
            for name, u in FIGURES.items():
                value = found.performance[name] - (ZERO_CELSIUS if u == "degC" else 0.0)
                sigma = KELVIN if u == "degC" else SHARE * value
                cells += [f"{value + sigma * random.standard_normal():.9g}", f"{sigma:.6g}"]
            lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def draw(machine: str, fault: str, number: int, jobs: int | None) -> dict:
    """Return the result of diagnosing one faulty machine: the rank of the true fault, and its probability."""
    file, _, _, parameters = MACHINES[machine]
    scene, random = load(file, ROUGH), np.random.default_rng([list(MACHINES).index(machine), number])
    share = float(random.uniform(*SHARES))
    faulty = scene
    if fault != NOTHING:
        low, high, way = parameters[fault]
        bound = read_text(scene, fault, text_of(fault, high if way == "up" else low))
        before = float(value_at(scene, fault))
        faulty = with_values(scene, {fault: before + share * (bound - before)})
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "data.csv").write_text(measured(faulty, machine, random), encoding="utf-8")
        lines = [f"scene: {json.dumps(str(Path(folder, 'scene.yaml')))}", "data: data.csv", "parameters:"]
        lines += [f"  {p}: {{from: {text_of(p, a)}, to: {text_of(p, b)}}}" for p, (a, b, _) in parameters.items()]
        Path(folder, "scene.yaml").write_text(scene.text, encoding="utf-8")
        Path(folder, "x.fit.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
        found = screwsim.diagnose(Path(folder, "x.fit.yaml"), jobs=jobs)
    true = () if fault == NOTHING else (fault,)
    ranked = [one.paths for one in found.hypotheses]
    mine = ranked.index(true) if true in ranked else None
    first = ranked[0] if ranked else ()
    pairs = [{one.first, one.second} for one in found.alike]
    told = {" + ".join(true), found.hypotheses[0].path} in pairs if ranked else False
    return {
        "fault": fault,
        "draw": number,
        "share": share,
        "status": found.status,
        "rank": None if mine is None else mine + 1,
        "probability": None if mine is None else found.hypotheses[mine].probability,
        "first": list(first),
        "probability_of_first": found.hypotheses[0].probability if ranked else None,
        "told_alike": told,
        "solutions": found.solutions,
    }


def short(path: str) -> str:
    """Return a path as shown in the table."""
    return path.removeprefix("effects.")


def summary(runs: list[dict]) -> list[list[str]]:
    """Return a row per fault: draws, right first, among two, said alike, sure and wrong, probability, taken for."""
    rows = []
    for fault in dict.fromkeys(each["fault"] for each in runs):
        of = [each for each in runs if each["fault"] == fault]
        first, two = (sum(each["rank"] is not None and each["rank"] <= n for each in of) for n in (1, 2))
        wrong = [each for each in of if each["rank"] != 1]
        alike = sum(each["told_alike"] for each in wrong)
        sure = sum((each["probability_of_first"] or 0.0) > 0.9 for each in wrong)
        mean = sum(each["probability"] or 0.0 for each in of) / len(of)
        taken = dict.fromkeys(
            " + ".join(p.removeprefix("effects.") for p in each["first"]) or NOTHING for each in wrong
        )
        counts = map(str, (len(of), first, two, alike, sure))
        rows.append([short(fault), *counts, f"{100.0 * mean:.0f} %", "; ".join(taken) or "–"])
    return rows


def table(outcomes: dict) -> str:
    """Return the outcomes as a table for the docs."""
    heads = ["machine", "has changed", "draws", "first", "first two", "said alike", "sure and wrong", "probability"]
    lines = ["| " + " | ".join([*heads, "taken for"]) + " |", "|" + "---|" * 9]
    for machine, runs in outcomes.items():
        lines += ["| " + " | ".join([machine, *row]) + " |" for row in summary(runs)]
    every = [each for runs in outcomes.values() for each in runs]
    hits = sum(each["rank"] == 1 for each in every)
    return "\n".join([*lines, "", f"{hits} of {len(every)} right at first"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", choices=MACHINES, default="r134a")
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--table", type=Path, metavar="FILE.json")
    asked = parser.parse_args()
    if asked.table is not None:
        print(table(json.loads(asked.table.read_text(encoding="utf-8"))))
        return
    faults = [path for path, (_, _, way) in MACHINES[asked.machine][3].items() if way] + [NOTHING]
    runs = []
    for number in range(asked.draws):
        for fault in faults:
            runs.append(draw(asked.machine, fault, number, asked.jobs))
            one = runs[-1]
            said = f"rank {one['rank']}, first {one['first']} {one['probability_of_first']}"
            print(f"{number} {fault}: {said}", flush=True)
            if asked.output is not None:
                known = json.loads(asked.output.read_text("utf-8")) if asked.output.exists() else {}
                asked.output.write_text(json.dumps(known | {asked.machine: runs}, indent=1) + "\n", encoding="utf-8")
    print(table({asked.machine: runs}))


if __name__ == "__main__":
    main()
