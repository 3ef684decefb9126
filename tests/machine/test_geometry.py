"""From settings to laws: breakpoints inside the life, tables that give the paper's laws back, ranges."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from each_row import each_row

from screwsim.machine import paper_law
from screwsim.machine.geometry import Geometry
from screwsim.machine.laws import table_breakpoints, volume_rows
from screwsim.machine.settings import LIFE, TURN, DischargePort, SuctionPort, TwinScrew, VolumeLaw, check_twin_screw
from screwsim.numerics.spline import pack_curve

DEG = pi / 180
MACHINE = TwinScrew(
    rotor_diameter=0.16,
    rotor_length=0.176,
    volume=VolumeLaw(max=6e-4, phi_A=60 * DEG),
    suction_port=SuctionPort(area=4e-3, phi_B=60 * DEG),
    discharge_port=DischargePort(area=1.2e-3, opens=600 * DEG, phi_C=640 * DEG),
)
GRID = np.radians(np.arange(0.0, 720.5, 1.0))


def write(path, angles, column, values):
    rows = "\n".join(
        f"{np.degrees(a)!r},{v!r}".replace("np.float64(", "").replace(")", "")
        for a, v in zip(angles, values, strict=True)
    )
    path.write_text(f"angle_deg,{column}\n{rows}\n")
    return str(path)


def volumes(law):
    TAB = pack_curve(*law.tables["volume_curve"])
    return (
        np.array([law.volume(phi, TAB, 0.0, law.values["V_min"]) for phi in GRID]),
        np.array([law.slope(phi, TAB, 0.0) for phi in GRID]),
    )


@pytest.fixture(scope="module")
def tabled(tmp_path_factory):
    """Return the machine with the paper's volume and discharge laws as tables of one row a degree."""
    folder = tmp_path_factory.mktemp("tables")
    V = [paper_law.volume(phi, 6e-4, 0.0, 60 * DEG) for phi in GRID]
    S = [paper_law.discharge_area(phi, 1.2e-3, 600 * DEG, 640 * DEG) for phi in GRID]
    return replace(
        MACHINE,
        volume=VolumeLaw(law="table", max=6e-4, file=write(folder / "V.csv", GRID, "volume_m3", V)),
        discharge_port=DischargePort(law="table", file=write(folder / "S.csv", GRID, "area_m2", S)),
    )


def test_a_fine_volume_table_gives_the_papers_volume(tabled):
    found, _ = volumes(Geometry(tabled).volume_law())
    exact = [paper_law.volume(phi, 6e-4, 6e-8, 60 * DEG) for phi in GRID]
    np.testing.assert_allclose(found, exact, atol=1e-5 * 6e-4)  # rows are met; the scale by the largest row is left


def test_a_fine_volume_table_gives_the_papers_slope(tabled):
    _, found = volumes(Geometry(tabled).volume_law())
    exact = np.array([paper_law.volume_slope(phi, 6e-4, 60 * DEG) for phi in GRID])
    # PCHIP is of second order in the slope, first where curvature jumps: one degree over the turn
    np.testing.assert_allclose(found, exact, atol=0.01 * np.max(np.abs(exact)))


def test_a_volume_table_is_scaled_to_the_swept_volume(tmp_path):
    file = write(tmp_path / "V.csv", GRID, "volume_m3", [7.0 * paper_law.bump(phi / TURN, 0.2) for phi in GRID])
    law = Geometry(replace(MACHINE, volume=VolumeLaw(law="table", max=6e-4, file=file))).volume_law()
    assert np.max(law.tables["volume_curve"][1]) == pytest.approx(6e-4, rel=1e-14)


def test_table_volume_is_dead_volume_at_the_ends(tabled):
    found, _ = volumes(Geometry(tabled).volume_law())
    assert found[[0, -1]] == pytest.approx([6e-8, 6e-8], rel=1e-9)


@pytest.mark.parametrize("name", ["volume_law", "suction_law", "discharge_law"])
def test_breakpoints_lie_inside_the_life(name):
    breakpoints = getattr(Geometry(MACHINE), name)().breakpoints
    assert all(0.0 <= at <= LIFE for at in breakpoints)


