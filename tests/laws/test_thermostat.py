"""A thermostatic valve of injected liquid, the loss of the liquid's line, and the liquid in the refrigeration cycle."""

import pytest
from CoolProp.CoolProp import PropsSI

from screwsim import load
from screwsim.inputs.faults import SceneError
from screwsim.simulate import simulate
from screwsim.template import new_scene, request_of

CONFIG = "tests/plain/r134a.yaml"
WET = "gas.two_phase=equilibrium"
WANTED = 273.15 + 61.0
FLUID, T_E, T_C, SUPERHEAT = "R134a", 275.15, 318.15, 10.0  # as CONFIG states
P_D = PropsSI("P", "T", T_C, "Q", 0, FLUID)


@pytest.fixture(scope="module")
def inject(pytestconfig):
    def made(more="", *others):
        bore = f"effects.liquid_injection={{opens: 500 deg, closes: 600 deg, area: 4 mm^2{more}}}"
        return simulate(load(pytestconfig.rootpath / CONFIG, [WET, bore, *others]))

    return made


@pytest.fixture(scope="module")
def mixed(inject):
    return inject(", discharge_temperature: 55 degC", "effects.separator={}")


@pytest.fixture(scope="module")
def kept(inject):
    return inject(", discharge_temperature: 61 degC")


def test_the_valve_opens_so_far_that_the_discharge_comes_to_its_temperature(kept, inject):
    found = kept.performance
    assert (kept.status, kept.warnings) == ("ok", ())
    assert found.discharge_temperature == pytest.approx(WANTED, abs=2e-2)
    assert 0.1 < found.liquid_injection_opening < 0.9
    stated = inject(f", opening: {found.liquid_injection_opening}").performance
    for name in ("discharge_temperature", "shaft_power", "liquid_injection_mass_flow", "cooling_capacity"):
        assert found[name] == pytest.approx(stated[name], rel=6e-4), name


def test_a_warmer_discharge_needs_less_liquid(kept, inject):
    warmer = inject(", discharge_temperature: 64 degC")
    assert warmer.performance.discharge_temperature == pytest.approx(WANTED + 3.0, abs=2e-2)
    assert warmer.performance.liquid_injection_mass_flow < 0.7 * kept.performance.liquid_injection_mass_flow


def test_gas_and_oil_of_one_temperature_are_what_the_valve_keeps(mixed):
    assert (mixed.status, mixed.warnings) == ("ok", ())
    assert mixed.performance.mixture_discharge_temperature == pytest.approx(328.15, abs=2e-2)


@pytest.mark.parametrize("area", [5, 20, 80])
def test_a_bore_of_any_size_is_opened_alike_where_oil_comes_back_as_warm_as_it_left(area, tmp_path):
    """Such oil holds no temperature: the liquid cools all of it. Bores of 20 mm^2 and more did not close."""
    text = new_scene("refrigeration", request_of(fluid="R1234ze(E)", displacement="780 m^3/h"))
    file = tmp_path / "machine.yaml"
    file.write_text(text, encoding="utf-8")
    bore = f"{{opens: 480 deg, closes: 560 deg, area: {area} mm^2, discharge_temperature: 55 degC}}"
    found = simulate(load(file, [WET, f"effects.liquid_injection={bore}"]), trace=False)
    assert (found.status, found.warnings) == ("ok", ())
    assert found.performance.mixture_discharge_temperature == pytest.approx(328.15, abs=2e-2)
    assert area * found.performance.liquid_injection_opening == pytest.approx(2.07, rel=0.01)


