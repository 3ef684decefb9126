"""A fit: least squares of a linear model, its standard errors and correlation; what is not told apart; failures."""

import numpy as np
import pytest
from fit_fakes import (
    CAPACITY,
    DEGENERATE,
    FIT,
    GAP,
    POINTS,
    SCENE,
    Stopped,
    coordinates,
    hopeless,
    plane,
    product,
    torn,
    write_fit,
)
from scipy.optimize import lsq_linear

from screwsim.inputs.faults import Interrupted, UsageError
from screwsim.printing.calibration import _changes, print_calibration
from screwsim.scene import load
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.identifiability import certainty
from screwsim.study.calibration.solve import Start, best_start
from screwsim.study.scene_files import fitted_text

SLOPES = np.array([[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]])  # of kW over gap / 10 µm and capacity / (kJ/(kg K))
POWER, SIGMA = np.array([3.1, 5.2, 6.8]), np.array([0.1, 0.1, 0.2])


@pytest.fixture
def fit(tmp_path):
    return read_fit(write_fit(tmp_path))


def exact() -> tuple[np.ndarray, np.ndarray]:
    """Return the solution of the linear problem and its covariance."""
    weighted = SLOPES / SIGMA[:, None]
    covariance = np.linalg.inv(weighted.T @ weighted)
    return covariance @ weighted.T @ (POWER / SIGMA), covariance


def test_a_linear_fit_is_that_of_linear_algebra(fit):
    found = calibrate(fit, jobs=1, simulate=plane)
    x, covariance = exact()
    assert found.status == "ok"
    # the search ends at 1e-5 of the bounds' distance
    assert found.values[GAP] / 1e-5 == pytest.approx(x[0], abs=1e-3)
    assert found.values[CAPACITY] / 1e3 == pytest.approx(x[1], abs=1e-3)
    errors = np.array(found.certainty.errors) / (1e-5, 1e3)
    assert errors == pytest.approx(np.sqrt(np.diag(covariance)), rel=1e-6)  # differences of a linear function are exact
    r = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert found.certainty.correlation[0][1] == pytest.approx(r, rel=1e-6)
    left = (POWER - SLOPES @ x) / SIGMA
    assert found.chi_squared == pytest.approx(float(left @ left), rel=1e-4)
    assert found.freedom == 1


def test_tables_of_a_fit_have_its_numbers_in_si(fit):
    found = calibrate(fit, jobs=1, simulate=plane)
    points, parameters = found.to_pandas(), found.to_pandas("parameters")
    fitted = points[points.use == "fit"]
    assert float((fitted.residual**2).sum()) == pytest.approx(found.chi_squared)
    assert ((points.computed - points.measured) / points.uncertainty).to_numpy() == pytest.approx(
        points.residual.to_numpy()
    )
    assert list(fitted.measured) == pytest.approx(list(POWER * 1e3))  # of kW
    x, covariance = exact()
    left = (POWER - SLOPES @ x) / SIGMA
    scale = max(1.0, float(np.sqrt(left @ left)))  # of one degree of freedom
    assert dict(zip(parameters.parameter, parameters.units, strict=True)) == {GAP: "m", CAPACITY: "J/(kg K)"}
    expected = scale * np.sqrt(np.diag(covariance)) * (1e-5, 1e3)
    assert parameters.error.to_numpy() == pytest.approx(expected, rel=1e-3)
    with pytest.raises(UsageError, match=r"^table: 'starts' is not one of points, parameters$"):
        found.to_pandas("starts")


@pytest.mark.parametrize("sure", [1e3, 1e6])
def test_figures_that_are_off_by_many_uncertainties_count_as_all_others(sure, tmp_path):
    """All uncertainties a thousandth or a millionth of theirs: the same values, χ² as many times as large squared."""
    points = POINTS.replace(",0.1\n", f",{0.1 / sure}\n").replace(",0.2\n", f",{0.2 / sure}\n")
    found = calibrate(read_fit(write_fit(tmp_path, points=points)), jobs=1, simulate=plane)
    x, _ = exact()
    assert (found.status, found.freedom, found.reasons) == ("ok", 1, {})
    assert found.values[GAP] / 1e-5 == pytest.approx(x[0], abs=1e-3)
    assert found.values[CAPACITY] / 1e3 == pytest.approx(x[1], abs=1e-3)
    left = sure * (POWER - SLOPES @ x) / SIGMA
    assert found.chi_squared == pytest.approx(float(left @ left), rel=1e-3)


