"""What every gas keeps (`fluid.gas`): one equation behind kernels and plain Python, thermodynamically consistent.

A gas of another back end is added to GASES; derivatives are central differences.
"""

import json

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from own_gases.covolume import CovolumeGas
from own_gases.other_zero import OtherZero
from own_gases.peng_robinson import PengRobinson

from screwsim.explain import explain
from screwsim.figures.errors import relative_errors, worst
from screwsim.fluid.gas import Gas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.limits import Limit, Outside
from screwsim.fluid.models import GasRequest, find_gas_model
from screwsim.fluid.moist_air import MoistAir
from screwsim.fluid.nozzle import choking
from screwsim.fluid.real_gas import RealGas
from screwsim.inputs.faults import QuantityNotFound, SceneError, UsageError
from screwsim.numerics.kernel import Kernel
from screwsim.results.schema import identity_of
from screwsim.scene import loads
from screwsim.simulate import simulate

GASES = {
    "ideal": IdealGas(81.49, 1.12),
    "real": RealGas("R134a"),
    "in equilibrium": RealGas("R134a", "equilibrium"),
    "pseudo-pure": RealGas("R410A"),
    "blend": RealGas("R454B"),
    "moist": MoistAir(IdealGas(287.05, 1.4), 0.005, 1400.0),
    "wet": MoistAir(IdealGas(287.05, 1.4), 0.06, 1400.0),
    "real, moist": MoistAir(RealGas("Air"), 0.005),
    "real, wet": MoistAir(RealGas("Air"), 0.06),
    "covolume": CovolumeGas(81.49, 1.12, 1e-3),
    "other zero": OtherZero(81.49, 1.12),
    "Peng-Robinson": PengRobinson(81.49, 1.12, 374.2, 4.06e6, 0.327),
}
STATES = ((1.2e5, 290.0), (6e5, 330.0), (12e5, 360.0))  # Pa, K: vapour of each of them
STEP = 1e-4  # of a central difference: its error is of the square, rounding over it 1e-11
SLACK = 1e-6

every_gas = pytest.mark.parametrize("gas", GASES.values(), ids=GASES)
every_state = pytest.mark.parametrize(("p", "T"), STATES)


def asked(gas, kernel, *free):
    """Return what a kernel of a gas gives in plain Python."""
    named = dict(zip(("T", "rho") if len(free) == 2 else ("phase", "T", "rho"), free, strict=True)) | dict(gas.values)
    return kernel(*(named[name] for name in kernel.arguments))


def slopes(f, T, rho):
    """Return the derivatives of f(T, ρ) by T and by ρ."""
    dT, drho = STEP * T, STEP * rho
    return (f(T + dT, rho) - f(T - dT, rho)) / (2 * dT), (f(T, rho + drho) - f(T, rho - drho)) / (2 * drho)


@every_gas
def test_it_has_what_the_protocol_lists(gas):
    assert not [name for name in vars(Gas) if not name.startswith("_") and not hasattr(gas, name)]
    kernels = (gas.state, gas.specific_entropy, *(gas.phased_state or ()))
    assert all(isinstance(kernel, Kernel) for kernel in kernels)
    assert all(set(kernel.arguments) <= {"phase", "T", "rho", *gas.values} for kernel in kernels)
    assert gas.c_p - gas.c_v == pytest.approx(gas.R, rel=1e-12)


