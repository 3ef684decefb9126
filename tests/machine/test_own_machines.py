"""A machine of the user's own is refused in one line where it is bad, and counts in the identity of results."""

import sys

import pytest
from blowers import GAPS, blower

from screwsim import simulate
from screwsim.inputs.faults import SceneError
from screwsim.results.schema import identity_of
from screwsim.scene import loads

WRONG = "own_machines.wrong"


def refused(**changes):
    with pytest.raises(SceneError) as error:
        blower(**changes)
    assert len(error.value.lines) == 1
    return error.value.lines[0].partition(": ")[2]


MODULES = {
    "nothing": ("X = 1\n", "cannot be imported (module own_{0} defines no MACHINE); fix that module"),
    "another": ("MACHINE = 3\n", "cannot be imported (module own_{0} defines no MACHINE); fix that module"),
    "fails": ("1 / 0\n", "fails on import (ZeroDivisionError: division by zero); fix that module"),
    "ends": ("raise SystemExit(3)\n", "cannot be imported (it ends the program, by SystemExit: 3); fix that module"),
    "settings": (
        """from dataclasses import dataclass
from screwsim.machine.protocol import MachineKind
@dataclass(frozen=True)
class Settings: pass
MACHINE = MachineKind(Settings, Settings, frozenset())
""",
        "lacks the setting kind, mode; fix that module",
    ),
    "bare": (
        "from screwsim.machine.protocol import MachineKind\nMACHINE = MachineKind(int, int, frozenset())\n",
        "fails on import (TypeError: must be called with a dataclass type or instance); fix that module",
    ),
}


@pytest.mark.parametrize("name", MODULES)
def test_a_module_that_is_no_machine_is_refused(name, tmp_path, monkeypatch):
    text, what = MODULES[name]
    package = f"{name}_machines"
    (tmp_path / package).mkdir()
    (tmp_path / package / "it.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    kind = f"{package}.it"
    assert refused(kind=kind) == f"machine.kind: '{kind}' {what}".replace("own_{0}", kind)
    for each in [each for each in sys.modules if each.startswith(package)]:
        del sys.modules[each]


def test_a_module_that_is_not_there_is_refused():
    assert refused(kind="no_such.machine") == (
        "machine.kind: 'no_such.machine' cannot be imported (No module named 'no_such'); tried PYTHONPATH and the "
        "working folder (is it there?)"
    )


FLAWS = {
    "life": "its life of 396 deg is not a whole number of pitches of 60 deg",
    "injection": "its injection_angle of 198 deg is not a whole number of pitches of 60 deg inside its life",
    "swept": "its swept_volume is 0.0016 m³, and its volume changes by 0.0008 m³",
    "thin": "its volume is -1.5e-05 m³ at 0 deg, which is impossible",
    "slope": "its volume_slope does not match the slope of its volume up to 4 deg",
    "speed": "its surface_speed is nan m/s at 1 rad/s, which is impossible",
    "port": "the area of its suction port is -1.12305e-05 m² at 0.5 deg, which is impossible",
    "behind": "its tip gap leads to a chamber 0 pitches ahead, and a life has 6 pitches",
    "beyond": "its tip gap leads to a chamber 7 pitches ahead, and a life has 6 pitches",
    "short": "the size of its tip gap is -0.2 at 38 deg, which is impossible",
    "disorder": "the angles of its tip gap do not increase, at 30 deg",
}


@pytest.mark.parametrize("flaw", FLAWS)
def test_a_geometry_that_cannot_be_is_refused(flaw):
    line = refused(kind=WRONG, flaw=flaw)
    assert line.startswith(f"machine.kind: {WRONG}: {FLAWS[flaw]}") and line.endswith("; fix that module")


def test_a_geometry_that_fails_is_refused():
    assert refused(kind=WRONG, flaw="raises") == (
        f"machine.kind: {WRONG} fails (ZeroDivisionError: no law); fix that module"
    )


def test_a_port_of_less_than_nothing_at_a_few_angles_fails_the_case():
    result = simulate(blower(kind=WRONG, flaw="pierced", accuracy=1e-2))
    assert result.status == "failed"
    assert result.message.startswith("effects.suction_port: its area is -")
    assert result.message.endswith(", which is impossible; fix that module")


def test_its_own_checks_and_what_it_does_not_offer_are_told():
    assert refused(pocket="3000 cm^3").startswith("machine.pocket: and machine.dead are more than the 0.002")
    belongs = "applies only to machine.kind: twin_screw (remove the effect, or change the machine)"
    assert refused(effects={"blow_hole": {"area": "1 mm^2"}}) == f"effects.blow_hole: {belongs}"
    length = {**GAPS, "interlobe_leakage": {"gap": "0.2 mm", "length": "1 m"}}
    what = "is given as well as machine.kind: own_machines.roots_blower, which finds it by angle (remove it)"
    assert refused(effects=length) == f"effects.interlobe_leakage.length: {what}"
    assert "of the rotor diameters" not in refused(effects={"tip_leakage": {"gap": "30 mm"}})


def test_the_scene_reads_back_and_results_know_the_module():
    scene = blower(effects=GAPS)
    assert loads(scene.text, folder=scene.folder) == scene
    known = identity_of(scene)
    assert "module own_machines/roots_blower.py" in known
    assert scene.own == {"own_machines.roots_blower": "machine.kind: own_machines.roots_blower"}
