"""`run` and `sweep` on a small scene: the JSON document, the files, the table for people."""

import importlib
import json

import pytest
from folders import CONFIGS

import screwsim
from screwsim.figures.engineering import shown_name
from screwsim.outputs import BALANCE, LEDGER, NUMERICS, NUMERICS_TEXT, PERFORMANCE, Figures, Result


def _document(text: str) -> dict:
    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


ALWAYS = {name for name, figure in PERFORMANCE.items() if not figure.needs}  # whatever a scene names


def test_json_of_run_has_the_names_of_the_contract(folder, command):
    answer = command("run", "small.yaml", "--json")
    assert answer.code == 0, answer.err
    document = _document(answer.out)
    assert (document["status"], document["message"]) == ("ok", "")
    assert document["effects"] == ["suction_port", "discharge_port", "tip_leakage"]
    assert document["states"] == ["T", "rho"]
    assert set(document["performance"]) == {*ALWAYS, "built_in_volume_ratio"}
    assert set(document["balance"]) == set(BALANCE)
    assert set(document["error"]) == set(document["performance"])
    assert set(document["numerics"]) == {*NUMERICS, *NUMERICS_TEXT}
    assert set(LEDGER) <= set(document["ledger"])
    assert {f"exergy_destroyed_{effect}" for effect in document["effects"]} <= set(document["ledger"])
    assert "knock_out" not in document
    assert 0.0 < document["performance"]["volumetric_efficiency"] < 1.0


def test_run_writes_the_base_point_only_when_asked(folder, command):
    before = {path.name for path in folder.iterdir()}
    assert command("run", "swept.yaml").code == 0
    assert {path.name for path in folder.iterdir()} == before
    assert command("run", "swept.yaml", "-o", "out/point.h5").code == 0
    stored = screwsim.open_results("out/point.h5")
    assert stored.shape == ()
    assert "pressure" in stored.cycle
    assert "sweep" not in stored.scene_yaml


def test_run_writes_the_base_point_of_a_sample(folder, command):
    over = "{operation.speed: {from: 2000 rpm, to: 3000 rpm}}"
    sample = f"sweep.sample={{kind: sobol, count: 2, seed: 1, over: {over}}}"
    answer = command("run", "small.yaml", "--set", sample, "-o", "point.h5")
    assert answer.code == 0, answer.err
    assert "sweep" not in screwsim.open_results("point.h5").scene_yaml


def test_table_is_clean_in_a_pipe(folder, command):
    answer = command("run", "small.yaml")
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    assert max(map(len, lines)) <= 80
    assert "\x1b" not in answer.out
    assert lines[:2] == ["small", "status: ok"]
    table = {line[:28].strip(): line[28:].split() for line in lines}
    assert table["shaft power"][1] == "kW"
    assert table["peak pressure"][1] == "bar"
    assert table["isothermal efficiency"][1] == "%"
    figures = screwsim.simulate(screwsim.load("small.yaml")).performance
    assert [name for name in figures if shown_name(name) not in table] == []
    assert "oil ratio" not in table and "mechanical power" not in table
    assert any(line.startswith("balance: ") for line in lines)


@pytest.mark.parametrize(
    "ended",
    [
        Result("failed", "the integration stopped at 12.00 deg", numerics=Figures(integrator="rodas4", wall_time=0.01)),
        Result("not_closed", "mass 1e-3", performance=Figures(shaft_power=float("nan"), oil_ratio=None)),
    ],
)
@pytest.mark.parametrize("extra", [(), ("--json",)])
def test_a_point_that_is_not_ok_ends_with_4(folder, command, monkeypatch, ended, extra):
    monkeypatch.setattr(importlib.import_module("screwsim.simulate"), "simulate", lambda scene, **_: ended)
    answer = command("run", "small.yaml", *extra)
    assert answer.code == 4
    if extra:
        document = _document(answer.out)
        assert (document["status"], document["message"]) == (ended.status, ended.message)
    else:
        assert f"status: {ended.status}; {ended.message}" in answer.out


def test_what_the_command_line_changes_stands_below_the_title(folder, command):
    changes = ("--set", "operation.speed=1000 rpm", "--without", "tip_leakage")
    lines = command("run", "small.yaml", *changes).out.splitlines()
    assert lines[:3] == ["small, changed", "with operation.speed=1000 rpm, without tip_leakage", "status: ok"]