@every_gas
@every_state
def test_the_kernels_are_one_equation(gas, p, T):
    rho = gas.density(p, T)
    found = asked(gas, gas.state, T, rho)
    p_found, _h, c_v, TpT, a, drop, choked = found
    assert p_found == pytest.approx(p, rel=1e-9)
    dp_dT, dp_drho = slopes(lambda *at: asked(gas, gas.state, *at)[0], T, rho)
    du_dT, du_drho = slopes(lambda *at: (q := asked(gas, gas.state, *at))[1] - q[0] / at[1], T, rho)
    ds_dT, ds_drho = slopes(lambda *at: asked(gas, gas.specific_entropy, *at), T, rho)
    assert TpT == pytest.approx(T * dp_dT, rel=SLACK)
    assert c_v == pytest.approx(du_dT, rel=SLACK)
    assert T * ds_dT == pytest.approx(c_v, rel=SLACK)  # T ds = du + p d(1/ρ)
    assert rho**2 * T * ds_drho == pytest.approx(rho**2 * du_drho - p, rel=SLACK)
    assert -(rho**2) * ds_drho == pytest.approx(dp_dT, rel=SLACK)  # Maxwell
    assert 1.0 / a == pytest.approx(rho / p * (dp_drho + TpT**2 / (T * c_v * rho**2)), rel=SLACK)  # ρ c²/p
    assert (drop, choked) == pytest.approx(choking(1.0 / a), rel=1e-9)
    if not gas.varies:
        assert (a, drop, choked) == asked(gas, gas.state, 1.1 * T, 0.5 * rho)[4:]


@every_gas
@every_state
def test_a_state_of_a_stated_phase_is_the_state(gas, p, T):
    if gas.phased_state is None:
        return
    rho = gas.density(p, T)
    phase, phased = gas.phased_state
    assert asked(gas, phased, asked(gas, phase, T, rho), T, rho) == asked(gas, gas.state, T, rho)


@every_gas
@every_state
def test_plain_python_is_the_same_equation(gas, p, T):
    rho = gas.density(p, T)
    p_found, h, _, _, *flow = asked(gas, gas.state, T, rho)
    assert gas.enthalpy(p, T) == pytest.approx(h, rel=1e-12)
    assert gas.entropy(p, T) == pytest.approx(asked(gas, gas.specific_entropy, T, rho), rel=1e-12)
    assert gas.temperature(p, h) == pytest.approx(T, rel=1e-9)
    assert gas.port_state(p, T) == pytest.approx((p_found, rho, h, *flow), rel=1e-9)
    assert gas.port_state_of_enthalpy(p, h) == pytest.approx(gas.port_state(p, T), rel=1e-7)  # p to which T is found
    there = gas.vapour(p, T)
    assert (there.p, there.T, there.rho, there.h) == pytest.approx((p, T, rho, h), rel=1e-9)
    assert gas.nearest_vapour(p, T) == T


@every_gas
@every_state
def test_works_are_those_of_its_states(gas, p, T):
    lower, h, s = 0.6 * p, gas.enthalpy(0.6 * p, T), gas.entropy(0.6 * p, T)
    work = gas.isentropic_work(lower, p, T)
    assert work > 0.0 == pytest.approx(gas.isentropic_work(p, p, T), abs=1e-6 * work)
    assert gas.isentropic_work_of_enthalpy(lower, p, h) == pytest.approx(work, rel=1e-7)
    assert gas.entropy(p, gas.temperature(p, h + work)) == pytest.approx(s, rel=1e-7, abs=1e-6 * gas.R)
    rise = gas.enthalpy(p, T) - h - T * (gas.entropy(p, T) - s)
    assert gas.isothermal_obstacle(lower, p, T) is None
    assert gas.isothermal_work(lower, p, T) == pytest.approx(rise, rel=1e-9)
    assert gas.ideal_isothermal_work(lower, p, T) == pytest.approx(gas.R * T * np.log(1.0 / 0.6), rel=1e-12)


@every_gas
def test_the_first_state_outside_is_one_that_it_says_why_of(gas):
    T = np.array([300.0, 330.0, 250.0, 5000.0])
    rho = np.array([1.0, 2.0, 200.0, 1.0])
    found = [gas.why_outside(float(a), float(b)) for a, b in zip(T, rho, strict=True)]
    assert found[:2] == [None, None] and gas.first_outside(T[:2], rho[:2]) is None
    first = gas.first_outside(T, rho)
    assert (first is None) == (not any(found))
    if first is not None:
        assert isinstance(found[first], Outside) and found[first].limit in Limit


