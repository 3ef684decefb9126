"""New machines in two stages: what is written runs as the command says, divides the pressure ratio, and is refused."""

import itertools
import re
from typing import NamedTuple

import pytest
from CoolProp.CoolProp import PropsSI

from screwsim.cli import exit_code
from screwsim.outputs.customary import RPM
from screwsim.study.stages import run_stages
from screwsim.study.stages.read import read_stages
from screwsim.template.request import request_of
from screwsim.template.two_stages import CONDITIONS, ends_of

pytestmark = pytest.mark.around
MACHINES = {
    "air": ("air", "--pressure", "13 bar(g)", "--flow", "10 m^3/min", "--variable-speed"),
    "halocarbon": ("refrigeration", "--condition", "-35/40 degC", "--capacity", "150 kW"),
    "heat pump": ("heat_pump", "--condition", "0/85 degC", "--capacity", "500 kW"),
    "ammonia": ("refrigeration", "--fluid", "R717", "--condition", "-40/35 degC", "--capacity", "300 kW"),
    # of which gas may condense in one of both by itself
    "one on cooled oil": ("refrigeration", "--fluid", "R22", "--condition", "-23/36 degC", "--capacity", "250 kW"),
}
WANTED = {
    "air": ("free_air_delivered", 10.0 / 60.0),
    "halocarbon": ("cooling_capacity", 150e3),
    "heat pump": ("heating_capacity", 500e3),
    "ammonia": ("cooling_capacity", 300e3),
    "one on cooled oil": ("cooling_capacity", 250e3),
}


class Written(NamedTuple):
    """What a command said, the chain that it wrote, and its result."""

    said: str
    chain: object
    result: object
    folder: object


