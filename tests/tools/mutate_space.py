"""The files of the mutation tool: what is mutated, how a mutant is read, and what no reading may do.

A mutant is told by its seed and number. It is read as the commands read: results files by plot, report, map, compare
and the resuming of a sweep, scenes and tables by explain, fits and validation tables by their readers. Nothing is
solved. Beside the files lie traps: modules, programs and texts that no file names, and of which nothing may be seen.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
import traceback
import warnings
import zipfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import mutate_hdf5
import mutate_text
import numpy as np

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("results", "report")]
import report_fakes  # noqa: E402
import result_fakes  # noqa: E402

from screwsim import cli  # noqa: E402
from screwsim.inputs.faults import SceneError, UsageError  # noqa: E402
from screwsim.machine.rotors.export import lobe_csv  # noqa: E402
from screwsim.machine.rotors.rotors import make_rotors  # noqa: E402
from screwsim.outputs import Result  # noqa: E402
from screwsim.results import open_results, save  # noqa: E402
from screwsim.scene import Scene, case, case_count, load, loads  # noqa: E402
from screwsim.study.calibration import read_fit  # noqa: E402
from screwsim.study.sweep import run_sweep  # noqa: E402
from screwsim.study.validation import NotRun, read_table  # noqa: E402

KINDS = ("results", "scene", "table", "results", "scene", "table", "scene", "fit", "parts", "table")  # in turn
TRAP = "open({marker!r}, 'w').close()\n"
TRAPS = ("trap.py", "trap/__init__.py", "trap/effect.py", "h5py.py", "yaml.py", "ruamel.py", "sitecustomize.py")
TRAPS += ("plotly.py", "usercustomize.py", "validation/trap/compare.py", "my-package/effect.py", "conftest.py")
INTERNAL = "internal error"
ANSWERS = (0, 2, 3, 4)

TABLE = """\
title: tables
machine:
  rotor_diameter: 160 mm
  rotor_length: 176 mm
  volume: {law: table, file: volume.csv, max: 600 cm^3, phi_A: 60 deg}
  suction_port: {law: table, file: suction.csv, area: 40 cm^2, phi_B: 60 deg}
  discharge_port: {law: table, file: discharge.csv, area: 12 cm^2, opens: 600 deg, phi_C: 640 deg}
gas: {fluid: R134a, isentropic_exponent: 1.12}
operation: {speed: 3000 rpm, suction: {pressure: 1.5 bar, temperature: 283 K}, discharge: {pressure: 12 bar}}
effects:
  suction_port:
  discharge_port:
  motor: {rated_power: 75 kW, efficiency_file: motor.csv}
sweep:
  operation.speed: {file: speeds.csv, column: speed, unit: rpm}
"""
FIT = """\
title: two unknowns
scene: plain.yaml
data: points.csv
parameters:
  effects.tip_leakage.gap: {from: 10 um, to: 100 um, prior: {mean: 50 um, deviation: 10 um}}
  oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K), start: 1.5 kJ/(kg K)}
starts: 3
"""
POINTS = """\
# made up
name,use,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]
a,fit,1000,3.1,0.1
b,fit,2000,5.2,0.1
c,fit,3000,6.8,0.2
d,check,4000,9,0.1
"""
STAGES = (
    "title: two stages\nstages: [first.yaml, second.yaml]\nintercooler: {kind: cooler, outlet_temperature: 35 degC}\n"
)
MAP = """\
  operation.evaporating_temperature: [-15 degC, -10 degC, -5 degC, 0 degC, 5 degC]
  operation.condensing_temperature: [30 degC, 35 degC, 40 degC, 45 degC]
