"""Energy of an air package over a profile of demands, against sums by hand; what no profile is, is one line."""

import pytest

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.study.datasheet import SheetOptions, sheet_of
from screwsim.study.datasheet.air_points import Point
from screwsim.study.datasheet.air_rating import Rating
from screwsim.study.datasheet.air_year import Demand, read_profile, year, year_document, year_table

FULL, LEAST = 0.2, 0.1  # m³/s
PROFILE = (Demand(0.3, 100.0), Demand(0.15, 1000.0), Demand(0.05, 500.0), Demand(0.0, 10.0))


def point(flow, power):
    return Point(300.0, Result("ok", performance=Figures(free_air_delivered=flow, package_input_power=power)))


def rated(*points, unloaded=None):
    idle = None if unloaded is None else point(0.0, unloaded)
    return Rating(points, idle, None, len(points) > 1, "air")


def test_a_package_of_fixed_speed_is_on_load_for_the_share_of_its_flow():
    shares = year(rated(point(FULL, 80e3), unloaded=20e3), PROFILE)
    assert [each.loaded for each in shares] == pytest.approx([1.0, 0.75, 0.25, 0.0])
    assert [each.power for each in shares] == pytest.approx([80e3, 65e3, 35e3, 20e3])
    found = year_document(shares)
    assert found["energy"] == pytest.approx(3600.0 * (80e3 * 100 + 65e3 * 1000 + 35e3 * 500 + 20e3 * 10))
    assert found["volume"] == pytest.approx(3600.0 * (FULL * 100 + 0.15 * 1000 + 0.05 * 500))


def test_one_of_variable_speed_follows_the_flow_and_stops_below_its_lowest():
    package = rated(point(FULL, 80e3), point(0.15, 56e3), point(LEAST, 40e3))
    shares = year(package, PROFILE)
    assert [each.power for each in shares] == pytest.approx([80e3, 56e3, 20e3, 0.0])
    assert "it starts and stops" in year_table(package, shares, ()).note


def test_a_demand_above_full_flow_is_told_and_counts_what_is_given():
    package = rated(point(FULL, 80e3), unloaded=20e3)
    shares = year(package, PROFILE)
    assert shares[0].given == FULL
    table = year_table(package, shares, ())
    assert table.note.startswith("during 100 h it delivers less than demanded, 12.00 m³/min")
    assert table.rows[-1][0] == "all" and table.rows[-1][1] == "1610"


def test_parts_of_hours_are_shown_as_they_are_asked_for():
    package = rated(point(FULL, 80e3), unloaded=20e3)
    table = year_table(package, year(package, (Demand(FULL, 0.5), Demand(0.0, 10.25))), ())
    assert [row[1] for row in table.rows] == ["0.5", "10.25", "10.75"]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("flow, hours\n8, 100", "is not a table of flows (with unit) and hours"),
        ("flow [m^3/min], hours", "is not a table of flows (with unit) and hours"),
        ("flow [m3/mn], hours\n8, 100", "line 2: flow: '8 m3/mn' is not a volume flow"),
        ("flow [m^3/min], hours\n8, 1e5", "line 2: hours '1e5' is not a number from 0 to 8760"),
        ("flow [m^3/min], hours\n-8, 10", "line 2: a flow of -8 is below 0"),
        ("flow [m^3/min], hours\n8, 8000\n7, 8000", "has 16000 hours in all"),
    ],
)
def test_what_is_no_profile_is_told_in_one_line(tmp_path, text, says):
    (tmp_path / "loads.csv").write_text(text)
    with pytest.raises(UsageError) as told:
        read_profile(str(tmp_path / "loads.csv"))
    assert says in str(told.value) and "\n" not in str(told.value)


def test_columns_may_come_in_any_order_and_unit(tmp_path):
    (tmp_path / "loads.csv").write_text("# of a week\nhours, flow [L/s]\n10, 100\n")
    assert read_profile(str(tmp_path / "loads.csv")) == (Demand(pytest.approx(0.1), 10.0),)
    for unit in ("acfm", "cfm", "ft^3/min"):  # as sheets in US units print flows
        (tmp_path / "loads.csv").write_text(f"flow [{unit}], hours\n658.4, 10\n")
        assert read_profile(str(tmp_path / "loads.csv"))[0].flow == pytest.approx(658.4 * 0.3048**3 / 60.0)


def test_flows_in_percent_are_shares_of_the_packages_own_full_flow(tmp_path):
    package = rated(point(FULL, 80e3), unloaded=20e3)
    (tmp_path / "loads.csv").write_text("flow [%], hours\n100, 10\n50, 20\n0, 5\n", encoding="utf-8")
    stated = year(package, read_profile(str(tmp_path / "loads.csv")))
    flows = (Demand(FULL, 10.0), Demand(0.5 * FULL, 20.0), Demand(0.0, 5.0))
    assert stated == year(package, flows)
    (tmp_path / "loads.csv").write_text("flow [%], hours\nfull, 10\n", encoding="utf-8")
    with pytest.raises(UsageError, match=r"loads\.csv line 2: flow: 'full' is not a number"):
        read_profile(str(tmp_path / "loads.csv"))


def test_no_other_machine_has_a_profile(pytestconfig):
    from screwsim import load

    with pytest.raises(UsageError, match="--profile: belongs to an air package"):
        sheet_of(load(pytestconfig.rootpath / "configs" / "r134a" / "point.yaml"), SheetOptions(profile="loads.csv"))