def test_the_condenser_gives_off_what_evaporator_and_shaft_bring_and_the_oil_cooler_does_not_take(mixed):
    """Liquid that is injected goes round the evaporator, and through the condenser; enthalpies from CoolProp."""
    found = mixed.performance
    h_liquid = PropsSI("H", "T", T_C, "Q", 0, FLUID)
    h_suction = PropsSI("H", "T", T_E + SUPERHEAT, "P", PropsSI("P", "T", T_E, "Q", 1, FLUID), FLUID)
    h_discharge = PropsSI("H", "T", found.mixture_discharge_temperature, "P", P_D, FLUID)
    evaporator = found.gas_mass_flow * (h_suction - h_liquid)
    assert found.cooling_capacity == pytest.approx(evaporator, rel=1e-5)
    assert found.cop == pytest.approx(evaporator / found.shaft_power, rel=1e-5)
    liquid = found.liquid_injection_mass_flow * (h_discharge - h_liquid)
    condenser = found.gas_mass_flow * (h_discharge - h_liquid) + liquid
    assert found.heating_capacity == pytest.approx(condenser, rel=1e-5)
    assert found.heating_cop == pytest.approx(condenser / found.shaft_power, rel=1e-5)
    brought = evaporator + found.shaft_power - found.oil_cooler_duty
    assert condenser == pytest.approx(brought, abs=3e-3 * liquid)
    assert liquid > 0.02 * brought


def test_a_valve_that_cannot_keep_the_temperature_says_where_it_stands(inject):
    open_, shut = inject(", discharge_temperature: 50 degC"), inject(", discharge_temperature: 90 degC")
    assert (open_.status, shut.status) == ("ok", "ok")
    assert open_.warnings == (
        "no flow of injected liquid brings the discharge to 50.0 degC: with the valve wide open it is at 58.2 degC "
        "(choose a larger effects.liquid_injection.area, or a bore that opens earlier)",
    )
    assert len(shut.warnings) == 1
    assert shut.warnings[0].startswith(
        "the liquid injection valve stays shut: without liquid the discharge is at 66.9 degC, not at 90.0 degC"
    )
    assert shut.performance.liquid_injection_flow_ratio < 1e-5


def test_the_loss_of_the_liquid_line_is_lost_before_the_bore(inject):
    cold = "operation.subcooling=5 K"
    free, lossy = inject("", cold), inject(", pressure_loss: 0.8 bar", cold)
    angle = free.cycle["angle"]
    inside = (angle >= 511.0) & (angle <= 589.0)
    name = "mass_flow_liquid_injection"
    density = PropsSI("D", "T", T_C - 5.0, "P", P_D - 0.4e5, FLUID)
    for result, p in ((free, P_D), (lossy, P_D - 0.8e5)):
        flow, chamber = result.cycle[name][inside], result.cycle["pressure"][inside]
        assert flow == pytest.approx(0.61 * 4e-6 * (2.0 * density * (p - chamber)) ** 0.5, rel=8e-3)
    assert lossy.performance.liquid_injection_mass_flow < 0.97 * free.performance.liquid_injection_mass_flow


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (
            ", pressure_loss: 0.5 bar",
            r"liquid_injection\.pressure_loss: 0\.5 bar: liquid of 45 degC boils in its line once it has lost 0 bar",
        ),
        (
            ", discharge_temperature: 40 degC",
            r"discharge_temperature: 40 degC is not above condensation, 45 degC: some liquid would not evaporate",
        ),
        (
            ", discharge_temperature: 60 degC, opening: 0.5",
            r"opening: is given as well as effects\.liquid_injection\.discharge_temperature, which finds it",
        ),
    ],
)
def test_what_liquid_cannot_do_is_refused(inject, more, told):
    with pytest.raises(SceneError, match=told):
        inject(more)


def test_oil_and_liquid_do_not_keep_one_temperature_both(inject):
    oil = "oil_supply={kind: pump, discharge_temperature: 60 degC, temperature: 325 K, source: separator}"
    with pytest.raises(
        SceneError, match=r"is stated as well as oil_supply\.discharge_temperature: either oil or liquid can"
    ):
        inject(", discharge_temperature: 60 degC", oil, "effects.separator={}")
