"""The flow into pulsating lines, read from the rates at the nodes: its means, and how they change with a number."""

import numpy as np
import pytest
from closed_points import CONFIGS, closed_scene
from near_arrays import assert_near

import screwsim
from screwsim.cycle.balances import streams_of
from screwsim.cycle.feedback import LINE_POINTS, into_lines
from screwsim.cycle.problem import Series
from screwsim.derivatives.around import number_shifted
from screwsim.derivatives.collocation import FINE
from screwsim.derivatives.directions import Directions
from screwsim.derivatives.line_flows import LineMeans
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.solving import STEP
from screwsim.model.slots import OF_GAS
from screwsim.scene.fields import value_at

PLENUMS = "effects.plenums={discharge_volume: 3 l, suction_volume: 8 l, discharge_area: 15 cm^2, suction_area: 40 cm^2}"
NUMBERS = (
    "machine.discharge_port.opens",  # moves slices
    "operation.speed",  # the flow over the angle stays, that over time does not
    "operation.discharge.pressure",
    "effects.tip_leakage.gap",
    "oil_supply.ratio",  # through the injection alone
)
ROUNDING = 1e-9
DIFFERENCED = 1e-8  # of the flow: rounding of differences over 1e-10 of a number, within a thousand nodes
READ_OTHERWISE = 3e-4  # of the largest flow: by the life, between the nodes, too, where ports open and shut
OPEN = 1e-3  # of the open volume: by intervals of the pitch, with the flow or with the area


def slices(draw):
    """Return edges of slices, unevenly over a pitch, some within one interval of the means and some over several."""
    return np.concatenate([[0.0], np.cumsum(draw.uniform(0.001, 0.02, 150))])


def polynomial_means(edges, flow):
    """Return means of flow(angle), a cubic over the pitch at most, around even angles by a dense trapezium rule."""
    width = edges[-1] / LINE_POINTS
    within = (np.arange(400) + 0.5) / 400 - 0.5
    angles = width * (np.arange(LINE_POINTS)[:, None] + within)
    return flow(angles % edges[-1]).mean(axis=1)


def test_means_of_a_parabola_are_exact():
    edges = slices(np.random.default_rng(1))

    def flow(angles):
        return 1.0 + 2.0 * angles - 3.0 * angles**2

    at, widths = Mesh.between(edges).angles, np.diff(edges)[:, None]
    found = LineMeans.of(edges).through((widths * flow(at))[..., None])[0]
    assert_near(found, polynomial_means(edges, flow), rel=1e-5)
    assert found.mean() * edges[-1] == pytest.approx(edges[-1] + edges[-1] ** 2 - edges[-1] ** 3, rel=ROUNDING)


@pytest.mark.parametrize("wider", [0.0, 0.3])
def test_means_change_with_edges_as_differences_say(wider):
    draw = np.random.default_rng(2)
    edges = slices(draw)
    moves, g = draw.normal(size=len(edges)) * 0.1, draw.normal(size=(len(edges) - 1, 3, 2))
    moves[0], moves[-1], by = 0.0, wider * edges[-1], 1e-7

    def means(step):
        moved = edges + step * moves
        return LineMeans.of(moved).through(np.diff(moved)[:, None, None] * g)

    of = LineMeans.of(edges)
    found = of.through(np.diff(moves)[:, None, None] * g) + of.as_edges_move(g, moves, wider) - wider * means(0.0)
    differences = (means(by) - means(-by)) / (2.0 * by)
    assert_near(found, differences, abs=1e-5 * np.abs(differences).max())


@pytest.fixture(scope="module")
def cycle():
    """Return the collocated cycle of the paper's machine between plenums, its history installed."""
    found = closed_scene(screwsim.load(CONFIGS / "paper" / "point.yaml", [PLENUMS]), FINE)
    found.pitch.put(found.at)
    found.pitch.install(found.start, found.nodes)
    return found


def test_rates_at_the_nodes_tell_the_flow_that_the_life_tells(cycle):
    of_life, of_nodes = into_lines(cycle.pitch.machinery.trajectory), cycle.into
    assert_near(of_nodes.flow, of_life.flow, abs=READ_OTHERWISE * np.abs(of_life.flow).max())
    assert_near(of_nodes.volume, of_life.volume, rel=OPEN)


def test_the_means_sum_up_to_the_quadratures_and_so_do_their_changes(cycle):
    problem = cycle.pitch.problem
    every, series = Directions(cycle), Series()
    values = {path: value_at(problem.scene, path) for path in NUMBERS}
    directions = [every.of(number_shifted(problem, series, path, value), STEP) for path, value in values.items()]
    found = every.along(directions).by_changes

    def of_quadratures(sums, omega):
        into = -streams_of(problem.composition, sums)[:4, OF_GAS].reshape(2, 2, *sums.shape[1:]).sum(axis=1)
        return into * omega / problem.parts.geometry.pitch

    omega = problem.parts.omega
    here = of_quadratures(cycle.sums, omega)
    assert_near(cycle.into.flow.mean(axis=1), here, rel=ROUNDING)
    for j, direction in enumerate(directions):
        faster = (direction.problem.parts.omega / omega - 1.0) / STEP
        expected = of_quadratures(found.sums[:, j], omega) + faster * here
        assert_near(found.lines[..., j].mean(axis=1), expected, abs=DIFFERENCED * np.abs(here))
