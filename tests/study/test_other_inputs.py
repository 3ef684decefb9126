"""The tolerance of an input that is not fitted moves the fitted values as a fit with another value of it does."""

import json
import math
import re
from dataclasses import replace

import pytest

from screwsim import simulate
from screwsim.cli import exit_code
from screwsim.printing.calibration import calibration_document, print_calibration
from screwsim.printing.posterior import print_posterior
from screwsim.scene import load, value_at, with_values
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration import other_inputs as other_inputs_module
from screwsim.study.calibration.answers import ParameterInterval, Posterior
from screwsim.study.calibration.other_inputs import errors_by_inputs, other_inputs
from screwsim.study.uncertainty import point

pytestmark = pytest.mark.around

CLEARANCE, BORE, WALL = "machine.clearance", "machine.bore", "effects.cylinder_heat.wall_temperature"
SCENE = """\
base: {base}
machine: {{bore: 200 mm ± 0.4 mm, clearance: 230 cm^3 ± 2 %}}
effects:
  ring_leakage: {{gap: 8 um}}
  cylinder_heat: {{wall_temperature: 370 K ± 8 K}}
uncertainty: {{correlated: [[machine.bore, machine.clearance]]}}
"""
FIT = """\
scene: machine.yaml
data: points.csv
parameters:
  effects.ring_leakage.gap: {from: 2 um, to: 20 um}
  effects.mechanical.fraction: {from: 0.02, to: 0.3}
starts: 1
accuracy: 1e-6
"""
FLOW, POWER = "gas_mass_flow [kg/s],gas_mass_flow_uncertainty [kg/s]", "shaft_power [W],shaft_power_uncertainty [W]"


