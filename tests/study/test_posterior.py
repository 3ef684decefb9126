"""The posterior of a fit: a linear one is that of linear algebra, intervals cover, what is not told is said."""

import json
import sys

import h5py
import numpy as np
import pytest
from fit_fakes import CAPACITY, GAP, HEAD, ONE_START, coordinates, hopeless, plane, product, write_fit

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Figures, Result
from screwsim.printing import posterior as printed
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.emulator import terms
from screwsim.study.calibration.fit import Fit, Measurement, Point
from screwsim.study.calibration.posterior import CONVERGED_R_HAT, TOLERATED_ERROR, posterior, split_r_hat
from screwsim.study.calibration.predict import predict

pytestmark = pytest.mark.around


def points(seed: int, fitted: int, checked: int, discrepancy: float, noise: float = 0.05) -> str:
    """Return points of 2 + 2 n kW, n in 1000 rpm, with a deviation of the model at each, and noise of measurement."""
    generator = np.random.default_rng(seed)
    rows = []
    for number in range(fitted + checked):
        n = generator.uniform(1.0, 5.0)
        power = 2.0 + 2.0 * n + discrepancy * generator.standard_normal() + noise * generator.standard_normal()
        rows.append(f"p{number},{'fit' if number < fitted else 'check'},{1e3 * n:.3f},{power:.6f},{noise}")
    return HEAD + "\n".join(rows) + "\n"


def sampled(folder, text, simulate=plane, fit=ONE_START, **how):
    found = calibrate(read_fit(write_fit(folder, fit, text)), jobs=1, simulate=simulate)
    return found, posterior(found, jobs=1, simulate=simulate, **how)


def test_without_discrepancy_the_widths_are_those_of_linear_algebra(tmp_path):
    """Given the width the parameters are normal, and that of the width alone is an integral over one number."""
    text, noise = points(3, 40, 0, 0.0), 50.0
    found, wide = sampled(tmp_path, text, most_steps=6000)
    speed, power = np.loadtxt(text.splitlines()[1:], delimiter=",", usecols=(2, 3)).T
    design = np.column_stack([np.ones(40), speed / 1e3])
    _, squares, *_ = np.linalg.lstsq(design, 1e3 * power)
    widths = noise * np.exp(np.linspace(-9.0, 7.0, 4001))
    variance, ratio = noise**2 + widths**2, widths / noise
    weight = -19.0 * np.log(variance) - 0.5 * squares / variance + np.log(ratio) - np.log1p(ratio**2)
    weight = np.exp(weight - weight.max())
    more = np.sqrt(np.sum(weight * variance) / np.sum(weight)) / noise
    assert 1.0 < more < 1.2
    for spread, error in zip(wide.parameters, found.certainty.errors, strict=True):
        assert spread.deviation == pytest.approx(more * error, rel=0.04)
    assert wide.r_hat < CONVERGED_R_HAT and wide.off < 1e-6 and wide.status == "ok"


def test_intervals_cover_held_out_points_of_a_machine_with_a_discrepancy(tmp_path):
    inside = []
    for seed in range(4):
        folder = tmp_path / str(seed)
        folder.mkdir()
        _, wide = sampled(folder, points(seed, 40, 80, 0.2), most_steps=800)
        inside += [each.inside for each in wide.predicted if not each.fitted]
    assert len(inside) == 320
    assert 0.85 <= np.mean(inside) <= 0.95


def test_polynomials_that_bend_the_posterior_are_said(tmp_path):
    """Over its logarithm the gap is no polynomial: off by less than an uncertainty, but at every point the same way."""
    fit = ONE_START.replace("to: 100 um}", "to: 100 um, spacing: log}")
    generator = np.random.default_rng(5)
    n = generator.uniform(1.0, 5.0, 10)
    power = 0.5 + 2.0 * n + 0.3 * generator.standard_normal(10)  # the gap lies at its bound
    rows = [f"p{i},fit,{1e3 * x:.6f},{y:.9f},0.3" for i, (x, y) in enumerate(zip(n, power, strict=True))]
    _, wide = sampled(tmp_path, HEAD + "\n".join(rows) + "\n", fit=fit, most_steps=2000)
    assert wide.off < TOLERATED_ERROR
    assert "the polynomials may shift the results by up to" in wide.message and wide.status == "not converged"


