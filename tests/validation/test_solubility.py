"""validation/solubility: files of measured points, the sources' own equations, units of loadings, and deviations."""

import math
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row

from screwsim.effects import refrigerant_solubility as effect
from screwsim.fluid.solubility import M_OIL, M_REFRIGERANT
from screwsim.fluid.solubility_laws import ESTER
from screwsim.study.validation import NotRun, sibling

HERE = Path(__file__).parents[2] / "validation" / "solubility"
own, points, oils, measured, machine = (
    sibling(HERE / f"{name}.py") for name in ("own", "points", "oils", "deviations", "machine")
)
GREBNER = oils.OILS[0]
SOURCE = "Grebner, J. J. (1992)"
STATES = [(T, x) for T in (283.15, 323.15, 343.15) for x in (0.204, 0.404, 0.604)]  # between rows


@pytest.fixture
def compare(compare_of):
    return compare_of("solubility")


def plain_file(folder, rows, source=SOURCE):
    """Write a file with one row a point: T, p, loading."""
    lines = [f'POE,"{source}",{T},{p},{loading}' for T, p, loading in rows]
    path = folder / "points.csv"
    path.write_text("\n".join(["oil,source,T_K,p_Pa,loading_as_stored", *lines]) + "\n", encoding="utf-8")
    return path


def collected_file(folder, rows):
    """Write a file as SorpPropLib has it: one row an oil, after one with units."""
    T, p, loading = (",".join(str(each) for each in column) for column in zip(*rows, strict=True))
    path = folder / "R-134a.csv"
    head = "refrigerant;sorbent;sorbent-subtype;pressures;temperatures;loadings;literature"
    oil = f'R-134a;lubricant;POE;{p};{T};{loading};"Grebner, J. J. (1992): The Effects of Oil; a thesis."'
    path.write_text(f"{head}\n-;-;-;in Pa;in K;in kg/kg or mol/mol;-\n{oil}\n", encoding="utf-8")
    return path


def by_m195():
    """Return T, p and mole fraction of points that lie on M195."""
    return [(T, ESTER.equilibrium_pressure(measured.ratio(x, M_OIL), T), x) for T, x in STATES]


def test_both_forms_of_a_file_hold_the_same_points(tmp_path):
    rows = [(280.0, 1.5e5, 0.4), (280.0, 3e5, 0.7)]
    plain, collected = points.read(plain_file(tmp_path, rows)), points.read(collected_file(tmp_path, rows))
    assert plain == collected == {("Grebner", "POE"): [points.Point(*row) for row in rows]}


@each_row(
    "text,told",
    [
        (None, "cannot be read"),
        ("a,b\n1,2\n", ":1: has not the columns of measured points"),
        ("oil,source,T_K,p_Pa,loading_as_stored\nPOE,x,300,1e5,0.1\nPOE,x,300,much,0.1\n", ":3: holds no points"),
        ("sorbent-subtype;literature;temperatures;pressures;loadings\nPOE;x;1,2;3,4;5\n", ":2: holds no points"),
    ],
)
def test_a_file_that_holds_no_points_says_where_and_what_to_take(tmp_path, text, told):
    path = tmp_path / "points.csv"
    if text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(NotRun) as raised:
        points.read(path)
    assert told in str(raised.value) and points.REMEDY in str(raised.value)


HEAD = "oil,source,T_K,p_Pa,loading_as_stored"


@each_row(
    "values,told",
    [
        ("25,2e5,0.3", "temperature 25 K is not within 169.85 to 374."),
        ("380,2e5,0.3", "write kelvins, not °C"),
        ("nan,2e5,0.3", "temperature nan K is not within"),
        ("300,0,0.3", "pressure 0 Pa is not above 0"),
        ("300,inf,0.3", "write pascals"),
        ("300,2e5,1", "loading 1 is not between 0 and 1"),
        ("300,2e5,30", "write the mole fraction of R134a, not per cent"),
        ("300,2e5,0", "loading 0 is not between 0 and 1"),
    ],
)
def test_a_point_that_no_oil_with_r134a_has_says_where_and_what_to_write(tmp_path, values, told):
    path = tmp_path / "points.csv"
    path.write_text(f"{HEAD}\nPOE,Grebner,300,1e5,0.1\nPOE,Grebner,{values}\n", encoding="utf-8")
    with pytest.raises(NotRun) as raised:
        points.read(path, {("Grebner", "POE")})
    assert ":3: holds no points" in str(raised.value) and told in str(raised.value)
    assert len(points.read(path, ())[("Grebner", "POE")]) == 2  # not compared, so not judged


