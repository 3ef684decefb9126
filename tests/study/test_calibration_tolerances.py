"""A scene's tolerance is the prior of a fitted parameter that has none: a linear fit is that of linear algebra."""

import json
import math
import sys

import numpy as np
import pytest
from fit_fakes import CAPACITY, FIT, GAP, HEAD, POINTS, SCENE, plane, write_fit

from screwsim.cli import exit_code
from screwsim.inputs.faults import SceneError
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.fit import GROUP_CORRELATION as CORRELATION
from screwsim.study.calibration.fit import Prior
from screwsim.study.calibration.plan import candidates_of, plan
from screwsim.study.calibration.posterior import posterior
from screwsim.study.calibration.read import fit_schema

pytestmark = pytest.mark.around


VAGUE = HEAD + "a,fit,1000,7,500\nb,fit,2000,9,500\n"  # tell nothing
ONE_SPEED = HEAD + "".join(
    f"p{i},fit,2000,{10.0 + off},0.02\n" for i, off in enumerate((-0.02, -0.01, 0.0, 0.01, 0.02))
)
ALONE = "oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K), start: 1.5 kJ/(kg K)}"


def tolerant(gap: str = "50 um", capacity: str = "2 kJ/(kg K)") -> str:
    """Return the scene with other texts of the two values that are fitted."""
    return SCENE.replace("gap: 50 um", f"gap: {gap}").replace(
        "heat_capacity: 2 kJ/(kg K)", f"heat_capacity: {capacity}"
    )


def fitted(folder, scene, fit=FIT, points=POINTS):
    return calibrate(read_fit(write_fit(folder, fit, points, scene)), jobs=1, simulate=plane)


def test_a_tolerance_pulls_as_the_prior_of_half_its_size(tmp_path):
    own = FIT.replace("to: 100 um}", "to: 100 um, prior: {mean: 20 um, deviation: 1 um}}")
    stated = fitted(tmp_path, tolerant(), own)
    found = fitted(tmp_path, tolerant("20 um ± 2 um"))
    assert found.values == pytest.approx(stated.values, rel=1e-6) and found.freedom == stated.freedom == 2
    assert found.certainty.errors == pytest.approx(stated.certainty.errors, rel=1e-6)
    assert found.values[GAP] != pytest.approx(fitted(tmp_path, tolerant("20 um")).values[GAP], rel=0.05)


def test_a_sum_is_shared_by_the_tolerances_as_linear_algebra_has_it(tmp_path):
    # at 2000 rpm 10 kW = gap + 2 capacity, whose tolerances are 2 and 2 · 0.4 kW: standard ones 1 and 0.4
    found = fitted(tmp_path, tolerant("50 um ± 20 um", "2 kJ/(kg K) ± 20 %"), points=ONE_SPEED)
    gap, deviation = 5.0 + 1.0 / 1.16, math.sqrt(0.16 / 1.16)
    assert found.values[GAP] * 1e5 == pytest.approx(gap, abs=2e-3)
    assert found.certainty.errors[0] * 1e5 == pytest.approx(deviation, rel=1e-3)
    wide = posterior(found, jobs=1, simulate=plane, most_steps=4000)
    assert wide.parameters[0].median * 1e5 == pytest.approx(gap, abs=0.1 * deviation)
    assert wide.parameters[0].deviation * 1e5 == pytest.approx(deviation, rel=0.1)
    assert wide.parameters[0].of_prior == pytest.approx(deviation, rel=0.1)


COARSE = HEAD + "".join(f"p{i},fit,2000,10,1\n" for i in range(5))
TOGETHER = f"uncertainty: {{correlated: [[{GAP}, {CAPACITY}]]}}\n"


def test_what_the_scene_says_errs_together_does_so_as_linear_algebra_has_it(tmp_path):
    # at 2000 rpm 10 kW = gap + 2 capacity within 1/sqrt(5); gap 5 + z, capacity 2 + 0.2 z, of one z: 9 + 1.4 z = 10
    scene = tolerant("50 um ± 20 um", "2 kJ/(kg K) ± 20 %") + TOGETHER
    found = fitted(tmp_path, scene, points=COARSE)
    information = 1.0 + 5.0 * 1.4**2
    z, deviation = 5.0 * 1.4 / information, information**-0.5
    for path, mean, size in ((GAP, 50e-6, 10e-6), (CAPACITY, 2000.0, 200.0)):
        i = list(found.values).index(path)
        assert found.values[path] == pytest.approx(mean + z * size, abs=5e-3 * size)
        assert found.certainty.errors[i] == pytest.approx(deviation * size, rel=1e-2)
    # as correlated beforehand, of which the points have narrowed the common part
    across = 0.5 * (1.0 - CORRELATION)
    assert found.certainty.correlation[0][1] == pytest.approx(1.0 - 2.0 * across / deviation**2, abs=3e-3)
    assert found.certainty.open == ()  # it is the scene that holds them together
    wide = posterior(found, jobs=1, simulate=plane, most_steps=6000)
    assert wide.status == "ok"
    gap, capacity = (wide.samples[:, 0] - 50e-6) / 10e-6, (wide.samples[:, 1] - 2000.0) / 200.0
    assert np.corrcoef(gap, capacity)[0, 1] > 0.99
    # the discrepancy's width is sampled, too, and leaves the points less to say: between theirs alone and the prior's
    assert deviation < gap.std() < 1.0 and 0.0 < gap.mean() < z + 0.05


