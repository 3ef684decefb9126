"""The command `sensitivity --local`: one document, a table that fits a terminal, files, mistakes in one line."""

import csv
import json

import pytest

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.results.write import save


def test_local_sensitivities_are_one_document_with_the_method_of_each_number(folder, command):
    answer = command("sensitivity", "oiled.yaml", "--local", "oil_supply.ratio", "operation.speed", "--json")
    assert answer.code == 0
    document = json.loads(answer.out)
    assert document["method"] == {"oil_supply.ratio": "exact", "operation.speed": "exact"}
    assert set(document["derivatives"]) == set(document["performance"])
    assert document["relative"]["displacement_flow"]["operation.speed"] == pytest.approx(1.0, rel=1e-6)


def test_what_gauge_pressures_were_read_over_is_left_out_with_the_reason(folder, command):
    gauge = ("--set", "operation.discharge.pressure=8 barg")
    answer = command("sensitivity", "oiled.yaml", *gauge, "--local", "--figure", "shaft_power", "--json")
    document = json.loads(answer.out)
    assert "operation.discharge.pressure" in document["derivatives"]["shaft_power"]
    assert "operation.ambient_pressure" not in document["derivatives"]["shaft_power"]
    assert document["left_out"]["operation.ambient_pressure"] == "gauge pressures were read relative to it"


def test_local_sensitivities_are_shown_in_percent_and_in_words(folder, command):
    answer = command("sensitivity", "oiled.yaml", "--local", "operation.speed", "--figure", "gas_mass_flow")
    assert answer.code == 0
    assert "percent per percent" in answer.out
    assert "of operation.speed = " in answer.out
    assert max(map(len, answer.out.splitlines())) <= 80


def test_of_temperatures_the_change_by_a_kelvin_is_shown_as_their_zero_is_a_convention(folder, command):
    asked = ("--local", "operation.suction.temperature", "operation.speed", "--figure", "gas_mass_flow")
    document = json.loads(command("sensitivity", "oiled.yaml", *asked, "--json").out)
    by, flow = document["derivatives"]["gas_mass_flow"], document["performance"]["gas_mass_flow"]
    lines = map(str.split, command("sensitivity", "oiled.yaml", *asked).out.splitlines())
    shown = {line[0]: line for line in lines if line}
    *_, kelvin = shown["operation.suction.temperature"]
    *_, percent = shown["operation.speed"]
    assert shown["operation.suction.temperature"][-3:-1] == ["1", "K"]
    assert float(kelvin) == pytest.approx(100.0 * by["operation.suction.temperature"] / flow, rel=5e-3)
    assert float(percent) == pytest.approx(document["relative"]["gas_mass_flow"]["operation.speed"], rel=5e-3)


def test_local_sensitivities_are_written_a_row_a_figure_and_number(folder, command):
    asked = ("--local", "operation.speed", "--figure", "shaft_power", "-o", "s.csv")
    assert command("sensitivity", "oiled.yaml", *asked).code == 0
    head, row = (folder / "s.csv").read_text(encoding="utf-8").splitlines()
    assert head == "figure,path,value,number,derivative,relative,method"
    assert row.startswith("shaft_power,operation.speed,")


def test_local_sensitivities_are_stored_with_the_results_of_the_point(folder, command):
    answer = command(
        "sensitivity", "oiled.yaml", "--local", "operation.speed", "oil_supply.ratio", "-o", "s.h5", "--json"
    )
    assert answer.code == 0
    document, data = json.loads(answer.out), open_results(folder / "s.h5")
    assert data.derivatives["number"].tolist() == ["operation.speed", "oil_supply.ratio"]
    for figure, slopes in document["derivatives"].items():
        assert data.performance[figure] == document["performance"][figure]
        for path, slope in slopes.items():
            assert data.derivatives[figure, path] == slope
    units = dict(zip(data.derivatives["number"], data.derivatives["number_units"], strict=True))
    assert units == {"operation.speed": "rad/s", "oil_supply.ratio": "1"}
    assert data.derivatives["number_exact"].tolist() == [1, 1]
    with pytest.raises(UsageError, match="derivatives has no 'gas'"):
        data.derivatives["shaft_power", "gas"]


@pytest.mark.parametrize(
    ("rest", "told"),
    [
        (("--local", "operation.spede"), "did you mean 'operation.speed'?"),
        (("--local", "machine.male_lobes"), "is a whole number, not a continuous quantity"),
        (("--local", "--path", "oil_supply.ratio=1..2"), "--local takes no ranges"),
        (("oil_supply.ratio",), "has no range"),
        (("--local", "--figure", "cop"), "is not a figure of this scene"),
    ],
)
def test_local_sensitivities_of_what_there_is_not_are_refused_in_one_line(folder, command, rest, told):
    answer = command("sensitivity", "oiled.yaml", *rest)
    assert answer.code == 2
    assert told in answer.err
    assert len(answer.err.splitlines()) == 1


