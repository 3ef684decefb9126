"""The kernels of a real gas by fluid and treatment of two phases, and their compiled module for use from Python."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from screwsim.codegen.modules import load
from screwsim.fluid import isobar, limits
from screwsim.fluid.blend_dome import blend_equilibrium_kernels
from screwsim.fluid.description import describe
from screwsim.fluid.dome import equilibrium_kernels, margin_kernel, saturation_kernels
from screwsim.fluid.helmholtz import entropy_kernel, state_kernel
from screwsim.fluid.settings import EQUILIBRIUM
from screwsim.numerics.kept_text import flat_module
from screwsim.numerics.kernel import Kernel


def kernels_of(fluid: str, two_phase: str) -> Mapping[str, Kernel]:
    """Return the kernels of a gas by name; those of two phases in equilibrium, unless a single one is continued."""
    if not describe(fluid).glides:
        return equilibrium_kernels(fluid)
    if two_phase == EQUILIBRIUM:
        return blend_equilibrium_kernels(fluid)
    return {"state": state_kernel(fluid), "specific_entropy": entropy_kernel(fluid)}


@lru_cache(maxsize=64)
def compiled(fluid: str, two_phase: str) -> dict[str, Callable[..., Any]]:
    """Return the compiled kernels of a fluid by the quantity that they return, for use from Python."""
    known, own = saturation_kernels(fluid), kernels_of(fluid, two_phase)
    kernels = {
        "single_state": state_kernel(fluid),
        "single_entropy": entropy_kernel(fluid),
        "state": own["state"],
        "specific_entropy": own["specific_entropy"],
        "saturated_vapour": known.vapour,
        "saturated_liquid": known.liquid,
        "saturation_temperature": known.temperature,
        "saturation_pressure": known.pressure,
        "margin": margin_kernel(fluid),
    }
    calling = {"density": isobar.density, "at_pressure": isobar.at_pressure, "first_outside": limits.first_outside}
    slots = {name: kernel.flat_name for name, kernel in kernels.items()}
    module = load(flat_module(tuple(kernels.values()), tuple(calling.values()), slots), "fluid")
    return {name: getattr(module, kernel.flat_name) for name, kernel in (kernels | calling).items()}