@pytest.mark.parametrize("spacing", ["linear", "log"])
def test_where_the_points_tell_nothing_the_posterior_is_what_errs_together(tmp_path, spacing):
    fit = FIT.replace("to: 100 um}", f"to: 200 um, spacing: {spacing}}}")
    scene = tolerant("50 um ×/÷ 1.5", "2 kJ/(kg K) ± 10 %") + TOGETHER
    found = posterior(fitted(tmp_path, scene, fit, VAGUE), jobs=1, simulate=plane)
    gap, capacity = np.log(found.samples[:, 0] / 50e-6) / (0.5 * math.log(1.5)), (found.samples[:, 1] - 2000.0) / 100.0
    assert found.status == "ok"
    error = 4.0 / min(len(gap), found.effective) ** 0.5
    for each in (gap, capacity):
        assert each.mean() == pytest.approx(0.0, abs=error) and each.std() == pytest.approx(1.0, abs=error)
    assert np.std(gap - capacity) == pytest.approx((2.0 * (1.0 - CORRELATION)) ** 0.5, rel=0.2)


def test_a_plan_knows_beforehand_what_errs_together(tmp_path):
    scene = tolerant("50 um ± 20 um", "2 kJ/(kg K) ± 20 %") + TOGETHER
    fit = read_fit(write_fit(tmp_path, FIT, COARSE, scene))
    found = plan(fit, candidates_of(fit, paths=["operation.speed=1000 rpm..5000 rpm"]), count=1, jobs=1, simulate=plane)
    assert found.before == pytest.approx(calibrate(fit, jobs=1, simulate=plane).certainty.errors, rel=1e-3)


def test_only_what_the_scenes_tolerances_hold_is_held_together(tmp_path):
    scene = tolerant("50 um ± 20 um", "2 kJ/(kg K) ± 20 %") + TOGETHER
    assert read_fit(write_fit(tmp_path, FIT, COARSE, scene)).with_priors().together == ((0, 1),)
    for prior in ("none", "{mean: 50 um, deviation: 10 um}"):
        own = FIT.replace("to: 100 um}", f"to: 100 um, prior: {prior}}}")
        assert read_fit(write_fit(tmp_path, own, COARSE, scene)).with_priors().together == ()


@pytest.mark.parametrize("spacing", ["linear", "log"])
@pytest.mark.parametrize(
    ("text", "low", "high"),
    [
        ("50 um ± 20 um", 50.0 - 1.645 * 10.0, 50.0 + 1.645 * 10.0),
        ("50 um ×/÷ 1.5", 50.0 * 1.5 ** (-1.645 / 2.0), 50.0 * 1.5 ** (1.645 / 2.0)),
    ],
)
def test_where_the_points_tell_nothing_the_posterior_is_the_tolerance(tmp_path, text, low, high, spacing):
    fit = FIT.replace("to: 100 um}", f"to: 200 um, spacing: {spacing}}}").replace(f"  {ALONE}\n", "")
    found = fitted(tmp_path, tolerant(text), fit, VAGUE)
    sampled = posterior(found, jobs=1, simulate=plane, most_steps=4000)
    spread, deviation = sampled.parameters[0], (high - low) / (2.0 * 1.645)
    by_chance = 4.0 * deviation / min(len(sampled.samples), sampled.effective) ** 0.5  # of a mean
    # quantiles of normal samples err by more: 1.25 times that in the middle, 2.1 at both ends
    assert spread.median * 1e6 == pytest.approx(50.0, abs=1.25 * by_chance)  # without the spacing's density 2 um off
    assert spread.low * 1e6 == pytest.approx(low, abs=2.1 * by_chance)
    assert spread.high * 1e6 == pytest.approx(high, abs=2.1 * by_chance)
    assert spread.of_prior == pytest.approx(1.0, abs=2.1 * by_chance / deviation)


