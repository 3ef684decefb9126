"""A user's effect that returns what cannot be, where and what its parameters say."""

from __future__ import annotations

import math
from dataclasses import dataclass

from screwsim.effects.base import (
    Drawn,
    Effect,
    FeedbackUnknown,
    FlowPath,
    HeatRate,
    Made,
    Plenum,
    PowerLoss,
    Reading,
    Site,
    Turn,
    Wall,
)
from screwsim.inputs.declare import choice, number, quantity
from screwsim.numerics.kernel import kernel

DEGREE = math.pi / 180.0
POWERS = {"right": 10.0, "nan": math.nan, "inf": math.inf, "gain": -1e9, "none": None, "text": "ten"}


@dataclass(frozen=True)
class Parameters:
    """What goes wrong between two angles: nothing, or what 1 returns by default."""

    opens: float = quantity("angle", "where it begins", 400.0 * DEGREE)
    closes: float = quantity("angle", "where it ends", 420.0 * DEGREE)
    area: float = number("sign of the area there", 1.0)
    spread: float = number("divides the area there", 1.0)
    level: float = number("under a root, of the area there", 1.0)
    coefficient: float = number("flow coefficient", 0.7)
    hot: float = quantity("temperature", "above which the heat rate is the root of a negative number", 1e4)
    gain: float = number("sign of the conductance there", 1.0)
    power: str = choice("what the loss is", tuple(POWERS), "right")
    kept: float = number("power that the oil keeps [W]", 0.0)
    made: str = choice("what the cycle makes", ("right", "nan"), "right")
    figure: str = choice("what is read", ("right", "nan"), "right")
    pressure: str = choice("what is in the plenum", ("right", "nan"), "right")


@kernel
def area(phi, size, opens, closes, sign, spread, level):
    """Return a constant area [m²], but for what goes wrong."""
    if opens < phi < closes:
        return sign * size * math.sqrt(level) / spread
    return size


@kernel
def heat(T, T_oil, m_oil, hot):
    """Return a little heat [W] from the oil, none that is a number where the gas is hot."""
    return 1e-3 * (T_oil - T) * math.sqrt(hot - T) * m_oil


@kernel
def conductance(phi, gain, opens, closes):
    """Return a small conductance [W/K], a negative one where it goes wrong."""
    return 1e-3 * gain if opens < phi < closes else 1e-3


def build(parameters: Parameters, machine) -> list:
    window = {"opens": parameters.opens, "closes": parameters.closes}
    wrongs = {"sign": parameters.area, "spread": parameters.spread, "level": parameters.level}
    sizes = {"size": 1e-7, **window, **wrongs}
    nan = {name: getattr(parameters, name) == "nan" for name in ("made", "figure", "pressure")}

    def state(site: Site):
        held = site.gas.vapour(0.5 * (site.p_s + site.p_d), site.T_s)
        return held._replace(p=math.nan) if nan["pressure"] else held

    def figures(drawn: Drawn):
        return {"economizer_mass_flow": math.nan if nan["figure"] else drawn.flow}

    def image(turn: Turn) -> float:
        return math.nan if nan["made"] else 300.0

    breakpoints = (parameters.opens, parameters.closes)
    return [
        FlowPath("vessel", area=area, values=sizes, breakpoints=breakpoints, flow_coefficient=parameters.coefficient),
        FlowPath(to="neighbour", area=area, values=sizes, breakpoints=breakpoints, offset=1),
        Plenum("vessel", state, figures),
        HeatRate(heat, {"hot": parameters.hot}),
        Made(FeedbackUnknown("wrong_temperature"), lambda site: 300.0, image),
        Wall("wrong", conductance, {"gain": parameters.gain, **window}, "wrong_temperature"),
        PowerLoss("bearing_power", lambda known: POWERS[parameters.power], lambda known: parameters.kept),
        Reading((), lambda known: {}),
    ]


EFFECT = Effect(
    name="wrong",
    title="returns what cannot be",
    equations=(),
    source="a test",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil",),
)
