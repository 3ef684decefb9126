"""Files that commands write: a place that is refused is told before the work, and what was written is named last."""

import json
import os

import pytest
from each_row import each_row
from folders import CONFIGS

from screwsim import cli
from screwsim.outputs import Figures, Result
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

POINT, MAP = str(CONFIGS / "paper" / "point.yaml"), str(CONFIGS / "r134a" / "map.yaml")
FIT = str(CONFIGS / "calibration" / "leakage.fit.yaml")
ONE = ("--jobs", "1")
SPEED = ("--vary", "operation.speed=1000 rpm..4000 rpm")
RATIO = ("--vary", "oil_supply.ratio=0.5..2")
WRITES = {  # what each command is given beside the output, and the ending of that; none: a folder
    "run": ((POINT,), ".h5"),
    "sweep": (("swept.yaml", *ONE), ".h5"),
    "accuracy": ((POINT, "--quick"), ""),
    "new": (("air",), ".yaml"),
    "find": ((POINT, *SPEED, "--for", "shaft_power=40 kW", *ONE), ".yaml"),
    "optimize": ((POINT, *RATIO, "--maximize", "isothermal_efficiency", *ONE), ".h5"),
    "optimum": ((POINT, *ONE), ".csv"),
    "sensitivity": ((POINT, "--path", "oil_supply.ratio=1..2", *ONE), ".csv"),
    "map": (("results.h5",), ".csv"),
    "compare": (("results.h5", "results.h5"), ""),
    "calibrate": ((FIT, *ONE), ""),
    "plan": ((FIT, "--path", "operation.speed=1000 rpm..4000 rpm", *ONE), ".csv"),
    "tolerance": ((str(CONFIGS / "slider_crank" / "r134a.yaml"), *ONE), ""),
    "startup": ((str(CONFIGS / "drive" / "point.yaml"),), ""),
    "datasheet": ((str(CONFIGS / "r134a" / "point.yaml"), *ONE), ".html"),
    "rotors": ((str(CONFIGS / "rotors" / "a.yaml"),), ""),
    "plot": (("results.h5",), ""),
    "scene": (("results.h5",), ".yaml"),
    "report": (("results.h5",), ".html"),
    "validate": ((*ONE,), ""),
    "export fmu": ((MAP, "--sources-only", *ONE), ".fmu"),
    "export modelica": ((MAP, *ONE), ".mo"),
    "export csv": ((MAP, *ONE), ".csv"),
    "export tespy": ((MAP, *ONE), ".json"),
    "export energyplus": ((MAP, *ONE), ".idf"),
    "export en12900": ((MAP, *ONE), ".csv"),
    "export loads": ((POINT,), ""),
    "export cases": (("results.h5",), ".csv"),
}
REFUSED = "blocked is a file, not a folder (choose another place with -o)\n"


def instant(scene, trace=True):
    figures = Figures(shaft_power=scene.operation.speed, gas_mass_flow=0.3, isothermal_efficiency=0.7)
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))


@pytest.fixture
def results(folder):
    """Work in a folder with the results of a sweep, and a file where an output would want a folder."""
    run_sweep(load("swept.yaml"), "results.h5", jobs=1, simulate=instant)
    (folder / "blocked").write_text("mine\n")
    return folder


def _options(command):
    return {name for each in command.params for name in each.opts}


def test_every_command_with_an_output_is_tried_here():
    commands = dict(cli._parser("").commands)
    below = {f"export {name}": each for name, each in commands.pop("export").commands.items()}
    assert {name for name, each in (commands | below).items() if "-o" in _options(each)} == set(WRITES)


@each_row("name", WRITES)
def test_a_place_that_cannot_be_written_is_refused_before_anything_is_solved(name, results, command, monkeypatch):
    def solved(*_, **__):
        raise AssertionError("solved before the output was checked")

    monkeypatch.setattr("screwsim.model.leases.lease", solved)
    given, ending = WRITES[name]
    answer = command(*name.split(), *given, "-o", str(results / "blocked" / f"out{ending}"))
    assert (answer.code, answer.out) == (2, "") and answer.err.endswith(REFUSED), answer
    assert len(answer.err.splitlines()) == 1 and (results / "blocked").read_text() == "mine\n"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@each_row("name", [name for name, (_, ending) in WRITES.items() if ending and name != "new" and name != "scene"])
def test_a_device_is_no_place_for_a_file(name, results, command):
    """`new` and `scene` overwrite nothing, and say that it exists."""
    given, ending = WRITES[name]
    place = f"{name.replace(' ', '_')}{ending}"
    (results / place).symlink_to("/dev/full")
    answer = command(*name.split(), *given, "-o", place)
    told = f"{place}: is a pipe or a device, not a file (choose another -o)\n"
    assert (answer.code, answer.out, answer.err) == (2, "", told)


@pytest.mark.parametrize("as_json", [False, True])
def test_the_file_of_a_run_is_named_last_and_on_stderr_beside_json(as_json, folder, command):
    answer = command("run", "small.yaml", "-o", "out.h5", *(["--json"] if as_json else []))
    named = answer.err if as_json else answer.out
    assert answer.code == 0 and named.splitlines()[-1] == "out.h5"
    assert not as_json or json.loads(answer.out)["status"] == "ok"


@pytest.mark.around
def test_files_that_an_earlier_command_left_beside_new_ones_are_told(folder, command):
    """A machine without a profile has no forces: those of another machine would pass for its own."""
    for old in ("loads/forces.csv", "loads/flows.csv", "loads/notes.txt"):
        (folder / old).parent.mkdir(exist_ok=True)
        (folder / old).touch()
    told = command("export", "loads", POINT, "-o", "loads").err
    assert "warning: loads/forces.csv: from an earlier command, not of these results" in told
    assert "flows.csv" not in told and "notes.txt" not in told
