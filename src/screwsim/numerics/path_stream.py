"""A stream through a path, as the text from which the network writes its flow.

It lies beside the declarations of kernels, which the texts of compiled modules are made of as well.
"""

from collections.abc import Sequence
from typing import NamedTuple

GAS, OIL = "gas", "oil"  # what a stream consists of; that of gas takes along the oil which its source has per gas


class PathStream(NamedTuple):
    """A stream through a path as text: the statements that lead to its mass flux [kg/(m² s)], and that flux.

    The flux is over the path's area and positive into the chamber. The stream has the port state of its source. In the
    text stand in braces: numbers of port states, `{own.p}` of the chamber itself and `{beyond.p}` of what lies beyond
    the path, `{leading.p}` of the chamber ahead or of the line, with p, rho, h, exponent, oil_ratio, T_oil (with oil
    that takes room: enthalpy over heat capacity) or held; `{width}` [Pa], below which pressure differences may be
    smoothed; `{nozzle}`, a nozzle's flux (M12); `{per_slow}`, after a flux that holds at the mean speed of the rotors.
    The text of each stream stands by itself: what it uses, it sets.

    A `driven` stream is one of oil that a moving wall takes from the leading to the trailing chamber, whatever their
    pressures; its flux, ≥ 0, is into the latter. Where oil takes room it does work on the wall (M257).
    """

    of: str  # GAS or OIL
    before: Sequence[str]
    flux: str
    driven: bool = False
