"""Another law of a twin screw's volume is one class and one entry: geometry, checks and model ask the law itself."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from scenes import balanced, make

from screwsim.explain import explain
from screwsim.inputs.declare import LEAF
from screwsim.machine.geometry import Geometry
from screwsim.machine.kinds import check_machine
from screwsim.machine.laws import LAWS, PaperLaw
from screwsim.machine.protocol import VolumeKernels
from screwsim.machine.settings import DischargePort, SuctionPort, VolumeLaw
from screwsim.numerics.kernel import kernel
from screwsim.simulate import simulate

NAME = "cosine"


@kernel
def volume(phi, V_max, V_min):
    """Return V_min + V_max (1 − math.cos(φ/2))/2 [m³]."""
    return V_min + 0.5 * V_max * (1.0 - math.cos(0.5 * phi))


@kernel
def volume_slope(phi, V_max):
    """Return its derivative [m³/rad]."""
    return 0.25 * V_max * math.sin(0.5 * phi)


class CosineLaw(PaperLaw):
    """A chamber that fills and empties as a cosine."""

    def volume(self, geometry):
        """Return the volume, with no angle at which it is not smooth."""
        law = geometry.settings.volume
        return VolumeKernels(volume, volume_slope, {"V_max": law.max, "V_min": law.dead}, ())


@pytest.fixture
def scene(monkeypatch):
    monkeypatch.setitem(LAWS, NAME, CosineLaw(source="this test"))
    scene = make({"operation.speed": "1500 rpm"})
    changed = replace(scene.machine.volume, law=NAME, phi_A=None)
    return replace(scene, machine=replace(scene.machine, volume=changed))


@pytest.mark.parametrize("section", [VolumeLaw, SuctionPort, DischargePort])
def test_every_section_offers_every_law_and_each_is_read_in_one_way(section):
    options = next(each for each in fields(section) if each.name == "law").metadata[LEAF].limits["options"]
    assert options == tuple(LAWS)
    assert [law.by_formula + law.from_file + law.from_rotors for law in LAWS.values()] == [1] * len(LAWS)


def test_another_law_is_that_of_the_geometry_and_needs_no_angle_of_the_papers(scene):
    assert check_machine(scene.machine) == []
    settings = scene.machine.volume
    V, slope = Geometry(scene.machine).volume_law().along(np.array([0.0, 2.0 * math.pi, 3.0 * math.pi]))
    assert np.allclose(V, settings.dead + np.array([0.0, 1.0, 0.5]) * settings.max, rtol=1e-12)
    assert np.allclose(slope, [0.0, 0.0, -0.25 * settings.max], atol=1e-12 * settings.max)


def test_a_machine_by_another_law_closes_its_balances_and_is_explained(scene):
    balanced(simulate(scene))
    assert f"law: {NAME} (this test)" in str(explain(scene))
