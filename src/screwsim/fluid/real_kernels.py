"""The kernels of a real gas by fluid and treatment of two phases, and their compiled module for use from Python."""

from collections.abc import Callable
from functools import lru_cache
from types import ModuleType
from typing import Any

from screwsim.codegen.modules import load
from screwsim.fluid import isobar, limits
from screwsim.fluid.blend_dome import blend_equilibrium_kernels
from screwsim.fluid.description import describe
from screwsim.fluid.dome import EquilibriumKernels, equilibrium_kernels, margin_kernel, saturation_kernels
from screwsim.fluid.helmholtz import entropy_kernel, state_kernel
from screwsim.fluid.settings import EQUILIBRIUM
from screwsim.numerics.kept_text import flat_module
from screwsim.numerics.kernel import Kernel


def two_phases(fluid: str, two_phase: str) -> EquilibriumKernels | None:
    """Return the kernels of two phases in equilibrium; None where a single phase is continued."""
    if not describe(fluid).glides:
        return equilibrium_kernels(fluid)
    return blend_equilibrium_kernels(fluid) if two_phase == EQUILIBRIUM else None


def state_of(fluid: str, two_phase: str) -> Kernel:
    """Return the kernel (T, rho) → state."""
    known = two_phases(fluid, two_phase)
    return state_kernel(fluid) if known is None else known.state


def entropy_of(fluid: str, two_phase: str) -> Kernel:
    """Return the kernel (T, rho) → s [J/(kg K)]."""
    known = two_phases(fluid, two_phase)
    return entropy_kernel(fluid) if known is None else known.entropy


@lru_cache(maxsize=64)
def border(fluid: str, two_phase: str) -> ModuleType:
    """Return the compiled module of a fluid for use from Python."""
    known = saturation_kernels(fluid)
    single = state_kernel(fluid), entropy_kernel(fluid)
    slots = {
        "single_state": single[0].flat_name,
        "single_entropy": single[1].flat_name,
        "saturated_vapour": known.vapour.flat_name,
        "saturated_liquid": known.liquid.flat_name,
        "saturation_temperature": known.temperature.flat_name,
        "saturation_pressure": known.pressure.flat_name,
        "margin": margin_kernel(fluid).flat_name,
    }
    equilibrium = two_phases(fluid, two_phase)
    kernels = single if equilibrium is None else (*single, equilibrium.state, equilibrium.entropy)
    kernels += (known.vapour, known.liquid, known.temperature, known.pressure)
    calling = (isobar.density, isobar.at_pressure, limits.first_outside)
    return load(flat_module((*kernels, margin_kernel(fluid)), calling, slots), "fluid")


@lru_cache(maxsize=64)
def compiled(fluid: str, two_phase: str) -> dict[str, Callable[..., Any]]:
    """Return the compiled kernels of a fluid by the quantity that they return."""
    module, known = border(fluid, two_phase), saturation_kernels(fluid)
    kernels = {
        "state": state_of(fluid, two_phase),
        "single state": state_kernel(fluid),
        "entropy": entropy_of(fluid, two_phase),
        "vapour": known.vapour,
        "liquid": known.liquid,
        "pressure": known.pressure,
        "temperature": known.temperature,
        "density": isobar.density,
        "at_pressure": isobar.at_pressure,
        "first_outside": limits.first_outside,
    }
    return {what: getattr(module, kernel.flat_name) for what, kernel in kernels.items()}
