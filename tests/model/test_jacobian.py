"""Derivatives of the rates by the state and by the angle against differences, for one chamber and for all of them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from scenes import OF_ALL_STREAMS, closed, make

Array = np.ndarray
# off the breakpoints: there the derivatives of both sides differ
ALONE = tuple(np.radians((20.5, 151.0, 303.0, 355.5, 423.0, 583.0, 621.0, 703.0)))
TOGETHER = tuple(np.radians((5.5, 41.0, 85.5)))  # of the first chamber; the others stand a pitch ahead each
ANGLE_STEP = 1e-6  # rad, as the integrator takes it


class Driver(NamedTuple):
    """The kernels of one way to see the machine, with its context."""

    n: int
    n_E: int
    surroundings: Callable[..., None]
    rates: Callable[..., None]
    jacobian: Callable[..., None]
    context: tuple
    states: Callable[[float], Array]
    angles: tuple[float, ...]
    nq: int


@pytest.fixture(scope="module", params=OF_ALL_STREAMS)
def machinery(request):
    numerics = {"closing": "coupled", "accuracy": 6e-4}  # so wide that differences of 1e-6 resolve the roots
    scene = make({"operation.speed": "1000 rpm", "numerics": numerics, **OF_ALL_STREAMS[request.param]})
    _, machinery, cycle = closed(scene)
    assert cycle.status == "ok"
    machinery.lives.kept[0] = 0  # both sides are read from the last turn
    return machinery


@pytest.fixture(params=["chamber", "coupled"])
def driver(machinery, request):
    c, m = machinery.composition, machinery.module
    if request.param == "chamber":
        kernels = m.chamber__surroundings, m.chamber__rates, m.chamber__jacobian
        return Driver(
            machinery.n,
            c.n_E,
            *kernels,
            machinery.context,
            lambda phi: machinery.lives.states_at(np.array([phi]))[0],
            ALONE,
            machinery.nq,
        )
    m = machinery.together
    kernels = m.chambers__surroundings, m.chambers__rates, m.chambers__jacobian
    offsets = c.P[1] * np.arange(c.chambers)
    states = lambda s: machinery.lives.states_at(s + offsets).ravel()  # noqa: E731
    return Driver(
        c.chambers * machinery.n, c.n_E_all, *kernels, machinery.coupled_context, states, TOGETHER, machinery.nq + 1
    )


def surrounded(driver, phi, middle):
    E = np.zeros(driver.n_E)
    driver.surroundings(phi, middle, driver.context, E)
    return E


def rates(driver, y, E, nq):
    f, g = np.empty(driver.n), np.empty(nq)
    driver.rates(y, E, driver.context, f, g)
    return np.concatenate([f, g])


def derivatives(driver, phi, nq):
    """Return (rates, derivatives by the state, derivatives by the angle) as the jacobian kernel gives them."""
    n = driver.n
    f, g, J, Jq, f_phi, g_phi = (np.empty(shape) for shape in (n, nq, (n, n), (nq, n), n, nq))
    E, E_next = (surrounded(driver, a, phi + 1e-3) for a in (phi, phi + ANGLE_STEP))
    driver.jacobian(driver.states(phi), E, E_next, ANGLE_STEP, driver.context, f, g, J, Jq, f_phi, g_phi)
    return np.concatenate([f, g]), np.vstack([J, Jq]), np.concatenate([f_phi, g_phi])


def test_the_jacobian_gives_the_rates_themselves(driver, machinery):
    for phi in driver.angles:
        found, _, _ = derivatives(driver, phi, driver.nq)
        expected = rates(driver, driver.states(phi), surrounded(driver, phi, phi + 1e-3), driver.nq)
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12 * np.max(np.abs(expected)))  # order of sums


def test_the_jacobian_is_the_derivative_of_the_rates(driver, machinery):
    for phi in driver.angles:
        y, E = driver.states(phi), surrounded(driver, phi, phi + 1e-3)
        values, found, _ = derivatives(driver, phi, driver.nq)
        expected = np.empty_like(found)
        for j in range(driver.n):
            shift = np.zeros(driver.n)
            shift[j] = 1e-6 * y[j]
            pair = [rates(driver, y + sign * shift, E, driver.nq) for sign in (1, -1)]
            expected[:, j] = (pair[0] - pair[1]) / (2 * shift[j])
        found, expected = found * y, expected * y  # in units of the states
        size = np.maximum(np.max(np.abs(expected), axis=1), 1e-5 * np.max(np.abs(values)))[:, None]  # rounding/1e-7
        # central differences of roots near equal pressures, forward ones of 1e-7 inside for smooth functions
        assert np.max(np.abs(found - expected) / size) < 1e-4, np.degrees(phi)


def test_the_derivative_by_the_angle_is_that_of_the_rates(driver, machinery):
    for phi in driver.angles:
        y = driver.states(phi)
        values, _, found = derivatives(driver, phi, driver.nq)
        pair = [rates(driver, y, surrounded(driver, phi + s * ANGLE_STEP, phi + 1e-3), driver.nq) for s in (1, -1)]
        expected = (pair[0] - pair[1]) / (2 * ANGLE_STEP)
        # a step of 1e-6 changes a wide port's small Δp by parts of itself: the difference is good to some percent there
        np.testing.assert_allclose(
            found, expected, rtol=0.05, atol=1e-2 * np.max(np.abs(values)), err_msg=str(np.degrees(phi))
        )


def test_a_chamber_alone_has_the_rates_of_the_chamber_among_all(machinery):
    c, module = machinery.composition, machinery.module
    s = np.radians(40.0)
    states = machinery.lives.states_at(s + c.P[1] * np.arange(c.chambers))
    E, f, g = np.zeros(c.n_E_all), np.empty(states.size), np.empty(machinery.nq + 1)
    machinery.together.chambers__surroundings(s, s + 1e-3, machinery.coupled_context, E)
    machinery.together.chambers__rates(states.ravel(), E, machinery.coupled_context, f, g)
    together = f.reshape(c.chambers, -1)
    for j in range(c.chambers):
        own, one, quad = np.zeros(c.n_E), np.empty(machinery.n), np.empty(machinery.nq)
        phi = s + j * c.P[1]
        module.chamber__surroundings(phi, phi + 1e-3, machinery.context, own)
        module.chamber__rates(states[j], own, machinery.context, one, quad)
        # neighbours' pressures are cubics over steps whose states err by 9e-5
        np.testing.assert_allclose(one, together[j], rtol=9e-5, atol=1e-12, err_msg=f"chamber {j}")
