"""What the dense output of a long, stiff step misreads of the pressure between the ends of the step.

While a port holds the pressure, the chamber follows it within a fraction of a degree, and steps are much longer. Their
ends are right, but between them the dense output (a cubic) does not balance: the gas in the chamber changes by other
than what flows. Finer lives whose steps end at the same breakpoints repeat that. A small departure δ of ln ρ from the
solution obeys δ' = −λ (δ − δ₀), where δ₀ balances the flows at once and λ [1/rad] is the rate at which they decay. It
is integrated from the start of the step, where it is zero.
Source: ours; docs/explanation/errors.md.
"""

import numpy as np

from screwsim.model.slots import P_OMEGA, S_RHO
from screwsim.model.trace import SAMPLED
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
STIFF = 1.0  # step times the least decay λ, above which it is read: a chamber that relaxes within its step
NODES = 8  # angles at which flows are read, denser towards the last: 24 change what is added by a fiftieth at most
DENSER = 1e-7  # relative change of the density by which slopes of flows are found
SHARES = 1.0 - np.linspace(1.0, 0.0, NODES) ** 2  # of the way from the start of a step
VOLUME, PRESSURE, GAS_RATE = (SAMPLED.index(name) for name in ("volume", "pressure", "mass_rate"))
RHO = len(SAMPLED) + S_RHO


def missed_pressure(life: Trajectory, angles: Array) -> Array:
    """Return what to add to the pressures [Pa] of a life's dense output at angles [rad]; 0 in steps that are not stiff.

    Gas and oil in the chamber keep their temperatures and the oil its amount: a port holds the pressure by far more.
    """
    if len(angles) == 0:
        return np.zeros(0)
    times = life.times[: life.steps + 1]
    step = (times.searchsorted(angles, "right") - 1).clip(0, life.steps - 1)
    begun = times[step][:, None]
    nodes = begun + SHARES * (np.asarray(angles)[:, None] - begun)
    order = np.argsort(nodes, axis=None)
    found, flow = _read(life, nodes, order)
    changed, more = _read(life.denser(DENSER), nodes, order)
    slope = (more - flow) / DENSER  # of the net inflow over ln ρ [kg/s]
    omega = float(life.composition.P[P_OMEGA])
    decay = -slope / (omega * found[..., VOLUME] * found[..., RHO])
    stiff = decay.min(axis=1) * (times[step + 1] - times[step]) > STIFF
    aimed = np.divide(omega * found[..., GAS_RATE] - flow, slope, out=np.zeros_like(slope), where=stiff[:, None])
    departure = _followed(aimed, np.where(stiff[:, None], decay, 1.0), np.diff(nodes, axis=1))
    return departure * (changed[:, -1, PRESSURE] - found[:, -1, PRESSURE]) / DENSER


def _read(life: Trajectory, nodes: Array, order: Array) -> tuple[Array, Array]:
    """Return what `Trajectory.sample` reads at nodes (rows, NODES) that are sorted by `order`, and the net inflow."""
    sampled, flows = life.sample(nodes.ravel()[order])
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return sampled[back].reshape(*nodes.shape, -1), flows.sum(axis=1)[back].reshape(nodes.shape)


def _followed(aimed: Array, decay: Array, widths: Array) -> Array:
    """Return δ at the last node of each row, exactly where δ₀ is linear and λ constant between two nodes."""
    found = np.zeros(len(aimed))
    for k in range(widths.shape[1]):
        passed = np.maximum(0.5 * (decay[:, k] + decay[:, k + 1]) * widths[:, k], 1e-12)
        left = np.exp(-passed)
        mean = -np.expm1(-passed) / passed
        found = found * left + aimed[:, k] * (mean - left) + aimed[:, k + 1] * (1.0 - mean)
    return found
