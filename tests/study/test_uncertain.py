"""Uncertainty of figures by the tolerances of the inputs: propagation, groups, the sample that holds it to account."""

import numpy as np
import pytest
from folders import POINT

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene.fields import value_at
from screwsim.study.pool import solving
from screwsim.study.uncertainty.point import uncertainty
from screwsim.study.uncertainty.sampled import checked_by_sample, drawn_inputs

SPEED, VOLUME, GAP = "operation.speed", "machine.volume.max", "effects.tip_leakage.gap"
FLOW = "displacement_flow"  # swept volume times chambers a second: known by hand
CLOSE = 1e-6  # of differences of composed numbers


def spread(*changes):
    """Return what tolerances make of the displacement's flow, over the flow."""
    found = uncertainty(screwsim.load(POINT, changes))
    return found.spreads[FLOW], found.slopes.result.performance[FLOW]


def test_independent_inputs_add_in_squares():
    found, flow = spread(f"{SPEED}=1000 rpm ± 3 %", f"{VOLUME}=528 cm^3 ± 4 %")
    assert found.expanded / flow == pytest.approx(0.05, rel=CLOSE)
    assert [one.paths for one in found.contributors] == [(VOLUME,), (SPEED,)]
    assert [one.share for one in found.contributors] == pytest.approx([0.64, 0.36], rel=CLOSE)


def test_inputs_that_err_together_add_as_they_are():
    together = f"uncertainty.correlated=[[{SPEED}, {VOLUME}]]"
    found, flow = spread(f"{SPEED}=1000 rpm ± 3 %", f"{VOLUME}=528 cm^3 ± 4 %", together)
    assert found.expanded / flow == pytest.approx(0.07, rel=CLOSE)
    assert [one.paths for one in found.contributors] == [(SPEED, VOLUME)]


def test_a_factor_counts_by_its_logarithm():
    found, flow = spread(f"{SPEED}=1000 rpm ×/÷ 1.1")
    assert found.expanded / flow == pytest.approx(0.0953101798, rel=CLOSE)  # ln 1.1


def test_a_sample_agrees_where_figures_are_linear_and_warns_where_they_are_not():
    scene = screwsim.load(POINT, [f"{GAP}=27.5 um ± 2 um", "numerics.error=none"])
    found = checked_by_sample(scene, uncertainty(scene), 8, jobs=1)
    assert found.sampled["gas_mass_flow"].wrong == ""
    wide = screwsim.load(POINT, ["oil_supply.ratio=1 ×/÷ 6", "numerics.error=none"])
    found = checked_by_sample(wide, uncertainty(wide), 32, jobs=1)
    assert found.sampled["oil_ratio"].wrong  # a lognormal of that width spreads 1.8 times as far as its logarithm


def test_a_sample_of_which_a_part_has_no_figures_is_that_of_the_others(monkeypatch):
    scene = screwsim.load(POINT, [f"{GAP}=27.5 um ± 2 um", "numerics.error=none"])
    linear, whole = uncertainty(scene), solving._result_at
    part = checked_by_sample(scene, linear, 8, jobs=1)
    assert part.message == "" and part.sampled

    def fails(first: int):
        def result(of, points, number):
            return Result("failed", "too hot (cool it)") if number < first else whole(of, points, number)

        monkeypatch.setattr(solving, "_result_at", result)
        return checked_by_sample(scene, linear, 8, jobs=1)

    found = fails(2)
    assert found.message.startswith("2 of 8 samples have no figures: failed: too hot")
    flows = [whole(scene, drawn_inputs(scene, 8), number).performance["gas_mass_flow"] for number in range(2, 8)]
    assert found.sampled["gas_mass_flow"].mean == pytest.approx(np.mean(flows), rel=1e-4)
    assert not fails(5).sampled  # three of eight say nothing


def test_a_superheat_that_is_rounding_is_not_called_wrong(request):
    base = request.config.rootpath / "configs/ammonia/flooded.yaml"
    scene = screwsim.load(base, ["operation.evaporating_temperature=-10 degC ± 0.5 K", "numerics.error=none"])
    found = checked_by_sample(scene, uncertainty(scene), 8, jobs=1).sampled["suction_superheat"]
    assert 0.0 < found.mean < 2e-6 and found.wrong == ""


def test_a_sample_has_the_moments_that_the_tolerances_state():
    """Three err together, one of them by a factor: means, standard uncertainties and correlations are as asked."""
    radius, ratio = "effects.oil_heat.droplet_radius", "oil_supply.ratio"
    together = f"uncertainty.correlated=[[{GAP}, {SPEED}, {radius}]]"
    given = [f"{GAP}=27.5 um ± 5 um", f"{SPEED}=1000 rpm ± 3 %", f"{radius}=9.5 um ×/÷ 2", f"{ratio}=3 ± 10 %"]
    scene = screwsim.load(POINT, [*given, together])
    drawn = drawn_inputs(scene, 1024)
    deviations = []
    for path, tolerance in scene.uncertain.items():
        nominal = float(value_at(scene, path))
        values = np.array([each[path] for each in drawn]) / nominal
        off = np.log(values) if tolerance.factor else values - 1.0
        standard = tolerance.standard if tolerance.factor else tolerance.standard_at(nominal) / nominal
        assert off.mean() == pytest.approx(0.0, abs=0.01 * standard)
        assert off.std(ddof=1) == pytest.approx(standard, rel=0.01)
        deviations.append(off / standard)
    names = list(scene.uncertain)
    found = np.corrcoef(deviations)
    for i, one in enumerate(names):
        for j, other in enumerate(names):
            asked = 1.0 if ratio not in (one, other) or one == other else 0.0
            assert found[i, j] == pytest.approx(asked, abs=0.01)


def test_a_scene_without_tolerances_is_refused_in_one_line():
    with pytest.raises(UsageError, match="no input has a tolerance"):
        uncertainty(screwsim.load(POINT))


def test_the_table_of_uncertainties_has_those_of_the_document():
    found = uncertainty(screwsim.load(POINT.parent / "uncertain.yaml"))
    table, document = found.to_pandas(), found.as_json()["figures"]
    assert list(table.index) == list(document)
    assert table.expanded.to_dict() == {name: each["expanded"] for name, each in document.items()}
    assert table.value["shaft_power"] == found.slopes.result.performance.shaft_power
    assert (table.units["shaft_power"], table.units["isothermal_efficiency"]) == ("W", "1")
