"""Linearise all chambers over one pitch along a history.

A change δ of the coordinates of all chambers alive (chamber by chamber) follows δ' = A δ + B r + F u: A are the
derivatives of the rates by the states, B the part of A by the chambers ahead, r a change of these alone, u a change of
the feedback unknowns. A, B, F are evaluated at the middle of each of a few slices and held over it; over a slice of
width h, with z = h A, a change is multiplied by (1 − z + z²/2)⁻¹, of order 2 and damped where stiff, and the
quadratures follow from it. That is approximate, as Newton's matrix may be; the equations solved remain those of the
integrator. Derivatives by the states are those of its steps, derivatives by the unknowns are differences of the rates.

The derivatives of the unknowns' next values are differences of the image itself. It reads the quadratures, which the
linearised pitch gives, and where lines pulsate the flow into them over the pitch, whose change is what the slices give
the lines, spread over the slices' angles.

Source: docs/explanation/closing.md, Newton's correction.
"""

import numpy as np

from screwsim.cycle.coordinates import logarithms
from screwsim.cycle.feedback import LINE_POINTS, LineInflow, into_lines, set_unknowns
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.linear_pitch import Tangents, shifted
from screwsim.cycle.problem import LEAST_OIL, Problem
from screwsim.model import compiled
from screwsim.model.all_chambers import inject
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slices import INSIDE
from screwsim.model.slots import P_INJECTION, P_OMEGA, P_PITCH
from screwsim.numerics.rodas import EVALUATED

STEP = 1e-4  # factor on changes of quadratures and unknowns for differences of the image


Array = np.ndarray
SLICES = 12  # of a pitch
EVEN_SHARE = 0.2  # weight of an even division into slices; the rest follows the density of the integrator's steps
LEAST = 1e-6  # share of a pitch: steps that end so near to its ends are ignored
RELAXED = 3  # Newton steps, at most, that move a slice's middle state to where it changes as the history does ...
DEPARTURE = 0.02  # ... while T or ρ would change, relatively, by this much more or less over the slice ...
LARGEST_MOVE = 0.1  # ... of at most this size each
SHIFT = 1e-5  # difference of a coordinate for derivatives ...
LINE_SHIFT = 1e-7  # ... and where lines pulsate: a chamber open to one is within a few pascals of it


def edges_of(machinery: Machinery, slices: int = SLICES) -> Array:
    """Return the edges [rad] of the slices of a pitch, as dense as all chambers' steps in the last history."""
    c, (times, _, _, steps) = machinery.composition, machinery.lives.last()
    pitch = float(c.P[P_PITCH])
    ends = np.sort(np.mod(times[1:steps], pitch))
    ends = np.concatenate([[0.0], ends[(ends > LEAST * pitch) & (ends < (1.0 - LEAST) * pitch)], [pitch]])
    places = np.linspace(0.0, len(ends) - 1.0, slices + 1)
    even = np.linspace(0.0, pitch, slices + 1)
    return (1.0 - EVEN_SHARE) * np.interp(places, np.arange(len(ends)), ends) + EVEN_SHARE * even


def angles_of(angles: Array, c: Composition) -> Array:
    """Return the angles [rad] in all chambers' lives at given angles of a pitch, chamber by chamber."""
    return (float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None] + angles).ravel()


def linearised(problem: Problem, machinery: Machinery, unknowns_in: Array, count: int = SLICES) -> Tangents:
    """Return the pitch linearised along the last history in `count` slices, with the unknowns set to `unknowns_in`."""
    c, n = machinery.composition, machinery.n
    edges = edges_of(machinery, count)
    middles, h = 0.5 * (edges[:-1] + edges[1:]), np.diff(edges)[:, None, None]
    N = n * c.chambers
    y = machinery.lives.states_at(angles_of(middles, c)).reshape(c.chambers, count, n).transpose(1, 0, 2)
    slices = middles, h[:, 0, 0], y.reshape(count, N), _changes(machinery, edges)
    A, F, sums, sums_by_unknowns = _slopes(problem, machinery, unknowns_in, *slices)
    z, one = h * A, np.eye(N)
    step = np.linalg.inv(one - z + 0.5 * z @ z)
    gain, twice = (one - 0.5 * z) @ step, 0.5 * (one - z) @ step
    chamber = np.arange(N) // n
    ahead = np.where(chamber > chamber[:, None], z, 0.0)
    through = enter = _injected(machinery)
    for each in step:
        through = each @ through
    around = np.linalg.inv(one - shifted(through, c.chambers))
    of_sums = h * sums @ gain, h * sums @ twice, h * sums_by_unknowns
    return Tangents(edges, enter, step, gain, ahead, h * F, *of_sums, around)


def _changes(machinery: Machinery, edges: Array) -> Array:
    """Return the change of all chambers' coordinates over each slice (slices, N) along the last history."""
    c, n, count = machinery.composition, machinery.n, len(edges) - 1
    ends = np.concatenate([edges[:-1] + INSIDE, edges[1:] - INSIDE])
    at = logarithms(machinery.lives.states_at(angles_of(ends, c)), c).reshape(c.chambers, 2, count, n)
    return (at[:, 1] - at[:, 0]).transpose(1, 0, 2).reshape(count, -1)


