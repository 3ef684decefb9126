"""Which point of a fluid with glide a condensing temperature is, beside that of EN 12900 and AHRI 540 (M316)."""

from screwsim.fluid import constants
from screwsim.fluid.composition import is_blend
from screwsim.scene.types import Scene

GLIDES = 0.1  # [K] distance of dew and bubble point in the condenser above which it is told


def of_scene(scene: Scene) -> str:
    """Return that a scene's condensing temperature is not the standards'; empty where it is, or states none."""
    T = scene.operation.condensing_temperature
    return "" if T is None else other_convention(scene.gas.name, T)


def other_convention(fluid: str, T: float, what: str = "the condensing temperature") -> str:
    """Return that a condensing temperature T [K], called `what`, is not the standards', of a fluid with glide.

    Empty where it is: of a pure fluid, and of a blend, whose temperatures are dew points.
    """
    glide = 0.0 if is_blend(fluid) else constants.glide(fluid, constants.condensing_pressure(fluid, T))
    if glide <= GLIDES:
        return ""
    blend = f"{fluid}.mix"
    remedy = f"write gas.fluid: {blend}" if is_blend(blend) else "add it to compare"
    above = f"of {fluid} {glide:.2g} K above the bubble point that {what} is here"
    return f"EN 12900 and AHRI 540 state the dew point in the condenser, {above} ({remedy})"
