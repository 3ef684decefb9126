"""The built-in volume ratio: the volume where suction closes over that where the discharge port opens."""

import math
from dataclasses import replace

import pytest
from folders import CONFIGS

from screwsim.machine.kinds import kind_of
from screwsim.scene import load

POINT = load(CONFIGS / "paper" / "point.yaml").machine


def falling(angle: float) -> float:
    """Return a volume that falls linearly from 360° to 720° of a compressor."""
    return (4.0 * math.pi - angle) / (2.0 * math.pi)


def ratio(machine, volume_at=falling):
    return kind_of(machine).geometry(machine).built_in_volume_ratio(volume_at)


def opening_at(degrees: float, **changes):
    port = replace(POINT.discharge_port, opens=math.radians(degrees), phi_C=math.radians(degrees + 10.0))
    return replace(POINT, discharge_port=replace(port, **changes))


def test_it_follows_the_opening_of_the_port():
    assert ratio(opening_at(540.0)) == pytest.approx(2.0, rel=1e-12)
    assert ratio(opening_at(630.0)) == pytest.approx(4.0, rel=1e-12)


def test_of_an_expander_it_is_that_of_the_machine_run_forwards():
    machine = replace(opening_at(540.0), mode="expander")
    assert ratio(machine, lambda angle: falling(4.0 * math.pi - angle)) == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize("first", [0, 360, 540])
def test_a_table_tells_it_by_the_last_row_before_it_opens(tmp_path, first):
    rows = "".join(f"{angle},{max(min(angle - 540, 720 - angle), 0) * 1e-5}\n" for angle in range(first, 721, 5))
    (tmp_path / "port.csv").write_text("angle_deg,area_m2\n" + rows)
    machine = opening_at(540.0, law="table", file=str(tmp_path / "port.csv"))
    assert ratio(machine) == pytest.approx(2.0, rel=1e-12)


def test_of_a_profile_it_is_what_the_scene_states():
    assert ratio(load(CONFIGS / "rotors" / "c.yaml", ["machine.built_in_volume_ratio=2.6"]).machine) == 2.6


def test_a_port_that_is_never_shut_and_a_cylinder_have_none(tmp_path):
    (tmp_path / "port.csv").write_text("angle_deg,area_m2\n360,1e-4\n540,2e-4\n720,1e-3\n")
    assert ratio(opening_at(540.0, law="table", file=str(tmp_path / "port.csv"))) is None
    assert ratio(replace(POINT, discharge_port=None)) is None
    assert ratio(load(CONFIGS / "slider_crank" / "air.yaml").machine) is None
