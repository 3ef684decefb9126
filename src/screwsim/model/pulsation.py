"""Lines with pulsating pressure: the port state that a chamber meets at an angle, in place of the line's own.

Source: docs/model.md M185, M186. The pressure is that of the line, plus an offset to which gas is throttled, and
harmonics of the lobe frequency, along which the gas is compressed isentropically.
"""

import math

from screwsim.numerics.kernel import kernel

LOWEST = 0.1  # share of the mean pressure to which a guessed pulsation is limited from below


@kernel
def harmonics(phase, P, first, count):
    """Return Σ a_k cos(k·phase) + b_k sin(k·phase); a_1, b_1, a_2 … are in P from `first` on."""
    c = math.cos(phase)
    s = math.sin(phase)
    ck = 1.0
    sk = 0.0
    total = 0.0
    for k in range(count):
        ck, sk = ck * c - sk * s, sk * c + ck * s
        total += P[first + 2 * k] * ck + P[first + 2 * k + 1] * sk
    return total


@kernel
def pulsed(p, rho, h, inverse, offset, pulse):
    """Return pressure, density and enthalpy in a pulsating line whose gas has the exponent 1/`inverse` (M186).

    `offset` and `pulse` are relative to the line's pressure.
    """
    raised = p * (1.0 + offset)
    density = rho * (1.0 + offset)
    ratio = max(LOWEST, 1.0 + pulse / (1.0 + offset))
    work = raised / density * (ratio ** (1.0 - inverse) - 1.0) / (1.0 - inverse)
    return raised * ratio, density * ratio**inverse, h + work