"""


def _curve(column: str, values: Sequence[float]) -> str:
    rows = [f"{720.0 * i / (len(values) - 1):g},{value:.6g}" for i, value in enumerate(values)]
    return f"# made up\nangle_deg,{column}\n" + "\n".join(rows) + "\n"


@cache
def _lobe() -> str:
    """Return the points of a male lobe as a table."""
    machine = load(ROOT / "configs/rotors/b.yaml").machine
    sizes = machine.male_lobes, machine.female_lobes, machine.rotor_diameter, machine.rotor_length
    head, *rows = lobe_csv(make_rotors(machine.profile, *sizes)).splitlines()
    return "\n".join([head, *rows[::8], rows[-1]]) + "\n"


@cache
def _texts() -> dict[str, str]:
    """Return the texts that are mutated, and those that they name."""
    arch = np.sin(np.linspace(0.0, np.pi, 25)) ** 2
    suction = np.where(np.linspace(0.0, 1.0, 25) < 0.5, arch * 4e-3, 0.0)
    discharge = np.where(np.linspace(0.0, 1.0, 25) > 0.8, arch * 1e-3, 0.0)
    speeds = "speed,note\n" + "\n".join(f"{1000 + 250 * i},{chr(97 + i)}" for i in range(9)) + "\n"
    motor = "load,efficiency\n0.25,0.9\n0.5,0.93\n0.75,0.94\n1,0.945\n1.25,0.94\n"
    point = (ROOT / "configs/r134a/point.yaml").read_text(encoding="utf-8")
    rotors = (ROOT / "configs/rotors/b.yaml").read_text(encoding="utf-8")
    return {
        "plain.yaml": result_fakes.SCENE,
        "swept.yaml": result_fakes.SCENE + result_fakes.GRID,
        "paper.yaml": (ROOT / "configs/paper/point.yaml").read_text(encoding="utf-8"),
        "r134a.yaml": point,
        "air.yaml": (ROOT / "configs/slider_crank/air.yaml").read_text(encoding="utf-8"),
        "based.yaml": "base: paper.yaml\ntitle: based\noperation: {speed: 2000 rpm}\neffects: {oil_pump: off}\n",
        "table.yaml": TABLE,
        "rotors.yaml": rotors,
        "points.yaml": rotors.replace("kind: rack", "kind: points\n    file: profile.csv"),
        "profile.csv": _lobe(),
        "volume.csv": _curve("volume_m3", 6e-4 * arch),
        "suction.csv": _curve("area_m2", suction),
        "discharge.csv": _curve("area_m2", discharge),
        "motor.csv": motor,
        "speeds.csv": speeds,
        "points.csv": POINTS,
        "small.fit.yaml": FIT,
        "first.yaml": result_fakes.SCENE,
        "second.yaml": result_fakes.SCENE.replace("1.5 bar", "12 bar").replace("12 bar}\noil", "40 bar}\noil"),
        "two.stages.yaml": STAGES,
        "droplets.csv": (ROOT / "validation/droplets/transfer_units.csv").read_text(encoding="utf-8"),
    }


SCENES = (
    "plain.yaml",
    "swept.yaml",
    "paper.yaml",
    "r134a.yaml",
    "air.yaml",
    "based.yaml",
    "table.yaml",
    "rotors.yaml",
    "points.yaml",
    "two.stages.yaml",
)
TABLES = (
    "profile.csv",
    "volume.csv",
    "suction.csv",
    "discharge.csv",
    "motor.csv",
    "speeds.csv",
    "points.csv",
    "droplets.csv",
)
RESULTS = ("run.h5", "sweep.h5", "cycles.h5", "map.h5", "zipped.h5", "sources.h5")


def _results(folder: Path) -> None:
    """Write the results files that are mutated, of simulators that take no time."""
    plain, texts = result_fakes.SCENE, _texts()
    short = "sweep:\n  operation.speed: [1000 rpm, 2000 rpm, 3000 rpm]\n  oil_supply.ratio: [0.5, 1, 2, 4]\n"
    zipped = "sweep:\n  zip:\n  - operation.speed: [1000 rpm, 2000 rpm]\n    oil_supply.ratio: [1, 2]\n"
    sources = "sweep:\n  oil_supply.source: [separator, suction]\n  operation.speed: [1000 rpm, 2000 rpm]\n"
    made = {
        "run.h5": (plain, report_fakes.with_ledger),
        "sweep.h5": (plain + result_fakes.GRID, report_fakes.some_fail),
        "cycles.h5": (plain + short + report_fakes.CYCLE, _thin_cycle),
        "map.h5": (texts["r134a.yaml"] + "sweep:\n" + MAP, report_fakes.ok),
        "zipped.h5": (plain + zipped, report_fakes.ok),
        "sources.h5": (plain + sources, report_fakes.ok),
    }
    for name, (text, simulate) in made.items():
        scene = loads(text)
        if scene.sweep:
            save(folder / name, scene, [simulate(case(scene, i)) for i in range(case_count(scene))], "sweep")
        else:
            save(folder / name, scene, simulate(scene))


def _thin_cycle(scene: Scene) -> Result:
    full = report_fakes.with_ledger(scene)
    return Result(
        full.status,
        performance=full.performance,
        cycle={name: values[::24] for name, values in full.cycle.items()},
        ledger=full.ledger,
    )


def furnish(folder: Path) -> None:
    """Write everything that mutants are made of, and the traps."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in _texts().items():
        (folder / name).write_text(text, encoding="utf-8")
    levels = "\n".join(
        f"a{i}: &a{i} {{{', '.join(f'k{j}: *a{i - 1}' if i else f'k{j}: x' for j in range(9))}}}" for i in range(5)
    )
    (folder / "bomb.yaml").write_text(levels + "\n", encoding="utf-8")
    (folder / "self.yaml").write_text("base: self.yaml\n", encoding="utf-8")
    (folder / "secret.txt").write_text(mutate_hdf5.SECRET, encoding="utf-8")
    with h5py.File(folder / "secret.h5", "w") as file:
        file["text"] = np.frombuffer(mutate_hdf5.SECRET.encode(), "S1")
    os.mkfifo(folder / "pipe")
    for name in TRAPS:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(TRAP.format(marker=str(folder / "sprung")), encoding="utf-8")
    _results(folder)


