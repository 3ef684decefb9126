"""The ideal gas: its laws, and its constants against CoolProp."""

import math
from itertools import count

import numpy as np
import pytest
from scipy.integrate import quad

from screwsim.fluid import constants
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.numerics import store
from screwsim.numerics.kernel import Kernel

GAS = IdealGas(R=81.49, k=1.12)
ROUNDING = 1e-13


def state(T, rho):
    kernel = GAS.state
    assert isinstance(kernel, Kernel)
    return dict(
        zip(("p", "h", "c_v", "TpT", "a", "choke", "choked"), kernel(T, rho, *GAS.values.values()), strict=True)
    )


def test_values_are_named_in_the_order_of_the_kernels_arguments():
    assert ("T", "rho", *GAS.values) == GAS.state.arguments


def test_cp_minus_cv_is_R():
    assert GAS.c_p - GAS.c_v == pytest.approx(GAS.R, rel=ROUNDING)


def test_k_is_cp_over_cv():
    assert GAS.c_p / GAS.c_v == pytest.approx(GAS.k, rel=ROUNDING)


def test_pressure_is_rho_R_T():
    assert state(300.0, 7.0)["p"] == pytest.approx(7.0 * GAS.R * 300.0, rel=ROUNDING)


def test_density_inverts_the_pressure():
    assert GAS.density(state(300.0, 7.0)["p"], 300.0) == pytest.approx(7.0, rel=ROUNDING)


def test_temperature_inverts_the_enthalpy():
    assert GAS.temperature(3e5, GAS.enthalpy(3e5, 321.0)) == pytest.approx(321.0, rel=ROUNDING)


def test_enthalpy_is_inner_energy_plus_p_over_rho():
    found = state(300.0, 7.0)
    assert found["h"] == pytest.approx(found["c_v"] * 300.0 + found["p"] / 7.0, rel=ROUNDING)


def test_T_dp_dT_is_the_pressure():
    found = state(300.0, 7.0)
    assert found["TpT"] == found["p"]


def test_a_plenum_and_a_chamber_of_one_state_are_one_port_state():
    p, rho, h, a, choke, choked = GAS.port_state(3e5, 300.0)
    found = state(300.0, rho)
    assert (found["p"], found["h"], found["a"], found["choke"], found["choked"]) == pytest.approx(
        (p, h, a, choke, choked), rel=ROUNDING
    )


def test_isentropic_work_is_the_integral_of_dp_over_rho():
    p_1, p_2, T = 1.5e5, 12e5, 283.0
    rho_1 = GAS.density(p_1, T)
    integral, _ = quad(lambda p: 1.0 / (rho_1 * (p / p_1) ** (1 / GAS.k)), p_1, p_2, epsrel=1e-12)
    assert GAS.isentropic_work(p_1, p_2, T) == pytest.approx(integral, rel=1e-10)  # the quadrature's


def test_isothermal_work_is_the_integral_of_dp_over_rho():
    p_1, p_2, T = 1.5e5, 12e5, 283.0
    integral, _ = quad(lambda p: GAS.R * T / p, p_1, p_2, epsrel=1e-12)
    assert GAS.isothermal_work(p_1, p_2, T) == pytest.approx(integral, rel=1e-10)


def test_isentropic_work_tends_to_isothermal_work_as_k_tends_to_one():
    nearly = IdealGas(R=81.49, k=1.0 + 1e-6)
    # the difference is (k−1)/k ln(p2/p1)/2 = 1e-6 relative; (k−1) has lost six digits
    assert nearly.isentropic_work(1e5, 8e5, 300.0) == pytest.approx(nearly.isothermal_work(1e5, 8e5, 300.0), rel=2e-6)


# ---- constants against CoolProp itself ----


@pytest.fixture
def fresh(monkeypatch, tmp_path):
    """Let `constants` ask CoolProp anew, into an empty cache folder."""
    monkeypatch.setenv("SCREWSIM_CACHE", str(tmp_path))
    monkeypatch.setattr(constants, "_answered", count())
    forget()
    yield tmp_path
    forget()


def forget():
    """Let this process be one that has not asked anything yet."""
    constants._known.clear()
    constants._stored_lines.cache_clear()


def coolprop():
    return pytest.importorskip("CoolProp.CoolProp")


def test_the_gas_constant_is_coolprops(fresh):
    CP = coolprop()
    expected = CP.PropsSI("gas_constant", "R134a") / CP.PropsSI("molar_mass", "R134a")
    assert constants.gas_constant("R134a") == pytest.approx(expected, rel=ROUNDING)


def test_the_heat_capacity_is_coolprops_of_the_ideal_gas(fresh):
    expected = coolprop().PropsSI("CP0MASS", "T", 283.0, "P", 1e3, "R134a")
    assert constants.ideal_heat_capacity("R134a", 283.0) == pytest.approx(expected, rel=1e-12)


def test_the_saturation_temperature_is_coolprops(fresh):
    expected = coolprop().PropsSI("T", "P", 1.5e5, "Q", 1, "R134a")
    assert constants.saturation_temperature("R134a", 1.5e5) == pytest.approx(expected, rel=1e-10)  # its own iteration


