"""Laws of seat and stop: a ball that bounces has closed forms, and what rests leaves where its push turns."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from cylinder_scenes import SHUT, K, cylinder
from scipy.optimize import brentq

from screwsim.build import build_parts
from screwsim.cycle.guess import first_guess
from screwsim.effects.base import ChamberState, Stops
from screwsim.model.compose import compose
from screwsim.model.impacts import LOW, MOST_IMPACTS, NEAR
from screwsim.model.run import Machinery
from screwsim.model.slots import R_DISCHARGE, R_SUCTION
from screwsim.numerics.integrators import check_of
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import OK, TOO_MANY_JUMPS

RTOL = 1e-6
P_S, T_S = 1e5, 300.0
GAS, BALL, LID = (0, 1), (2, 3), (4, 5)  # states


@kernel
def height_rate(velocity, frequency):
    """Return dξ/dt, the frequency being that of the crank: angles are times."""
    return frequency * velocity


@kernel
def velocity_rate(weight, frequency):
    """Return dη/dt under a constant force."""
    return -frequency * weight


@kernel
def weight_push(weight):
    """Return the push of a constant force."""
    return -weight


@kernel
def lid_rate(lid_speed, frequency):
    """Return dξ/dt of a lid that the gas lifts."""
    return frequency * lid_speed


@kernel
def lid_speed_rate(p, held, frequency):
    """Return dη/dt of the lid: it is drawn up where the gas's pressure falls below what holds it."""
    return frequency * (held - p) / held


@kernel
def lid_push(p, held):
    """Return the push on the lid."""
    return (held - p) / held


def turned(weight=2.0, restitution=0.5, start=1.0, rtol=RTOL, held=2.5e5, method="rodas4"):
    """Return (status, machinery) of a turn: a ball from height `start`, and a lid on a gas that expands from 4 bar."""
    scene = cylinder(SHUT)
    omega = scene.operation.speed
    values = {"frequency": omega, "weight": weight, "held": held}
    both = restitution, restitution
    parts = replace(
        build_parts(scene),
        effects={
            "ball": [
                ChamberState("height", height_rate, values),
                ChamberState("velocity", velocity_rate, values),
                Stops("height", "velocity", weight_push, values, both),
            ],
            "lid": [
                ChamberState("lid", lid_rate, values),
                ChamberState("lid_speed", lid_speed_rate, values),
                Stops("lid", "lid_speed", lid_push, values, both),
            ],
        },
    )
    composition = compose(parts)
    machinery = Machinery(composition)
    y = first_guess(parts, machinery, P_S, T_S, 4e5)
    R = machinery.R
    R[R_SUCTION : R_SUCTION + 8] = *parts.gas.port_state(P_S, T_S), 0.0, T_S
    R[R_DISCHARGE : R_DISCHARGE + 8] = *parts.gas.port_state(4e5, T_S), 0.0, T_S
    y[list(GAS)] = T_S, parts.gas.density(4e5, T_S)
    y[list(BALL + LID)] = start, 0.0, 0.0, 0.0
    status, *_ = machinery.pitch(y, rtol, check=check_of(method))
    machinery.lives.swap()
    return status, machinery


def jumps(machinery, speed):
    """Return (angles, speeds before, speeds after) where a speed jumps between two steps."""
    times, dense, _, steps = machinery.lives.last()
    before, after = dense[: steps - 1, 1, speed], dense[1:steps, 0, speed]
    at = np.flatnonzero(before != after)
    return times[at + 1], before[at], after[at]


