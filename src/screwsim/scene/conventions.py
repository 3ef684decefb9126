"""Which point of a fluid with glide a condensing temperature is, beside that of EN 12900 and AHRI 540 (M316)."""

from screwsim.fluid import constants
from screwsim.fluid.composition import is_blend
from screwsim.fluid.description import describe
from screwsim.scene.types import Scene

GLIDES = 0.2  # [K] distance of dew and bubble point in the condenser above which it is told: some 0.7 % of a COP


def of_scene(scene: Scene) -> str:
    """Return that a scene's condensing temperature is not the standards'; empty where it is, or states none."""
    T = scene.operation.condensing_temperature
    return "" if T is None else other_convention(scene.gas.name, T)


def other_convention(fluid: str, T: float, what: str = "the condensing temperature") -> str:
    """Return that a condensing temperature T [K], called `what`, is not the standards', of a fluid with glide.

    Empty where it is: of a pure fluid, and of a blend, whose temperatures are dew points.
    """
    glide = glide_to_tell(fluid, T)
    if not glide:
        return ""
    blend = f"{fluid}.mix"
    remedy = f"write gas.fluid: {blend}" if is_blend(blend) else "add it to compare"
    above = f"of {fluid} {glide:.2g} K above the bubble point that {what} is here"
    return f"EN 12900 and AHRI 540 state the dew point in the condenser, {above} ({remedy})"


def glide_to_tell(fluid: str, T: float) -> float:
    """Return how far [K] the dew point is above a condensing temperature T [K] that is a bubble point.

    0 where it is a dew point, or where that is too little to tell.
    """
    if is_blend(fluid) or not describe(fluid).pseudo_pure:
        return 0.0
    found = constants.glide(fluid, constants.condensing_pressure(fluid, T))
    return found if found > GLIDES else 0.0