@pytest.mark.parametrize("spacing", ["linear", "log"])
def test_a_prior_of_the_fit_is_normal_in_the_value_whatever_the_spacing(tmp_path, spacing):
    prior = "prior: {mean: 50 um, deviation: 12 um}"
    fit = FIT.replace("to: 100 um}", f"to: 200 um, spacing: {spacing}, {prior}}}").replace(f"  {ALONE}\n", "")
    found = posterior(fitted(tmp_path, tolerant(), fit, VAGUE), jobs=1, simulate=plane, most_steps=4000)
    values = 1e6 * found.samples[:, 0]
    many = min(len(values), found.effective)
    # normal between 10 and 200 um: the end cuts off 3.3 deviations below; without the density of the spacing 2.9 off
    assert values.mean() == pytest.approx(50.0, abs=4.0 * 12.0 / many**0.5 + 0.03)
    assert values.std() == pytest.approx(12.0, abs=4.0 * 12.0 / (2.0 * many) ** 0.5 + 0.06)


def test_a_factor_pulls_in_the_logarithm(tmp_path):
    fit, points = FIT.replace(f"  {ALONE}\n", ""), HEAD + "a,fit,1000,3,1\n"
    found = fitted(tmp_path, tolerant("50 um ×/÷ 2"), fit, points)
    gap, deviation = found.values[GAP] * 1e5, 0.5 * math.log(2.0)
    # chi squared of a gap in 10 um: 1 of them is what 2 kJ/(kg K) at 1000 rpm leave of 3 kW
    grid = np.linspace(1.0, 10.0, 9001)
    least = float(np.min((grid - 1.0) ** 2 + (np.log(grid / 5.0) / deviation) ** 2))
    assert found.status == "ok"
    assert (gap - 1.0) ** 2 + (math.log(gap / 5.0) / deviation) ** 2 == pytest.approx(least, abs=5e-3)
    assert found.chi_squared == pytest.approx(least, abs=5e-3)
    prior = Prior(5e-5, deviation, logarithmic=True)
    assert prior.off(0.0) < -20.0 and math.isfinite(prior.slope(0.0))  # bounds may begin at nothing


def test_none_leaves_a_tolerance_out_and_a_prior_counts_before_it(tmp_path):
    none = FIT.replace("to: 100 um}", "to: 100 um, prior: none}")
    own = FIT.replace("to: 100 um}", "to: 100 um, prior: {mean: 30 um, deviation: 3 um}}")
    bare = fitted(tmp_path, tolerant())
    assert fitted(tmp_path, tolerant("50 um ± 5 um"), none).values == bare.values
    assert fitted(tmp_path, tolerant(), none).values == bare.values
    assert fitted(tmp_path, tolerant("50 um ± 5 um"), own).values == fitted(tmp_path, tolerant(), own).values


def test_the_schema_knows_none_and_no_other_word(tmp_path):
    prior = fit_schema()["properties"]["parameters"]["properties"][GAP]["properties"]["prior"]
    assert {"const": "none"} in prior["anyOf"] and {"mean", "deviation"} == set(prior["anyOf"][0]["properties"])
    with pytest.raises(SceneError, match=r"gap\.prior: 'free' is not a mapping .*or none"):
        read_fit(write_fit(tmp_path, FIT.replace("to: 100 um}", "to: 100 um, prior: free}")))


def test_a_plan_knows_beforehand_what_the_fit_does(tmp_path):
    scene = tolerant("50 um ×/÷ 1.5", "2 kJ/(kg K) ± 10 %")
    fit = read_fit(write_fit(tmp_path, FIT, HEAD + "a,fit,2000,9,0.09\n", scene))  # one point: tolerances fix it
    found = plan(fit, candidates_of(fit, paths=["operation.speed=1000 rpm..5000 rpm"]), count=1, jobs=1, simulate=plane)
    assert found.even == ()
    assert found.before == pytest.approx(calibrate(fit, jobs=1, simulate=plane).certainty.errors, rel=1e-3)
    none = FIT.replace("to: 100 um}", "to: 100 um, prior: none}")
    fit = read_fit(write_fit(tmp_path, none, HEAD + "a,fit,2000,9,0.09\n", scene))
    found = plan(fit, candidates_of(fit, paths=["operation.speed=1000 rpm..5000 rpm"]), count=1, jobs=1, simulate=plane)
    assert found.even == (GAP,)


