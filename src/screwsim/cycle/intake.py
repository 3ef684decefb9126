"""The gas at the suction port: what bypass and throttles make of that of the suction line.

Source: docs/model.md M160–M163, M341.
"""

from dataclasses import dataclass, replace

from screwsim.effects.base import SuctionChange
from screwsim.fluid.gas import Gas
from screwsim.model.parts import Parts
from screwsim.model.slots import ENTHALPY, PRESSURE

PortState = tuple[float, ...]


@dataclass(frozen=True)
class IntakeState:
    """The gas at the suction port: the line's, mixed with returned gas and throttled (M160–M163).

    `line` is the port state of the suction line, `pressure_ratio` that across all throttles, `returned` the share of
    returned gas; `kept` is the pressure ratio due to a package's losses, which count as one of the throttles.
    """

    gas: Gas
    line: PortState
    pressure_ratio: float = 1.0
    returned: float = 0.0
    kept: float = 1.0

    def ratio_of(self, part: SuctionChange) -> float:
        """Return the pressure ratio across one of the throttles."""
        return self.kept if part.package else part.pressure_ratio

    @property
    def changed(self) -> bool:
        """Whether the state at the suction port differs from the line's."""
        return self.pressure_ratio < 1.0 or self.returned > 0.0

    @property
    def pressure(self) -> float:
        """The pressure [Pa] before the machine's suction port."""
        return self.pressure_ratio * self.line[PRESSURE]

    def mixed(self, h_d: float) -> PortState:
        """Return the port state at the line's pressure with the returned gas of enthalpy h_d [J/kg] mixed in (M161)."""
        if self.returned == 0.0:
            return self.line
        h = (1.0 - self.returned) * self.line[ENTHALPY] + self.returned * h_d
        return self.gas.port_state_of_enthalpy(self.line[PRESSURE], h)

    def port_state(self, h_d: float) -> PortState:
        """Return the port state before the machine's suction port (M160, M161)."""
        mixed = self.mixed(h_d)
        if self.pressure_ratio == 1.0:
            return mixed
        return self.gas.port_state_of_enthalpy(self.pressure, mixed[ENTHALPY])

    def temperature(self, port_state: PortState, T_s: float) -> float:
        """Return the temperature [K] of a port state; T_s is the line's own."""
        return T_s if port_state is self.line else self.gas.temperature(port_state[PRESSURE], port_state[ENTHALPY])


def intake_of(parts: Parts, line: PortState, lost: float) -> IntakeState:
    """Return the gas at the suction port by a scene's effects, after a package's pressure loss `lost` [Pa] (M341)."""
    state = IntakeState(parts.gas, line, kept=1.0 - lost / line[PRESSURE])
    ratio, returned = 1.0, 0.0
    for _, part in parts.all(SuctionChange):
        ratio, returned = ratio * state.ratio_of(part), max(returned, part.returned)
    return replace(state, pressure_ratio=ratio, returned=returned) if ratio != 1.0 or returned != 0.0 else state
