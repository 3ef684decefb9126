"""Gas and oil that mix in the separator: their common temperature at discharge pressure, by the energy balance.

Source: docs/model.md M280, M281, the first law. Plain Python, called once a cycle.
"""

from typing import Any, NamedTuple

from screwsim.outputs.customary import in_celsius

NEAR = 1e-12  # relative accuracy of the gas's enthalpy
MOST = 60  # most iterations for it
WET = 1e-6  # relative distance from saturation within which the gas counts as condensing
CONDENSES = (
    "gas condenses in the separator: gas and oil mix at {T}, which is the saturation temperature at discharge "
    "pressure (use warmer oil, less oil, or a smaller cooler duty)"
)


class SeparatorInflow(NamedTuple):
    """The flows that a cycle delivers to the separator (SI units).

    `gas_flow` [kg/s] is what leaves as gas once the oil has reabsorbed the gas that it had released. `energy` [W] is
    the enthalpy flow of everything above that of gas with enthalpy `h_ref` [J/kg] and oil at the supply temperature
    `T_supply`; `T_inlet` [K] is that of the suction line's gas. `heating` [W] are the losses that heat gas and oil on
    their way, `friction` [W] those of bearings, seals and gears. `supplied` [W] is what enters the chambers above
    `h_ref`: work, gas from other port states, heat of walls.
    """

    gas: Any
    p: float
    gas_flow: float
    h_ref: float
    oil_flow: float
    oil_heat_capacity: float
    T_supply: float
    T_inlet: float
    energy: float
    heating: float
    friction: float
    supplied: float

    @property
    def oil_capacity(self) -> float:
        """Heat capacity rate of the oil's flow [W/K]."""
        return self.oil_flow * self.oil_heat_capacity

    def heat_of(self, T: float) -> float:
        """Return the enthalpy flow [W] of the gas at a temperature [K] above that of `h_ref`."""
        return self.gas_flow * (self.gas.enthalpy(self.p, T) - self.h_ref)

    def temperature(self, heat: float) -> tuple[float, bool]:
        """Return the mixture's temperature [K] with `heat` [W] added to `energy`, and whether its gas condenses.

        The gas's enthalpy is the unknown: the balance increases with it smoothly, except where the gas begins to
        condense.
        """
        total, C = self.energy + heat, self.oil_capacity
        T = self.gas.temperature(self.p, self._enthalpy(total, C))
        return T, self.gas.nearest_vapour(self.p, T * (1.0 - WET)) != T * (1.0 - WET)

    def _enthalpy(self, total: float, C: float) -> float:
        """Return the enthalpy [J/kg] of the gas at which gas and oil together have `total` [W]."""

        def lacks(h: float) -> float:
            return self.gas_flow * (h - self.h_ref) + C * (self.gas.temperature(self.p, h) - self.T_supply) - total

        slope = self.gas_flow + C / self.gas.c_p
        h = self.gas.enthalpy(self.p, self.gas.nearest_vapour(self.p, self.T_supply))
        open_ = lacks(h)
        for _ in range(MOST):
            if open_ == 0.0:
                break
            step = -open_ / slope
            after = lacks(h + step)
            slope = (after - open_) / step if after != open_ else slope
            h, open_ = h + step, after
            if abs(step) <= NEAR * abs(h):
                break
        return h


class Separated(NamedTuple):
    """State in which a cycle's gas and oil part, and duty of the cooler (SI units); see `effects.separator`.

    `supply` [K] is the change of the oil's supply temperature that should close the circuit, `open` [W] the present
    residual of the circuit; both are zero where the supply temperature is stated. `share` is the response of the
    separator's temperature to the supply's, `gain` the change of the supply per error of the separator's temperature.
    `load` is the duty over the most that the coolant takes; None where that is not bounded, or nothing. `why` says what
    rules the point out, `told` is a warning.
    """

    T_mixture: float
    T_separator: float
    duty: float
    ambient_loss: float
    lost_friction: float
    supply: float = 0.0
    open: float = 0.0
    share: float = 0.0
    gain: float = 0.0
    load: float | None = None
    why: str = ""
    told: str = ""


def separated(outflow: SeparatorInflow, friction_share: float = 1.0, ambient_loss: float = 0.0) -> Separated:
    """Return the temperatures of mixture and separator, and the duty at the present supply temperature (M280–M283)."""
    heating = outflow.heating + friction_share * outflow.friction
    T_mixture, wet = outflow.temperature(heating)
    T, wet_there = (T_mixture, wet) if ambient_loss == 0.0 else outflow.temperature(heating - ambient_loss)
    why = CONDENSES.format(T=in_celsius(T)) if wet or wet_there else ""
    lost = (1.0 - friction_share) * outflow.friction
    return Separated(T_mixture, T, outflow.oil_capacity * (T - outflow.T_supply), ambient_loss, lost, why=why)