def test_knock_out_leaves_each_effect_out_as_without_does(folder, command, monkeypatch):
    module, solved = importlib.import_module("screwsim.simulate"), {}

    def once(scene, **asked):  # what does not close takes seconds, each time the same
        if scene.text not in solved:
            solved[scene.text] = simulate(scene, **asked)
        return solved[scene.text]

    simulate = module.simulate
    monkeypatch.setattr(module, "simulate", once)
    rough = ("--set", "numerics.accuracy=0.05", "--set", "numerics.error=none")
    answer = command("run", "small.yaml", *rough, "--knock-out", "--json")
    assert answer.code == 0, answer.err
    document = _document(answer.out)
    costs = {cost["effect"]: cost for cost in document["knock_out"]}
    assert list(costs) == document["effects"]
    without = _document(command("run", "small.yaml", *rough, "--without", "tip_leakage", "--json").out)["performance"]
    whole, cost = document["performance"], costs["tip_leakage"]
    assert (cost["status"], cost["shaft_power"]) == ("ok", without["shaft_power"])
    assert cost["change_of_shaft_power"] == without["shaft_power"] - whole["shaft_power"]
    change = without["shaft_power"] / without["gas_mass_flow"] - whole["shaft_power"] / whole["gas_mass_flow"]
    assert cost["change_of_specific_work"] == pytest.approx(change, rel=1e-12)
    assert costs["suction_port"]["specific_work"] is None  # nothing is delivered without it
    for name in ("suction_port", "discharge_port"):  # what --without warns of, a knock-out says too
        doubts = _document(command("run", "small.yaml", *rough, "--without", name, "--json").out)["warnings"]
        new = [warning for warning in doubts if warning not in document["warnings"]]
        assert new and costs[name]["message"].endswith("; ".join(new))
    steps = [line for line in answer.err.splitlines() if "knock-out" in line]
    assert steps == [f"screwsim: knock-out {i} of 3: without {name}" for i, name in enumerate(costs, 1)]
    text = command("run", "small.yaml", *rough, "--knock-out").out
    assert "left out" in text and max(map(len, text.splitlines())) <= 80
    assert "…" not in text  # no cell is cut off


def test_sweep_writes_resumes_and_starts_over(folder, command):
    answer = command("sweep", "swept.yaml", "--jobs", "1", "--json")
    assert answer.code == 0, answer.err
    document = _document(answer.out)
    numbers = ["cases", "ok", "not_closed", "failed", "reused", "seconds"]
    assert list(document) == ["path", *numbers, "failures", "warned", "warned_by_status", "warnings"]
    assert document["path"] == "results/swept.h5"
    assert [document[name] for name in ("cases", "ok", "failed", "reused")] == [2, 2, 0, 0]
    assert screwsim.open_results("results/swept.h5").shape == (2,)
    assert _document(command("sweep", "swept.yaml", "--json").out)["reused"] == 2
    assert _document(command("sweep", "swept.yaml", "--jobs", "1", "--restart", "--json").out)["reused"] == 0


def test_sweep_over_condensing_temperature_has_its_axis_and_resumes(folder, command):
    states = "{suction: null, discharge: null, evaporating_temperature: 2 degC, superheat: 10 K}"
    (folder / "rated.yaml").write_text(f"base: small.yaml\noperation: {states}\n")
    grid = "sweep.operation.condensing_temperature=[30 degC, 45 degC]"
    changes = ("--set", "operation.condensing_temperature=40 degC", "--set", grid, "-o", "rated.h5")
    answer = command("sweep", "rated.yaml", *changes, "--jobs", "1")
    assert answer.code == 0, answer.err
    results = screwsim.open_results("rated.h5")
    assert list(results.axes["operation.condensing_temperature"]) == [303.15, 318.15]
    cop, p_d = results.performance["cop"], results.performance["discharge_pressure"]
    assert cop[0] > cop[1] > 1.0 and p_d[0] < p_d[1]
    assert "(2 from an earlier run)" in command("sweep", "rated.yaml", *changes).out
    other = command("sweep", "rated.yaml", *changes, "--set", "operation.subcooling=5 K")
    assert other.code == 2  # another scene's file


def test_sweep_lists_what_failed_and_ends_with_4(folder, command):
    # discharge below suction pressure: a fault of one case only
    grid = "sweep.operation.discharge.pressure=[1 bar, 12 bar]"
    answer = command("sweep", "small.yaml", "--set", grid, "--jobs", "1", "--json", "-o", "grid.h5")
    assert answer.code == 4
    document = _document(answer.out)
    assert [document[name] for name in ("cases", "ok", "failed")] == [2, 1, 1]
    [failure] = document["failures"]
    assert (failure["case"], failure["status"]) == (0, "failed")
    assert failure["values"] == {"operation.discharge.pressure": 1e5}
    assert "below the suction pressure" in failure["message"]
    text = command("sweep", "small.yaml", "--set", grid, "-o", "grid.h5")
    assert text.code == 4
    assert "2 cases: 1 ok, 1 failed (2 from an earlier run)" in text.out


def test_schema_is_one_document(command):
    answer = command("schema")
    assert (answer.code, answer.err) == (0, "")
    assert "machine" in _document(answer.out)["properties"]


def test_a_run_replaces_no_file_but_a_run_s(folder, command):
    scene = (folder / "small.yaml").read_text()
    told = "already exists, and is not a file of this kind (choose another -o, or remove it)"
    assert command("run", "small.yaml", "-o", "small.yaml") == (2, "", f"small.yaml: {told}\n")
    assert (folder / "small.yaml").read_text() == scene
    assert command("run", "small.yaml", "-o", "one.h5").code == 0
    assert command("run", "small.yaml", "-o", "one.h5").code == 0
    assert command("report", "one.h5", "-o", "one.h5") == (2, "", f"one.h5: {told}\n")
    assert command("sweep", "swept.yaml", "-o", "all.h5", "--jobs", "1").code == 0
    answer = command("run", "small.yaml", "-o", "all.h5")
    assert (answer.code, answer.err) == (2, "all.h5: holds results of a sweep (choose another -o, or remove it)\n")


