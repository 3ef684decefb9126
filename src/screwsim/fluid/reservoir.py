"""A reservoir of the working fluid: a state at rest, held constant, as streams and balances need it."""

from typing import NamedTuple


class Reservoir(NamedTuple):
    """Pressure [Pa], temperature [K], density [kg/m³], enthalpy [J/kg], entropy [J/(kg K)] and what nozzles ask.

    `exponent` is 1/k, `choke` the relative pressure drop from which on flow is choked, `choked` ψ² there (M12, M13).
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
        """Return (p, ρ, h, 1/k, drop and ψ² of choking), as `port_state` of a gas does."""
        return self.p, self.rho, self.h, self.exponent, self.choke, self.choked
