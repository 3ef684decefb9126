"""Radau's method IIA of three stages: order 5, damped where stiff; its last node is the end of a slice.

On a slice of width h that begins with y₀ the stages are Y = y₀ + h A f(Y). The embedded estimate, of order 3, is
|(γ/h − J)⁻¹ (f(y₀) + e (Y − y₀)/h)|, with γ = `EIGENVALUE` and e = `EMBEDDED`.

Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, IV.5 and IV.8.
"""

import numpy as np

_ROOT = 6.0**0.5
SHARES = np.array(((4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0))  # c: nodes, as shares of a slice
INTEGRALS = np.array(  # A: integrals from the start of a slice to each node, over its width
    (
        ((88.0 - 7.0 * _ROOT) / 360.0, (296.0 - 169.0 * _ROOT) / 1800.0, (-2.0 + 3.0 * _ROOT) / 225.0),
        ((296.0 + 169.0 * _ROOT) / 1800.0, (88.0 + 7.0 * _ROOT) / 360.0, (-2.0 - 3.0 * _ROOT) / 225.0),
        ((16.0 - _ROOT) / 36.0, (16.0 + _ROOT) / 36.0, 1.0 / 9.0),
    )
)
NODES = len(SHARES)
EIGENVALUE = 1.0 / (1.0 / 30.0 * (6.0 + 81.0 ** (1.0 / 3.0) - 9.0 ** (1.0 / 3.0)))  # real one of A⁻¹
EMBEDDED = np.array((-(13.0 + 7.0 * _ROOT) / 3.0, (-13.0 + 7.0 * _ROOT) / 3.0, -1.0 / 3.0))