def test_no_search_goes_where_figures_have_no_solution_however_far_the_others_are_off(tmp_path):
    """Beyond a gap of 50 µm nothing is solved; what is there is off by a million uncertainties."""

    def bounded(scene):
        return plane(scene) if coordinates(scene)[0] < 5.0 else hopeless(scene)

    points = "operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n1000,90,1e-4\n2000,91,1e-4\n"
    found = calibrate(read_fit(write_fit(tmp_path, points=points)), jobs=1, simulate=bounded)
    assert found.reasons == {} and found.chi_squared > 1e10
    assert found.values[GAP] < 5e-5


def test_all_starts_of_a_linear_fit_are_as_good(fit):
    found = calibrate(fit, jobs=1, simulate=plane)
    assert found.as_good == (0, 1, 2)
    assert [start.status for start in found.starts] == ["ok"] * 3


def test_the_answer_does_not_depend_on_the_workers(fit):
    alone, two = (calibrate(fit, jobs=jobs, simulate=plane) for jobs in (1, 2))
    assert (alone.values, alone.starts) == (two.values, two.starts)


def test_points_to_check_are_predicted_and_not_fitted(fit):
    found = calibrate(fit, jobs=1, simulate=plane)
    checked = [each for each in found.compared if not each.point.fitted]
    assert [each.point.name for each in checked] == ["d"]
    x, _ = exact()
    assert checked[0].ours / 1e3 == pytest.approx(x[0] + 4.0 * x[1], abs=1e-3)


def test_a_product_is_said_not_to_be_told_apart(tmp_path):
    text = FIT.partition("parameters:")[0] + DEGENERATE
    found = calibrate(read_fit(write_fit(tmp_path, text)), jobs=1, simulate=product)
    (combination,) = found.certainty.open
    assert set(combination.paths) == {GAP, CAPACITY}
    assert "the data fix only their product" in combination.says
    assert combination.strength < 1e-3


def test_a_sum_of_both_at_one_speed_is_not_told_apart(tmp_path):
    points = "operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n" + "2000,5,0.1\n" * 3
    found = calibrate(read_fit(write_fit(tmp_path, points=points)), jobs=1, simulate=plane)
    (combination,) = found.certainty.open
    assert "indistinguishable" in combination.says


def test_a_parameter_alone_that_does_nothing_is_said_to(tmp_path):
    """Its singular value is the largest, and what it tells is less than the bounds do."""
    idle = FIT.partition("parameters:")[0] + "parameters:\n  operation.ambient_temperature: {from: 280 K, to: 300 K}\n"
    found = calibrate(read_fit(write_fit(tmp_path, idle)), jobs=1, simulate=plane)
    (combination,) = found.certainty.open
    assert combination.says == "no figure of these points depends on operation.ambient_temperature"


def test_a_parameter_that_does_nothing_has_no_standard_error_and_leaves_those_of_others(tmp_path, capsys):
    idle = FIT.replace("starts:", "  operation.ambient_temperature: {from: 280 K, to: 300 K}\nstarts:")
    with_idle = calibrate(read_fit(write_fit(tmp_path, idle)), jobs=1, simulate=plane)
    alone = calibrate(read_fit(write_fit(tmp_path, FIT)), jobs=1, simulate=plane)
    *errors, none = with_idle.certainty.errors
    assert none is None and with_idle.certainty.blank == {2}
    assert errors == pytest.approx(list(alone.certainty.errors), rel=1e-9)
    print_calibration(with_idle)
    out = capsys.readouterr().out
    assert "not determined" in next(line for line in out.splitlines() if line.startswith("ambient_temperature "))
    assert "e+" not in out


def test_told_apart_parameters_raise_no_warning(fit):
    assert calibrate(fit, jobs=1, simulate=plane).certainty.open == ()


def test_a_parameter_at_its_bound_is_named_and_has_no_error(tmp_path):
    text = FIT.replace("from: 10 um, to: 100 um", "from: 20 um, to: 100 um")  # the minimum lies at 11 µm
    found = calibrate(read_fit(write_fit(tmp_path, text)), jobs=1, simulate=plane)
    assert found.certainty.border == ("lower", "")
    assert found.certainty.errors[0] is None
    assert found.certainty.errors[1] > 0.0


def test_a_prior_pulls_with_its_weight(tmp_path):
    text = FIT.replace("to: 100 um}", "to: 100 um, prior: {mean: 20 um, deviation: 1 um}}")
    found = calibrate(read_fit(write_fit(tmp_path, text)), jobs=1, simulate=plane)
    x, covariance = exact()
    weight = np.linalg.inv(np.linalg.inv(covariance) + np.diag([1.0 / 0.1**2, 0.0]))
    expected = weight @ (np.linalg.inv(covariance) @ x + np.array([2.0 / 0.1**2, 0.0]))
    assert found.values[GAP] / 1e-5 == pytest.approx(expected[0], abs=1e-3)
    assert found.freedom == 2