@every_gas
def test_equal_gases_are_equal(gas):
    again = type(gas)(*(getattr(gas, name) for name in gas.__dataclass_fields__))
    assert again == gas and hash(again) == hash(gas)


# ---- another back end in a whole cycle ---------------------------------------------------------------------------

SCENE = {
    "machine": {
        "rotor_diameter": "160 mm",
        "rotor_length": "176 mm",
        "volume": {"law": "paper", "max": "600 cm^3", "phi_A": "60 deg"},
        "suction_port": {"law": "paper", "area": "40 cm^2", "phi_B": "60 deg"},
        "discharge_port": {"law": "paper", "area": "12 cm^2", "opens": "600 deg", "phi_C": "640 deg"},
    },
    "gas": {"fluid": "R134a", "model": "ideal", "isentropic_exponent": 1.12},
    "operation": {
        "speed": "3000 rpm",
        "suction": {"pressure": "2 bar", "temperature": "283 K"},
        "discharge": {"pressure": "8 bar"},
    },
    "effects": {"suction_port": {}, "discharge_port": {}, "tip_leakage": {"gap": "50 um"}},
}


def scene_of(model, **gas):
    return loads(json.dumps({**SCENE, "gas": {**SCENE["gas"], "model": model, **gas}}))


def test_a_gas_of_another_back_end_is_solved_and_is_the_ideal_one_where_it_should_be():
    scene = scene_of("ideal")
    ideal, none, some = (
        simulate(each) for each in (scene, scene_of("own_gases.dilute"), scene_of("own_gases.covolume"))
    )
    assert [each.status for each in (ideal, none, some)] == ["ok"] * 3
    assert worst(relative_errors(ideal.performance, none.performance))[1] < 2.0 * scene.numerics.accuracy
    for name in ("mass", "energy", "entropy"):
        assert abs(some.balance[name]) < some.balance.bound
    # less gas has room at the same pressure and temperature
    assert some.performance.gas_mass_flow < none.performance.gas_mass_flow


@pytest.mark.parametrize(("p", "T"), STATES)
def test_the_cubic_gas_has_coolprops_densities(p, T):
    """CoolProp has the same equation as a back end of its own; its gas constant and 0.4572… have more digits."""
    gas = find_gas_model("own_gases.peng_robinson").make(GasRequest("R134a", 1.12, "no", lambda: T))
    assert gas.density(p, T) == pytest.approx(PropsSI("Dmass", "P", p, "T", T, "PR::R134a"), rel=2e-5)


def test_a_cubic_gas_has_no_vapour_where_there_is_only_liquid():
    gas = GASES["Peng-Robinson"]
    with pytest.raises(QuantityNotFound, match="no vapour at 30 bar"):
        gas.density(30e5, 280.0)
    assert "no vapour at 30 bar" in gas.isothermal_obstacle(2e5, 30e5, 280.0)
    assert gas.isothermal_work(2e5, 30e5, 280.0) is None


def test_a_cubic_gas_takes_in_what_the_real_one_does():
    """Its attraction is the real gas's; what is left is its heat capacity, which does not grow with temperature."""
    wide = {"machine.suction_port.area": "100 cm^2", "machine.discharge_port.area": "60 cm^2"}
    models = {"ideal": {}, "own_gases.peng_robinson": {}, "real": {"isentropic_exponent": None}}
    found = [simulate(scene_of(model, **gas).with_(wide)) for model, gas in models.items()]
    assert [each.status for each in found] == ["ok"] * 3
    ideal, cubic, real = (each.performance.gas_mass_flow for each in found)
    assert abs(cubic / real - 1.0) < 0.2 * abs(ideal / real - 1.0)


LINES = {  # both have an enthalpy that follows from the cycle
    "suction_line": {},
    "shaft_leakage": {"area": "17 mm^2"},
    "bypass": {"share": 0.1},
    "suction_throttle": {"pressure_ratio": 0.9},
}