def _slopes(
    problem: Problem, machinery: Machinery, unknowns_in: Array, phi: Array, h: Array, y: Array, changes: Array
) -> tuple[Array, Array, Array, Array]:
    """Return the derivatives of rates of coordinates, then of quadratures, each by coordinates and by unknowns.

    Values are A (by coordinates), F (by unknowns), and the same two for the quadratures, one entry for each slice of
    width h [rad], at its middle phi [rad], to which the states y are first adjusted (`model.slices`); `changes` are
    those of their coordinates over the slices.
    """
    c, N = machinery.composition, y.shape[1]
    logarithmic = np.tile(~np.isin(np.arange(machinery.n), c.signed), c.chambers).astype(float)
    shift = LINE_SHIFT if c.pulsating else SHIFT
    R, P = _shifted_numbers(problem, machinery, unknowns_in, shift)
    u, nq, module = len(unknowns_in), machinery.nq + 1, machinery.together
    A, Jq, F, G = (np.empty((len(phi), *size)) for size in ((N, N), (nq, N), (u, N), (u, nq)))
    least_oil, led = (LEAST_OIL if c.carried else 0.0), np.array([RELAXED, LARGEST_MOVE, DEPARTURE], float)
    states = phi, h, y, changes, logarithmic, machinery.n, least_oil, led
    given = *states, R, P, shift, machinery.coupled_context, c.n_E_all, A, Jq, F, G
    if "tangents" not in compiled.warm_drivers(module):
        at_first = y.copy()
        with machinery.compiling("tangents"):
            module.slices__derivatives_all(*given)
        y[:] = at_first
    asked = module.slices__derivatives_all(*given)
    machinery.counts[EVALUATED:] += c.chambers * len(phi) * u, c.chambers * asked
    scale = np.where(logarithmic > 0.0, np.maximum(np.abs(y), 1e-300), 1.0)
    return A, F.transpose(0, 2, 1), Jq[:, :-1] * scale[:, None, :], G[:, :, :-1].transpose(0, 2, 1)


def _shifted_numbers(problem: Problem, machinery: Machinery, unknowns_in: Array, shift: float) -> tuple[Array, Array]:
    """Return R and P with each unknown shifted, one row each, and unshifted in the last row; leave them unshifted."""
    entries, R, P = problem.entries, [], []
    here = entries.coordinates(unknowns_in)
    for j in range(len(unknowns_in) + 1):
        there = here.copy()
        if j < len(unknowns_in):
            there[j] += shift
        set_unknowns(problem, machinery, entries.values(there, unknowns_in) if j < len(unknowns_in) else unknowns_in)
        R.append(machinery.R.copy())
        P.append(machinery.composition.P.copy())
    return np.array(R), np.array(P)


def _injected(machinery: Machinery) -> Array:
    """Return the derivatives of all chambers' coordinates after the injection of oil by those before it."""
    c, n = machinery.composition, machinery.n
    found = np.eye(c.chambers * n)
    index = round(c.P[P_INJECTION] / c.P[P_PITCH])
    if not 0 < index < c.chambers:
        return found
    at, R = slice(index * n, index * n + n), machinery.R.copy()
    before = machinery.lives.states_at(np.array([index * float(c.P[P_PITCH]) - INSIDE]))[0]
    y, signed = np.ones(c.chambers * n), list(c.signed)

    def after(coordinates: Array) -> Array:
        y[at] = np.exp(coordinates)
        y[at][signed] = coordinates[signed]
        inject(machinery, y)
        machinery.R[:] = R
        return logarithms(y[at].copy(), c)

    here = np.log(np.maximum(before, LEAST_OIL * LEAST_OIL))
    here[signed] = before[signed]
    base = after(here)
    for i in range(n):
        there = here.copy()
        there[i] += SHIFT
        found[at, index * n + i] = (after(there) - base) / SHIFT
    return found


def slopes_of_image(
    problem: Problem,
    machinery: Machinery,
    tangents: Tangents,
    given: Array,
    q: Array,
    unknowns_in: Array,
    unknowns_out: Array,
) -> Array:
    """Return the response of the unknowns' next values to changes of the last life, in coordinates (u, k).

    `given` (slices, q, k) are the changes of the quadratures q by slice; the last u columns belong to a change of
    one unknown each. `unknowns_in` are the unknowns of the life, `unknowns_out` their next values.
    """
    entries, here = problem.entries, problem.entries.coordinates(unknowns_in)
    at_image, sums, count = entries.coordinates(unknowns_out), given.sum(axis=0), given.shape[2]
    first = count - len(unknowns_in)
    found = np.empty((len(unknowns_in), count))
    base = moved = None
    if problem.composition.pulsating:
        base = into_lines(machinery.trajectory)
        # by how much the flows [kg/s] into suction and discharge line change over the pitch (k, 2, LINE_POINTS)
        c = problem.composition
        streams = given[:, c.first_stream :: c.width][:, :4]  # gas to the chambers: suction in, out, discharge in, out
        lines = -(streams[:, 0::2] + streams[:, 1::2])
        moved = float(c.P[P_OMEGA]) * tangents.spread(lines, LINE_POINTS).transpose(2, 1, 0)
    for j in range(count):
        there = here.copy()
        if j >= first:
            there[j - first] += STEP
        set_unknowns(problem, machinery, entries.values(there, unknowns_in) if j >= first else unknowns_in)
        into = None if base is None or moved is None else LineInflow(base.flow + STEP * moved[j], base.volume)
        image = image_of(problem, machinery.trajectory, q + STEP * sums[:, j], into=into)
        found[:, j] = (entries.coordinates(image) - at_image) / STEP
    set_unknowns(problem, machinery, unknowns_in)
    return found
