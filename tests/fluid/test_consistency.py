"""A gas of the user's own that contradicts itself is refused, with the function and both numbers."""

import math
from dataclasses import dataclass

import pytest
from own_gases.covolume import CovolumeGas, specific_entropy, state
from test_gas_protocol import GASES

from screwsim.fluid.consistency import inconsistency
from screwsim.inputs.faults import QuantityNotFound
from screwsim.numerics.kernel import kernel

LINES = 1.2e5, 290.0, 12e5  # p_s [Pa], T_s [K], p_d [Pa]


@pytest.mark.parametrize("name", GASES)
def test_a_gas_of_one_equation_contradicts_nothing(name):
    assert inconsistency(GASES[name], *LINES) == ""


@kernel
def slope_without_temperature(T, rho, R_gas, k_gas, b_gas):
    p, h, c_v, TpT, a, drop, choked = state(T, rho, R_gas, k_gas, b_gas)
    return p, h, c_v, TpT / T, a, drop, choked


@kernel
def exponent_upside_down(T, rho, R_gas, k_gas, b_gas):
    p, h, c_v, TpT, a, drop, choked = state(T, rho, R_gas, k_gas, b_gas)
    return p, h, c_v, TpT, 1.0 / a, drop, choked


@kernel
def entropy_of_more(T, rho, R_gas, k_gas, b_gas):
    return -specific_entropy(T, rho, R_gas, k_gas, b_gas)


@kernel
def nothing_when_dense(T, rho, R_gas, k_gas, b_gas):
    if rho > 20.0:
        return math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return state(T, rho, R_gas, k_gas, b_gas)


FLAWS = {
    "state": (slope_without_temperature, "T ∂p/∂T [Pa] of its `state` at 1.2 bar, 290 K is "),
    "exponent": (exponent_upside_down, "1/k of its `state` at 1.2 bar, 290 K is "),
}


@pytest.mark.parametrize("flaw", FLAWS)
def test_a_kernel_of_another_equation_is_told(flaw):
    wrong, words = FLAWS[flaw]

    @dataclass(frozen=True)
    class Wrong(CovolumeGas):
        state = wrong

    assert inconsistency(Wrong(81.49, 1.12, 1e-3), *LINES).startswith(words)


def test_a_state_that_is_sought_and_not_there_is_told():
    @dataclass(frozen=True)
    class Wrong(CovolumeGas):
        state = nothing_when_dense

    with pytest.raises(QuantityNotFound, match="no vapour at 12 bar"):
        inconsistency(Wrong(81.49, 1.12, 1e-3), *LINES)


def test_an_entropy_of_another_sign_is_told():
    @dataclass(frozen=True)
    class Wrong(CovolumeGas):
        specific_entropy = entropy_of_more

    assert inconsistency(Wrong(81.49, 1.12, 1e-3), *LINES).startswith("T ∂s/∂T [J/(kg K)] of its `specific_entropy`")


PLAIN = {
    "density": ("density", 1.01, "p of its kernel `state`, with its density("),
    "no density": ("density", math.nan, "p of its kernel `state`, with its density("),
    "enthalpy": ("enthalpy", 1.01, "its enthalpy [J/kg] at"),
    "isentropic_work": ("isentropic_work", 1.1, "its entropy [J/(kg K)] after isentropic_work is "),
    "isothermal_work": ("isothermal_work", 1.01, "its isothermal_work [J/kg] is "),
}


@pytest.mark.parametrize("name", PLAIN)
def test_plain_python_of_another_equation_is_told(name):
    of, factor, words = PLAIN[name]
    wrong = type("Wrong", (CovolumeGas,), {of: lambda self, *at: factor * getattr(CovolumeGas, of)(self, *at)})
    assert inconsistency(wrong(81.49, 1.12, 1e-3), *LINES).startswith(words)