def test_failed_points_are_counted_and_never_nan(fit):
    found = calibrate(fit, jobs=1, simulate=torn)
    assert found.status == "failed"
    assert found.failed > 0
    assert list(found.reasons) == ["c", "d"]
    assert "pressure left the range" in found.reasons["c"]
    assert np.isfinite(found.chi_squared)
    # the two points that are left fix both parameters: 3.1 = g + c, 5.2 = g + 2 c
    assert found.values[CAPACITY] / 1e3 == pytest.approx(2.1, abs=1e-3)


def test_without_any_solution_the_fit_fails_with_the_reason(fit):
    found = calibrate(fit, jobs=1, simulate=hopeless)
    assert (found.status, found.values) == ("failed", {})
    assert "pressure left the range" in found.message


@pytest.mark.parametrize(
    ("costs", "ends", "best"),
    [
        ((7.005, 7.002, 7.0), (0.2, 0.5, 0.9), 0),  # along a valley: rounding does not choose
        ((7.005, 7.002, 7.0), (0.50, 0.51, 0.52), 2),  # one minimum
        ((7.02, 7.005, 7.0), (0.2, 0.5, 0.9), 1),  # the first is another, worse one
        ((np.inf, 7.005, 7.0), (0.2, 0.5, 0.9), 1),
        ((np.inf, np.inf), (0.2, 0.9), 0),
    ],
)
def test_of_starts_that_fit_alike_and_lie_apart_the_first_is_taken(costs, ends, best):
    pairs = zip(costs, ends, strict=True)
    starts = [Start("ok" if np.isfinite(cost) else "failed", "", (0.5,), (end,), cost) for cost, end in pairs]
    assert best_start(starts, 10) is starts[best]


@pytest.mark.parametrize("status, costs", [("not converged", (7.005, 7.0)), ("ok", (1e8 + 5e4, 1e8 + 5.0))])
def test_a_worse_start_is_not_taken_for_alike_where_it_ended_otherwise_or_has_no_solution(status, costs):
    starts = [Start(status, "", (0.5,), (0.2,), costs[0]), Start("ok", "", (0.5,), (0.9,), costs[1])]
    assert best_start(starts, 10) is starts[1]


@pytest.mark.parametrize(
    "slopes",
    [
        np.array([[100.0, 50.0], [0.0, 0.5]]),  # the data hardly constrain the second
        np.array([[100.0, 50.0], [0.0, 4.0]]),
    ],
)
def test_errors_beside_a_parameter_at_a_bound_are_those_of_many_such_fits(slopes, fit):
    """Linear fits to noise: the root mean square of (found - truth) / error of the first, where the second is bound."""
    random, off = np.random.default_rng(1), []
    for _ in range(600):
        truth = np.array([0.5, random.random()])
        data = slopes @ truth + random.standard_normal(2)
        places = lsq_linear(slopes, data, (0.0, 1.0), method="bvls").x
        known = certainty(fit.parameters, places, slopes, slopes @ places - data)
        if known.border[1] and not known.border[0]:
            size = fit.parameters[0].slope(fit.parameters[0].value(places[0]))
            off.append((places[0] - truth[0]) / (known.errors[0] / size))
    assert len(off) > 30
    assert 0.7 < np.sqrt(np.mean(np.square(off))) < 1.3


def test_an_interruption_is_raised_and_has_the_best_so_far(fit):
    with pytest.raises(Interrupted, match="best so far") as raised:
        calibrate(fit, jobs=1, simulate=Stopped())
    found = raised.value.found
    assert isinstance(raised.value, KeyboardInterrupt) and found.status == "interrupted"
    assert found.values
    assert "best so far" in found.message


def test_the_fitted_scene_loads_with_the_fitted_values(fit, tmp_path):
    found = calibrate(fit, jobs=1, simulate=plane)
    (tmp_path / "out").mkdir()
    target = tmp_path / "out" / "scene.yaml"
    target.write_text(fitted_text(found, tmp_path / "out"), encoding="utf-8")
    scene = load(target)
    # seven digits are written
    assert scene.effects["tip_leakage"].parameters.gap == pytest.approx(found.values[GAP], rel=1e-6)
    assert scene.oil.heat_capacity == pytest.approx(found.values[CAPACITY], rel=1e-6)
    assert scene.title == "two unknowns, fitted"