@each_row(
    "rows,told",
    [
        ([row for row in STATES if row[0] < 333.0], ["content, Grebner 1992, ester oil: mean of 6 points", "pressure"]),
        (
            [(323.15, 0.97), (343.15, 0.97)],
            ["content, Grebner 1992, ester oil"],
        ),  # above MOST
    ],
)
def test_points_that_are_only_cold_or_only_rich_have_the_rows_that_they_allow(
    compare, tmp_path, monkeypatch, rows, told
):
    at = [(T, ESTER.equilibrium_pressure(measured.ratio(x, M_OIL), T), x) for T, x in rows]
    monkeypatch.setenv(points.FILE, str(plain_file(tmp_path, at)))
    monkeypatch.setattr(compare.machine, "machine_rows", lambda root: [])
    found = compare.compare(HERE)
    of_m195 = [row for row in found.rows if not row.quantity.startswith("M198")]
    assert len(of_m195) == len(told)
    assert all(row.quantity.startswith(words) for row, words in zip(of_m195, told, strict=True))
    assert len(found.rows) == len(of_m195) + (len(told) == 2)  # with a law fitted to points that can be compared
    left = [row.note for row in of_m195 if "left out: none of its 2 points" in row.note]
    assert len(left) == 2 - len(told)
    assert len(found.panels) == len(told)  # without deviations only the laws are drawn


def test_heils_model_with_the_constants_of_m195_is_m195():
    for T, x in STATES:
        assert GREBNER.pressure(T, x) == pytest.approx(ESTER.equilibrium_pressure(measured.ratio(x, M_OIL), T))


@each_row("oil", oils.OILS, ids=lambda oil: f"{oil.source} {oil.oil}")
def test_own_equations_end_at_the_saturation_pressure(oil):
    """A cubic equation's own saturation of R134a is within 1 % of the fluid's."""
    for T in (283.15, 343.15):
        assert oil.pressure(T, 0.9999) == pytest.approx(ESTER.pair(T).p_sat, rel=0.011)


def test_a_cubic_equation_has_the_fugacity_of_its_closed_form():
    """Peng–Robinson in mixtures (D.-Y. Peng, D. B. Robinson, 1976), here by the slope of the Helmholtz energy."""
    a_1, a_2, b_1, b_2, cross = 1.6, 12.0, 6e-5, 3e-4, 3.9
    T, p, x, R, root = 323.15, 6e5, 0.3, own.R, math.sqrt(2.0)

    def a_b(T, x, y):
        return x * x * a_1 + 2.0 * x * y * cross + y * y * a_2, x * b_1 + y * b_2

    found = own.Cubic(1.0 + root, 1.0 - root, a_b).log_fugacity(T, p, x, True)
    a, b = a_b(T, x, 1.0 - x)
    A, B = a * p / (R * T) ** 2, b * p / (R * T)
    Z = min(np.real(each) for each in np.roots([1.0, B - 1.0, A - 3 * B * B - 2 * B, -(A * B - B * B - B**3)]))
    share = 2.0 * (x * a_1 + (1.0 - x) * cross) / a - b_1 / b
    ends = math.log((Z + (1.0 + root) * B) / (Z + (1.0 - root) * B))
    closed = b_1 / b * (Z - 1.0) - math.log(Z - B) - A / (2.0 * root * B) * share * ends
    assert found == pytest.approx(closed, rel=1e-6)  # of central differences


def test_vapour_of_low_pressure_has_its_pressure_as_fugacity():
    assert own.fugacity(323.15, 100.0) == pytest.approx(100.0, rel=1e-4)
    assert own.fugacity(343.15, 2e6) < 0.85 * 2e6


def test_points_on_m195_do_not_deviate_from_it():
    """The own equation of Grebner's oil is M195 too; its contents lie between the rows of a table, to 1e-3."""
    found = measured.deviations(GREBNER.pressure, [points.Point(*row) for row in by_m195()], M_OIL)
    assert np.abs(found.content).max() < 1e-9 and np.abs(found.pressure).max() < 1e-9
    assert np.abs(found.scatter).max() < 1e-3
    assert found.slips == 0 and found.mole < 1e-9 < found.mass


@each_row("factor", [0.5, 1.5])
def test_a_deviation_is_that_of_m195_from_what_was_measured(factor):
    rows = [
        points.Point(T, p, measured.mole_fraction(factor * measured.ratio(x, M_OIL), M_OIL)) for T, p, x in by_m195()
    ]
    found = measured.deviations(GREBNER.pressure, rows, M_OIL)
    assert found.content == pytest.approx(1.0 / factor - 1.0)


def test_the_unit_of_loadings_shows_in_the_sources_own_equation():
    """The same points with loadings in kilograms per kilogram of oil: the equation then follows these alone."""
    rows = [points.Point(T, p, measured.ratio(x, M_OIL)) for T, p, x in by_m195()]
    misses = {kind: np.abs(measured.misses(GREBNER.pressure, rows, kind, M_OIL)).mean() for kind in ("mole", "oil")}
    assert misses["oil"] < 1e-9 and misses["mole"] > 0.3


def test_a_point_far_off_its_sources_own_equation_is_left_out_as_a_slip():
    good = [points.Point(*row) for row in by_m195()]
    found = measured.deviations(GREBNER.pressure, [*good, good[4]._replace(p=good[4].p / 4.0)], M_OIL)
    assert found.slips == 1 and len(found.pressure) == len(good)


