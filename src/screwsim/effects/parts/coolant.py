"""What carries the heat of a package away: its volume flow and how much warmer it becomes.

From the heat over ρ c_p ΔT alone: one of flow and rise is stated, the other follows. Nothing of it acts back, as the
temperature that coolers count from is a scene's own.
Source: first law; water at 25 °C and 1 atm by IAPWS-95.
"""

from dataclasses import dataclass

from screwsim.effects.base import Given
from screwsim.inputs.declare import choice, quantity
from screwsim.outputs import Figure

AIR, WATER = "air", "water"
FLOW, RISE = "coolant_flow", "coolant_temperature_rise"
WATER_HEAT = 997.0 * 4182.0  # [J/(m³ K)] ρ c_p
DENSEST_ROOM = 1.2e5  # [Pa] air of a room has at the most, that of a mine of 1.5 km
NO_HEAT = "no heat leaves by it"
FIGURES = (
    Figure(FLOW, "m3 s-1", "volume flow of what carries the package's heat away", needs=(".coolant",)),
    Figure(RISE, "kelvin", "by how much that becomes warmer", needs=(".coolant",)),
)


@dataclass(frozen=True)
class Coolant:
    """Air of the room, or water, that carries the heat away; one of its temperature rise and its flow."""

    medium: str = choice(
        "air, which takes all heat of the package; water, which takes that of oil cooler and aftercooler",
        (AIR, WATER),
        AIR,
    )
    temperature_rise: float | None = quantity(
        "temperature_difference", "by how much it becomes warmer", None, gt=0.0, le=100.0, hardly=(2.0, 40.0)
    )
    flow: float | None = quantity("volume_flow", "its volume flow, as it enters", None, gt=0.0)

    def figures(self, heat: float | str | None, air: float) -> Given:
        """Return flow [m³/s] and rise [K] by the heat [W] that leaves; `air` is ρ c_p [J/(m³ K)] of the room's air.

        A heat that is a text says why there is none.
        """
        if heat is None or isinstance(heat, str) or not heat > 0.0:
            return dict.fromkeys((FLOW, RISE), heat if isinstance(heat, str) else NO_HEAT)
        per_kelvin = air if self.medium == AIR else WATER_HEAT
        if self.temperature_rise is not None:
            return {FLOW: heat / (per_kelvin * self.temperature_rise), RISE: self.temperature_rise}
        assert self.flow is not None
        return {FLOW: self.flow, RISE: heat / (per_kelvin * self.flow)}

    def told(self, rise: float, most: float) -> tuple[str, ...]:
        """Return a warning of a rise [K] beyond `most`, at which the coolant is as hot as the separator; else none."""
        if rise <= most:
            return ()
        what = (
            f"effects.air_package.coolant becomes warmer by {rise:.4g} K, and would leave hotter than the separator is"
        )
        remedy = "a larger flow" if self.flow is not None else "a smaller temperature_rise"
        return (f"{what}, {most:.3g} K above what enters (choose {remedy})",)