def test_a_path_that_follows_is_changed_too(tmp_path):
    text = FIT.replace(
        "  oil.heat",
        "  machine.discharge_port.opens: {from: 590 deg, to: 610 deg, also: "
        "{machine.discharge_port.phi_C: {offset: 40 deg}}}\n  oil.heat",
    )
    fit = read_fit(write_fit(tmp_path, text))
    machine = fit.machine(fit.first_start()).machine.discharge_port
    assert machine.phi_C - machine.opens == pytest.approx(np.radians(40.0))


@pytest.mark.parametrize(("spread", "doubted"), [(0.11, False), (0.5, True)])
def test_a_fit_is_doubted_where_chance_hardly_makes_such_residuals(spread, doubted, tmp_path, capsys):
    """Three residuals of a line in two unknowns leave one degree of freedom."""
    rows = [
        f"{name},fit,{1000 * n},{1.0 + 2.0 * n + off},0.1"
        for name, n, off in zip("abc", (1, 2, 3), (0, 2 * spread, 0), strict=True)
    ]
    points = "name,use,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n" + "\n".join(rows) + "\n"
    print_calibration(calibrate(read_fit(write_fit(tmp_path, points=points)), jobs=1, simulate=plane))
    out = " ".join(capsys.readouterr().out.split())
    assert "the residuals exceed the stated uncertainties, which chance alone does in" in out
    assert ("the model or the uncertainties do not suit the data" in out) == doubted


@pytest.mark.parametrize(("fluid", "told"), [("R407C", True), ("R407C.mix", False), ("R134a", False)])
def test_a_fit_says_that_condensing_temperatures_of_its_points_are_not_dew_points(fluid, told, tmp_path, capsys):
    """Makers' sheets have dew points: of R407C at 40 °C of its bubble point 4.9 K above, by CoolProp."""
    pressures = "  suction: {pressure: 1.5 bar, temperature: 283 K}\n  discharge: {pressure: 12 bar}\n"
    lines = "  evaporating_temperature: 0 degC\n  condensing_temperature: 40 degC\n  superheat: 10 K\n"
    machine = SCENE.replace(pressures, lines).replace("R134a", fluid)
    print_calibration(calibrate(read_fit(write_fit(tmp_path, scene=machine)), jobs=1, simulate=plane))
    out = " ".join(capsys.readouterr().out.split())
    assert ("dew point in the condenser, of R407C 4.9 K above the bubble point" in out) == told


@pytest.mark.parametrize(
    ("typos", "named"),
    [
        ({}, ""),
        ({5: 90.0}, "1 of 20 numbers (e5: shaft power "),
        ({5: 90.0, 7: -60.0}, "(e5: shaft power "),
        (dict.fromkeys(range(0, 12, 2), 90.0), ""),  # many: not mistakes of the table
    ],
)
def test_the_few_numbers_that_make_up_most_of_the_misfit_are_named(typos, named, tmp_path, capsys):
    head = "name,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n"
    rows = [f"e{n},{500 * (n + 1)},{3.0 + n + typos.get(n, 0.0)},0.1\n" for n in range(20)]
    print_calibration(calibrate(read_fit(write_fit(tmp_path, points=head + "".join(rows))), jobs=1, simulate=plane))
    out = " ".join(capsys.readouterr().out.split())
    assert ("of chi squared comes from" in out) == bool(named)
    assert named in out
    assert ("in fewer than 1e-06 of all cases" in out) == bool(typos)


def test_one_typing_error_among_few_numbers_is_named(tmp_path, capsys):
    head = "name,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n"
    rows = [f"e{n},{500 * (n + 1)},{3.0 + n + 1.0 * (n == 2)},0.1\n" for n in range(6)]
    print_calibration(calibrate(read_fit(write_fit(tmp_path, points=head + "".join(rows))), jobs=1, simulate=plane))
    out = " ".join(capsys.readouterr().out.split())
    assert "of chi squared comes from 1 of 6 numbers (e2: shaft power -" in out and "σ): check it;" in out


def test_a_fit_says_by_how_much_it_changed_the_scene(fit):
    found = calibrate(fit, jobs=1, simulate=plane)
    gap, capacity = fit.scene.effects["tip_leakage"].parameters.gap, fit.scene.oil.heat_capacity
    for told, value, start in zip(_changes(found), found.values.values(), (gap, capacity), strict=True):
        assert told.endswith((f" {value / start - 1.0:+.1%}", f" × {value / start:.3g}"))
        assert ("×" in told) == (not 0.5 < value / start < 2.0)