def test_a_file_that_comes_to_the_place_of_a_run_meanwhile_stays(folder, command, monkeypatch):
    module = importlib.import_module("screwsim.simulate")
    simulate = module.simulate

    def simulated(scene, trace):
        (folder / "out.h5").write_text("my thesis")
        return simulate(scene, trace)

    monkeypatch.setattr(module, "simulate", simulated)
    answer = command("run", "small.yaml", "-o", "out.h5")
    assert (answer.code, len(answer.err.splitlines())) == (2, 1)
    assert (folder / "out.h5").read_text() == "my thesis"


def test_short_is_one_screen_of_the_ten_figures_that_are_read_first(folder, command):
    answer, whole = command("run", "oiled.yaml", "--short"), command("run", "oiled.yaml")
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert lines[:2] == ["small", "status: ok"]
    head = next(i for i, line in enumerate(lines) if line.startswith("figure"))
    rows = lines[head + 1 : lines.index("", head)]
    assert len(rows) == 10
    figures = screwsim.simulate(screwsim.load("oiled.yaml")).performance
    there = [line.split() for line in whole.out.splitlines()]
    for row in rows:
        given = row.startswith("pressure ratio")  # of stated pressures, which err by nothing
        assert (row.split() if given else row.split()[:-1]) in [each[:-1] for each in there], row
        assert given or row.split() in there
    assert any(row.startswith("pressure ratio") for row in rows)
    valued = sum(value is not None for value in figures.values())
    assert lines[-1] == f"without --short: {valued - 10} more figures, where the power goes"


def test_short_of_what_fails_says_why_and_fits_the_screen(folder, command):
    answer = command("run", "oiled.yaml", "--short", "--set", "operation.speed=20 rpm")
    lines = answer.out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert lines[0].startswith("small, changed: physically impossible: volumetric efficiency -")
    assert lines[1] == "with operation.speed=20 rpm"
    assert any(line.startswith("warning: ") for line in lines)


@pytest.mark.parametrize(("other", "words"), [("--json", "prints everything"), ("--knock-out", "a table of its own")])
def test_short_is_refused_beside_what_asks_for_more(folder, command, other, words):
    answer = command("run", "small.yaml", "--short", other)
    assert answer.code == 2 and words in answer.err and answer.out == ""


def test_a_group_is_left_out_at_once_as_without_leaves_its_effects_out(folder, command):
    rough = ("--set", "numerics.accuracy=0.01", "--set", "numerics.error=none")
    both = ("--together", "leaks", "--together", "tip_leakage, oil_heat")
    answer = command("run", "oiled.yaml", *rough, *both, "--json")
    assert answer.code == 0, answer.err
    costs = {cost["effect"]: cost for cost in _document(answer.out)["knock_out"]}
    assert list(costs) == ["leaks", "tip_leakage+oil_heat"]
    for name, effects in (("leaks", ["tip_leakage"]), ("tip_leakage+oil_heat", ["tip_leakage", "oil_heat"])):
        without = [word for effect in effects for word in ("--without", effect)]
        other = _document(command("run", "oiled.yaml", *rough, *without, "--json").out)["performance"]
        assert costs[name]["shaft_power"] == other["shaft_power"], name
    text = command("run", "oiled.yaml", *rough, "--together", "leaks").out
    assert any(line.startswith("leaks ") for line in text.splitlines())


def test_groups_follow_what_effects_say_that_they_are():
    from screwsim.study.knock_out import read_groups

    scene = screwsim.load(CONFIGS / "r134a" / "point.yaml")
    leaks, oil, friction = (set(each.effects) for each in read_groups(scene, ["leaks", "oil", "friction"]))
    assert leaks == {f"{name}_leakage" for name in ("tip", "interlobe", "end_face", "shaft")} | {"blow_hole"}
    assert (oil, friction) == ({"droplets", "hydromechanical"}, {"mechanical"})
    piston = screwsim.load(CONFIGS / "slider_crank" / "air.yaml")
    assert [each.effects for each in read_groups(piston, ["walls"])] == [("cylinder_heat",)]


@pytest.mark.parametrize(
    ("group", "words"),
    [
        ("leak", "leak is neither a group nor an effect of this scene (did you mean 'leaks'?)"),
        ("tip_leakage,blow_hole", "blow_hole is neither a group nor an effect of this scene"),
        ("walls", "the scene simulates no effect of group walls"),
        (",", "names nothing (write e.g. --together leaks)"),
    ],
)
def test_a_group_that_is_none_is_told_before_anything_is_simulated(folder, command, group, words):
    answer = command("run", "small.yaml", "--together", group)
    assert answer.code == 2 and words in answer.err and answer.out == ""
