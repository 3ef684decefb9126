"""Mechanical loss: bearings, seals and gears as a share of a power, and a friction mean effective pressure.

What: P = f |P_ind| (M33), or P = f |M_th| ω (M460), where M_th is the torque of compressing the whole displacement from
p_s to p_d without loss; and p_mf times the displaced flow (M461), which no pressure of the gas changes.
Source: Giuffrida, Appl. Therm. Eng. 93 (2016) 813: 26.5 % of the theoretical power for a small machine (f = 0.265);
p_mf as the constant term of Chen, Flynn, SAE 650733 (1965), and of the losses of a compressor in Jin, Oklahoma State
University (2002).
Assumptions: the loss is proportional to the speed, and to the indicated power or to that of the displacement between
the lines' pressures. With a slide or a throttle the indicated power falls with the gas flow, although the pressures on
bearings and shaft seals stay; with the theoretical power the friction torque stays. p_mf changes neither with pressures
nor with the speed.
Parameters: fraction, of, mean_effective_pressure.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, PowerLoss
from screwsim.effects.parts.usual import FRICTION
from screwsim.inputs.declare import choice, number, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import CYLINDER, ROTORS
from screwsim.outputs import power_figure

INDICATED, THEORETICAL = "indicated_power", "theoretical_power"


@dataclass(frozen=True)
class Parameters:
    """Share of a power, and a mean effective pressure."""

    fraction: float = number(
        "f: mechanical loss over the power that key of chooses (Giuffrida: 0.265)", ge=0.0, le=100.0, hardly=(None, 0.5)
    )
    of: str = choice(
        "indicated_power: the loss is proportional to it; theoretical_power: the torque of the loss stays constant at "
        "part load (M460)",
        (INDICATED, THEORETICAL),
        INDICATED,
    )
    mean_effective_pressure: float | None = quantity(
        "pressure_difference",
        "p_mf: friction mean effective pressure: besides that share, a loss of each turn over the displacement, "
        "whatever the pressures of the gas (M461; absent: 0)",
        None,
        ge=0.0,
        hardly=(None, 2e5),
    )


def build(parameters: Parameters, machine) -> list[PowerLoss]:
    def power(figures) -> float:
        """Return the mechanical loss [W]: in proportion to a power (M33, M460) and to the displaced flow (M461)."""
        indicated = parameters.of == INDICATED
        loss = figures.indicated_power if indicated else figures.theoretical_torque() * figures.omega
        share = parameters.fraction * abs(loss)
        if parameters.mean_effective_pressure is None:
            return share
        return share + parameters.mean_effective_pressure * machine.swept_volume / machine.pitch * abs(figures.omega)

    return [PowerLoss("mechanical_power", power, friction=True)]


def check(parameters: Parameters, facts) -> Faults:
    if parameters.of == THEORETICAL and facts.machine.expands:
        what = f"{THEORETICAL} counts the whole displacement of a compressor; an expander takes in less"
        yield Fault("effects.mechanical.of", f"{what} (write {INDICATED})")


EFFECT = Effect(
    name="mechanical",
    title="bearings, seals and gears",
    equations=("M33", "M460", "M461"),
    source="Giuffrida 2016; Chen, Flynn 1965",
    parameters=Parameters,
    build=build,
    check=check,
    figures=(power_figure("mechanical_power", "mechanical loss"),),
    usual={ROTORS: FRICTION, CYLINDER: FRICTION},
)
