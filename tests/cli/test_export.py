"""`screwsim export`: what it writes, prints and refuses."""

import json
import zipfile
from pathlib import Path

import pytest

from screwsim.export import tespy
from screwsim.outputs import Figures, Result
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

POINT = Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml"
T_E, T_C = "operation.evaporating_temperature", "operation.condensing_temperature"
SPEED = "operation.speed=2500 rpm..3500 rpm"


def test_a_unit_is_written_from_a_scene(command, folder):
    answer = command("export", "fmu", "small.yaml", "-o", "new/x.fmu", "--over", SPEED, "--jobs", "1")
    assert answer.code == 0 and "speed 2500 rpm … 3500 rpm" in answer.err
    assert "new/x.fmu" in answer.out and "gas_mass_flow" in answer.out
    assert "modelDescription.xml" in zipfile.ZipFile("new/x.fmu").namelist()


def test_json_is_one_document_also_from_results(command, folder):
    command("sweep", "swept.yaml", "-o", "x.h5", "--jobs", "1")
    answer = command("export", "fmu", "x.h5", "-o", "x.fmu", "--sources-only", "--json")
    found = json.loads(answer.out)
    assert answer.code == 0 and found["files"] == ["x.fmu"]
    assert [one["name"] for one in found["inputs"]] == ["speed"] and found["error"] is None
    assert found["error_is"] == "unknown, as no axis has five values"


def test_an_error_that_is_not_met_is_told_with_exit_code_4(command, folder):
    over = "operation.discharge.pressure=3 bar..25 bar"
    wanted = ("--error", "0.00031", "--most-cases", "5", "--jobs", "1", "--sources-only")
    answer = command("export", "fmu", "small.yaml", "-o", "x.fmu", "--over", over, *wanted)
    assert answer.code == 4 and "is above the 0.00031 requested" in answer.err
    assert Path("x.fmu").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("fmu", "small.yaml", "-o", "x.zip", "--over", SPEED), "needs an ending that states its format"),
        (("fmu", "small.yaml", "-o", "x.fmu"), "there is nothing to map over"),
        (("fmu", "small.yaml", "-o", "x.fmu", "--over", SPEED, "--fmi", "1"), "'1' is not one of '2', '3'"),
        (("fmuu", "small.yaml"), "did you mean 'fmu'?"),
        (
            ("fmu", "small.yaml", "-o", "small.fmu", "--over", SPEED),
            "small.fmu: already exists, and is not a file of this kind",
        ),
    ],
)
def test_what_makes_no_sense_is_one_line_and_exit_code_2(command, folder, arguments, says):
    Path("small.fmu").write_text("mine")
    answer = command("export", *arguments)
    assert answer.code == 2 and says in answer.err and answer.out == ""
    assert Path("small.fmu").read_text() == "mine"


def simple(scene) -> Result:
    """Return figures that are polynomials of both temperatures."""
    S, D = (T - 273.15 for T in (scene.operation.evaporating_temperature, scene.operation.condensing_temperature))
    figures = Figures(
        isentropic_efficiency=0.7 - 1e-3 * S,
        volumetric_efficiency=0.9 - 1e-3 * D,
        gas_mass_flow=1.0 + 0.01 * S,
        shaft_power=3e4 + 100.0 * D,
        cooling_capacity=2e5 + 1e3 * S,
        heating_capacity=2.3e5 + 1e3 * S + 100.0 * D,
        discharge_temperature=350.0 + D,
        displacement=2e-3,
        displacement_flow=2e-3 * 2950.0 / 60.0,
        suction_pressure=3e5 + 1e4 * S,
        discharge_pressure=1e6 + 2e4 * D,
    )
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))


