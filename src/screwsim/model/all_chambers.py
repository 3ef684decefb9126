"""A pitch of all chambers alive at once: how it begins, is integrated and ends, and the life that it makes.

Chamber j is at s + j pitch; after a pitch each moves on by one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH

if TYPE_CHECKING:
    from screwsim.model.run import Machinery

Array = np.ndarray


def pitch_breakpoints(machinery: Machinery) -> Array:
    """Return the breakpoints of all chambers within one pitch [rad]."""
    pitch = machinery.composition.P[P_PITCH]
    breakpoints = np.sort(np.mod(machinery.composition.breakpoints, pitch))
    breakpoints = np.append(breakpoints[breakpoints < pitch - 1e-7], pitch)
    return np.concatenate([[0.0], breakpoints[np.diff(breakpoints, prepend=0.0) > 1e-7]])


def own_pitch(machinery: Machinery, y: Array, rtol: float, h: float, inset: float = 0.0) -> tuple[int, float, Array]:
    """Do what `Machinery.pitch` does, with our own method."""
    c, coupled = machinery.composition, machinery.coupled
    inject(machinery, y)
    q = np.zeros(machinery.nq + 1)
    counts, breakpoints = np.zeros(4, np.int64), pitch_breakpoints(machinery)
    breakpoints[[0, -1]] += inset, -inset
    status, s, _ = machinery.together.rodas__integrate_all(
        *(breakpoints, len(breakpoints), y, q, machinery.coupled_context, rtol, h, c.n_E_all),
        *(*coupled.history, coupled.kept, counts),
    )
    machinery.counts += counts * (1, 1, c.chambers, c.chambers)  # counted as evaluations of one chamber
    return int(status), float(s), q[:-1]


def inject(machinery: Machinery, y: Array) -> None:
    """Inject oil into the chamber at the injection angle [in place]."""
    c = machinery.composition
    index = round(c.P[P_INJECTION] / c.P[P_PITCH])
    if index < c.chambers:
        machinery.module.chamber__inject(y, index * machinery.n, c.P, c.TAB, machinery.R)


def moved_on(machinery: Machinery, y: Array) -> Array:
    """Return the states a pitch later: each chamber moves on, the last starts anew with what it retained."""
    return np.concatenate([y[-machinery.n :], y[: -machinery.n]])


def install_pitch(machinery: Machinery) -> None:
    """Install the last pitch of all chambers as the history of one chamber's life."""
    lives, c = machinery.lives, machinery.composition
    if machinery.alone:
        if lives.kept[0] > 0:
            lives.swap()
        return
    times, dense, steps = machinery.coupled.last()
    t = np.concatenate([times[:steps] + j * c.P[P_PITCH] for j in range(c.chambers)] + [[c.P[P_LIFE]]])
    states = dense[:steps].reshape(steps, 4, c.chambers, machinery.n)
    life = np.concatenate([states[:, :, j] for j in range(c.chambers)])
    machinery.install(t, life, np.zeros((len(life), machinery.nq)))
    machinery.module.trace__work_along(*lives.last(), machinery.context)
