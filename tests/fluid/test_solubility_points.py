"""What an oil dissolves by measured points (M198): the fitted law, its limits, and points that give none."""

import math

import numpy as np
import pytest
from each_row import each_row

from screwsim.fluid.description import describe
from screwsim.fluid.reference_state import reference_pressure
from screwsim.fluid.solubility_laws import COLUMNS, ESTER, EXPANDS, Measured, Point, law_of_points, read_points
from screwsim.inputs.faults import UsageError

T_CRITICAL = {"R290": 369.89, "R134a": 374.21}
HEAD = ",".join(COLUMNS)
PERCENT, CELSIUS = (2.0, 5.0, 10.0, 15.0, 20.0, 30.0), (-10.0, 20.0, 50.0, 80.0)


def ratio(percent):
    return percent / (100.0 - percent)


def points_of(pressure, percent=PERCENT, celsius=CELSIUS):
    """Return points of a pressure law over content [kg/kg] and temperature [K]."""
    states = [(t + 273.15, ratio(each)) for t in celsius for each in percent]
    return tuple(Point(i, T, pressure(w, T), w) for i, (T, w) in enumerate(states, 2))


class Interaction(Measured):
    """M198 with known constants."""

    def __init__(self, fluid, constants):
        super(Measured, self).__init__(fluid, 260.0, 360.0, 1.0)
        self.expands_to = EXPANDS * T_CRITICAL[fluid]
        self._constants = constants


@pytest.fixture(scope="module")
def propane():
    return Interaction("R290", (-0.3, 0.5, 0.2))


def test_points_of_flory_and_huggins_law_give_it_back(propane):
    law = law_of_points("R290", points_of(propane.equilibrium_pressure))
    assert law.misfit < 1e-3  # of the tables of saturation and fugacity, which begin and end elsewhere
    for T in (270.0, 320.0, 350.0):
        for share in (0.05, 0.3, 0.5):
            p = share * law.p_sat(T)
            assert law.content(p, T) == pytest.approx(propane.content(p, T), rel=2e-3)


def test_points_of_heils_law_give_its_contents():
    """R134a in a polyol ester by M195, up to 30 % of the solution and 0.8 of the saturation pressure."""
    law = law_of_points("R134a", points_of(ESTER.equilibrium_pressure))
    assert law.misfit < 0.04  # M195 has the volume of saturated liquid up to 80 degC, M198 to 45
    for T in (280.0, 333.0, 350.0):
        for share in (0.1, 0.3, 0.5):
            p = share * ESTER.p_sat(T)
            assert law.content(p, T) == pytest.approx(ESTER.content(p, T), rel=0.06)


@each_row("T", [265.0, 300.0, 350.0])
def test_pressure_is_the_inverse_of_the_content(T, propane):
    for held in (1e-4, 0.03, 0.4):
        assert propane.content(propane.equilibrium_pressure(held, T), T) == pytest.approx(held, rel=1e-9)


@each_row("T", [265.0, 300.0, 350.0])
def test_thin_solutions_obey_henrys_law(T, propane):
    thin, thinner, thinnest = (propane.equilibrium_pressure(w, T) / w for w in (1e-5, 1e-7, 1e-12))
    assert thin == pytest.approx(thinner, rel=1e-4)
    assert propane.content(1e-9 * thinnest, T) == pytest.approx(1e-9, rel=1e-3)
    assert propane.content(1e-12 * thinnest, T) == pytest.approx(1e-12, rel=1e-3)  # below the search
    assert propane.content(0.0, T) == 0.0


def test_without_interaction_it_is_raoults_law_of_volumes_with_its_entropy():
    """ln a = ln φ + 1 − φ, of a polymer's solution; a → 1 as the refrigerant becomes pure."""
    law = Interaction("R290", (0.0, 0.0, 0.0))
    v_1, v_2 = 1.0 / law.liquid_density(300.0), 1.0 / law.oil_density
    share = 0.3 * v_1 / (0.3 * v_1 + v_2)
    assert law.log_activity(0.3, 300.0) == pytest.approx(math.log(share) + 1.0 - share, abs=1e-14)
    assert law.log_activity(1e9, 300.0) == pytest.approx(0.0, abs=1e-8)


def test_it_holds_up_to_where_pressures_no_longer_rise():
    """Near saturation χ above one half makes the fitted pressure fall with the content."""
    more = Interaction("R290", (0.0, 0.5, 0.0))
    points = points_of(more.equilibrium_pressure, (*PERCENT, 50.0, 70.0, 85.0, 93.0))
    law = Measured("R290", [each for each in points if each.p < 0.999 * more.p_sat(each.T)])
    assert ratio(50.0) < law.most < ratio(90.0)
    for T in (law.known_from, 300.0, law.high):
        contents = np.geomspace(1e-6, law.most, 200)
        assert (np.diff([law.log_activity(float(each), T) for each in contents]) > 0.0).all()
    assert law.content(0.999 * law.p_sat(300.0), 300.0) <= law.most