def test_with_pressures_warm_oil_holds_less():
    """The vapour is less ideal at saturation than below, so p/p_sat is below f/f_sat: the more, the warmer."""

    def more(T):
        p = 0.3 * ESTER.pair(T).p_sat
        return ESTER.content(p, T) / measured.by_pressures(p, T) - 1.0

    assert more(343.15) > 0.15 > more(273.15) > 0.0


def test_pressure_by_pressures_is_the_inverse_of_the_content():
    for T in (283.15, 343.15):
        p = 0.5 * ESTER.pair(T).p_sat
        assert measured.pressure_by_pressures(measured.by_pressures(p, T), T) == pytest.approx(p, rel=1e-9)


def test_rows_judge_the_sources_of_ester_oils_that_m195_was_not_fitted_to(compare, tmp_path, monkeypatch):
    text = plain_file(tmp_path, by_m195()).read_text(encoding="utf-8")
    martz = "".join(line.replace(SOURCE, "Martz, W. L. (1994)") + "\n" for line in text.splitlines()[1:])
    path = tmp_path / "both.csv"
    path.write_text(text + martz, encoding="utf-8")
    monkeypatch.setenv(points.FILE, str(path))
    monkeypatch.setattr(compare.machine, "machine_rows", lambda root: [])
    rows = compare.compare(HERE).rows
    fitted = [row for row in rows if row.quantity.startswith("M198")]
    rows = [row for row in rows if row not in fitted]
    told = [(row.quantity.split(",")[0], row.kind, row.verdict) for row in rows]
    judged = [("content", "calibrated", "holds"), ("pressure", "calibrated", "holds")]
    judged += [("content", "published", "holds"), ("pressure", "published", "holds")]
    assert told == [*judged, ("content at 60 to 90 °C", "estimate", "no verdict")]
    assert [row.ours for row in rows[:4]] == pytest.approx([0.0] * 4, abs=1e-6)
    assert [(row.kind, row.verdict) for row in fitted] == [("calibrated", "no verdict")] * 2
    assert all(0.0 < row.ours < 3.0 for row in fitted)  # % of pressures of Heil's law


def test_a_source_that_m195_misses_by_more_than_its_scatter_fails(compare):
    """An oil that holds twice what M195 has, and an own equation that says so: no scatter, half of its content."""
    martz = next(oil for oil in oils.OILS if (oil.source, oil.oil) == ("Martz", "POE"))

    def pressure(T, x):
        return ESTER.equilibrium_pressure(0.5 * measured.ratio(x, M_OIL), T)

    rows = [points.Point(T, pressure(T, x), x) for T, x in STATES]
    row = compare.content_row(martz, [measured.deviations(pressure, rows, M_OIL)])
    assert row.verdict == "fails" and row.uncertainty < 0.1
    assert row.ours == pytest.approx(-50.0)


def test_without_a_file_the_rows_say_how_to_name_one(compare, monkeypatch):
    monkeypatch.delenv(points.FILE, raising=False)
    monkeypatch.setattr(compare.machine, "machine_rows", lambda root: [])
    (row,) = compare.compare(HERE).rows
    assert row.verdict == "no verdict" and points.FILE in row.note and points.REMEDY in row.note


def test_a_file_without_any_of_the_oils_is_refused(compare, tmp_path, monkeypatch):
    monkeypatch.setenv(points.FILE, str(plain_file(tmp_path, by_m195(), "Nobody, N. (2000)")))
    with pytest.raises(NotRun, match="holds none of the oils"):
        compare.compare(HERE)


def test_another_solubility_is_taken_back():
    plain = ESTER.content(8e5, 338.15)
    with machine.dissolving(1.25) as law:
        assert effect.law_of(effect.Parameters(), ESTER.fluid) is law
        assert law.content(8e5, 338.15) == pytest.approx(1.25 * plain)
        assert law.equilibrium_pressure(1.25 * plain, 338.15) == pytest.approx(8e5)
    assert effect.law_of(effect.Parameters(), ESTER.fluid) is ESTER


def test_oil_that_dissolves_more_costs_efficiency():
    more, less = machine.machine_rows(HERE.parents[1])
    assert more.ours < 0.0 < less.ours


def test_molar_masses_are_those_of_the_formulas():
    """Pentaerythritol C5H12O4 and four acids less four waters; R134a CH2FCF3, to 1e-4 of IUPAC's weights."""
    carbon, hydrogen, oxygen, fluorine = 12.011, 1.008, 15.999, 18.998
    assert pytest.approx(1e3 * M_REFRIGERANT, rel=1e-4) == 2 * carbon + 2 * hydrogen + 4 * fluorine
    acids = {"PEC9": 9, "PEB6": 6, "PEB8": 8}
    for oil in oils.OILS:
        if oil.oil in acids:
            n = 5 + 4 * acids[oil.oil]
            grams = n * carbon + (2 * n - 6) * hydrogen + 8 * oxygen
            assert 1e3 * oil.molar_mass[0] == pytest.approx(grams, rel=1e-4)
    for bound, n in zip(oils.ESTERS, (5 + 4 * 5, 5 + 4 * 9), strict=True):
        assert 1e3 * bound == pytest.approx(n * carbon + (2 * n - 6) * hydrogen + 8 * oxygen, rel=1e-3)
