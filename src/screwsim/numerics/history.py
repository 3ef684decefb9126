"""Histories: stored trajectories of chamber lives, as dense output of an integration, read by neighbouring chambers.

A history is (times[0…n], dense[n, 4, states]) as filled by `rodas.integrate`; the independent variable is the angle.
"""

from screwsim.numerics.kernel import kernel

NUDGE = 1e-9  # [rad] at a jump, the side on which the middle of the caller's segment lies is chosen


@kernel
def locate(phi, middle, times, steps, hint):
    """Return the step that contains phi, searching from `hint`; on a boundary the one on the side of `middle`."""
    x = phi + NUDGE if middle > phi else phi - NUDGE
    i = hint
    if i >= steps or times[i] > x + 0.5:
        i = 0
    while i < steps - 1 and times[i + 1] <= x:
        i += 1
    while i > 0 and times[i] > x:
        i -= 1
    return i


@kernel
def read(phi, times, dense, i, out):
    """Fill `out` with the state at phi inside step i."""
    theta = (phi - times[i]) / (times[i + 1] - times[i])
    for j in range(out.shape[0]):
        c = dense[i, 2, j] + theta * dense[i, 3, j]
        out[j] = dense[i, 0, j] * (1.0 - theta) + theta * (dense[i, 1, j] + (1.0 - theta) * c)


@kernel
def cubic(v0, v1, v2, v3):
    """Return (c3, c4) of the dense output through values at 0, 1/3, 2/3 and 1 of a step (v0 and v3 its ends)."""
    return -4.5 * v0 + 9.0 * v1 - 4.5 * v2, 4.5 * v0 - 13.5 * v1 + 13.5 * v2 - 4.5 * v3


@kernel
def add_history(times, steps, other_times, other_dense, other_steps, weight, out):
    """Add weight × another history to `out`, the dense form on the steps of `times`.

    In each step a cubic through its values at 0, 1/3, 2/3 and 1 replaces the other history's pieces.
    """
    n = out.shape[2]
    i = 0
    for step in range(steps):
        a = times[step]
        h = times[step + 1] - a
        middle = a + 0.5 * h
        for k in range(4):
            phi = a + h * k / 3.0
            i = locate(phi, middle, other_times, other_steps, i)
            theta = (phi - other_times[i]) / (other_times[i + 1] - other_times[i])
            for j in range(n):
                inner = other_dense[i, 2, j] + theta * other_dense[i, 3, j]
                value = other_dense[i, 0, j] * (1.0 - theta) + theta * (other_dense[i, 1, j] + (1.0 - theta) * inner)
                value *= weight
                # the cubic through v0 … v3: c3 = −4.5 v0 + 9 v1 − 4.5 v2, c4 = 4.5 v0 − 13.5 v1 + 13.5 v2 − 4.5 v3
                if k == 0:
                    out[step, 0, j] += value
                    out[step, 2, j] -= 4.5 * value
                    out[step, 3, j] += 4.5 * value
                elif k == 1:
                    out[step, 2, j] += 9.0 * value
                    out[step, 3, j] -= 13.5 * value
                elif k == 2:
                    out[step, 2, j] -= 4.5 * value
                    out[step, 3, j] += 13.5 * value
                else:
                    out[step, 1, j] += value
                    out[step, 3, j] -= 4.5 * value


@kernel
def states_at(angles, times, dense, steps, out):
    """Fill out[i] with the state of a history at angles[i], which increase."""
    i = 0
    for a in range(angles.shape[0]):
        i = locate(angles[a], angles[a] + 1e-6, times, steps, i)
        read(angles[a], times, dense, i, out[a])
