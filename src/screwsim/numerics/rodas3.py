"""Rodas3: order 3(2) in four stages, in the form of `rodas`, to measure what the order of the method is worth.

Coefficients: E. Hairer, G. Wanner, Solving ODEs II (Springer 1996); A. Sandu et al., Atmos. Environ. 31 (1997) 3459.
The method has no dense output of its own order: of the four conditions on weights b(θ) two are dependent on the others
except at θ = 0 and 1. `dense_weights` satisfies the two of order 2 and, of order 3, that of quadratures.
"""

import numpy as np

GAMMA = 0.5
ORDER = 3
STAGES = 4
A = np.array(((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 0.0, 1.0)))
C = np.array(((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (1.0, -1.0, 0.0), (1.0, -1.0, -8.0 / 3.0)))
NODES = np.array((0.0, 0.0, 1.0, 1.0))
D = np.array((0.5, 1.5, 0.0, 0.0))


def dense_weights() -> np.ndarray:
    """Return w[power, stage]: y(θ) = y0 + Σ_stage (w[1] θ + w[2] θ² + w[3] θ³) u.

    In untransformed weights b(θ): Σ b = θ, Σ b β = θ²/2 and Σ b α² = θ³/3, where b₃ and b₄ share θ³/3 as at θ = 1.
    """
    gamma = np.linalg.inv(np.eye(STAGES) / GAMMA - np.hstack([C, np.zeros((STAGES, 1))]))
    b = np.array(((0.0, 0.0, 0.0, 0.0), (1.5, -0.5, 0.0, 0.0), (-0.5, 0.5, 0.0, 0.0), (-1 / 6, -1 / 6, -1 / 6, 0.5)))
    return b @ np.linalg.inv(gamma)


_W = dense_weights()
DENSE = np.array((_W[1] - np.append(A[-1], 1.0), -_W[3]))  # c3 and c4 in y0 (1 − θ) + θ (y1 + (1 − θ) (c3 + θ c4))