@pytest.fixture(scope="module")
def fit_file(tmp_path_factory, request):
    """A fit of a machine to what it computes itself; three other inputs have tolerances, two of which err together."""
    folder = tmp_path_factory.mktemp("fit")
    text = SCENE.format(base=request.config.rootpath / "configs/slider_crank/air.yaml")
    (folder / "machine.yaml").write_text(text, encoding="utf-8")
    rows = [f"operation.speed [rpm],{FLOW},{POWER}"]
    for rpm in (500, 720, 900):
        found = simulate(load(folder / "machine.yaml").with_({"operation.speed": f"{rpm} rpm"})).performance
        flow, power = found["gas_mass_flow"], found["shaft_power"]
        rows.append(f"{rpm},{flow},{0.01 * flow},{power},{0.01 * power}")
    (folder / "points.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "small.fit.yaml").write_text(FIT, encoding="utf-8")
    return folder / "small.fit.yaml"


def test_the_shift_by_another_input_is_that_of_a_fit_with_its_other_value(fit_file):
    fit = read_fit(fit_file)
    found = calibrate(fit, jobs=1)
    assert [shift.paths for shift in found.shifts] == [(BORE, CLEARANCE), (WALL,)]
    for shift in found.shifts:
        ends = []
        for way in (1.0, -1.0):
            at = {path: value_at(fit.scene, path) for path in shift.paths}
            off = {path: v + way * fit.scene.uncertain[path].standard_at(v) for path, v in at.items()}
            ends.append(calibrate(replace(fit, scene=with_values(fit.scene, off)), jobs=1).values)
        refitted = [0.5 * (ends[0][path] - ends[1][path]) for path in found.values]
        # searches end a few hundredths of a standard error from the least squares; slopes are those of 1 % differences
        for one, other, error in zip(shift.changes, refitted, found.certainty.errors, strict=True):
            assert one == pytest.approx(other, rel=0.03, abs=0.02 * error)
    gap = [shift.changes[0] for shift in found.shifts]
    assert errors_by_inputs(found.shifts, 2)[0] == pytest.approx((gap[0] ** 2 + gap[1] ** 2) ** 0.5)


def test_what_is_fitted_or_follows_is_no_other_input(fit_file):
    tied = FIT.replace("20 um}", f"20 um, also: {{{BORE}: {{factor: 1, offset: 199.99 mm}}}}}}")
    tied = tied.replace("starts: 1", f"  {WALL}: {{from: 350 K, to: 390 K}}\nstarts: 1")
    other = fit_file.with_name("tied.fit.yaml")
    other.write_text(tied, encoding="utf-8")
    assert other_inputs(read_fit(other)) == ((CLEARANCE,),)


def test_the_command_states_the_error_by_other_inputs_beside_that_of_the_points(fit_file, capsys):
    assert exit_code(["calibrate", str(fit_file), "--jobs", "1"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "by other inputs: standard error by the tolerances of inputs that are not fitted" in text
    assert exit_code(["calibrate", str(fit_file), "--jobs", "1", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    for name, each in document["parameters"].items():
        squares = [one["changes"][name] ** 2 for one in document["other_inputs"]]
        assert each["standard_error_by_other_inputs"] == pytest.approx(sum(squares) ** 0.5, rel=1e-12) and squares[0]


def test_a_posterior_says_what_it_takes_as_exact(fit_file):
    from screwsim.printing.posterior import _notes, posterior_document

    found = Posterior(read_fit(fit_file), "ok", "", r_hat=1.0, autocorrelation=1.0, effective=1.0)
    told = " ".join(_notes(found))
    assert f"intervals take {BORE}, {CLEARANCE}, {WALL} as exact" in told
    assert posterior_document(found)["taken_as_exact"] == [BORE, CLEARANCE, WALL]


def test_a_posterior_says_how_wide_the_tolerances_of_other_inputs_make_it(fit_file, capsys):
    """Linear, at the level of its intervals: 1.645 standard errors."""
    found = calibrate(read_fit(fit_file), jobs=2)
    spreads = tuple(ParameterInterval(path, 0.9 * v, v, 1.1 * v, 0.06 * v) for path, v in found.values.items())
    print_posterior(found, Posterior(found.fit, "ok", "", spreads, r_hat=1.0, autocorrelation=1.0, effective=1.0))
    told = capsys.readouterr().out
    gap = 1.6448536 * errors_by_inputs(found.shifts, 2)[0]
    assert re.search(rf"ring_leakage.gap .* {1e6 * gap:.2g} um$", told, re.MULTILINE), told
    assert "by the tolerances of inputs that are not fitted" in " ".join(told.split())
    exact = replace(found, shifts=())
    print_posterior(exact, Posterior(found.fit, "ok", "", spreads, r_hat=1.0, autocorrelation=1.0, effective=1.0))
    assert "by other inputs" not in capsys.readouterr().out


def test_an_input_without_a_derivative_at_one_point_is_in_no_shift_and_named(fit_file, monkeypatch, capsys):
    """The fit lost the shifts by all inputs."""
    original = point.sensitivities

    def lost_at_720_rpm(scene, paths, *asked, **more):
        found = original(scene, paths, *asked, **more)
        if scene.operation.speed != pytest.approx(24.0 * math.pi):
            return found
        values = {path: value for path, value in found.values.items() if path != WALL}
        return replace(found, values=values, left_out={WALL: "failed: too hot"})

    whole = calibrate(read_fit(fit_file), jobs=2)
    monkeypatch.setattr(point, "sensitivities", lost_at_720_rpm)
    found = calibrate(read_fit(fit_file), jobs=1)
    assert (found.status, found.message, found.shifts) == ("ok", "", whole.shifts[:1])
    ((path, why),) = found.left_out.items()
    assert path == WALL and why.endswith(": failed: too hot") and not whole.left_out
    assert calibration_document(found)["left_out"] == found.left_out
    print_calibration(found)
    told = f"warning: the tolerance of {WALL} is not included in the uncertainties: at"
    assert told in " ".join(capsys.readouterr().out.split())


def test_shifts_by_other_inputs_are_found_by_as_many_workers_as_the_starts(fit_file, monkeypatch):
    asked, original = [], other_inputs_module.parallel_map
    monkeypatch.setattr(
        other_inputs_module, "parallel_map", lambda *a, **more: asked.append(more["jobs"]) or original(*a, **more)
    )
    calibrate(read_fit(fit_file), jobs=2)
    assert asked == [2]