def test_a_tight_prior_is_the_posterior(tmp_path):
    prior = "{from: 1 kJ/(kg K), to: 3 kJ/(kg K), prior: {mean: 2 kJ/(kg K), deviation: 0.000001 kJ/(kg K)}}"
    with_prior = ONE_START.replace("{from: 1 kJ/(kg K), to: 3 kJ/(kg K)}", prior)
    _, wide = sampled(tmp_path, points(3, 10, 0, 0.0, 0.5), fit=with_prior, most_steps=4000)
    assert wide.status == "ok", wide.message
    assert wide.parameters[1].deviation == pytest.approx(1e-3, rel=0.1)


def test_the_width_of_the_discrepancy_is_found(tmp_path):
    _, wide = sampled(tmp_path, points(5, 60, 0, 0.3), most_steps=1500)
    (spread,) = wide.discrepancies
    assert spread.low < 300.0 < spread.high and spread.high < 2.0 * spread.low


def test_what_the_points_do_not_tell_is_as_wide_as_its_prior(tmp_path):
    # gap and capacity enter as their product alone, which at one speed is all that is measured
    rows = HEAD + "a,fit,1000,8,0.5\nb,fit,1000,8.2,0.5\n"
    _, wide = sampled(tmp_path, rows, product, most_steps=1500)
    capacity = wide.parameters[1]
    assert capacity.of_prior > 0.8


def test_a_prior_counts(tmp_path):
    prior = "{from: 1 kJ/(kg K), to: 3 kJ/(kg K), prior: {mean: 1.5 kJ/(kg K), deviation: 0.01 kJ/(kg K)}}"
    with_prior = ONE_START.replace("{from: 1 kJ/(kg K), to: 3 kJ/(kg K)}", prior)
    _, wide = sampled(tmp_path, points(3, 4, 0, 0.0, 0.5), fit=with_prior, most_steps=2000)
    assert wide.parameters[1].median == pytest.approx(1500.0, abs=5.0)
    assert wide.parameters[1].deviation == pytest.approx(10.0, rel=0.2)


def test_a_fit_without_a_solution_has_no_posterior(tmp_path):
    _, wide = sampled(tmp_path, points(3, 4, 0, 0.0), hopeless)
    assert wide.status == "failed" and "there is no fit to start from" in wide.message


def test_chains_that_disagree_have_not_settled():
    same = np.random.default_rng(1).standard_normal((1000, 8, 1))
    assert split_r_hat(same)[0] == pytest.approx(1.0, abs=0.01)
    assert split_r_hat(same + np.arange(8)[:, None])[0] > 1.5


def test_polynomials_have_all_products_of_two():
    x = np.array([[0.75, 0.0]])  # 0.5 and -1 of the region
    assert terms(x).tolist() == [[1.0, 0.5, -1.0, 0.25, -0.5, 1.0]]


def bent(scene):
    """Return a power that no polynomial of second degree follows."""
    gap, capacity, speed = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * (gap + capacity * speed + 20.0 * np.sin(8.0 * gap))))


def test_polynomials_that_do_not_follow_the_model_are_said(tmp_path):
    _, wide = sampled(tmp_path, points(3, 6, 0, 0.0, 0.5), bent, most_steps=1000)
    assert wide.status == "not converged" and "the polynomials are off by up to" in wide.message