def test_the_zero_of_enthalpy_is_arbitrary():
    """Gas flows back from both lines; its enthalpy is negative there with another zero."""
    oil = {"oil": {"density": "980 kg/m^3", "heat_capacity": "2 kJ/(kg K)"}, "oil_supply": {"kind": "pump", "ratio": 1}}
    oil["oil_supply"] |= {"temperature": "320 K", "source": "separator"}
    effects = {
        **SCENE["effects"],
        **LINES,
        "oil_heat": {"droplet_radius": "50 um", "heat_transfer_coefficient": "500 W/(m^2 K)"},
    }
    scenes = [
        loads(json.dumps({**SCENE, **oil, "effects": effects, "gas": {**SCENE["gas"], "model": model}}))
        for model in ("ideal", "own_gases.other_zero")
    ]
    usual, other = map(simulate, scenes)
    assert (usual.status, other.status) == ("ok", "ok")
    assert usual.performance.returned_gas_flow > 0.0
    assert worst(relative_errors(usual.performance, other.performance))[1] < scenes[0].numerics.accuracy


def test_the_scene_reads_back_and_results_know_the_module():
    scene = scene_of("own_gases.covolume")
    assert loads(scene.text, folder=scene.folder) == scene
    assert "module own_gases/covolume.py" in identity_of(scene)
    assert "gas of own_gases.covolume" in str(explain(scene))


def test_a_gas_of_another_back_end_says_itself_whether_its_lines_may_be_liquid():
    """R134a of 2 bar condenses at 263 K."""
    cold = {**SCENE["operation"], "suction": {"pressure": "2 bar", "temperature": "255 K"}}
    scene = {**SCENE, "operation": cold}
    for model, refused in (("own_gases.dilute", False), ("own_gases.condensing", True)):
        text = json.dumps({**scene, "gas": {**SCENE["gas"], "model": model}})
        if refused:
            with pytest.raises(
                SceneError, match=r"operation\.suction\.temperature: -18\.15 degC makes R134a of 2 bar a liquid"
            ):
                loads(text)
        else:
            assert loads(text).gas.model == model


MODULES = {
    "no gas": ("", "cannot be imported (module {} defines no GAS); fix that module"),
    "another": ("GAS = 3\n", "cannot be imported (module {} defines no GAS); fix that module"),
    "fails": ("1 / 0\n", "fails on import (ZeroDivisionError: division by zero); fix that module"),
}


@pytest.mark.parametrize("name", MODULES)
def test_a_module_that_is_no_gas_is_refused_in_one_line(name, tmp_path, monkeypatch):
    text, what = MODULES[name]
    package = f"{name.replace(' ', '_')}_gases"
    (tmp_path / package).mkdir()
    (tmp_path / package / "it.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    module = f"{package}.it"
    with pytest.raises(SceneError) as error:
        scene_of(module)
    assert [line.partition("gas.model: ")[2] for line in error.value.lines] == [f"'{module}' {what.format(module)}"]


def test_a_gas_that_lacks_a_part_of_the_protocol_is_refused_by_its_name(tmp_path, monkeypatch):
    (tmp_path / "poor_gas").mkdir()
    text = "from screwsim.fluid.models import GasModel\nGAS = GasModel(lambda asked: object())\n"
    (tmp_path / "poor_gas" / "it.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(UsageError, match=r"gas.model: poor_gas.it: .*its gas has no equations, varies.*fix that"):
        simulate(scene_of("poor_gas.it"))


@pytest.mark.parametrize(
    ("gas", "line"),
    [
        ({"two_phase": "equilibrium"}, "gas.two_phase: equilibrium needs model: real"),
        ({"fluid": "air", "relative_humidity": 0.5}, "gas.relative_humidity: needs gas.model: ideal or real"),
    ],
)
def test_what_belongs_to_the_built_in_models_is_refused_beside_another(gas, line):
    with pytest.raises(SceneError, match=line):
        scene_of("own_gases.covolume", **gas)