TOLERANT = ("--set", "operation.speed=3000 rpm ± 2 %", "--set", "effects.tip_leakage.gap=50 um ×/÷ 1.5")


def test_a_run_with_tolerances_tells_numerical_error_and_inputs_apart(folder, command):
    answer = command("run", "oiled.yaml", *TOLERANT, "--json")
    assert answer.code == 0
    document = json.loads(answer.out)
    found = document["uncertainty"]["figures"]["displacement_flow"]
    assert found["expanded"] == pytest.approx(0.02 * document["performance"]["displacement_flow"], rel=1e-6)
    assert found["contributors"][0]["paths"] == ["operation.speed"]
    assert document["error"]["gas_mass_flow"] < document["uncertainty"]["figures"]["gas_mass_flow"]["expanded"]


def test_a_run_with_tolerances_shows_the_largest_contributors_in_lines_that_fit(folder, command):
    answer = command("run", "oiled.yaml", *TOLERANT)
    told = answer.out[answer.out.index("uncertain by") :]
    assert answer.code == 0
    assert "tip_leakage.gap" in told and "coverage factor 2" in told
    assert max(map(len, told.splitlines())) <= 80


def test_a_run_without_tolerances_says_nothing_of_them(folder, command):
    assert "uncertainty" not in json.loads(command("run", "oiled.yaml", "--json").out)


def test_the_linear_uncertainty_is_held_against_a_sample(folder, command):
    answer = command("sensitivity", "oiled.yaml", *TOLERANT, "--check-sobol", "8", "--jobs", "1", "--json")
    assert answer.code == 0
    sampled = json.loads(answer.out)["sampled"]
    assert sampled["samples"] == 8
    assert sampled["figures"]["gas_mass_flow"]["standard"] > 0.0


def test_a_sample_has_the_figures_the_seed_and_the_file_that_are_asked_for(folder, command):
    words = ("sensitivity", "oiled.yaml", *TOLERANT, "--check-sobol", "8", "--jobs", "1", "--figure", "gas_mass_flow")
    documents = []
    for seed in ("1", "2"):
        file = folder / f"sample{seed}.csv"
        answer = command(*words, "--seed", seed, "-o", str(file), "--json")
        assert answer.code == 0
        documents.append(json.loads(answer.out))
        ((name, figure),) = documents[-1]["sampled"]["figures"].items()
        (row,) = csv.DictReader(file.read_text(encoding="utf-8").splitlines())
        assert (row["figure"], row["units"]) == (name, "kg s-1") == ("gas_mass_flow", "kg s-1")
        assert float(row["sampled"]) == pytest.approx(2.0 * figure["standard"], rel=1e-12)
        assert float(row["linear"]) == pytest.approx(documents[-1]["figures"][name]["expanded"], rel=1e-12)
    assert documents[0]["sampled"] != documents[1]["sampled"]


def test_a_sample_of_a_figure_that_no_tolerance_moves_says_so(folder, command):
    """It was a head of a table without rows."""
    answer = command("sensitivity", "oiled.yaml", *TOLERANT, "--check-sobol", "8", "--figure", "displacement")
    assert answer.code == 0 and "no figure here depends on the inputs with a tolerance" in answer.out
    assert "sampled  unit" not in answer.out


@pytest.mark.parametrize(
    ("rest", "told"),
    [
        (("--check-sobol", "8"), "no input has a tolerance"),
        ((*TOLERANT, "--check-sobol", "7"), "is not a power of two"),
        ((*TOLERANT, "--check-sobol", "8", "--local"), "takes no --local (the scene's tolerances say what varies)"),
        ((*TOLERANT, "--check-sobol", "8", "--samples", "4"), "takes no --samples"),
        ((*TOLERANT, "--check-sobol", "8", "--path", "operation.speed=900 rpm..1000 rpm"), "takes no --path"),
        ((*TOLERANT, "operation.speed", "--check-sobol", "8"), "takes no path"),
        ((*TOLERANT, "--check-sobol", "8", "-o", "a.txt"), "-o a.txt"),
        ((*TOLERANT, "--check-sobol", "8", "--figure", "oil_ratoi"), "did you mean 'oil_ratio'"),
    ],
)
def test_a_sample_that_cannot_be_is_refused_in_one_line(folder, command, rest, told):
    answer = command("sensitivity", "oiled.yaml", *rest)
    assert answer.code == 2
    assert told in answer.err


def test_a_file_tells_how_each_derivative_was_found(folder):
    found = {}
    for fine in (True, False):
        scene, file = screwsim.load(str(folder / "oiled.yaml")), folder / f"{fine}.h5"
        slopes = screwsim.sensitivities(scene, ["operation.speed"], fine=fine)
        save(file, scene, slopes.result, derivatives=slopes)
        found[slopes.method["operation.speed"]] = int(open_results(file).derivatives["number_exact"][0])
    assert found == {"exact": 1, "quick": 2}
