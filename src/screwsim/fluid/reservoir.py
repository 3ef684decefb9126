"""A reservoir of the working fluid: a stagnant state, held constant, as streams and balances need it."""

from typing import NamedTuple


class Reservoir(NamedTuple):
    """Pressure [Pa], temperature [K], density [kg/m³], enthalpy [J/kg], entropy [J/(kg K)] and data of nozzle flow.

    `exponent` is 1/k, `choke` the relative pressure drop beyond which the flow is choked, `choked` ψ² there (M12, M13).
    """

    p: float
    T: float
    rho: float
    h: float
    s: float
    exponent: float
    choke: float
    choked: float

    @property
    def port_state(self) -> tuple[float, ...]:
        """(p, ρ, h, 1/k, drop and ψ² of choking), as returned by `port_state` of a gas."""
        return self.p, self.rho, self.h, self.exponent, self.choke, self.choked
