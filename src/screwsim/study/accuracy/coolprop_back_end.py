"""Cycle of a real gas with CoolProp called in the right-hand side, as a check of the compiled equation of state.

Everything else is compiled as usual; only the state function calls back into CoolProp's AbstractState for each
property. For studies of cost and accuracy, not for production: nothing of it is cached on disk.
"""

import ctypes
import math
import re
from typing import Any

from screwsim.codegen.modules import Module
from screwsim.cycle.problem import problem_of
from screwsim.fluid.description import describe
from screwsim.fluid.models import find_gas_model
from screwsim.fluid.nozzle import choking
from screwsim.model.run import Machinery
from screwsim.numerics.derivative import tangent
from screwsim.scene.types import Scene

STATE_KERNEL = """def {name}({arguments}):
    found = np.empty(7)
    coolprop_state(T, rho, found)
    return found[0], found[1], found[2], found[3], found[4], found[5], found[6]
"""
SLOPES_KERNEL = """def {name}({arguments}):
    p, h, c, t, a, x, f = {state}({arguments})
    d = {step} * T
    T = T + d
    p_1, h_1, c_1, t_1, a_1, x_1, f_1 = {state}({arguments})
    T = T - d
    e = {step} * rho
    rho = rho + e
    p_2, h_2, c_2, t_2, a_2, x_2, f_2 = {state}({arguments})
    by_T = (p_1 - p) / d, (h_1 - h) / d, (c_1 - c) / d, (t_1 - t) / d, 0.0, 0.0, 0.0
    by_rho = (p_2 - p) / e, (h_2 - h) / e, (c_2 - c) / e, (t_2 - t) / e, 0.0, 0.0, 0.0
    return p, h, c, t, a, x, f, {of_T}, {of_rho}
"""
DIFFERENCE_STEP = 1e-7  # relative step of the differences: CoolProp does not give all derivatives that are needed


def state_function(fluid: str) -> Any:
    """Return a C function (T, ρ, out) that fills out with p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking.

    Where CoolProp refuses a state, out is NaN: the integrator then repeats the step with a shorter one.
    """
    import CoolProp.CoolProp as coolprop

    known = describe(fluid)
    state = coolprop.AbstractState("HEOS", "&".join(known.components) if known.blend else fluid)
    if known.blend:
        state.set_mole_fractions(list(known.fractions))
    state.specify_phase(coolprop.iphase_gas)  # no saturation is computed: the equation of state alone

    def fill(T: float, rho: float, address: int) -> None:
        out = (ctypes.c_double * 7).from_address(address)
        try:
            state.update(coolprop.DmassT_INPUTS, rho, T)
            p = state.p()
            k = rho * state.speed_sound() ** 2 / p
            slope = state.first_partial_deriv(coolprop.iP, coolprop.iT, coolprop.iDmass)
            out[:] = (p, state.hmass(), state.cvmass(), T * slope, 1.0 / k, *choking(k))
        except ValueError:
            out[:] = (math.nan,) * 7

    return ctypes.CFUNCTYPE(None, ctypes.c_double, ctypes.c_double, ctypes.c_void_p)(fill)


def is_replaceable(scene: Scene) -> bool:
    """Return whether CoolProp can replace a scene's gas."""
    return find_gas_model(scene.gas.model).by_coolprop and not scene.gas.relative_humidity


def machinery_with_coolprop(scene: Scene) -> Machinery:
    """Return a machinery for a real-gas scene whose chambers call CoolProp; compiled anew in every process.

    Raises ValueError for an ideal gas or moist air.
    """
    if not is_replaceable(scene):
        raise ValueError("gas.model: CoolProp provides real gases only, and no moist air here")
    problem = problem_of(scene)
    gas, text = problem.parts.gas, problem.composition.text
    kernel = gas.state if gas.phased_state is None else gas.phased_state[1]
    each = ", ".join(kernel.arguments)
    text = _replaced(text, STATE_KERNEL.format(name=kernel.flat_name, arguments=each))
    named = {"name": tangent(kernel, ("T", "rho")).flat_name, "state": kernel.flat_name, "arguments": each}
    named |= {f"of_{of}": ", ".join(f"by_{of}[{i}]" for i in range(7)) for of in ("T", "rho")}
    text = _replaced(text, SLOPES_KERNEL.format(step=DIFFERENCE_STEP, **named))
    state = state_function(scene.gas.name)
    address = ctypes.cast(state, ctypes.c_void_p).value
    assert address is not None
    module = Module("coolprop back end", text, {"coolprop_state": address})
    vars(module)["state of CoolProp"] = state  # kept alive as long as its caller
    return Machinery(problem.composition, module)


def _replaced(text: str, function: str) -> str:
    """Return a text with a function replaced by another one of the same name."""
    head = function[: function.index("(") + 1]
    found = re.search(rf"^{re.escape(head)}.*?\n\n", text, flags=re.DOTALL | re.MULTILINE)
    assert found is not None
    return text.replace(found.group(0), function + "\n\n")
