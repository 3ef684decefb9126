"""A real gas's cycle with CoolProp called in the right-hand side: what the compiled equation of state is measured by.

Everything else is ours and compiled; only the state function calls back into CoolProp's AbstractState for each of its
properties. For studies of cost and accuracy, not for work: nothing of it is kept on disk.
"""

from __future__ import annotations

import ctypes
import math
import re
from typing import Any

from screwsim.codegen.modules import Module
from screwsim.cycle.problem import problem_of
from screwsim.fluid.nozzle import choking
from screwsim.model.run import Machinery
from screwsim.scene.types import Scene

STATE = """def phased_state(phase, T, rho, P, TAB):
    found = np.empty(7)
    coolprop_state(T, rho, found)
    return found[0], found[1], found[2], found[3], found[4], found[5], found[6]
"""


def state_function(fluid: str) -> Any:
    """Return a C function (T, ρ, out) that fills out with p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking.

    With NaN where CoolProp refuses a state: the step that tried it is made again, shorter.
    """
    import CoolProp.CoolProp as coolprop

    state = coolprop.AbstractState("HEOS", fluid)
    state.specify_phase(coolprop.iphase_gas)  # no saturation is asked for: the equation alone

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


def machinery_with_coolprop(scene: Scene) -> Machinery:
    """Return a machinery for a real-gas scene whose chambers ask CoolProp; compiled anew in every process.

    Raises ValueError for an ideal gas.
    """
    if scene.gas.model != "real":
        raise ValueError("gas.model: only a real gas can be asked of CoolProp")
    composition = problem_of(scene).composition
    text = composition.text
    found = re.search(r"def phased_state\(.*?\n\n", text, flags=re.DOTALL)
    assert found is not None
    state = state_function(scene.gas.fluid)
    address = ctypes.cast(state, ctypes.c_void_p).value
    assert address is not None
    module = Module("coolprop back end", text.replace(found.group(0), STATE + "\n\n"), {"coolprop_state": address})
    vars(module)["state of CoolProp"] = state  # kept as long as what calls it
    return Machinery(composition, module)