def test_the_isentropic_exponent_is_that_of_the_ideal_gas(fresh):
    c_p, R = constants.ideal_heat_capacity("R134a", 283.0), constants.gas_constant("R134a")
    assert constants.isentropic_exponent("R134a", 283.0) == pytest.approx(c_p / (c_p - R), rel=ROUNDING)


def test_cached_constants_are_the_asked_ones_bit_for_bit(fresh):
    asked = constants.ideal_heat_capacity("R134a", 290.0)
    forget()
    assert constants.ideal_heat_capacity("R134a", 290.0) == asked


def test_a_torn_cache_file_is_asked_again(fresh):
    asked = constants.gas_constant("R134a")
    for path in fresh.glob("coolprop-*"):
        path.write_text("{")
    forget()
    assert constants.gas_constant("R134a") == asked


def test_an_unknown_fluid_is_named(fresh):
    from screwsim.inputs.faults import UsageError

    with pytest.raises(UsageError, match="no pure fluid 'R134z'"):
        constants.gas_constant("R134z")


def test_saturation_above_the_critical_pressure_is_refused_without_asking_twice(fresh, monkeypatch):
    from screwsim.inputs.faults import UsageError

    with pytest.raises(UsageError, match=r"no saturation at 60 bar \(critical: 40\.5\d+ bar\)") as asked:
        constants.saturation_temperature("R134a", 60e5)
    forget()
    monkeypatch.setattr(constants, "coolprop_state", lambda _: never())
    with pytest.raises(UsageError) as kept:
        constants.saturation_temperature("R134a", 60e5)
    assert str(kept.value) == str(asked.value)


def test_heat_capacity_rises_with_temperature_as_vibrations_do(fresh):
    values = [constants.ideal_heat_capacity("R134a", T) for T in (250.0, 300.0, 350.0)]
    assert np.all(np.diff(values) > 0.0) and math.isfinite(sum(values))


def test_many_processes_may_keep_answers_in_one_file(fresh):
    first = constants.gas_constant("R134a")
    (path,) = fresh.glob("coolprop-*")
    store.append_line(path.name, '["of another process", 1.5]', constants._FULL)
    with path.open("a") as stream:
        stream.write('["torn')
    second = constants.gas_constant("R32")
    forget()
    known = constants.ask("R134a R", never), constants.ask("of another process", never), constants.ask("R32 R", never)
    assert known == (first, 1.5, second)


def never():
    raise AssertionError("it was asked again")


def test_answers_about_many_conditions_fill_neither_memory_nor_disk(fresh, monkeypatch):
    monkeypatch.setattr(constants, "_FULL", 2000)
    monkeypatch.setattr(constants, "_MOST", 50)
    asked = [constants.dew_pressure("R134a", 250.0 + 0.5 * step) for step in range(80)]
    (path,) = fresh.glob("coolprop-*")
    assert path.stat().st_size < 2200
    assert len(constants._known) == 50
    forget()
    assert 20 < len(constants._stored_lines()) < 50 and not path.exists()  # full: what it held serves this process
    assert [constants.dew_pressure("R134a", 250.0 + 0.5 * step) for step in range(80)] == asked
    assert path.stat().st_size < 2200


def test_a_sweep_leaves_others_the_answers_that_it_asked_for_first(fresh, monkeypatch):
    monkeypatch.setattr(constants, "_LEFT", 3)
    for step in range(8):
        constants.dew_pressure("R134a", 250.0 + step)
    forget()
    assert len([*filter(None, map(store.checked_line, constants._stored_lines().values()))]) == 3


def test_saturation_is_coolprops(fresh):
    PropsSI = coolprop().PropsSI
    assert constants.dew_pressure("R134a", 275.15) == pytest.approx(PropsSI("P", "T", 275.15, "Q", 1, "R134a"))
    assert constants.bubble_pressure("R407C", 318.15) == pytest.approx(PropsSI("P", "T", 318.15, "Q", 0, "R407C"))
    assert constants.bubble_pressure("R407C", 300.0) > constants.dew_pressure("R407C", 300.0)


def test_dew_pressure_inverts_the_saturation_temperature(fresh):
    assert constants.saturation_temperature("R134a", constants.dew_pressure("R134a", 275.15)) == pytest.approx(275.15)


def test_limits_of_an_unknown_fluid_are_none_and_kept(fresh):
    assert constants.limits("R134z") is None
    forget()
    assert constants.ask("R134z limits", never) is None
    assert constants.limits("R32&R125") is None


def test_saturation_ends_at_the_limits(fresh):
    found = constants.limits("R134a")
    assert found is not None
    assert constants.dew_pressure("R134a", found.T_triple) == pytest.approx(found.p_triple)
    # CoolProp's saturation lines meet within 1e-9 at the critical point
    assert constants.bubble_pressure("R134a", found.T_critical) == pytest.approx(found.p_critical, rel=1e-8)
