"""Where slices end: no node is so near to a flow's turning that a difference to one side passes it."""

import numpy as np
import pytest
from closed_points import CONFIGS

from screwsim.derivatives.mesh import NEAR, SHARE_BEFORE, Crossing, Mesh, with_rings
from screwsim.derivatives.radau import SHARES
from screwsim.scene import load, with_values
from screwsim.simulate import simulate
from screwsim.study.uncertainty.point import sensitivities

SEAMS = np.array([0.0, np.pi / 2.0])
AT, WIDE = 0.67, 1.65  # rad: a turning, and the width of its layer, which is wider than the slices


def turned(behind, before=0.05):
    """Return the distances [widths of the layer] of all nodes from a turning in a plain slice around it."""
    end = AT - SHARE_BEFORE * WIDE
    edges = np.array([0.0, end - before, end + behind, SEAMS[1]])
    found = with_rings(edges, SEAMS, [Crossing(AT, WIDE)], (0.5, 0.7), float("nan"))
    return (Mesh.between(found).angles.ravel() - AT) / WIDE


@pytest.mark.parametrize("node", range(len(SHARES)))
def test_no_node_comes_as_near_to_a_turning_as_differences_move_it(node):
    """Whichever of its nodes a slice would have there; a slice ends before the turning all the same."""
    for aside in (-0.1, 0.0, 0.1):
        apart = turned((1.0 + aside) * SHARE_BEFORE * WIDE / SHARES[node])
        assert np.abs(apart).min() >= NEAR * SHARE_BEFORE
        assert np.abs(apart + SHARE_BEFORE).min() < 1e-9


def test_a_slice_whose_nodes_are_far_from_the_turning_stays_whole():
    assert len(turned(0.3)) == len(SHARES) * 4


def test_the_slope_by_a_line_s_pressure_is_that_of_differences_where_a_node_would_meet_the_turning():
    """The suction flow turns over a layer wider than the pitch; a node lay 4e-6 of it before, a step is 1e-5 of it."""
    path, point = "operation.suction.pressure", CONFIGS / "paper" / "point.yaml"
    changes = ("oil.transport=carried", "oil_supply.temperature=320 K")
    numbers = {
        "operation.speed": 82.71650474875076,
        "oil_supply.ratio": 0.01697159525012216,
        "operation.discharge.pressure": 627006.6125665247,
    }
    scene = with_values(load(point, changes), numbers)
    found = sensitivities(scene, [path])
    fine = with_values(load(point, (*changes, "numerics.rtol=1e-8", "numerics.error=none")), numbers)
    p = scene.operation.suction.pressure
    low, high = (simulate(with_values(fine, {path: p * by}), trace=False).performance for by in (0.999, 1.001))
    for figure in ("gas_mass_flow", "oil_mass_flow", "volumetric_efficiency"):
        differenced = (high[figure] - low[figure]) / (2e-3 * simulate(fine, trace=False).performance[figure])
        assert found.relative(figure, path) == pytest.approx(differenced, abs=1e-4), figure
