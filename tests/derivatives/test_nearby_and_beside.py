"""States that place slices leave as little open as asked, and rates side by side are those one by one."""

import numpy as np
import pytest
from closed_points import closed_point
from near_arrays import assert_near

from screwsim.derivatives import chamber_newton, lane_rates, newton, residual
from screwsim.derivatives.block_bidiagonal import BlockBidiagonal, follow_once
from screwsim.derivatives.collocated_cycle import NotClosed
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.node_rates import NodeRates
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.radau import INTEGRALS


@pytest.fixture(scope="module", params=["paper", "r134a"])
def cycle(request):
    """Return the collocated cycle of a scene."""
    return closed_point(request.param)


@pytest.mark.parametrize("bound", [1e-3, 1e-6])
def test_states_nearby_leave_less_open_than_asked_and_are_near(cycle, bound):
    pitch = cycle.pitch
    pitch.install(cycle.start, cycle.nodes * (1.0 + 1e-4 * np.sin(np.arange(pitch.N))))
    found = chamber_newton.approach(pitch, bound, chamber_newton.ChamberFactors())
    assert found is not None
    start, Y = found
    assert residual.size_of(residual.stage_residual(pitch, Y, start, pitch.rates.at(Y)[0]), Y) < bound
    pitch.install(cycle.start, cycle.nodes)
    assert chamber_newton.approach(pitch, 1e-7, chamber_newton.ChamberFactors()) is not None
    assert_near(pitch.read(), cycle.nodes, rel=1e-4, abs=1e-6)


def test_what_is_followed_solves_the_stage_equations(cycle):
    pitch, J = cycle.pitch, cycle.slopes.by_states
    draw = np.random.default_rng(1)
    start, right = draw.normal(size=(pitch.N, 3)), draw.normal(size=(*cycle.nodes.shape, 3))
    blocks = BlockBidiagonal(J, pitch.mesh.widths, pitch.n, max(pitch.machinery.composition.offsets))
    found = blocks.follow(start, right.copy())
    once = follow_once(J, pitch.mesh.widths, pitch.n, max(pitch.machinery.composition.offsets), start, right.copy())
    np.testing.assert_array_equal(once, found)
    before = np.concatenate([start[None], found[:-1, -1]])[:, None]
    inside = np.einsum("k,ij,kjnm,kjmc->kinc", pitch.mesh.widths, INTEGRALS, J, found)
    left = found - before - inside - right
    assert np.abs(left).max() < 1e-9 * np.abs(found).max()


def test_what_is_followed_chamber_by_chamber_begins_with_what_the_one_before_leaves(cycle):
    pitch, n = cycle.pitch, cycle.pitch.n
    chambers, draw = pitch.N // n, np.random.default_rng(2)
    J = cycle.slopes.by_states.reshape(pitch.count, 3, chambers, n, chambers, n)
    own = np.ascontiguousarray(J[:, :, range(chambers), :, range(chambers)]).reshape(-1, 3, n, n)
    blocks = BlockBidiagonal(own, np.tile(pitch.mesh.widths, chambers), n, 0)
    right, inject = draw.normal(size=cycle.nodes.shape), draw.normal(size=(pitch.N, pitch.N))
    found = blocks.follow_one_by_one(right.copy(), inject)
    for j in range(chambers):
        here, one = slice(j * n, j * n + n), own[j * pitch.count : (j + 1) * pitch.count]
        start = inject[here, here] @ found[-1, -1, (j - 1) * n : j * n] if j else np.zeros(n)
        before = np.concatenate([start[None], found[:-1, -1, here]])[:, None]
        inside = np.einsum("k,im,kmst,kmt->kis", pitch.mesh.widths, INTEGRALS, one, found[..., here])
        left = found[..., here] - before - inside - right[..., here]
        assert np.abs(left).max() < 1e-9 * np.abs(found[..., here]).max()


def test_rates_side_by_side_are_those_one_by_one(cycle):
    pitch, at = cycle.pitch, cycle.at
    asked = []
    for i in range(6):
        P, edges = at.P.copy(), pitch.mesh.edges.copy()
        P[5 + i] *= 1.0 + 1e-4
        edges[1:-1] += 1e-9 * i
        asked.append(lane_rates.RateRequest(at._replace(P=P), edges if i % 2 else None))
    (which, f, g), *more = lane_rates.rates_of(pitch.rates, cycle.nodes, asked)
    assert lane_rates._entries[pitch.machinery.together.__name__] is not None
    assert (which, more) == (slice(0, 6), [])
    for i, (numbers, edges) in enumerate(asked):
        pitch.put(numbers)
        rounding = 1e-3 * np.abs(cycle.nodes).max(axis=(0, 1))  # of what balances to nothing, by the state it is of
        for one, many, least in zip(pitch.rates.at(cycle.nodes, edges), (f, g), (rounding, 0.0), strict=True):
            scale = np.maximum(np.abs(one).max(axis=(0, 1)), least)
            assert (np.abs(many[..., i] - one) <= 1e-11 * scale).all()
    pitch.put(at)


def test_rates_of_parts_of_the_nodes_side_by_side_are_those_one_by_one(cycle):
    pitch, edges = cycle.pitch, cycle.pitch.mesh.edges.copy()
    pitch.put(cycle.at)
    edges[1:-1] += 1e-9
    for moved in (None, edges):
        rounding = 1e-3 * np.abs(cycle.nodes).max(axis=(0, 1))  # as above
        many, single = lane_rates.rates(pitch.rates, cycle.nodes, moved), pitch.rates.at(cycle.nodes, moved)
        for one, other, least in zip(single, many, (rounding, 0.0), strict=True):
            assert one.shape == other.shape
            scale = np.maximum(np.abs(one).max(axis=(0, 1)), least)
            assert (np.abs(other - one) <= 1e-11 * scale).all()


