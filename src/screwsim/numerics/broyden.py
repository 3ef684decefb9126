"""Broyden's update of a Jacobian: the least change with which it reproduces what a step showed.

Source: C. G. Broyden, Mathematics of Computation 19 (1965) 577.
"""

import numpy as np

Array = np.ndarray


def updated(jacobian: Array, change: float | Array, step: Array, weight: float = 1.0) -> Array:
    """Return the Jacobian B + w (Δf − B Δx) Δxᵀ / ΔxᵀΔx, where `change` is Δf and `step` is Δx.

    A scalar f has a row (n,) in place of B (m, n). Of what B missed the share `weight` w is learnt.
    """
    missed = np.asarray(change) - jacobian @ step
    return jacobian + weight * np.multiply.outer(missed, step) / float(step @ step)
