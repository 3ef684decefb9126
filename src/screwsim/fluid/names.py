"""Names of fluids: suggestions for unknown ones, and reasons why others have no data."""

import re

from screwsim.fluid.blend_border import blend_border
from screwsim.fluid.blend_flash import dome
from screwsim.fluid.composition import ENDING, is_blend, predefined
from screwsim.fluid.constants import ask
from screwsim.fluid.description import PSEUDO_PURE, describe
from screwsim.inputs.faults import UsageError


def why_no_blend(fluid: str) -> str | None:
    """Return in one line why a blend is not available; None for one that is, and for any other name."""
    try:
        if is_blend(fluid):
            blend_border(fluid)
    except UsageError as error:
        return str(error).removeprefix("gas.fluid: ")
    return None


def same_fluid(name: str) -> str | None:
    """Return the name or alias of the fluid that differs only in case, blanks or hyphens: 'r-134A' gives "'R134a'".

    A name without its isomer gives those that there are: "'R1234ze(E)' or 'R1234ze(Z)'". One that is merely similar
    belongs to another fluid: R134z is not R134a, and R454B not R404A.
    """

    def question() -> list[list[str]]:
        import CoolProp.CoolProp as coolprop

        names = coolprop.get_global_param_string("FluidsList").split(",")
        return [[each, *coolprop.get_fluid_param_string(each, "aliases").split(",")] for each in names]

    wanted, fluids = _bare(name), ask("fluids", question)
    found = sorted(known[0] for known in fluids if "(" in known[0] and _bare(known[0].partition("(")[0]) == wanted)
    if not found and wanted:
        same = ([each for each in known if _bare(each) == wanted] for known in fluids)
        found = [names[0] for names in same if names]
        found = found if len(found) == 1 else []
    return " or ".join(map(repr, found)) or None


def _bare(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def suggested_blend(name: str) -> str | None:
    """Return what to write for a blend that is misspelt; None for a name that is not a blend's."""
    wanted = _bare(name.removesuffix(ENDING))
    for each in predefined():
        if wanted and wanted == _bare(each.removesuffix(ENDING)):
            return f"did you mean '{each}'?"
    if "&" in name or "/" in name:
        return "write a blend of your own as fluid: [NAME, NAME], with mass_fractions or mole_fractions"
    if re.fullmatch(r"r[45][0-9]{2}[a-z]?", wanted):
        what = "R4xx and R5xx are blends, and CoolProp has none of this number"
        return f"{what} (write its components as fluid: [NAME, NAME], with mass_fractions)"
    return None


def why_no_dome(fluid: str) -> str | None:
    """Return in one line why two-phase equilibrium of a known fluid is not available; None where it is."""
    if not is_blend(fluid):
        known = describe(fluid)
        return PSEUDO_PURE.format(known.name) if known.pseudo_pure else None
    try:
        dome(fluid)
    except UsageError as error:
        return str(error).removeprefix("gas.two_phase: ")
    return None