@pytest.fixture
def both(folder):
    """Write x.h5, a sweep over both temperatures."""
    axes = {"sweep.operation.evaporating_temperature": [f"{T} degC" for T in (-10, -5, 0, 5)]}
    axes["sweep.operation.condensing_temperature"] = [f"{T} degC" for T in (35, 40, 45, 50)]
    run_sweep(load(POINT).with_(axes), folder / "x.h5", jobs=1, simulate=simple)
    return folder


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("tespy", "x.json"),
        ("energyplus", "x.idf"),
        ("energyplus", "x.epJSON"),
        ("en12900", "x.csv"),
        ("en12900", "x.json"),
        ("modelica", "x.mo"),
        ("csv", "x.csv"),
    ],
)
def test_texts_are_written_from_results(command, both, kind, name, monkeypatch):
    monkeypatch.setattr(tespy, "OTHER_MACHINE", 1e9)  # `simple` is no machine of a real gas
    answer = command("export", kind, "x.h5", "-o", f"new/{name}")
    assert answer.code == 0 and answer.out.splitlines()[-1] == f"new/{name}"
    assert answer.out.startswith("Semi-hermetic compact screw by the paper's laws, R134a, 2/45 °C\n")
    text = Path("new", name).read_text()
    assert len(text) > 500
    again = command("export", kind, "x.h5", "-o", f"new/{name}", "--json")
    assert json.loads(again.out)["files"] == [f"new/{name}"] and Path("new", name).read_text() == text
    other = command("export", kind, "x.h5", "-o", "x.pdf")
    assert other.code == 2 and "needs an ending that states its format" in other.err


def test_modelica_refuses_another_number_of_inputs_before_it_simulates(command, folder, monkeypatch):
    monkeypatch.setattr("screwsim.export.source.tabulated_map", None)  # nothing is simulated
    inputs = [f"operation.{each}" for each in ("speed=2000 rpm..3000 rpm", "suction.pressure=1 bar..2 bar")]
    for over in (inputs[:1], [*inputs, "operation.discharge.pressure=10 bar..14 bar"]):
        words = [word for each in over for word in ("--over", each)]
        answer = command("export", "modelica", "small.yaml", *words, "-o", "x.mo")
        count = f"{len(over)} input{'s' * (len(over) > 1)} (speed"
        assert answer.code == 2 and answer.err.startswith(f"the map has {count}")
        assert "two (name two with --over, or a sweep over two; fmu takes any number)" in answer.err


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (["gas.fluid=R454B"], "gas.fluid: is the blend R454B, whose condensing temperature is that of its dew point; "),
        (["gas.model=ideal"], "gas.model: TESPy's compressor, which takes real gas from one inlet, would be up to "),
        (
            ["effects.economizer={temperature: 18 degC, opens: 420 deg, closes: 520 deg, area: 1 cm^2}"],
            "effects.economizer: lets in vapour or liquid, and TESPy's compressor takes gas from one inlet (leave",
        ),
        (["gas.model=ideal", "operation.superheat=0 K"], "gas.model: TESPy's compressor, which takes real gas from o"),
        ([f"sweep.zip=[{{{T_E}: [-10 degC, 0 degC], operation.superheat: [5 K, 8 K]}}]"], "operation.superheat varies"),
        ([f"sweep.zip=[{{{T_E}: [-10 degC, 0 degC], operation.speed: [1e3 rpm, 2e3 rpm]}}]"], "operation.speed varies"),
    ],
)
def test_tespy_refuses_what_is_no_machine_of_its_before_it_simulates(command, folder, monkeypatch, changes, told):
    monkeypatch.setattr("screwsim.export.polynomials.temporary_results", None)  # nothing is simulated
    swept = [f"sweep.{T_C}=[35 degC, 45 degC]"]
    swept += [] if "zip" in changes[0] else [f"sweep.{T_E}=[-10 degC, 0 degC]"]
    words = [word for each in (*swept, *changes) for word in ("--set", each)]
    answer = command("export", "tespy", str(POINT), *words, "-o", "x.json")
    assert answer.code == 2 and answer.err.startswith(told)