@pytest.fixture(scope="module", params=MACHINES)
def written(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        said = []
        patch.setattr("screwsim.printing.tables.print_text", lambda text, err=False: said.append(text))
        assert exit_code(["new", *MACHINES[request.param], "--two-stage", "-o", "plant.stages.yaml"]) == 0
    chain = read_stages(folder / "plant.stages.yaml")
    return request.param, Written("\n".join(said), chain, run_stages(chain), folder)


def test_files_run_as_the_command_said_without_a_warning(written):
    name, (said, _, result, folder) = written
    assert sorted(each.name for each in folder.iterdir()) == ["plant.stages.yaml", "plant_high.yaml", "plant_low.yaml"]
    assert result.status == "ok" and not result.as_result().warnings, result.as_result().warnings
    p = result.performance
    figure, wanted = WANTED[name]
    assert p[figure] == pytest.approx(wanted, rel=5e-3)
    powers = [float(each) for each in re.findall(r"stage takes ([\d.]+) kW", said)]
    assert powers == pytest.approx([p.first_shaft_power / 1e3, p.second_shaft_power / 1e3], rel=1e-4)
    assert said.count("computed: ") == 1


def test_both_stages_share_the_pressure_ratio_and_their_motors_carry_the_load(written):
    _, (_, chain, result, _) = written
    p = result.performance
    assert p.first_pressure_ratio == pytest.approx(p.second_pressure_ratio, rel=0.06)  # losses count to the second
    for stage, scene in chain.by_stage.items():
        load = p[f"{stage}_shaft_power"] / scene.effects["motor"].parameters.rated_power
        assert 0.5 < load <= 1.0
        assert scene.operation.speed == pytest.approx(2950.0 * RPM)


def test_scenes_state_the_line_between_them_as_it_was_found(written):
    name, (_, chain, result, _) = written
    p, low, high = result.performance, chain.first.operation, chain.second.operation
    if name == "air":
        assert low.discharge.pressure == high.suction.pressure == pytest.approx(p.intermediate_pressure, rel=2e-3)
        return
    assert low.condensing_temperature == high.evaporating_temperature
    assert high.evaporating_temperature == pytest.approx(p.intermediate_temperature, abs=0.1)
    assert high.superheat == pytest.approx(p.second_suction_temperature - p.intermediate_temperature, abs=1.0)


def test_what_lies_between_suits_the_gas(written):
    name, (_, chain, result, _) = written
    assert chain.intercooler.kind == {"air": "cooler", "ammonia": "flash_intercooler"}.get(name, "economizer")
    if name != "air":
        return
    p = result.performance
    vapour = PropsSI("P", "T", 293.15, "Q", 1, "Water") * p.intermediate_pressure / 1e5
    margin = chain.intercooler.outlet_temperature - PropsSI("T", "P", vapour, "Q", 1, "Water")
    assert 4.9 < margin < 10.1
    first, second = (chain.sweep[f"{stage}.operation.speed"] for stage in chain.by_stage)
    assert first == second and len(first) == 6 and max(first) == pytest.approx(2950.0 * RPM)
    assert all(slow < fast for fast, slow in itertools.pairwise(first))
    packages = [scene.effects["air_package"].parameters for scene in chain.by_stage.values()]
    assert [package.fan is None for package in packages] == [False, True]
    assert [package.inlet_filter is None for package in packages] == [False, True]
    assert [package.aftercooler is None for package in packages] == [True, False]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ["air", "-o", "x.yaml"],
            "-o x.yaml: the file that joins two stages must end in .stages.yaml (write -o x.stages.yaml)",
        ),
        (["expander"], "--two-stage: is for air, refrigeration and heat_pump (remove it)"),
        (
            ["booster"],
            "write a booster to the pressure between and one from it, and join them: docs/how-to/two-stages.md)",
        ),
        (["heat_pump", "--condition", "20/65 degC"], "a pressure ratio of 3.36 takes one stage"),
        (["air", "--motor", "90 kW"], "--motor: each stage has a motor of its own"),
        (["air", "--vi", "3"], "--vi: each stage has its own built-in volume ratio"),
        (["refrigeration", "--slide"], "--slide: a slide valve belongs to one stage"),
        (["refrigeration", "--economizer"], "--economizer: two stages have a flash tank"),
        (
            ["air", "--pressure", "4 bar(g)"],
            "--two-stage: a pressure ratio of 5 takes one stage",
        ),
        (
            ["refrigeration", "--condition", "0/40 degC"],
            "a pressure ratio of 3.47 takes one stage",
        ),
        (
            ["air", "--pressure", "400 bar(g)"],
            "a pressure ratio of 401 takes more than two stages",
        ),
        (["air", "--flow", "900 m^3/min"], "--flow: a displacement of 60000 m^3/h"),
        (
            ["refrigeration", "--fluid", "CO2", "--condition", "-30/35 degC"],
            "needs a gas cooler",
        ),
        (
            ["refrigeration", "--fluid", "R449A"],
            "vapour boiling off R449A, a blend, in the tank between both stages differs from it in composition",
        ),
        (["refrigeration", "--fluid", "R600", "--condition", "-60/110 degC"], "takes more than two stages"),
    ],
)
def test_what_makes_no_sense_is_told_in_one_line(arguments, told, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    where = [] if "-o" in arguments else ["-o", "x.stages.yaml"]
    assert exit_code(["new", *arguments, *where, "--two-stage"]) == 2
    out, err = capsys.readouterr()
    assert out == "" and told in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_three_files_do_not_go_to_the_screen(capsys):
    assert exit_code(["new", "air", "--two-stage"]) == 2
    assert "--two-stage: writes three files (write e.g. -o plant.stages.yaml)" in capsys.readouterr().err


@pytest.mark.parametrize("there", ["x_low.yaml", "x_high.yaml", "x.stages.yaml"])
def test_no_file_is_overwritten(there, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / there).write_text("mine", encoding="utf-8")
    assert exit_code(["new", "air", "--two-stage", "-o", "x.stages.yaml"]) == 2
    assert f"-o {there}: already exists and is not overwritten" in capsys.readouterr().err
    assert (tmp_path / there).read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(("inlet", "cooled"), [("20 degC", True), ("45 degC", False)])
def test_air_of_a_hot_inlet_is_not_cooled_between(inlet, cooled):
    """Its water would condense below the temperature at which the first stage delivers."""
    ends = ends_of("air", request_of(condition=f"0 bar(g)/25 bar(g), {inlet}"))
    assert (ends.cooled is not None) == cooled


@pytest.mark.parametrize("kind", CONDITIONS)
def test_a_default_condition_is_one_for_two_stages(kind):
    ends = ends_of(kind, request_of())
    assert ends.between**2 == pytest.approx(ends.p_s * ends.p_d)