@pytest.mark.parametrize(("method", "rtol"), [("rodas4", RTOL), ("scipy-radau", 1e-9)])
@pytest.mark.parametrize("restitution", [0.5, 0.6])
def test_impacts_of_a_ball_are_a_geometric_series(restitution, method, rtol):
    status, machinery = turned(restitution=restitution, rtol=rtol, method=method)
    times, before, after = jumps(machinery, BALL[1])
    fall, speed = 1.0, 2.0  # from 1 with weight 2
    n = len(times)
    assert status == OK
    assert n > 5
    expected = fall + 2.0 * fall * np.cumsum(np.append(0.0, restitution ** np.arange(1, n)))
    # half of NEAR of the tolerance too deep adds weight times that to the energy at each impact, and so to what follows
    bound = NEAR * RTOL / (speed * restitution ** np.arange(n)) / (1.0 - restitution**2) / (1.0 - restitution)
    assert np.all(np.abs(times - expected) <= bound)
    assert np.all(np.abs(before + speed * restitution ** np.arange(n)) <= 2.0 * bound)
    np.testing.assert_allclose(after[:-1], -restitution * before[:-1], rtol=1e-15)
    # the last bounce would have risen no higher than is seen
    assert after[-1] == 0.0
    assert (restitution * before[-1]) ** 2 / 4.0 <= LOW * rtol < before[-1] ** 2 / 4.0


def test_heights_between_impacts_are_geometric_and_energy_is_lost_at_impacts_only():
    restitution = 0.6
    _, machinery = turned(restitution=restitution)
    times, dense, _, steps = machinery.lives.last()
    shares = np.linspace(0.0, 1.0, 41)[:, None]
    rows = [dense[:steps, i, BALL[0]] for i in range(4)]
    height = rows[0] * (1 - shares) + shares * (rows[1] + (1 - shares) * (rows[2] + shares * rows[3]))
    assert height.min() > -NEAR * RTOL
    at, before, _ = jumps(machinery, BALL[1])
    for n, (a, b) in enumerate(pairwise(at[:5]), 1):
        inside = (times[:steps] >= a - 1e-12) & (times[1 : steps + 1] <= b + 1e-12)
        assert height[:, inside].max() == pytest.approx(restitution ** (2 * n), rel=1e-3)
    energy = 0.5 * dense[:steps, :2, BALL[1]] ** 2 + 2.0 * dense[:steps, :2, BALL[0]]
    lost = 0.5 * (1.0 - restitution**2) * before[:-1] ** 2
    assert np.abs(energy[:, 1] - energy[:, 0]).max() < 1e-7  # in flight
    steps_lost = energy[:-1, 1] - energy[1:, 0]
    np.testing.assert_allclose(np.sort(steps_lost)[::-1][: len(lost)], np.sort(lost)[::-1], rtol=1e-6, atol=1e-9)
    assert lost.sum() == pytest.approx(2.0, rel=1e-5)  # of the height 1


def test_no_restitution_no_bounce():
    _, machinery = turned(restitution=0.0)
    times, _, after = jumps(machinery, BALL[1])
    assert len(times) == machinery.impacts - len(jumps(machinery, LID[1])[0]) == 1
    assert times[0] == pytest.approx(1.0, abs=1e-6)
    assert after[0] == 0.0
    angles, dense, _, steps = machinery.lives.last()
    resting = angles[:steps] >= times[0]
    assert (dense[:steps][resting][:, :, list(BALL)] == 0.0).all()


def test_impacts_that_do_not_end_are_a_status():
    status, machinery = turned(weight=1e8, restitution=1.0)
    assert status == TOO_MANY_JUMPS
    assert machinery.impacts == MOST_IMPACTS + 1


def test_a_ball_that_starts_beyond_seat_or_stop_is_put_there():
    for start, expected in ((-0.1, 0.0), (1.3, 1.0)):
        _, machinery = turned(start=start)
        assert machinery.lives.last()[1][0, 0, BALL[0]] == expected


@pytest.mark.parametrize(("method", "rtol"), [("rodas4", RTOL), ("scipy-radau", 1e-8)])
def test_what_rests_leaves_where_its_push_turns(method, rtol):
    held = 2.5e5
    _, machinery = turned(held=held, rtol=rtol, method=method)
    times, dense, _, steps = machinery.lives.last()
    moving = np.flatnonzero(dense[:steps, 1, LID[1]] != 0.0)[0]
    c = machinery.composition

    def excess(phi):
        V = machinery.module.volume_at(phi, c.P, c.TAB)
        return 4e5 * (machinery.module.volume_at(0.0, c.P, c.TAB) / V) ** K - held

    assert times[moving] == pytest.approx(brentq(excess, 0.0, math.pi), abs=2e-6)
