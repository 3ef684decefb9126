"""Jacobians of one chamber and of all of them against central differences of the rates, on a closed cycle."""

import numpy as np
import pytest
from scenes import make

from screwsim.simulate import Solution

ANGLES = (20.0, 150.0, 300.0, 355.0, 420.0, 580.0, 620.0, 700.0)


@pytest.fixture(scope="module", params=["paper", "carried"])
def solved(request):
    scene = make({"operation.speed": "1000 rpm", "oil.transport": request.param, "numerics": {"closing": "coupled"}})
    solution = Solution(scene)
    solution.machinery.warm_up(solution.start)
    assert solution.close().status == "ok"
    return solution.machinery


def compare(y, rates, jacobian, n, nq):
    """Return the largest difference of J and of Jq from central differences, in units of each row's largest term."""
    f, g, J, Jq = np.empty(n), np.empty(nq), np.empty((n, n)), np.empty((nq, n))
    jacobian(y, f, g, J, Jq)
    both = np.vstack([J, Jq])
    found = np.empty_like(both)
    for j in range(n):
        step = 1e-6 * y[j]
        shift = np.zeros(n)
        shift[j] = step
        plus, minus = (np.concatenate(rates(y + sign * shift)) for sign in (1, -1))
        found[:, j] = (plus - minus) / (2 * step)
    scaled, differences = both * y, found * y
    size = np.maximum(np.max(np.abs(differences), axis=1), 1e-9 * np.max(np.abs(np.concatenate([f, g]))))
    return np.max(np.abs(scaled - differences) / size[:, None])


def test_a_chambers_jacobian_is_the_derivative_of_its_rates(solved):
    module, n, nq, worst = solved.module, solved.n, solved.nq, 0.0
    for angle in np.radians(ANGLES):
        y = solved.states_at(np.array([angle]))[0]
        E = np.zeros(solved.composition.n_E)
        solved.kept[0] = 0  # both sides are read from the last turn
        module.chamber__surroundings(angle, angle + 1e-3, solved.context, E)

        def rates(state, E=E):
            f, g = np.empty(n), np.empty(nq)
            module.chamber__rates(state, E, solved.context, f, g)
            return f, g

        def jacobian(state, f, g, J, Jq, E=E):
            module.chamber__jacobian(state, E, solved.context, f, g, J, Jq)

        worst = max(worst, compare(y, rates, jacobian, n, nq))
    assert worst < 1e-4  # central differences of a root near equal pressures, forward ones of 1e-7 for state functions


def test_the_jacobian_of_all_chambers_is_the_derivative_of_their_rates(solved):
    c, module, nq, worst = solved.composition, solved.module, solved.nq, 0.0
    n = c.chambers * solved.n
    for s in np.radians((5.0, 40.0, 85.0)):
        y = solved.states_at(s + c.P[1] * np.arange(c.chambers)).ravel()
        E = np.zeros(c.n_E_all)
        module.coupled__all_surroundings(s, s + 1e-3, solved.coupled_context, E)

        def rates(state, E=E):
            f, g = np.empty(n), np.empty(nq)
            module.coupled__all_rates(state, E, solved.coupled_context, f, g)
            return f, g

        def jacobian(state, f, g, J, Jq, E=E):
            module.coupled__all_jacobian(state, E, solved.coupled_context, f, g, J, Jq)

        worst = max(worst, compare(y, rates, jacobian, n, nq))
    assert worst < 1e-4  # as above


def test_a_chamber_alone_has_the_rates_of_the_chamber_among_all(solved):
    c, module = solved.composition, solved.module
    s = np.radians(40.0)
    states = solved.states_at(s + c.P[1] * np.arange(c.chambers))
    E, f, g = np.zeros(c.n_E_all), np.empty(states.size), np.empty(solved.nq)
    module.coupled__all_surroundings(s, s + 1e-3, solved.coupled_context, E)
    module.coupled__all_rates(states.ravel(), E, solved.coupled_context, f, g)
    together = f.reshape(c.chambers, -1)
    solved.kept[0] = 0
    for j in range(c.chambers):
        own, one, quad = np.zeros(c.n_E), np.empty(solved.n), np.empty(solved.nq)
        phi = s + j * c.P[1]
        module.chamber__surroundings(phi, phi + 1e-3, solved.context, own)
        module.chamber__rates(states[j], own, solved.context, one, quad)
        np.testing.assert_allclose(one, together[j], rtol=1e-9, err_msg=f"chamber {j}")  # rounding of the histories read