def test_a_value_with_a_tolerance_outside_the_bounds_is_located(tmp_path):
    file = write_fit(tmp_path, FIT.replace("to: 100 um}", "to: 40 um}"), POINTS, tolerant("50 um ± 5 um"))
    with pytest.raises(SceneError) as refused:
        read_fit(file)
    (line,) = str(refused.value).splitlines()
    assert "small.fit.yaml:5:28: parameters.effects.tip_leakage.gap: is 0.05 mm with a tolerance in the scene" in line
    assert line.endswith("outside 0.01 mm … 0.04 mm (widen from and to, or write prior: none)")
    read_fit(
        write_fit(tmp_path, FIT.replace("to: 100 um}", "to: 40 um, prior: none}"), POINTS, tolerant("50 um ± 5 um"))
    )


@pytest.mark.parametrize(
    ("prior", "column", "told"),
    [
        ("{mean: 20 bar, deviation: 1 um}", 68, ".mean: '20 bar' is not a length"),
        ("{mean: 20 um, deviation: 1 bar}", 86, ".deviation: '1 bar' is not a length"),
        ("{mean: 20 um, deviation: -1 um}", 86, ".deviation: '-1 um' is out of range (it must be greater than 0 mm)"),
        ("{mean: 200 um, deviation: 1 um}", 68, ".mean: lies outside 0.01 mm … 0.1 mm (move it, or widen from and to)"),
    ],
)
def test_a_prior_that_cannot_be_is_told_at_its_line(tmp_path, prior, column, told):
    fit = FIT.replace("to: 100 um}", f"to: 100 um, prior: {prior}}}")
    with pytest.raises(SceneError) as refused:
        read_fit(write_fit(tmp_path, fit))
    (line,) = str(refused.value).splitlines()
    assert f"small.fit.yaml:5:{column}: parameters.{GAP}.prior{told}" in line


def test_a_prior_of_what_is_no_parameter_is_told_at_its_line(tmp_path):
    fit = FIT.replace("effects.tip_leakage.gap:", "effects.tip_leakage.gapp:").replace("um}", "um, prior: none}")
    with pytest.raises(SceneError, match=r"small\.fit\.yaml:5:3: .*gapp: is not known; did you mean '.*\.gap'"):
        read_fit(write_fit(tmp_path, fit))


@pytest.mark.parametrize(
    ("group", "told"),
    [
        (f"[{GAP}, {GAP}]", f"'{GAP}' is listed twice (name it once)"),
        (f"[{GAP}, {CAPACITY}, 1.5]", "1.5 is not a path; a group is fully correlated and has no coefficient"),
        (f"[{GAP}, oil.density]", "'oil.density' has no tolerance in this scene"),
    ],
)
def test_a_group_that_cannot_be_is_told_at_its_line(tmp_path, group, told):
    scene = tolerant("50 um ± 20 um", "2 kJ/(kg K) ± 20 %") + f"uncertainty: {{correlated: [{group}]}}\n"
    with pytest.raises(SceneError) as refused:
        read_fit(write_fit(tmp_path, FIT, COARSE, scene))
    (line,) = str(refused.value).splitlines()
    assert f"machine.yaml:{len(scene.splitlines())}:" in line and f"uncertainty.correlated: {told}" in line


def test_the_command_says_by_which_tolerance_a_parameter_is_held(tmp_path, capsys, monkeypatch):
    from screwsim.simulate import warm_up

    monkeypatch.setattr("screwsim.study.calibration.residuals.WarmSimulation", lambda trace: plane)
    monkeypatch.setattr(sys.modules[warm_up.__module__], "warm_up", lambda scene: None)

    def told(scene: str, fit: str = FIT) -> str:
        assert exit_code(["calibrate", str(write_fit(tmp_path, fit, POINTS, scene)), "--jobs", "1"]) == 0
        return capsys.readouterr().out

    both = told(tolerant("20 um ± 2 um", "2 kJ/(kg K) ×/÷ 1.1"))
    assert "prior from the scene's tolerance" in " ".join(both.split())
    rows = {line.split()[0]: line for line in both.splitlines() if "±" in line or "×/÷" in line}
    assert rows["gap"].endswith("0.02 ± 0.002") and rows["heat_capacity"].endswith("×/÷ 1.1")
    none = told(tolerant("20 um ± 2 um"), FIT.replace("to: 100 um}", "to: 100 um, prior: none}"))
    assert "none (left out)" in none
    assert "tolerance" not in told(tolerant())
    file = write_fit(tmp_path, FIT, POINTS, tolerant("20 um ± 2 um"))
    assert exit_code(["calibrate", str(file), "--jobs", "1", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)["parameters"]
    prior = document[GAP]["prior"]
    assert (prior["distribution"], prior["stated_in"]) == ("normal", "scene")
    assert np.array([prior["mean"], prior["deviation"]]) == pytest.approx([20e-6, 1e-6])
    assert document[CAPACITY]["prior"] is None
