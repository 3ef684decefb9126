"""What a cycle leaves open: residues of mass, energy and oil, and the mean of what flows out, from its quadratures.

Source: docs/model.md M27, M37–M39.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from screwsim.model.run import Machinery
from screwsim.model.slots import BETWEEN, Q_HEAT, Q_WALLS
from screwsim.numerics.made import Entry

Array = np.ndarray
LEAST_OIL = 1e-4  # oil per gas below which its change does not count
LEAST_WORK = 1e-6  # of p V of the trapped gas: work below this is rounding


@cache
def discharge_line(carried: bool, dissolves: bool = False) -> tuple[Entry, ...]:
    """Return the entries of the discharge line (M27): its enthalpy, and with carried oil its ratio and temperature.

    Where oil dissolves gas, also what it holds there (M230).
    """
    ratio = Entry("discharge_oil_ratio", floor=LEAST_OIL)
    oil = (ratio, Entry("discharge_oil_temperature", of=ratio.name)) if carried else ()
    if dissolves:
        oil = (*oil, Entry("discharge_held_gas", of=ratio.name, scale=1.0))
    return Entry("discharge_enthalpy"), *oil


class Balances:
    """Relative residues of mass and energy, and the discharge plenum that the outflow makes, from quadratures."""

    def __init__(
        self, machinery: Machinery, oil_heat_capacity: float, oil_in: Callable[[], tuple[float, float]]
    ) -> None:
        self.machinery = machinery
        self.c_oil = oil_heat_capacity
        self.oil_in = oil_in
        self.width = machinery.composition.width

    def streams(self, q: Array) -> Array:
        """Return the sums as rows, by the categories of slots: suction in, suction out, discharge in …"""
        return q[Q_WALLS + 2 * len(self.machinery.composition.walls) :].reshape(-1, self.width)

    def walls(self, q: Array) -> Array:
        """Return of each wall the heat into the gas [J] and the conductance times time [J/K] over one life (M170)."""
        return q[Q_WALLS : Q_WALLS + 2 * len(self.machinery.composition.walls)].reshape(-1, 2)

    def mass_in(self, q: Array) -> float:
        """Return the gas [kg] that a life takes in beyond what it gives back: nothing, where the cycle is closed."""
        return float(self._outer(q)[:, 0].copy().sum())

    def _outer(self, q: Array) -> Array:
        """Return the sums of all categories but that between chambers."""
        streams = self.streams(q)
        return np.concatenate([streams[:BETWEEN], streams[BETWEEN + 1 :]])

    def residues(self, q: Array, trapped: float, h_suction: float, pv: float) -> tuple[float, float, float, float]:
        """Return relative residues of gas mass, energy and oil mass over one life (M37–M39); pv is p/ρ at suction.

        The last is that of the oil where there is little of it: as a share of the trapped gas.
        """
        flows = self._outer(q)
        mass = flows[:, 0]
        enthalpy = flows[:, 1] - h_suction * mass
        energy = enthalpy.sum() + q[0]
        scale = np.abs(enthalpy).sum() + abs(q[0])
        oil = oil_share = 0.0
        if self.width >= 4:
            injected, T_oil = self.oil_in()
            energy += self.c_oil * (flows[:, 3].sum() - T_oil * flows[:, 2].sum())
            lost, through = abs(flows[:, 2].sum() + injected), max(injected, np.abs(flows[:, 2]).sum() / 2)
            oil, oil_share = lost / max(through, LEAST_OIL * trapped), lost / max(through, trapped)
            if self.width == 5:  # what it holds dissolved, over the gas
                held = abs(flows[:, 4].sum()) / max(trapped, np.abs(flows[:, 4]).sum() / 2)
                oil, oil_share = max(oil, held), max(oil_share, held)
        else:
            energy += q[Q_HEAT]
        if self.machinery.composition.walls:
            heats = self.walls(q)[:, 0]
            energy, scale = energy + heats.sum(), scale + np.abs(heats).sum()
        mass_scale = max(trapped, 0.5 * np.abs(mass).sum())
        return abs(mass.sum()) / mass_scale, abs(energy) / max(scale, LEAST_WORK * trapped * pv), oil, oil_share


def discharge_enthalpy(streams: Array) -> tuple[float, float, float] | None:
    """Return (h, oil per gas, T_oil) of the outflow's flow-weighted mean; None when nothing flows out."""
    out = streams[3]
    if not out[0] < 0.0:
        return None
    ratio = out[2] / out[0] if len(out) >= 4 else 0.0
    T_oil = out[3] / out[2] if len(out) >= 4 and out[2] < 0.0 else 0.0
    return float(out[1] / out[0]), float(ratio), float(T_oil)


def discharge_held(streams: Array) -> float:
    """Return the gas [kg/kg] that the outflow's oil holds in the mean, 0 where it is no state or none flows out."""
    out = streams[3]
    return float(out[4] / out[2]) if len(out) == 5 and out[2] < 0.0 else 0.0