@pytest.mark.parametrize("name", ["volume_law", "suction_law", "discharge_law"])
def test_breakpoints_hold_every_jump_of_curvature(name):
    """Away from the breakpoints the second difference of the law changes continuously."""
    law = getattr(Geometry(MACHINE), name)()
    function = law.volume if name == "volume_law" else law.area
    values = np.array([function(phi, *law.values.values()) for phi in GRID])
    curvature = np.diff(values, 2)
    jumps = np.nonzero(np.abs(np.diff(curvature)) > 1e-3 * np.max(np.abs(curvature)))[0] + 1.5  # degrees, ± 1.5
    known = np.degrees([*law.breakpoints, 0.0, LIFE])
    assert all(np.min(np.abs(known - jump)) <= 2.0 for jump in jumps)


def test_coarse_tables_have_a_breakpoint_at_every_row():
    assert table_breakpoints(np.radians([0.0, 20.0, 50.0])) == pytest.approx(np.radians([0.0, 20.0, 50.0]))


def test_fine_tables_have_breakpoints_at_their_ends_only():
    assert table_breakpoints(np.radians([0.0, 5.0, 50.0])) == pytest.approx(np.radians([0.0, 50.0]))


def test_rows_ten_degrees_apart_are_coarse_however_their_radians_are_rounded():
    angles = np.radians(np.arange(0.0, 730.0, 10.0))
    assert np.min(np.diff(angles)) < np.radians(10.0)  # by its last digit
    assert table_breakpoints(angles) == pytest.approx(angles)


def test_steps_end_at_every_row_of_a_volume_that_is_coarse_or_rough():
    coarse, fine = (np.radians(np.arange(0.0, 720.0 + each / 2, each)) for each in (5.0, 2.0))
    smooth = 1.0 - np.cos(fine / 2)
    rough = smooth * (1.0 + 1e-3 * np.where(np.arange(len(fine)) % 2, 1.0, -1.0))
    assert volume_rows(coarse, 1.0 - np.cos(coarse / 2)) == pytest.approx(coarse)
    assert volume_rows(fine, rough) == pytest.approx(fine)
    assert volume_rows(fine, smooth) == ()


@each_row("lobes", [1, 3, 4, 5, 6, 12])
def test_chambers_alive_are_life_over_pitch(lobes):
    geometry = Geometry(replace(MACHINE, male_lobes=lobes))
    assert geometry.chambers * geometry.pitch == pytest.approx(geometry.life, rel=1e-15)


def test_the_discharge_port_is_widest_in_its_middle():
    geometry = Geometry(MACHINE)
    law = geometry.discharge_law()
    areas = [law.area(phi, *law.values.values()) for phi in GRID]
    assert geometry.widest_discharge() == pytest.approx(GRID[np.argmax(areas)])


def test_a_table_finds_its_widest_row(tabled):
    assert Geometry(tabled).widest_discharge() == pytest.approx(660 * DEG)


@each_row(
    ("part", "field", "bad"),
    [
        ("volume", "phi_A", 0.0),
        ("volume", "phi_A", 361.0),
        ("suction_port", "phi_B", 0.0),
        ("suction_port", "phi_B", 181.0),
        ("discharge_port", "opens", 360.0),
        ("discharge_port", "opens", 720.0),
        ("discharge_port", "phi_C", 600.0),
        ("discharge_port", "phi_C", 661.0),
    ],
)
def test_angles_outside_their_ranges_are_faults(part, field, bad):
    machine = replace(MACHINE, **{part: replace(getattr(MACHINE, part), **{field: bad * DEG})})
    assert [fault.path for fault in check_twin_screw(machine)] == [f"machine.{part}.{field}"]


@pytest.mark.parametrize(("part", "field", "limit"), [("volume", "phi_A", 360.0), ("suction_port", "phi_B", 180.0)])
def test_the_upper_ends_of_the_ranges_are_allowed(part, field, limit):
    machine = replace(MACHINE, **{part: replace(getattr(MACHINE, part), **{field: limit * DEG})})
    assert check_twin_screw(machine) == []