def test_the_command_prints_and_writes_the_posterior(tmp_path, capsys, monkeypatch):
    from screwsim.simulate import warm_up

    file = write_fit(tmp_path, ONE_START, points(3, 8, 2, 0.1))
    monkeypatch.setattr("screwsim.study.calibration.residuals.WarmSimulation", lambda trace: plane)
    monkeypatch.setattr(sys.modules[warm_up.__module__], "warm_up", lambda scene: None)
    monkeypatch.setattr(Fit, "short_names", lambda fit: {GAP: "tip_leakage.gap", CAPACITY: "heat_capacity"})
    drawn, draw = [], printed.pairs_figure

    def seen(parameters, *arguments):
        drawn.extend(each.label for each in parameters)
        return draw(parameters, *arguments)

    monkeypatch.setattr(printed, "pairs_figure", seen)
    code = exit_code(["calibrate", str(file), "--posterior", "--jobs", "1", "-o", str(tmp_path / "out")])
    told = " ".join(capsys.readouterr().out.split())
    assert code == 0 and "effects.tip_leakage.gap" in told and "heat_capacity" in told
    assert "* not fitted: " in told and "R-hat 1.00" in told
    rows = (tmp_path / "out" / "posterior.csv").read_text().splitlines()
    assert rows[0] == f"{GAP} [m],{CAPACITY} [J/(kg K)],discrepancy_shaft_power [W]" and len(rows) == 4001
    assert drawn == ["tip leakage gap (µm)", "heat capacity (kJ/(kg K))"]
    assert {each.name for each in (tmp_path / "out").glob("posterior.*")} >= {"posterior.png", "posterior.pdf"}
    assert exit_code(["calibrate", str(file), "--posterior", "--jobs", "1", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)["posterior"]
    assert set(document["parameters"]) == {GAP, CAPACITY} and len(document["predicted"]) == 10


def fakes(monkeypatch):
    """Solve nothing: the plane answers commands and functions."""
    from screwsim.simulate import warm_up

    monkeypatch.setattr("screwsim.study.calibration.residuals.WarmSimulation", lambda trace: plane)
    monkeypatch.setattr(sys.modules[warm_up.__module__], "warm_up", lambda scene: None)


def test_predictions_of_a_linear_model_are_those_of_linear_algebra(tmp_path):
    noise, discrepancy, count = 0.05, 0.2, 60
    found, wide = sampled(tmp_path, points(7, count, 0, discrepancy, noise), most_steps=4000)
    rpm = np.pi / 30.0
    new = [
        Point("amid", {"operation.speed": 3000.0 * rpm}, {"shaft_power": Measurement(np.nan, 400.0)}),
        Point("afar", {"operation.speed": 20000.0 * rpm}, {"shaft_power": Measurement(99e3, 50.0)}),
    ]
    told = predict(wide, new, simulate=plane, jobs=1)
    assert told.status == "ok" and told.off < 1e-6
    speed = np.array([point.values["operation.speed"] / rpm / 1e3 for point in found.fit.points])
    power = np.array([point.measured["shaft_power"].value for point in found.fit.points])
    width = wide.discrepancies[0].median
    design = np.column_stack([np.ones(count), speed])  # power = 1 kW (gap / 10 um + capacity n)
    best = np.linalg.lstsq(design, power)[0]
    spread = np.linalg.inv(design.T @ design) * (width**2 + (1e3 * noise) ** 2)
    for each, n, measuring in zip(told.figures, (3.0, 20.0), (400.0, 50.0), strict=True):
        row = np.array([1.0, n])
        ours = np.sqrt(row @ spread @ row)
        assert each.parameters == pytest.approx(ours, rel=0.1)
        assert each.discrepancy == pytest.approx(width, rel=0.1) and each.measuring == measuring
        whole = np.sqrt(ours**2 + width**2 + measuring**2)
        assert each.median == pytest.approx(row @ best, abs=0.1 * whole)
        assert each.high - each.low == pytest.approx(2.0 * 1.645 * whole, rel=0.1)
    assert told.figures[0].inside is None and told.figures[1].inside is False


def test_a_point_without_a_solution_is_not_predicted_and_told(tmp_path):
    _, wide = sampled(tmp_path, points(3, 6, 0, 0.0, 0.5), most_steps=500)

    def torn_at_speed(scene):
        return hopeless(scene) if coordinates(scene)[2] > 6.0 else plane(scene)

    new = [Point(str(n), {"operation.speed": 1e3 * n * np.pi / 30.0}, {}) for n in (3, 7)]
    told = predict(wide, new, simulate=torn_at_speed, jobs=1)
    assert told.status == "failed" and told.message == "1 of 2 points have no solution"
    assert list(told.reasons) == ["7"] and "pressure left the range" in told.reasons["7"]
    assert [each.point for each in told.figures] == ["3"]


def test_the_command_predicts_other_points(tmp_path, capsys, monkeypatch):
    file, new, out = write_fit(tmp_path, ONE_START, points(3, 8, 0, 0.1)), tmp_path / "new.csv", tmp_path / "out"
    fakes(monkeypatch)
    new.write_text(
        "name,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\nx,6000,,0.4\ny,2000,9,0.1\n"
    )
    asked = ["calibrate", str(file), "--predict", str(new), "--jobs", "1"]
    assert exit_code([*asked, "-o", str(out)]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "shaft power [kW] x 13." in told and "9 outside" in told and "0 of 1 measured inside" in told
    with h5py.File(out / "predicted.h5") as data:
        assert [data[name].attrs["units"] for name in ("shaft_power_median", "operation_speed")] == [b"W", b"rad s-1"]
        assert data["shaft_power_measuring"][...].tolist() == [400.0, 100.0]
        ends = data["shaft_power_low"][0], data["shaft_power_median"][0], data["shaft_power_high"][0]
    assert ends[0] < 14e3 < ends[2] and ends[0] < ends[1] < ends[2]
    assert exit_code([*asked, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)["posterior"]["predictions"]
    assert document["points"][0]["conditions"] == {"operation.speed": pytest.approx(200.0 * np.pi)}
    assert document["points"][1]["inside"] is False and document["points"][0]["inside"] is None


def test_a_program_has_posterior_and_predictions(tmp_path, monkeypatch):
    file, new = write_fit(tmp_path, ONE_START, points(3, 8, 0, 0.1)), tmp_path / "new.csv"
    fakes(monkeypatch)
    new.write_text("operation.speed [rpm]\n3000\n")
    found = screwsim.posterior(file, predict=new, jobs=1)
    assert repr(found).startswith("Posterior: ok; R-hat 1.00") and GAP in repr(found)
    (told,) = found.predictions.figures
    usual = np.median([0.05 / (each.measured / 1e3) for each in found.predicted])
    assert told.measuring == pytest.approx(usual * told.median, rel=0.02)  # as well as the fit's points, in shares
    assert "line 2  shaft_power" in repr(found.predictions)
    again = screwsim.posterior(screwsim.calibrate(file, jobs=1), jobs=1)
    assert np.array_equal(again.samples, found.samples) and again.predictions is None


def test_points_that_cannot_be_predicted_are_told_where_they_are(tmp_path, monkeypatch):
    file, new = write_fit(tmp_path, ONE_START, points(3, 8, 0, 0.1)), tmp_path / "new.csv"
    fakes(monkeypatch)
    new.write_text("operation.speed [bar]\n3000\n")
    with pytest.raises(SceneError, match=r"new\.csv:1:1: operation\.speed: "):
        screwsim.posterior(file, predict=new)
    new.write_text("operation.speed [rpm],gas_mass_flow_uncertainty [kg/s]\n3000,0.1\n")
    with pytest.raises(UsageError, match="gas_mass_flow: is measured at no fitted point"):
        screwsim.posterior(file, predict=new)
    with pytest.raises(UsageError, match=r"nothing\.csv: is not a file"):
        screwsim.posterior(file, predict=tmp_path / "nothing.csv")
    with pytest.raises(UsageError, match="int is not a fit"):
        screwsim.posterior(3)


def test_the_pairs_are_drawn_within_the_picture_in_the_units_that_people_write(tmp_path):
    import matplotlib.pyplot as plt

    from screwsim.printing.posterior import _parameter_samples
    from screwsim.report.calibration import pairs_figure
    from screwsim.report.style import journal

    found, wide = sampled(tmp_path, points(3, 8, 0, 0.1), most_steps=300)
    two = [_parameter_samples(found, wide, i) for i in range(2)]
    assert [each.label for each in two] == ["gap (µm)", "heat capacity (kJ/(kg K))"]
    assert np.median(two[0].samples) == pytest.approx(1e6 * wide.parameters[0].median)
    assert two[1].low == pytest.approx(1e-3 * wide.parameters[1].low)
    with journal():
        figure = pairs_figure([*two, two[0], two[1], two[0]], 0.9)
        figure.canvas.draw()
        labels = [text for axes in figure.axes if axes.axison for text in (axes.xaxis.label, axes.yaxis.label)]
        boxes = [text.get_window_extent() for text in labels if text.get_text()]
        assert len(boxes) == 9  # below five, beside four
        whole = figure.bbox
        assert all(whole.x0 <= box.x0 and whole.y0 <= box.y0 and box.x1 <= whole.x1 for box in boxes)
        assert not any(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[:i])
        plt.close(figure)
