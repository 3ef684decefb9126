"""Where a chamber lets nothing out to the discharge line, its outflow is not looked at: it must have none there."""

import numpy as np
import pytest
from scenes import DROP, closed, make

from screwsim.effects.base import DISCHARGE
from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH

SCENES = {
    "paper": {},
    "gaps alone": {"effects.discharge_port": DROP, "machine.discharge_port": DROP},
    "opens late": {"machine.discharge_port.opens": "650 deg", "machine.discharge_port.phi_C": "680 deg"},
}


@pytest.mark.parametrize("name", SCENES)
def test_what_flows_out_to_discharge_is_let_out(name):
    life = closed(make(SCENES[name]))[2].trajectory
    c, P, ports = life.composition, life.composition.P, len(life.composition.ports)
    angles = np.linspace(0.0, P[P_LIFE], 2001)[1:-1] + 1e-5
    flows, out = life.sample(angles)[1], np.zeros(len(angles), bool)
    for i, end in enumerate(c.ends[:ports]):
        out |= (flows[:, i] < 0.0) & (end == DISCHARGE)
    for i, (_, offset) in enumerate(c.gaps):
        out |= (flows[:, ports + 2 * i] < 0.0) & (angles + offset * P[P_PITCH] > P[P_LIFE])
    let = np.array([life.module.chamber__lets_out(phi, phi + 1e-6, P, c.TAB) for phi in angles.tolist()])
    assert (let | ~out).all()
    assert out.any()
    assert not let[angles > P[P_INJECTION]].all()  # there is something to leave out
