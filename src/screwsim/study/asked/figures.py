"""Names of figures as people write them: in any case, or as symbols (docs/reference/nomenclature.md)."""

import re
from collections.abc import Iterable
from contextlib import suppress

from screwsim.build import build_parts
from screwsim.figures import called_for, known, needs_of
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import names_containing
from screwsim.scene import Scene, case
from screwsim.scene.fields import unknown_key
from screwsim.study.asked.varied import Varied

# Lower case, without blanks, underscores and hyphens; symbols that may mean two figures ('eta', 'w') are left out
_SYMBOLS = {
    "volumetric_efficiency": "λ lambda ηv etav etavol",
    "isentropic_efficiency": "ηs etas etais ηis",
    "isothermal_efficiency": "ηiso etaiso ηt etat",
    "gas_mass_flow": "mdot ṁ massflow",
    "shaft_power": "pshaft",
    "indicated_power": "pind",
    "electrical_power": "pel",
    "discharge_temperature": "td",
    "cooling_capacity": "q0 qdot0 q̇0 refrigeratingcapacity refrigerationcapacity",
    "heating_capacity": "qh qdoth q̇h condensercapacity",
    "heating_cop": "coph copheating",
    "volumetric_cooling_capacity": "qv",
    "free_air_delivered": "fad freeair freeairdelivery",
}
_NAME_BY_SYMBOL = {symbol: name for name, symbols in _SYMBOLS.items() for symbol in symbols.split()}
_OF_STAGE = re.compile(r"(first|second)[._ ](\w+)")
_ONE_STAGE = "is a figure of one stage, not of these two together"
_NAME_REMEDY = "a name of performance in `run --json`"


def figure_named(text: str, here: Iterable[str] = (), others: Iterable[str] = (), option: str = "--figure") -> str:
    """Return the figure that a text names; raise UsageError with the nearest name, or with the figures `here`.

    Known are the program's figures, those `here`, and `others`; `option` names where the text was given.
    """
    here = tuple(here)
    every = tuple(dict.fromkeys((*known(), *here, *others)))
    bare = "".join(letter for letter in text.lower() if letter not in " _-")
    same = [name for name in every if name.replace("_", "") == bare]
    if same or bare in _NAME_BY_SYMBOL:
        return same[0] if same else _NAME_BY_SYMBOL[bare]
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if len(parts) > 1 and all(part in every for part in parts):
        remedy = f"give each one by itself: {option} {parts[0]} …"
        raise UsageError(f"{option} {text}: names {len(parts)} figures ({remedy})")
    short = [name for name in here or every if _abbreviates(text, name)]
    if len(short) == 1:
        raise UsageError(f"{option} {text}: is not known; did you mean '{short[0]}'?")
    there = ", ".join(here)
    raise UsageError(f"{option} {text}: {unknown_key(text, every, f'one of {there}' if there else _NAME_REMEDY)}")


def _abbreviates(text: str, name: str) -> bool:
    """Return whether each word of a text begins the word of a name: 'discharge temp' for discharge_temperature."""
    words, whole = re.split(r"[\s_-]+", text.lower()), name.split("_")
    pairs = zip(words, whole, strict=False)
    return len(words) == len(whole) > 1 and all(len(word) > 1 and each.startswith(word) for word, each in pairs)


def figure_of(scene: Varied, text: str, option: str = "--figure") -> str:
    """Return the figure of a scene, or of two stages together, that a text names.

    Raise UsageError with the figures there are where it has none of that name.
    """
    alone = isinstance(scene, Scene)
    here = figures_of(scene) if alone else tuple(scene.figures)
    of_stage = None if alone else _OF_STAGE.fullmatch(text)
    if of_stage and of_stage[2] in known() and "_".join(of_stage.groups()) not in here:
        raise UsageError(f"{option} {text}: {_ONE_STAGE} (use one of {', '.join(here)})")
    name = figure_named(text, here, option=option)
    if name not in here:
        what = "is not a figure of this scene" if alone else _ONE_STAGE
        if needs := needs_of(name) if alone else " and ".join(scene.lacks(name)):
            what = f"is not a figure of {'this scene' if alone else 'these two stages'}: it needs {needs}"
        use = names_containing(name, here) or here
        raise UsageError(f"{option} {text}: {what} (use {'one of ' if len(use) > 1 else ''}{', '.join(use)})")
    return name


def figures_of(scene: Scene) -> tuple[str, ...]:
    """Return the figures that a scene, or the first case of its sweep, calls for.

    A sweep's first case may lie at a border where the machine is not valid, which is tolerated.
    """
    found = dict.fromkeys(called_for(scene, build_parts(scene)))
    if scene.sweep:
        with suppress(UsageError):
            first = case(scene, 0)
            found |= dict.fromkeys(called_for(first, build_parts(first)))
    return tuple(found)
