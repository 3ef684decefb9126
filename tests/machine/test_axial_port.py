"""A slide's stop: the radial part of the discharge port moves, the axial one stays as it was cut."""

import re

import numpy as np
import pytest
from folders import CONFIGS

from screwsim.inputs.faults import SceneError
from screwsim.machine.kinds import kind_of
from screwsim.scene import load


def ported(*changes):
    scene = load(CONFIGS / "rotors" / "b.yaml", changes)
    return kind_of(scene.machine).geometry(scene.machine)


def area(found, angle):
    law = found.discharge_law()
    return float(np.interp(angle, *law.rows))


def test_a_slide_stop_moves_the_radial_part_of_the_port_alone():
    """Axial port cut for 3.6: at a stop of 2.4 the port opens at 2.4, and its end-face part where one of 3.6 opens."""
    low, high = ported("machine.built_in_volume_ratio=2.4"), ported("machine.built_in_volume_ratio=3.6")
    stop = ported("machine.built_in_volume_ratio=2.4", "machine.axial_volume_ratio=3.6")
    assert stop.profile.opens == low.profile.opens < high.profile.opens
    assert stop.stated_volume_ratio == 2.4
    radial = low.profile.curves.discharge["radial"]
    for later in np.radians((2.0, 5.0, 10.0)):
        at = low.profile.opens + later
        alone = np.interp(at - low.profile.born, radial.angle, radial.value)
        assert area(stop, at) == pytest.approx(alone, rel=1e-3)  # tables have a row a degree
    at = 0.5 * (high.profile.opens + high.profile.ends)
    assert area(high, at) < area(stop, at) < area(low, at)


def test_an_axial_port_of_the_same_ratio_changes_nothing():
    one = ported()
    other = ported(f"machine.axial_volume_ratio={one.settings.built_in_volume_ratio}")
    assert np.array_equal(one.discharge_law().rows[1], other.discharge_law().rows[1])


def test_the_part_that_opens_first_is_the_built_in_volume_ratio():
    found = ported("machine.built_in_volume_ratio=3.6", "machine.axial_volume_ratio=2.4")
    assert found.stated_volume_ratio == 2.4
    assert found.profile.opens == ported("machine.built_in_volume_ratio=2.4").profile.opens


@pytest.mark.parametrize(
    ("config", "change", "told"),
    [
        ("r134a/point.yaml", "machine.axial_volume_ratio=3", "axial_volume_ratio: applies only to law: profile"),
        (
            "rotors/b.yaml",
            "machine.axial_volume_ratio=1e6",
            "axial_volume_ratio: 1e+06 leaves the port 10 deg before the",
        ),
    ],
)
def test_an_axial_port_that_cannot_be_is_refused(config, change, told):
    with pytest.raises(SceneError, match=re.escape(told)):
        load(CONFIGS / config, [change])