@pytest.mark.parametrize("kind", ["en12900 -o x.csv", "energyplus -o x.idf"])
@pytest.mark.parametrize(
    ("file", "path"),
    [
        ("paper/point.yaml", "operation.evaporating_temperature"),
        ("co2/transcritical.yaml", "operation.condensing_temperature"),
        ("two_stage/air.stages.yaml", "first.operation.evaporating_temperature"),
    ],
)
def test_polynomials_of_a_machine_without_these_temperatures_name_the_maps_it_may_have(
    command, folder, kind, file, path
):
    answer = command("export", *kind.split(), str(POINT.parents[1] / file))
    told = f"states no {path}, over which these polynomials are (export csv, modelica and fmu take a map over its press"
    assert answer.code == 2 and told in answer.err


@pytest.mark.parametrize(
    "given", [("--bearings", "40 mm,60 mm"), ("--shafts", "40 mm,60 mm"), ("--steps", "8")], ids=lambda given: given[0]
)
def test_an_option_of_rotors_is_refused_where_there_are_none_with_a_profile(command, folder, given):
    answer = command("export", "loads", "small.yaml", "-o", "loads", *given)
    assert (answer.code, answer.out) == (2, "") and not any(Path("loads").glob("*"))
    assert answer.err.startswith(f"{given[0]}: applies to forces and surfaces of rotors with a profile")
    assert answer.err.endswith(f"(write machine.volume.law: profile, or remove {given[0]}: flows are written)\n")


@pytest.mark.parametrize(
    ("scene", "remedy"),
    [
        ("expander/point.yaml", "(write machine.volume.law: profile, or remove --steps: flows are written)\n"),
        ("slider_crank/air.yaml", "with a profile (remove --steps: flows are written)\n"),
    ],
)
def test_only_a_machine_that_can_have_such_rotors_is_told_to_state_them(command, folder, scene, remedy):
    answer = command("export", "loads", str(POINT.parents[1] / scene), "-o", "loads", "--steps", "8")
    assert answer.code == 2 and answer.err.endswith(remedy)


def test_loads_of_a_machine_without_profile_are_its_flows(command, folder):
    answer = command("export", "loads", "small.yaml", "-o", "loads")
    assert answer.code == 0 and "forces and surfaces need rotors with a profile" in answer.err
    assert sorted(path.name for path in Path("loads").iterdir()) == ["flows.csv", "flows_spectrum.csv", "loads.json"]
    assert answer.out.splitlines()[-1] == "loads/loads.json"
    found = json.loads(command("export", "loads", "small.yaml", "-o", "loads", "--json").out)
    assert found["status"] == "ok" and found["left_out"]
    assert command("export", "loads", "small.yaml", "-o", "small.yaml").code == 2


@pytest.mark.parametrize(
    "arguments", [("loads", "-o", "loads"), ("csv", "-o", "x.csv", "--over", SPEED, "--jobs", "1")]
)
def test_what_the_command_line_changes_stands_below_the_title(command, folder, arguments):
    kind, *rest = arguments
    answer = command("export", kind, "small.yaml", *rest, "--set", "operation.discharge.pressure=6 bar")
    assert answer.out.splitlines()[1] == "with operation.discharge.pressure=6 bar"


WARM = "operation.suction.temperature=30 degC"


@pytest.mark.parametrize(
    ("kind", "target", "file"),
    [("loads", "loads", "loads/loads.json"), ("csv", "x.csv", "x.csv"), ("modelica", "x.mo", "x.mo")],
)
def test_an_exported_file_says_what_the_command_line_changes(command, folder, kind, target, file):
    over = [] if kind == "loads" else ["--over", SPEED, "--jobs", "1"]
    over += ["--over", "operation.discharge.pressure=6 bar..7 bar"] if kind == "modelica" else []
    answer = command("export", kind, "small.yaml", "-o", target, *over, "--set", WARM)
    assert answer.code == 0, answer.err
    text = Path(file).read_text(encoding="utf-8")
    assert text.count(f"with {WARM}") == 1
