"""A scroll, a machine of the user's own whose chambers live for several turns and which compresses inside.

The law: beside wide ports a pocket of V_s closes at p_s, is compressed without loss to V_o, where it opens, equals p_d
there at constant volume, whether it comes from below or from above, and is pushed out at p_d but for V_c. So
−∮ p dV = p_s V_s ((V_s/V_o)^(k−1) − 1)/(k − 1) + p_d (V_o − V_c) − p_s (V_s − V_c). What it delivers has
taken up just that, where what flows back to the suction line comes in again.
"""

import json
from itertools import pairwise

import pytest
from true_error import true_error

from screwsim import simulate
from screwsim.scene import Scene, loads

K, P_S, T_S, V_S, V_C = 1.4, 1e5, 300.0, 60e-6, 0.4e-6
GAPS = {"tip_leakage": {"gap": "5 um"}, "interlobe_leakage": {"gap": "5 um"}}


def scroll(
    ratio=4.0, opens=800.0, area=50.0, accuracy=3e-4, turns=3, speed=300.0, fluid="Nitrogen", **effects
) -> Scene:
    """Return the scene of a scroll: its pressure ratio, where its discharge opens [deg], area of its ports [cm²]."""
    ideal = {"model": "ideal", "isentropic_exponent": K} if fluid == "Nitrogen" else {"model": "real"}
    sizes = {"turns": turns, "volume": "60 cm^3", "dead": "0.4 cm^3", "opens": f"{opens} deg", "height": "30 mm"}
    ports = {"suction_area": f"{area} cm^2", "discharge_area": f"{area} cm^2"}
    operation = {
        "speed": f"{speed} rpm",
        "suction": {"pressure": "1 bar", "temperature": "300 K"},
        "discharge": {"pressure": f"{ratio} bar"},
    }
    scene = {
        "machine": {"kind": "own_machines.scroll", **sizes, **ports},
        "gas": {"fluid": fluid, **ideal},
        "operation": operation,
        "effects": {"suction_port": {}, "discharge_port": {}, **effects},
        "numerics": {"accuracy": accuracy},
    }
    return loads(json.dumps(scene), "scroll.yaml")


def law(ratio, opens):
    """Return the work of a pocket [J] beside wide ports."""
    V_o = V_S - (V_S - V_C) * (opens - 360.0) / 720.0
    inside = P_S * V_S / (K - 1.0) * ((V_S / V_o) ** (K - 1.0) - 1.0)
    return inside + ratio * P_S * (V_o - V_C) - P_S * (V_S - V_C)


@pytest.mark.parametrize(
    ("ratio", "opens"), [(4.0, 600.0), (4.0, 800.0), (1.2, 900.0)]
)  # opens early, about right, late
def test_the_work_of_a_pocket_tends_to_the_closed_form_as_ports_get_wider(ratio, opens):
    off = []
    for area in (5.0, 50.0, 500.0):
        result = simulate(scroll(ratio, opens, area, accuracy=1e-6), trace=False)
        assert result.status == "ok" and result.error["work_per_cycle"] < 1e-6
        off.append(result.performance.work_per_cycle / law(ratio, opens) - 1.0)
    assert abs(off[0]) < 1e-2
    # a port that opens as φ², of an area A, equals the pressures after A^(−1/3): a factor of 2.15 of a decade
    assert [narrow / wide for narrow, wide in pairwise(off)] == pytest.approx([2.15, 2.15], rel=0.1)


def test_what_it_delivers_has_taken_up_its_work():
    found = simulate(scroll(8.0, 950.0, suction_line={}), trace=False).performance
    c_p = K / (K - 1.0) * 296.8039  # [J/(kg K)]
    assert found.shaft_power == pytest.approx(found.gas_mass_flow * c_p * (found.discharge_temperature - T_S), rel=3e-4)
    assert found.returned_heat > 0.0  # of what was left at the centre


@pytest.mark.parametrize("fluid", ["Nitrogen", "R134a"])
@pytest.mark.parametrize(("turns", "opens"), [(2, 500.0), (4, 1000.0)])
def test_pockets_that_leak_into_each_other_keep_the_wanted_accuracy(fluid, turns, opens):
    scene = scroll(3.2, opens, 8.0, turns=turns, speed=3000.0, fluid=fluid, **GAPS)
    result = simulate(scene)
    assert result.status == "ok" and abs(result.ledger.relative_residue) < 1e-3
    status, _, error = true_error(scene, result)
    assert status == "ok" and error < 2.0 * scene.numerics.accuracy  # an accuracy is kept within a factor, as elsewhere