def test_oil_that_flashing_cools_below_the_points_follows_the_law_on(propane):
    """Held at the coldest point of 55 degC, 0.3 of what is dissolved at 35 degC was missing."""
    law = law_of_points("R290", points_of(propane.equilibrium_pressure, celsius=(55.0, 70.0, 85.0)))
    assert law.known_from == pytest.approx(328.15) and law.low == pytest.approx(298.15)
    assert law.content(3e5, 308.15) == pytest.approx(propane.content(3e5, 308.15), rel=2e-3)
    assert law.content(3e5, 308.15) > 1.3 * law.content(3e5, 328.15)


def written(folder, *rows, head=HEAD):
    path = folder / "oil.csv"
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return str(path)


def test_points_are_read_as_celsius_bar_and_percent_of_the_solution(tmp_path):
    (point,) = read_points(written(tmp_path, "60,8.5,20"), "R134a")
    assert point == (2, pytest.approx(333.15), pytest.approx(8.5e5), pytest.approx(0.25))


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["60,8.5,120"], "line 2: has a pressure not above 0, or refrigerant not between 0 and 100 %"),
        (["60,8.5,20", "60,x,20"], "line 3: has a cell that is not a number in the columns temperature_degC"),
        (["60,8.5"], "line 2: has 2 cells"),
    ],
)
def test_cells_that_are_no_point_are_told_with_their_line(rows, words, tmp_path):
    with pytest.raises(UsageError, match=words.replace("(", r"\(")):
        read_points(written(tmp_path, *rows), "R134a")


def test_a_file_without_the_columns_is_told(tmp_path):
    with pytest.raises(UsageError, match="needs the columns temperature_degC and pressure_bar and refrigerant_percent"):
        read_points(written(tmp_path, "60,8.5,20", head="T,p,w"), "R134a")
    with pytest.raises(UsageError, match=r"cannot be read: .*name a CSV file with the columns temperature_degC"):
        read_points(str(tmp_path / "none.csv"), "R134a")


def test_points_of_several_refrigerants_may_be_in_one_file(tmp_path):
    file = written(tmp_path, "60,8.5,20,R134a", "60,9,10,R290", "60,4,9,n-Propane", head=f"{HEAD},refrigerant")
    assert [each.line for each in read_points(file, "R290")] == [3, 4]
    assert [each.line for each in read_points(file, "R134a")] == [2]


def test_points_of_another_refrigerant_are_refused(tmp_path):
    file = written(tmp_path, "60,8.5,20,R134a", head=f"{HEAD},refrigerant")
    with pytest.raises(UsageError, match=r"has points of R134a, none of R290 \(name a file that has, or"):
        read_points(file, "R290")
    file = written(tmp_path, "60,8.5,20,r290", head=f"{HEAD},refrigerant")
    with pytest.raises(UsageError, match=r"line 2: 'r290' is no refrigerant that CoolProp has; did you mean 'R290'\?"):
        read_points(file, "R290")
    file = written(tmp_path, "60,8.5,20,R1344a", head=f"{HEAD},refrigerant")
    with pytest.raises(UsageError, match=r"line 2: 'R1344a' is no refrigerant that CoolProp has"):
        read_points(file, "R290")


def refused(points, fluid="R290"):
    with pytest.raises(UsageError) as told:
        Measured(fluid, points)
    return str(told.value)


def test_shares_in_place_of_percent_are_refused():
    points = points_of(ESTER.equilibrium_pressure)
    told = refused([each._replace(ratio=ratio(each.ratio / (1.0 + each.ratio))) for each in points], "R134a")
    assert "has no refrigerant_percent above 0.3, as if they were shares (write percent" in told
    assert "of the solution's mass: 30 for 0.3)" in told


def test_oils_that_dissolve_less_than_one_percent_may_have_points():
    """Ammonia in mineral oil, by Raoult's law over three."""

    def pressure(w, T):
        return x_of(3.0 * w) * reference_pressure("Ammonia", T)

    def x_of(w):
        return w / describe("Ammonia").molar_mass / (w / describe("Ammonia").molar_mass + 1.0 / 0.59)

    percent = (0.1, 0.2, 0.4, 0.6)
    assert Measured("Ammonia", points_of(pressure, percent, (0.0, 30.0, 60.0))).misfit < 0.1


def test_points_that_give_no_law_are_refused_with_their_line(propane):
    points = points_of(propane.equilibrium_pressure)
    assert "needs at least 6 points, with 3 contents and 20 K" in refused(points[:5])
    assert "needs at least 6 points" in refused(points[:6])  # of one temperature
    wrong = points[9]._replace(p=0.5 * points[9].p)
    assert refused((*points[:9], wrong, *points[10:])).startswith("line 11: has a pressure that the law fitted to all")
    liquid = points[3]._replace(p=1.01 * propane.p_sat(points[3].T))
    assert "line 5: 3.48733 bar is not below 3.4528 bar, at which R290 condenses at" in refused([liquid, *points])
    hot = points[3]._replace(T=460.0)
    told = refused((hot, *points))
    assert "line 5: 186.85 degC is outside" in told and "(write it in degC, or leave the row out)" in told
