"""Sobol indices: those of a function whose indices are known, nothing for what does nothing, all points needed."""

import math

import pytest
from each_row import each_row
from result_fakes import SCENE
from study_fakes import gappy, ishigami, noisy

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.scene import loads
from screwsim.study.asked.spans import read_ranges
from screwsim.study.uncertainty.sobol import cost_in_words, sensitivity, usual_samples

RANGES = (
    "machine.rotor_diameter=100 mm..200 mm",
    "oil.density=900 kg/m^3..1000 kg/m^3",
    "oil_supply.ratio=1..2",
    "machine.rotor_length=100 mm..200 mm",
)
BOTH = ("isothermal_efficiency", "shaft_power")


def ishigami_indices() -> tuple[list[float], list[float]]:
    """Return first-order and total indices of Ishigami's function with a = 7, b = 0.1, and of a dummy."""
    a, b = 7.0, 0.1
    first = 0.5 * (1.0 + b * math.pi**4 / 5.0) ** 2
    together = b**2 * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    second = a**2 / 8.0
    variance = first + second + together
    return [first / variance, second / variance, 0.0, 0.0], [
        (first + together) / variance,
        second / variance,
        together / variance,
        0.0,
    ]


def study(simulate, ranges=RANGES, figures=BOTH, **options):
    scene = loads(SCENE)
    return sensitivity(scene, read_ranges(scene, ranges), figures, simulate=simulate, **options)


@pytest.fixture(scope="module")
def found():
    return study(ishigami, samples=1024, jobs=2)


def test_known_indices_lie_within_the_confidence(found):
    assert (found.solutions, found.failed) == (1024 * 6, 0)
    indices = found.shares[0].indices
    assert [index.path for index in indices] == [text.partition("=")[0] for text in RANGES]
    for index, first, total in zip(indices, *ishigami_indices(), strict=True):
        # 95 % intervals of eight estimates: twice their width holds them all
        assert abs(index.first - first) <= 2.0 * index.first_confidence + 1e-12
        assert abs(index.total - total) <= 2.0 * index.total_confidence + 1e-12
        assert index.total_confidence < 0.1


def test_python_gives_the_same_indices_as_a_table(monkeypatch, found):
    monkeypatch.setattr("screwsim.study.uncertainty.sobol.simulator", lambda warm=None: ishigami)
    same = screwsim.sobol_indices(SCENE, RANGES, BOTH, samples=1024, jobs=1)
    assert same == found
    frame = same.to_pandas()
    row = frame.loc["isothermal_efficiency", "machine.rotor_diameter"]
    assert (row.first_order, row.total_confidence) == found.shares[0].indices[0][1:5:3]
    assert len(frame) == len(RANGES) and "shaft_power: does not vary" in repr(same)
    with pytest.raises(UsageError, match=r"oil_supply\.ratio: is not PATH=LOW\.\.HIGH"):
        screwsim.sobol_indices(SCENE, ["oil_supply.ratio"])


def test_what_does_nothing_has_no_share(found):
    index = found.shares[0].indices[3]
    assert index.first == pytest.approx(0.0, abs=1e-12)
    assert index.total == pytest.approx(0.0, abs=1e-12)


def test_a_figure_that_does_not_vary_has_no_indices(found):
    assert found.shares[1].indices == ()
    assert found.shares[1].message == "does not vary beyond its numerical error"
    assert study(noisy, figures=BOTH[:1], samples=16).shares[0].indices == ()


def test_the_mean_and_the_deviation_are_those_of_the_function(found):
    a, b = 7.0, 0.1
    variance = a**2 / 8.0 + b * math.pi**4 / 5.0 + b**2 * math.pi**8 / 18.0 + 0.5
    assert found.shares[0].mean == pytest.approx(a / 2.0, rel=1e-2)
    assert found.shares[0].deviation == pytest.approx(math.sqrt(variance), rel=1e-2)


def test_a_seed_gives_the_same_indices_on_any_number_of_workers():
    one, two = (study(ishigami, samples=32, seed=7, jobs=jobs).shares[0] for jobs in (1, 2))
    other = study(ishigami, samples=32, seed=8, jobs=1).shares[0]
    assert one == two != other


def test_a_failed_point_spoils_the_study_with_the_remedy():
    found = study(gappy, ("oil_supply.ratio=1..6",), BOTH[:1], samples=16)
    assert found.shares == () and 0 < found.failed < found.solutions == 48
    assert found.message.startswith(f"{found.failed} of 48 solutions: failed: pressure left the range")
    assert found.message.endswith("(every point is needed: narrow the ranges)")


def test_where_no_point_has_a_solution_its_own_remedy_is_said_not_that_narrower_ranges_help():
    """An orifice's number may be its default in the middle of its range, and has no meaning beside a pump elsewhere."""
    found = study(gappy, ("oil_supply.orifice_count=0.9..1.1",), BOTH[:1], samples=16)
    assert found.message.startswith("48 of 48 solutions: failed: oil_supply.orifice_count: applies only to kind: ")
    assert found.message.endswith("(remove it, or change the kind)")


def test_a_figure_that_is_missing_somewhere_is_a_failed_point():
    found = study(gappy, ("oil_supply.ratio=0.2..2",), BOTH[:1], samples=16)
    assert "no isothermal_efficiency: no gas is delivered (every point is needed: narrow the ranges" in found.message
    assert found.message.endswith(", or choose another --figure)")


@each_row(
    ("texts", "message"),
    [
        ((), "nothing varies (write one or more --path PATH=LOW..HIGH)"),
        (("oil_supply.ratio",), "--path oil_supply.ratio: is not PATH=LOW..HIGH"),
        (("oil_supply.ratio=1",), "--path oil_supply.ratio=1: is not PATH=LOW..HIGH"),
        (("oil_supply.ratio=0...5",), "--path oil_supply.ratio=0...5: is not PATH=LOW..HIGH"),
        (("oil_supply.ratoi=1..2",), "oil_supply.ratoi: is not known; did you mean 'oil_supply.ratio'?"),
        (("oil_supply.ratio=2..1",), "--path oil_supply.ratio: the range 2 … 1 is empty"),
        (("oil_supply.ratio=1..2", "oil_supply.ratio=2..3"), "--path oil_supply.ratio: is given twice"),
        (("oil.density=1..2",), "oil.density: '1' has no unit"),
        (("gas.model=ideal..real",), "gas.model: is a choice, not a continuous quantity"),
    ],
)
def test_wrong_ranges_are_refused_in_one_line(texts, message):
    with pytest.raises(UsageError) as refusal:
        read_ranges(loads(SCENE), texts)
    assert str(refusal.value).startswith(message) and "\n" not in str(refusal.value)


def test_one_input_alone_takes_fewer_samples_and_what_is_ahead_is_told():
    assert (usual_samples(1), usual_samples(4)) == (32, 256)
    assert cost_in_words(4, 256).startswith("1536 solutions, 256 samples × (4 inputs + 2) (--samples")
    assert cost_in_words(1, 32).startswith("96 solutions, 32 samples × (1 input + 2); a single input")
    assert study(ishigami, ("oil_supply.ratio=1..6",), BOTH[:1]).solutions == 96


def test_samples_are_a_power_of_two():
    with pytest.raises(UsageError, match="--samples 100: is not a power of two"):
        study(ishigami, samples=100)


def test_ranges_whose_middle_does_not_fit_are_refused():
    with pytest.raises(UsageError, match=r"in the middle of the ranges: operation\.discharge\.pressure"):
        study(ishigami, ("operation.discharge.pressure=0.5 bar..1 bar",))
