"""Short names of inputs, as maps and the files of other tools have them: evaporating_temperature, second_speed."""

from screwsim.effects import having
from screwsim.effects.parts.usual import SLIDES
from screwsim.study.stages.axes import STAGE_NAMES, names_in_chain

NAMES = {  # of paths whose last words would not do
    "operation.suction.pressure": "suction_pressure",
    "operation.suction.temperature": "suction_temperature",
    "operation.suction.superheat": "superheat",
    "operation.discharge.pressure": "discharge_pressure",
    "oil_supply.temperature": "oil_temperature",
    "oil_supply.ratio": "oil_ratio",
    "machine.slide_valve.position": "slide_position",
    **dict.fromkeys(having(SLIDES), "slide_position"),
}


def short_name(path: str) -> str:
    """Return the short name of an input: a usual one, else the last words of its path.

    Of two stages it begins with the stage where both have such an input: first_speed, but evaporating_temperature.
    """
    stage, _, own = path.partition(".")
    if stage in STAGE_NAMES:
        return short_name(own) if len(names_in_chain(own)) == 1 else f"{stage}_{short_name(own)}"
    words = path.split(".")[-1 if path.startswith("operation.") else -2 :]
    return NAMES.get(path, "_".join(words))