def make_light() -> None:
    """Leave out of pages and figures what is the same in all of them, and takes most of their time."""
    import plotly.offline

    from screwsim.report import style

    plotly.offline.get_plotlyjs = lambda: ""
    style._FORMATS = {"png": style._FORMATS["png"]}


class Answer(NamedTuple):
    """How the reading of a mutant ended: the answers, one a way of reading, and what is wrong with any."""

    kind: str
    how: str
    answers: tuple[str, ...]
    wrong: tuple[str, ...]


def read(folder: Path, work: Path, seed: int, number: int) -> Answer:
    """Make one mutant in `work`, read it in every way, and return how that ended."""
    random = np.random.default_rng((seed, number))
    kind = KINDS[number % len(KINDS)]
    how, ways = _MAKERS[kind](folder, work, random)
    answers, wrong = [], []
    for name, way in ways:
        answer, faults = _asked(way)
        answers.append(f"{name} {answer}")
        wrong += [f"{name}: {fault}" for fault in faults]
    if (folder / "sprung").exists():
        wrong.append("a trap was sprung")
        (folder / "sprung").unlink()
    return Answer(kind, how, tuple(answers), tuple(wrong))


Way = tuple[str, Callable[[], int]]


def _asked(way: Callable[[], int]) -> tuple[str, list[str]]:
    """Return the exit code of a way of reading as text, and what is wrong with what it said."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("default")
        try:
            code = way()
        except (SceneError, UsageError, NotRun) as error:
            print(error, file=err)
            code = 3 if isinstance(error, SceneError) else 2
        except Exception:  # noqa: BLE001 - what is looked for
            print(f"{INTERNAL}: {traceback.format_exc(limit=-6)}", file=err)
            code = 1
    return str(code), _faults(code, out.getvalue(), err.getvalue())


def _faults(code: int, out: str, err: str) -> list[str]:
    found = []
    if code not in ANSWERS or INTERNAL in err:
        found.append(f"exit code {code}: {err[-1500:]}")
    if code == 2 and err.count("\n") != 1:
        found.append(f"not one line: {err[:1000]!r}")
    if "Traceback" in err or "Warning" in err:
        found.append(f"noise: {err[:1000]}")
    if "memory" in err:
        found.append(f"memory: {err[:300]}")
    if code != 3 and mutate_hdf5.SECRET[:14] in out + err:  # 3: a scene that names the text as its base
        found.append("the secret was told")
    if re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\ud800-\udfff]", out + err):
        found.append(f"steers the terminal: {(out + err)[:300]!r}")
    return found


def _command(*arguments: object) -> Callable[[], int]:
    return lambda: cli.exit_code([str(each) for each in arguments])


def _mutate_results(folder: Path, work: Path, random: np.random.Generator) -> tuple[str, list[Way]]:
    source = folder / str(random.choice(RESULTS))
    target = work / "mutant.h5"
    how = mutate_hdf5.mutated(source, target, random)
    drawn: Way = ("plot", _command("plot", target, "-o", work / "drawn"))
    paged: Way = ("report", _page(target, work / "page.html"))
    ways: list[Way] = [drawn if random.random() < 0.25 else paged]
    pair = (target, source) if random.random() < 0.5 else (source, target, "--json")
    ways += [("compare", _command("compare", *pair)), ("resume", lambda: _resumed(source, target))]
    if random.random() < 0.3:
        ways.insert(0, ("xarray", lambda: _all_of(target)))
    if source.name == "map.h5" or random.random() < 0.1:
        ways.append(("map", _command("map", target, "--figure", "shaft_power", "--figure", "gas_mass_flow")))
    return f"{source.stem} {how}", ways


def _page(target: Path, page: Path) -> Callable[[], int]:
    def way() -> int:
        code = cli.exit_code(["report", str(target), "-o", str(page)])
        if code == 0 and mutate_hdf5.SECRET[:14] in page.read_text(encoding="utf-8"):
            raise AssertionError("the secret is on the page")
        return code

    return way


def _all_of(target: Path) -> int:
    open_results(target).to_xarray(None)
    return 0


def _resumed(source: Path, target: Path) -> int:
    """Resume the sweep of the unchanged file on the mutant; what is missing is not computed."""
    scene = loads(open_results(source).scene_yaml)
    if not scene.sweep:
        return cli.exit_code(["run", str(source.parent / "plain.yaml"), "--set", "gas.fluid=none", "-o", str(target)])
    return _swept(scene, target)


def _mutate_text(
    folder: Path, work: Path, random: np.random.Generator, names: Sequence[str], changes: Sequence[Any]
) -> tuple[str, str, Path]:
    """Write a mutant of one of the texts beside what it names; return its name, how it was made, its path."""
    name = str(random.choice(names))
    text, used = (folder / name).read_text(encoding="utf-8"), []
    for _ in range(1 + int(random.integers(3)) // 2):
        change = changes[int(random.integers(len(changes)))]
        text = change(text or " ", random)
        used.append(change.__name__)
    target = folder / f"mutant-{os.getpid()}-{name}"
    target.write_bytes(mutate_text.encoded(text, random))
    return name, used[0], target


def _mutate_scene(folder: Path, work: Path, random: np.random.Generator) -> tuple[str, list[Way]]:
    name, how, target = _mutate_text(folder, work, random, SCENES, mutate_text.YAML)
    return f"{name.split('.')[0]} {how}", [("explain", _command("explain", target))]


def _mutate_fit(folder: Path, work: Path, random: np.random.Generator) -> tuple[str, list[Way]]:
    _, how, target = _mutate_text(folder, work, random, ("small.fit.yaml",), mutate_text.YAML)
    return f"fit {how}", [("fit", lambda: _fit(target))]


def _fit(path: Path) -> int:
    read_fit(path)
    return 0


def _mutate_table(folder: Path, work: Path, random: np.random.Generator) -> tuple[str, list[Way]]:
    name, how, target = _mutate_text(folder, work, random, TABLES, mutate_text.CSV)
    if name == "droplets.csv":
        return f"validation {how}", [("table", lambda: len(read_table(target)) and 0)]
    if name == "points.csv":
        fit = target.with_suffix(".fit.yaml")
        fit.write_text(FIT.replace("points.csv", target.name), encoding="utf-8")
        return f"points {how}", [("fit", lambda: _fit(fit))]
    scene = target.with_suffix(".yaml")
    text = _texts()["points.yaml" if name == "profile.csv" else "table.yaml"]
    scene.write_text(text.replace(name, target.name), encoding="utf-8")
    return f"{name.split('.')[0]} {how}", [("explain", _command("explain", scene))]


def _mutate_parts(folder: Path, work: Path, random: np.random.Generator) -> tuple[str, list[Way]]:
    """Mutate the parts of a sweep that was interrupted, and resume it."""
    scene = load(folder / "swept.yaml")
    output = work / "parts.h5"
    parts = work / "parts.h5.parts"
    for old in (output, *(parts.glob("*") if parts.is_dir() else ())):
        old.unlink(missing_ok=True)
    count = [0]

    def stopped(one: Scene) -> Result:
        count[0] += 1
        if count[0] > 12:
            raise KeyboardInterrupt
        return report_fakes.ok(one)

    with contextlib.suppress(KeyboardInterrupt):
        run_sweep(scene, output, jobs=1, simulate=stopped)
    files = [*sorted(parts.glob("cases_*")), parts / "sweep.json"]
    target = files[int(random.integers(len(files)))]
    how = _mutate_part(target, folder, random)
    return f"parts {how}", [("resume", lambda: _swept(scene, output))]


def _swept(scene: Scene, output: Path) -> int:
    run_sweep(scene, output, jobs=1, simulate=report_fakes.ok)
    return 0


def _mutate_part(target: Path, folder: Path, random: np.random.Generator) -> str:
    kind = int(random.integers(5))
    if kind == 0 or target.suffix == ".json":
        if random.random() < 0.5:
            target.write_bytes(mutate_hdf5.bytes_turned(target.read_bytes(), random))
        else:
            texts = ("[]", "{}", "null", "[" * 5000, '{"scene_sha256": [1]}', '"\\ud800"', "", "NaN")
            target.write_text(texts[int(random.integers(len(texts)))], encoding="utf-8")
        return "bytes"
    if kind == 1:
        os.replace(target, target.with_name("cases_000000000_999999999.npz"))
        return "renamed"
    arrays = dict(np.load(target))
    name = sorted(arrays)[int(random.integers(len(arrays)))]
    if kind == 2:
        arrays.pop(name)
    elif kind == 3:
        objects = np.array([_Sprung(str(folder / "sprung"))], object)
        odd = (objects, np.zeros(3), np.full(arrays[name].shape, 9), np.empty(0), arrays[name].astype("S9"))
        arrays[name] = odd[int(random.integers(len(odd)))]
    else:
        flat = np.array(arrays[name]).ravel()
        if flat.size:
            flat[int(random.integers(flat.size))] = 99
        arrays[name] = flat.reshape(np.shape(arrays[name]))
    with target.open("wb") as stream:
        (np.savez_compressed if random.random() < 0.3 else np.savez)(stream, **arrays)
    if random.random() < 0.1:
        with zipfile.ZipFile(target, "a", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("trace_x.npy", bytes(50_000_000))
    return "arrays"


class _Sprung:
    """Springs the trap where it is unpickled."""

    def __init__(self, marker: str) -> None:
        self.marker = marker

    def __reduce__(self) -> tuple[Any, ...]:
        return open, (self.marker, "w")


_MAKERS = {
    "results": _mutate_results,
    "scene": _mutate_scene,
    "table": _mutate_table,
    "parts": _mutate_parts,
    "fit": _mutate_fit,
}
