"""A stream of the state of a place, added to the sums of its category: what closes the mass balance of a step.

Source: docs/model.md M1–M13. `sums` holds mass, enthalpy and, with carried oil, oil mass and oil mass × T_oil, and the
gas that the oil holds where that is a state (M230).
"""

from __future__ import annotations

from screwsim.model.slots import (
    CARRIED,
    DISSOLVED,
    DISSOLVES,
    ENTHALPY,
    OIL_RATIO,
    OIL_TEMPERATURE,
    STREAM_ENTHALPY,
    STREAM_HELD,
    STREAM_OIL,
    STREAM_OIL_HEAT,
)
from screwsim.numerics.kernel import kernel


@kernel
def add_stream(sums, at, m, source, s):
    """Add a stream of mass flow m that has the state of place `source[s]` to the sums of one category."""
    sums[at] += m
    sums[at + STREAM_ENTHALPY] += m * source[s + ENTHALPY]
    if CARRIED == 1:
        oil = m * source[s + OIL_RATIO]
        sums[at + STREAM_OIL] += oil
        sums[at + STREAM_OIL_HEAT] += oil * source[s + OIL_TEMPERATURE]
        if DISSOLVES == 1:
            sums[at + STREAM_HELD] += oil * source[s + DISSOLVED]