def test_what_each_chamber_makes_of_itself_through_its_life_closes_the_cycle(cycle):
    pitch, at = cycle.pitch, cycle.at
    pitch.put(at)
    off = cycle.nodes * (1.0 + 1e-6 * np.sin(np.arange(pitch.N)))
    assert residual.residual_of(pitch, off).size(off) > 1e-5
    found = chamber_newton.closed(pitch, off, 1e-6, chamber_newton.ChamberFactors())
    assert found is not None
    assert residual.residual_of(pitch, found).size(found) < 1e-6
    assert_near(found, cycle.nodes, rel=1e-4, abs=1e-6)
    pitch.put(at)
    pitch.install(cycle.start, cycle.nodes)


def between(pitch, edges):
    """Return a pitch on other slices, read from the last history."""
    return CollocatedPitch(pitch.problem, pitch.machinery, Mesh.between(edges), pitch.events.seams, pitch.events.course)


def test_slices_that_stay_lend_their_factors_and_others_have_their_own(cycle, monkeypatch):
    """Of a slice that is divided, and of one whose states are others, derivatives are asked for; of no other one."""
    pitch, at, asked = cycle.pitch, cycle.at, []
    pitch.put(at)
    pitch.install(cycle.start, cycle.nodes)
    kept, edges = chamber_newton.ChamberFactors(), pitch.mesh.edges
    kept.anew(pitch, cycle.nodes)
    finer = between(pitch, np.insert(edges, 8, 0.5 * (edges[7] + edges[8])))
    Y, by_states = finer.read(), NodeRates.by_own_states
    Y[20] *= 1.0 + 2.0 * chamber_newton.UNCHANGED_WITHIN
    monkeypatch.setattr(NodeRates, "by_own_states", lambda *given: asked.append(given[2].tolist()) or by_states(*given))
    lent = kept.begun(finer, Y)
    assert asked == [[7, 8, 20]]
    assert kept.of(finer) is lent
    own = chamber_newton.ChamberFactors().anew(finer, Y)
    assert (lent.pivots == own.pivots).all()
    assert np.abs(lent.factors - own.factors).max() < 1e-3 * np.abs(own.factors).max()
    new = np.zeros(finer.count, bool)
    new[[7, 8, 20]] = True
    chambers = finer.N // finer.n
    one, other = (each.factors.reshape(chambers, finer.count, -1)[:, new] for each in (lent, own))
    np.testing.assert_array_equal(one, other)


def test_slices_nearly_as_wide_take_factors_over_unless_they_are_wrong(cycle, monkeypatch):
    pitch, at, asked = cycle.pitch, cycle.at, []
    pitch.put(at)
    pitch.install(cycle.start, cycle.nodes)
    kept, edges = chamber_newton.ChamberFactors(), pitch.mesh.edges.copy()
    before = kept.anew(pitch, cycle.nodes).factors.reshape(pitch.N // pitch.n, pitch.count, -1)
    widths, wrong = np.diff(edges), np.zeros(pitch.count, bool)
    edges[8] += 0.5 * chamber_newton.ALIKE * min(widths[7:9])
    edges[20] += 3.0 * chamber_newton.ALIKE * max(widths[19:21])
    wrong[30], by_states = True, NodeRates.by_own_states
    monkeypatch.setattr(NodeRates, "by_own_states", lambda *given: asked.append(given[2].tolist()) or by_states(*given))
    moved = between(pitch, edges)
    found = kept.renewed(moved, moved.read(), wrong, chamber_newton.ALIKE).factors.reshape(before.shape)
    assert asked == [[19, 20, 30]]
    np.testing.assert_array_equal(found[:, [7, 8]], before[:, [7, 8]])
    kept.renewed(moved, moved.read(), np.zeros(pitch.count, bool), 0.0)
    assert len(asked) == 2, "no slice is wrong: all are factored anew"
    assert asked[1] == list(range(pitch.count))


def test_a_cycle_that_cannot_be_closed_so_leaves_the_numbers_as_they_were(cycle):
    pitch, at = cycle.pitch, cycle.at
    pitch.put(at)
    start = pitch.period.start(cycle.nodes)
    assert chamber_newton.closed(pitch, cycle.nodes, 0.0, chamber_newton.ChamberFactors()) is None
    assert (pitch.numbers.P == at.P).all()
    assert_near(pitch.period.start(cycle.nodes), start, rel=0.0, abs=0.0)


@pytest.mark.parametrize("size", [5e-6, 5e-4])
def test_an_iteration_that_comes_no_nearer_ends_with_what_is_near_enough_or_none(cycle, size, monkeypatch):
    """As nodes do that go to and fro over a border of phases: sizes in threes, over and over."""
    pitch, asked = cycle.pitch, []
    pitch.put(cycle.at)
    pitch.install(cycle.start, cycle.nodes)

    def in_threes(_open, _Y):
        asked.append(size * (1.0, 1.9, 1.4)[len(asked) % 3])
        return asked[-1]

    monkeypatch.setattr(residual.Residual, "size", in_threes)
    monkeypatch.setattr(chamber_newton, "closed", lambda *_: None)
    if size < newton.STATES_WITHIN:
        newton.close(pitch, 1e-9, None, chamber_newton.ChamberFactors())
    else:
        with pytest.raises(NotClosed):
            newton.close(pitch, 1e-9, None, chamber_newton.ChamberFactors())
    assert len(asked) == 1 + newton.STALLED
