"""Two stages: flows match at the pressure found, what lies between them, and chains that have no such pressure."""

import json
import re
from dataclasses import replace
from functools import partial
from math import log

import pytest
from CoolProp.CoolProp import PropsSI
from folders import CONFIGS
from scenes import DROP, ECONOMIZER, SOLUBLE, scene_dict

from screwsim.build import build_gas
from screwsim.cli import exit_code
from screwsim.figures.errors import error_scale
from screwsim.fluid import constants
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import STAGES, Figures, Result
from screwsim.printing.stages import print_stages
from screwsim.scene import lines, loads
from screwsim.scene.file_kinds import is_stages
from screwsim.simulate import simulate, simulate_next
from screwsim.study.stages import read_stages, run_stages
from screwsim.study.stages.result import capacities, electrical_figures
from screwsim.study.stages.solve import ChainResult

ACCURACY = 3e-4
HIGH = {"operation.speed": "1300 rpm"}
COOLER = {"kind": "cooler", "outlet_temperature": "290 K"}
CONDENSED = {"operation": {"speed": "1300 rpm", "evaporating_temperature": "10 degC", "superheat": "5 K",
                           "condensing_temperature": "45 degC"}}  # fmt: skip


EQUILIBRIUM = {"gas.model": "real", "gas.two_phase": "equilibrium"}
WET = {**EQUILIBRIUM, "operation.suction": {"pressure": "2 bar"}, "oil_supply.temperature": "330 K"}
DRY = {f"effects.{name}": DROP for name in ("oil_heat", "oil_pump", "hydromechanical")}
DRY |= {"oil_supply.temperature": DROP, "oil_supply": DROP, "oil": DROP}
WET_HIGH = {**EQUILIBRIUM, **HIGH}


@pytest.fixture
def chain(tmp_path):
    """Write a chain's files, and return how to read it; scenes of one compiled structure."""

    def write(between=None, high=None, low=None, **more):
        for name, changes in (("low", low or {}), ("high", HIGH if high is None else high)):
            (tmp_path / f"{name}.yaml").write_text(json.dumps(scene_dict(changes)))
        content = {"stages": ["low.yaml", "high.yaml"], **more}
        if between is not None:
            content["intercooler"] = between
        path = tmp_path / "chain.yaml"
        path.write_text(json.dumps(content))
        return path

    return write


def test_scenes_of_different_gases_are_told_the_keys_that_differ(chain):
    with pytest.raises(SceneError, match=r"stages: have different gases: gas\.model, gas\.two_phase \(write the same"):
        read_stages(chain(high=WET_HIGH))


def test_flows_match_between_the_pressures_of_both_ends(chain):
    found = run_stages(read_stages(chain()))
    assert found.status == "ok"
    p, (first, second) = found.performance, (result.performance for result in found.stages)
    assert 1.5e5 < p.intermediate_pressure < 12e5
    assert second.gas_mass_flow == pytest.approx(first.gas_mass_flow, rel=ACCURACY)
    assert p.flow_mismatch <= ACCURACY
    assert p.shaft_power == first.shaft_power + second.shaft_power
    assert p.first_pressure_ratio * p.second_pressure_ratio == pytest.approx(8.0, rel=1e-12)
    ideal = p.gas_mass_flow * constants.gas_constant("R134a") * 283.0 * 2.0794415416798357  # ln 8
    assert p.isothermal_efficiency == pytest.approx(ideal / p.shaft_power, rel=1e-6)


def test_electrical_figures_are_those_of_both_motors_if_both_stages_have_one(chain, capsys):
    both = run_stages(read_stages(CONFIGS / "two_stage" / "plant.stages.yaml"))
    p, parts = both.performance, [each.performance.electrical_power for each in both.stages]
    assert p.electrical_power == sum(parts) > p.shaft_power
    assert p.electrical_cop * p.electrical_power == pytest.approx(p.cop * p.shaft_power, rel=1e-12)
    assert p.electrical_heating_cop == pytest.approx(p.heating_capacity / p.electrical_power, rel=1e-12)
    assert 0.0 < both.error.electrical_power < ACCURACY
    motor = {"effects.motor": {"rated_power": "30 kW", "efficiency": 0.9}}
    one = run_stages(read_stages(chain(low=motor)))
    why = "the second stage has no motor (give it one as well)"
    assert one.status == "ok" and one.performance.electrical_power is None
    assert one.notes["electrical_power"] == why and one.error.electrical_power is None
    print_stages("a title", one)
    assert f"no electrical power: {why}" in " ".join(capsys.readouterr().out.split())
    assert "electrical_power" not in run_stages(read_stages(chain())).performance  # is not called for


def test_an_electrical_cop_without_a_capacity_is_null_for_the_reason_of_the_capacity():
    results = tuple(Result("ok", performance=Figures(electrical_power=power)) for power in (20e3, 30e3))
    found, reasons = capacities(150e3, 45e3, {"gas_mass_flow": 1.0}, None, "the oil stays mixed")
    figures, why = electrical_figures(results, found, reasons)
    assert figures == {"electrical_power": 50e3, "electrical_cop": 3.0, "electrical_heating_cop": None}
    assert (
        why == {"electrical_heating_cop": "the oil stays mixed"}
        and reasons["heating_capacity"] == "the oil stays mixed"
    )
    assert electrical_figures(results, {}, {}) == ({"electrical_power": 50e3}, {})  # none is called for


def test_electrical_figures_without_a_value_say_why():
    cooled = {"cooling_capacity": 150e3}
    motor = Result("ok", performance=Figures(electrical_power=20e3))
    none = Result("ok", performance=Figures(electrical_power=None), notes={"electrical_power": "it stands still"})
    bare, giving = Result("ok", performance=Figures()), Result("ok", performance=Figures(electrical_power=-30e3))
    for results, why in (
        ((motor, none), "second stage: it stands still"),
        ((bare, motor), "the first stage has no motor (give it one as well)"),
    ):
        names = ("electrical_power", "electrical_cop")
        assert electrical_figures(results, cooled, {}) == (dict.fromkeys(names), dict.fromkeys(names, why))
    why = {"electrical_cop": "the electrical power is not positive"}
    assert electrical_figures((motor, giving), cooled, {}) == ({"electrical_power": -10e3, "electrical_cop": None}, why)
    assert electrical_figures((bare, bare), cooled, {}) == ({}, {})


def test_stages_are_the_scenes_alone_at_that_pressure(chain):
    found = run_stages(read_stages(chain()))
    for scene, result in zip(found.scenes, found.stages, strict=True):
        assert simulate(scene).performance.shaft_power == pytest.approx(result.performance.shaft_power, rel=1e-9)
    low, high = (lines(scene) for scene in found.scenes)
    assert low.p_d == high.p_s == found.performance.intermediate_pressure
    assert high.T_s == pytest.approx(found.stages[0].performance.separator_temperature, rel=1e-12)
    assert found.performance.intercooler_heat == pytest.approx(0.0, abs=1e-6)
    assert [scene.text.count("  separator:") for scene in found.scenes] == [1, 1]  # so a file of a stage tells it


def test_gas_goes_on_as_it_leaves_the_separator_and_each_stage_states_what_its_oil_cooler_takes(chain):
    """Power is what gas, oil coolers (M287) and the cooler between take, but for heat left in suction lines (M54)."""
    for between in (None, COOLER):
        found = run_stages(read_stages(chain(between)))
        p, stages = found.performance, [result.performance for result in found.stages]
        assert p.first_separator_temperature < stages[0].discharge_temperature
        for which, stage in zip(("first", "second"), stages, strict=True):
            assert p[f"{which}_oil_cooler_duty"] == stage.oil_cooler_duty > 0.0
            assert p[f"{which}_separator_temperature"] == stage.separator_temperature
        k = constants.isentropic_exponent("R134a", 283.0)
        c_p = constants.gas_constant("R134a") * k / (k - 1.0)
        rise = p.gas_mass_flow * c_p * (stages[1].separator_temperature - 283.0)
        taken = rise + p.first_oil_cooler_duty + p.second_oil_cooler_duty + p.intercooler_heat
        assert taken == pytest.approx(p.shaft_power, rel=2e-3)


def test_stages_without_oil_have_no_oil_cooler_and_pass_on_what_they_discharge(chain):
    found = run_stages(read_stages(chain(low=DRY, high={**DRY, **HIGH})))
    assert found.status == "ok"
    assert not [name for name in found.performance if "oil" in name or "separator" in name]
    assert found.performance.second_suction_temperature == pytest.approx(
        found.stages[0].performance.discharge_temperature, rel=1e-9
    )


def test_a_stage_names_its_own_separator_or_states_what_its_balance_denies(chain):
    own = {"oil.transport": "carried", "effects.separator": {}, "oil_supply.temperature": DROP}
    found = run_stages(read_stages(chain(low=own)))
    assert found.performance.first_oil_cooler_duty == 0.0
    assert found.stages[0].performance.oil_supply_temperature > 293.0
    stated = {**SOLUBLE, "effects.refrigerant_solubility": {"separator_temperature": "350 K"}}
    warned = run_stages(read_stages(chain(low=stated))).stages[0]
    assert [told for told in warned.warnings if "not at the stated 76.9 degC" in told]


def test_a_cooler_takes_the_heat_between_its_ends_and_saves_power(chain):
    plain, cooled = (run_stages(read_stages(chain(between))) for between in (None, COOLER))
    p = cooled.performance
    T_d = cooled.stages[0].performance.separator_temperature
    k = constants.isentropic_exponent("R134a", 283.0)
    c_p = constants.gas_constant("R134a") * k / (k - 1.0)
    assert p.second_suction_temperature == 290.0
    assert p.intercooler_heat == pytest.approx(p.gas_mass_flow * c_p * (T_d - 290.0), rel=1e-6)
    assert p.shaft_power / p.gas_mass_flow < plain.performance.shaft_power / plain.performance.gas_mass_flow


def test_a_flash_intercooler_evaporates_what_the_gas_gives_off_and_leaves_it_saturated(chain):
    """What liquid and vapour bring and take of the tank agrees, by CoolProp, and so does the balance of the plant."""
    real = {"gas.fluid": "R134a", **EQUILIBRIUM, "oil_supply.temperature": DROP, "effects.separator": {}}
    dry = {**real, "oil.transport": "carried"}
    stated = {f"operation.{key}": value for key, value in CONDENSED["operation"].items()}
    high = {**dry, **stated, "operation.suction": DROP, "operation.discharge": DROP}
    mixed, found = (
        run_stages(read_stages(chain({"kind": kind}, high, dry))) for kind in ("economizer", "flash_intercooler")
    )
    assert (mixed.status, found.status) == ("ok", "ok")
    p, (first, second) = found.performance, (each.performance for each in found.stages)

    def at(what, pressure, **other):
        ((name, value),) = other.items()
        return PropsSI(what, "P", pressure, name, value, "R134a")

    h, s = partial(at, "H"), partial(at, "S")
    p_i, p_d = p.intermediate_pressure, second.discharge_pressure
    saturated, liquid, condensed = h(p_i, Q=1), h(p_i, Q=0), PropsSI("H", "T", 318.15, "Q", 0, "R134a")
    comes = p.gas_mass_flow * h(p_i, T=first.separator_temperature) + second.gas_mass_flow * condensed
    goes = p.gas_mass_flow * liquid + second.gas_mass_flow * saturated
    assert comes == pytest.approx(goes, abs=2.0 * ACCURACY * second.gas_mass_flow * (saturated - condensed))
    assert p.second_suction_temperature == pytest.approx(p.intermediate_temperature, abs=1e-6)
    assert p.vapour_mass_flow == pytest.approx(second.gas_mass_flow - p.gas_mass_flow, rel=10.0 * ACCURACY)
    p_s, T_s = first.suction_pressure, first.suction_temperature
    ideal = p.gas_mass_flow * (h(p_d, S=s(p_s, T=T_s)) - h(p_s, T=T_s))
    flashed = p.gas_mass_flow * (condensed - liquid) / (saturated - condensed)
    ideal += flashed * (h(p_d, S=s(p_i, Q=1)) - saturated)
    assert p.isentropic_efficiency == pytest.approx(ideal / p.shaft_power, rel=1e-4)
    assert p.second_suction_temperature < mixed.performance.second_suction_temperature - 5.0
    assert p.vapour_mass_flow / p.gas_mass_flow > mixed.performance.vapour_mass_flow / mixed.performance.gas_mass_flow


@pytest.mark.parametrize(("between", "speed"), [(COOLER, 1300), (None, 900), ({"pressure_drop": "0.1 bar"}, 1500)])
def test_figures_of_the_whole_are_off_by_no_more_than_twice_their_estimated_errors(chain, between, speed):
    """Held against the same chain at a hundredth of the accuracy, its pressure found anew."""

    def at(accuracy):
        more = {"numerics.accuracy": accuracy}
        return run_stages(read_stages(chain(between, {**more, "operation.speed": f"{speed} rpm"}, more)))

    found, better = at(ACCURACY), at(1e-2 * ACCURACY)
    known = {name: value or 0.0 for name, value in better.performance.items()}
    told = [name for name, error in found.error.items() if error is not None]
    assert {"intermediate_pressure", "gas_mass_flow", "shaft_power", "isothermal_efficiency"} <= set(told)
    assert found.performance.intermediate_pressure != better.performance.intermediate_pressure
    for name in told:
        off = abs(found.performance[name] - known[name]) / max(error_scale(name, STAGES[name].scale, known), 1e-300)
        assert off <= 2.0 * found.error[name] + 0.1 * ACCURACY, name
    assert max(better.error[name] for name in told) < 0.1 * max(found.error[name] for name in told)


def test_errors_of_both_stages_reach_the_whole_by_the_pressure_that_they_move(chain, monkeypatch):
    """Flows known to 1 % each leave the pressure open by 2 % over the slope of their ratio."""

    def rough(*asked):
        result = simulate_next(*asked)
        return replace(result, error=Figures(dict.fromkeys(result.error, 0.0) | {"gas_mass_flow": 0.01}))

    monkeypatch.setattr("screwsim.study.stages.solve.simulate_next", rough)
    found = run_stages(read_stages(chain(COOLER)))
    ratios = []
    for factor in (1.0, 1.02):
        between = f"{found.performance.intermediate_pressure * factor!r} Pa"
        after = {**HIGH, "operation.suction": {"pressure": between, "temperature": "290 K"}}
        scenes = (loads(json.dumps(scene_dict(each))) for each in ({"operation.discharge.pressure": between}, after))
        first, second = (simulate(scene).performance.gas_mass_flow for scene in scenes)
        ratios.append(first / second)
    slope = log(ratios[1] / ratios[0]) / log(1.02)
    assert found.error.intermediate_pressure == pytest.approx(0.02 / abs(slope), rel=0.05)
    assert any("above the wanted accuracy" in warning for warning in found.warnings)


def test_a_cooler_warmer_than_the_gas_does_nothing_and_says_so(chain):
    found = run_stages(read_stages(chain({**COOLER, "outlet_temperature": "450 K"})))
    warm = found.performance
    assert "the intercooler cools nothing: the gas arrives at" in found.warnings[0]
    assert run_stages(read_stages(chain(COOLER))).warnings == ()
    assert warm.intercooler_heat == pytest.approx(0.0, abs=1e-6)
    assert warm.shaft_power == pytest.approx(run_stages(read_stages(chain())).performance.shaft_power, rel=1e-9)


def test_a_pressure_drop_is_paid_by_the_second_stage(chain):
    found = run_stages(read_stages(chain({"pressure_drop": "0.2 bar"})))
    low, high = (lines(scene) for scene in found.scenes)
    assert low.p_d - high.p_s == pytest.approx(2e4)
    assert found.performance.second_pressure_ratio == 12e5 / high.p_s


def test_heat_of_both_stages_closes_the_balance_with_the_vapour_of_a_tank(chain):
    """The vapour has the real fluid's enthalpy, as in M202, and the ideal gas of each stage its own heat capacity."""
    ideal = {"oil.transport": "carried", "effects.suction_line": {}}
    ends = (("low", "3000 rpm", -20, 10), ("high", "1300 rpm", 10, 45))
    stages = {
        which: {**ideal, "operation": {"speed": speed, "superheat": "5 K", "evaporating_temperature": f"{low} degC",
                                       "condensing_temperature": f"{high} degC"}}
        for which, speed, low, high in ends
    }  # fmt: skip
    found = run_stages(read_stages(chain({"kind": "economizer"}, **stages)))
    p = found.performance
    assert found.status == "ok" and p.vapour_mass_flow > 0.2 * p.gas_mass_flow
    given_off = p.heating_capacity + p.first_oil_cooler_duty + p.second_oil_cooler_duty
    # the flows of both stages agree within a tenth of the accuracy
    assert given_off == pytest.approx(p.cooling_capacity + p.shaft_power, abs=ACCURACY * p.shaft_power)


def test_a_flash_tank_gives_the_vapour_of_the_liquid_that_goes_through_it(chain):
    high = {**{f"operation.{k}": v for k, v in CONDENSED["operation"].items()}}
    high |= {"operation.suction": {}, "operation.discharge": {}}
    found = run_stages(read_stages(chain({"kind": "economizer"}, high)))
    assert found.status == "ok"
    p, pressure = found.performance, found.performance.intermediate_pressure
    h_c = constants.saturated_liquid_enthalpy("R134a", 318.15)
    h_g, h_f = (constants.wet_enthalpy("R134a", pressure, quality) for quality in (1.0, 0.0))
    # vapour and liquid of what leaves the condenser: the liquid goes to the evaporator and the first stage
    assert p.vapour_mass_flow / p.gas_mass_flow == pytest.approx((h_c - h_f) / (h_g - h_c), rel=1e-9)
    first, second = (result.performance for result in found.stages)
    assert second.gas_mass_flow == pytest.approx(first.gas_mass_flow + p.vapour_mass_flow, rel=ACCURACY)
    assert p.second_suction_temperature < first.discharge_temperature
    assert p.cop == pytest.approx(p.cooling_capacity / p.shaft_power)
    assert p.heating_cop == pytest.approx(p.heating_capacity / p.shaft_power)
    # both give off what the real fluid has above the liquid, and what warmed them as the ideal gas of each stage
    (c_p, own), T_e = (
        (build_gas(each).c_p for each in found.scenes),
        constants.saturation_temperature("R134a", pressure),
    )
    T_2, h_s = p.second_suction_temperature, constants.vapour_enthalpy("R134a", 1.5e5, 283.0)
    warmed = own * (second.separator_temperature - T_2)
    from_suction, from_tank = (h - h_c + c_p * (T_2 - T) + warmed for h, T in ((h_s, 283.0), (h_g, T_e)))
    rejected = (second.gas_mass_flow - p.vapour_mass_flow) * from_suction + p.vapour_mass_flow * from_tank
    assert p.heating_capacity == pytest.approx(rejected, rel=1e-9)


def test_wet_suction_of_the_first_stage_stays_wet(chain):
    for quality in (1.0, 0.9):
        found = run_stages(read_stages(chain(low={**WET, "operation.suction.quality": quality}, high=WET_HIGH)))
        assert found.status == "ok"
        # cold oil of the second stage, as stated, would let gas condense there: its cooler has no duty, and a reason
        assert found.performance.second_oil_cooler_duty is None
        assert found.notes["second_oil_cooler_duty"].startswith("gas condenses in the separator")
        alone = simulate(found.scenes[0])
        assert found.scenes[0].operation.suction.quality == quality
        assert found.performance.gas_mass_flow == pytest.approx(alone.performance.gas_mass_flow, rel=1e-6)
        h = constants.wet_enthalpy("R134a", 2e5, quality)
        p_d, w = 12e5, found.performance.isentropic_efficiency * found.performance.shaft_power
        ideal = build_gas(found.scenes[0]).isentropic_work_of_enthalpy(2e5, p_d, h)
        assert w == pytest.approx(found.performance.gas_mass_flow * ideal, rel=1e-6)


@pytest.mark.parametrize(
    ("low", "words"),
    [
        ({"operation.suction.quality": 0.9, "oil_supply.temperature": "275 K"}, "gas condenses in the separator"),
        ({**DRY, "operation.suction.quality": 0.8}, "the first stage delivers wet vapour"),
    ],
)
def test_a_first_stage_that_delivers_wet_vapour_is_failed(chain, low, words):
    found = run_stages(read_stages(chain(low={**WET, **low}, high=WET_HIGH)))
    assert found.status == "failed"
    assert words in found.message


@pytest.mark.parametrize(
    ("speed", "words"),
    [("10000 rpm", "the second stage takes more"), ("150 rpm", "the second stage")],
)
def test_no_pressure_is_a_status(chain, speed, words):
    found = run_stages(read_stages(chain(high={"operation.speed": speed})))
    assert found.status in ("failed", "not_closed")
    assert words in found.message


def test_a_search_that_ends_at_a_failed_stage_says_why_it_went_there(tmp_path):
    path = tmp_path / "chain.yaml"
    files = [str(CONFIGS / "two_stage" / f"{name}.yaml") for name in ("low", "high")]
    path.write_text(json.dumps({"stages": files, "intercooler": {"kind": "economizer"}}))
    found = run_stages(read_stages(path, ["second.operation.speed=300 rpm"]))
    assert found.status != "ok"
    assert "the second stage takes less than the first one delivers even at" in found.message
    assert ", so it is too small or too slow; beyond, the " in found.message


def test_a_pressure_drop_that_leaves_no_room_is_named(chain):
    found = run_stages(read_stages(chain({"pressure_drop": "50 bar"})))
    assert found.status == "failed"
    assert found.message.startswith("intercooler.pressure_drop is 50 bar, which leaves no pressure between the stages")


LOW, HIGH_STAGE = (CONFIGS / "two_stage" / name for name in ("low", "high"))
COLD_COOLER = {"kind": "cooler", "outlet_temperature": "-7 degC"}  # liquid at the first guess, gas where flows match


@pytest.mark.parametrize(
    ("between", "changes"),
    [
        (COLD_COOLER, ()),
        ({"kind": "economizer"}, ("second.operation.speed=500 rpm",)),  # too hot at the first guess
    ],
)
def test_pressures_at_which_a_stage_has_no_result_are_gone_round(tmp_path, between, changes):
    path = tmp_path / "chain.yaml"
    path.write_text(json.dumps({"stages": [f"{LOW}.yaml", f"{HIGH_STAGE}.yaml"], "intercooler": between}))
    found = run_stages(read_stages(path, changes))
    assert found.status == "ok"
    first, second = (result.performance.gas_mass_flow for result in found.stages)
    assert second == pytest.approx(first + found.performance.get("vapour_mass_flow", 0.0), rel=ACCURACY)


def test_a_cooler_that_leaves_a_liquid_is_told_of_by_its_name(tmp_path):
    path = tmp_path / "chain.yaml"
    cold = {"kind": "cooler", "outlet_temperature": "-25 degC"}
    path.write_text(json.dumps({"stages": [f"{LOW}.yaml", f"{HIGH_STAGE}.yaml"], "intercooler": cold}))
    found = run_stages(read_stages(path))
    assert found.status == "failed"
    assert "the cooler leaves a liquid at -25 degC and" in found.message
    assert "(choose a higher intercooler.outlet_temperature)" in found.message


def test_overrides_go_to_their_stage(chain):
    changed = read_stages(chain(), ["second.operation.speed=1500 rpm", "first.oil_supply.ratio=2"])
    assert changed.second.operation.speed == pytest.approx(1500 * 3.141592653589793 / 30)
    assert changed.first.oil_supply.ratio == 2
    with pytest.raises(UsageError, match=r"starts with neither first\. nor second\."):
        read_stages(chain(), ["operation.speed=1500 rpm"])
    with pytest.raises(
        UsageError, match=r"two stages have one sweep \(write sweep: {first\.PATH: \[…\]} in the two-stage"
    ):
        read_stages(chain(), ["first.sweep.operation.speed=[1500 rpm, 2000 rpm]"])
    for path in ("intercooler.kind=none", "pressure_drop=1 bar", "stages=[]", "title=x"):
        with pytest.raises(UsageError, match=r"belongs to the two-stage file \(write it there\)"):
            read_stages(chain(), [path])


@pytest.mark.parametrize(
    ("override", "remedy"),
    [
        (
            "speed=1500 rpm",
            "write --set 'first.operation.speed=1500 rpm' or --set 'second.operation.speed=1500 rpm', or both",
        ),
        ("suction.pressure=2bar", "write --set first.operation.suction.pressure=2bar"),
        ("discharge.pressure=9bar", "write --set second.operation.discharge.pressure=9bar"),
        ("fluid=Air", "write --set first.gas.fluid=Air --set second.gas.fluid=Air"),
        (
            "tip_leakage=off",
            "write --set first.effects.tip_leakage=off or --set second.effects.tip_leakage=off, or both",
        ),
        ("flow_coefficient=0.9", "write the whole path, e.g. --set 'first.operation.speed=3000 rpm'"),
        ("lobes=3", "write the whole path, e.g. --set 'first.operation.speed=3000 rpm'"),
    ],
)
def test_an_override_without_a_stage_is_told_with_the_stages_that_have_it(chain, override, remedy):
    with pytest.raises(UsageError) as refusal:
        read_stages(chain(), [override])
    assert str(refusal.value).endswith(f"which name the stage ({remedy})")


def test_an_override_without_a_stage_is_told_of_scenes_with_faults_too(chain):
    path = chain()
    (path.parent / "low.yaml").write_text("gas: {fluid: Air}\n")
    with pytest.raises(UsageError, match=r"\(write the whole path, e\.g\. --set 'first\.operation\.speed=3000 rpm'\)"):
        read_stages(path, ["speed=1500 rpm"])


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"stages": ["low.yaml"]}, "not the files of two scenes"),
        ({"stages": ["low.yaml", "none.yaml"]}, "'none.yaml' is not a file"),
        ({"third": 3}, "third: is not known in a two-stage file"),
        ({"intercooler": {"kind": "cooler"}}, "outlet_temperature: is missing"),
        ({"intercooler": {"outlet_temperature": "300 K"}}, "outlet_temperature: belongs to kind: cooler"),
        ({"intercooler": {"kind": "economizer"}}, "economizer needs operation.condensing_temperature"),
        ({"intercooler": {"kind": "flash_intercooler"}}, "flash_intercooler needs operation.condensing_temperature"),
        (
            {"high": {**ECONOMIZER, **HIGH}},
            "the second scene names economizer, which draws gas that the balance between the stages does not include",
        ),
    ],
)
def test_faults_are_said(chain, more, words):
    with pytest.raises(SceneError) as caught:
        read_stages(chain(**more))
    assert words in str(caught.value)


@pytest.mark.parametrize(("fluid", "refused"), [("R407C", True), ("R454B", True), ("R410A", False), ("R134a", False)])
def test_a_flash_tank_is_refused_where_its_vapour_has_another_composition(chain, fluid, refused):
    """R407C, although it is described as if it were pure; R410A boils within a tenth of a kelvin."""
    gas = {"gas.fluid": fluid, "gas.model": "real"}
    operation = {f"operation.{key}": value for key, value in CONDENSED["operation"].items()}
    stated = {"operation.suction": DROP, "operation.discharge": DROP, **operation}
    path = chain({"kind": "economizer"}, high={**gas, **stated}, low=gas)
    if not refused:
        assert read_stages(path).intercooler.flashes
        return
    with pytest.raises(SceneError, match=f"vapour boiling off {fluid}, a blend, differs from it in composition"):
        read_stages(path)


def test_the_command_runs_stages_and_scenes(chain, capsys):
    path = chain()
    assert is_stages(path)
    assert not is_stages(path.with_name("low.yaml"))
    assert not is_stages(path.with_name("missing.yaml"))
    assert exit_code(["run", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["status"] == "ok"
    assert len(document["stages"]) == 2
    assert exit_code(["run", str(path), "--set", "second.operation.speed=10000 rpm"]) == 4
    assert "no intermediate pressure" in " ".join(capsys.readouterr().out.split())
    assert exit_code(["run", str(path), "--without", "tip_leakage"]) == 2


def test_explain_tells_of_what_lies_between_and_of_both_stages(chain, capsys):
    path = str(chain({**COOLER, "pressure_drop": "0.1 bar"}, title="a plant"))
    assert exit_code(["explain", path, "--set", "second.operation.speed=1234 rpm"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert text.startswith("a plant Two stages, 1.5 bar to 12 bar.")
    assert "A cooler cools the gas to 290 K" in text
    assert "pressure drop between both lines is 0.1 bar" in text
    assert text.index("The first stage") < text.index("The second stage") < text.index("1234 rpm")
    assert exit_code(["explain", path, "--without", "oil_heat"]) == 2


def fits(part, value):
    """Tell whether a value fits the keywords that the schema of stages uses."""
    kinds = {"object": dict, "array": list, "string": str, "null": type(None)}
    types = part.get("type", [])
    if types and not any(isinstance(value, kinds[kind]) for kind in ([types] if isinstance(types, str) else types)):
        return False
    if ("enum" in part and value not in part["enum"]) or ("const" in part and value != part["const"]):
        return False
    if isinstance(value, list):
        short = part["minItems"] <= len(value) <= part["maxItems"]
        return short and all(fits(part["items"], item) for item in value)
    if isinstance(value, dict):
        known = part.get("properties", {})
        inside = all(fits(known[name], item) for name, item in value.items() if name in known)
        closed = part.get("additionalProperties", True) or set(value) <= set(known)
        branch = part.get("then" if fits(part["if"], value) else "else", {}) if "if" in part else {}
        return inside and closed and set(part.get("required", ())) <= set(value) and (not branch or fits(branch, value))
    return not isinstance(value, str) or bool(re.search(part.get("pattern", ""), value))


def test_the_schema_takes_what_is_read_and_nothing_else(chain, capsys):
    assert exit_code(["schema", "--stages"]) == 0
    schema = json.loads(capsys.readouterr().out)
    takes = partial(fits, schema)
    for between in (None, {"kind": "none"}, COOLER, {"kind": "economizer", "pressure_drop": "0.1 bar"}):
        assert takes(json.loads(chain(between).read_text())), between
    files = ["low.yaml", "high.yaml"]
    swept = schema["properties"]["sweep"]
    axis = swept["properties"]["first.operation.speed"]["$ref"]
    assert axis.removeprefix("#/$defs/") in schema["$defs"]
    assert "second.operation.discharge.pressure" in swept["properties"]
    assert not {"operation.speed", "first.operation.discharge.pressure"} & set(swept["properties"])
    assert swept["additionalProperties"] is False
    for other in (
        {"stages": files[:1]},
        {"stages": files, "cooler": {}},
        {"stages": files, "intercooler": {"kind": "cooler"}},
        {"stages": files, "intercooler": {"kind": "none", "outlet_temperature": "290 K"}},
        {"stages": files, "intercooler": {"kind": "flash"}},
        {"title": "none"},
    ):
        assert not takes(other), other
    assert exit_code(["schema", "--stages", "--fit"]) == 2


def test_a_sweep_of_a_stage_is_said_to_be_left_aside(chain, capsys, monkeypatch):
    monkeypatch.setattr("screwsim.study.stages.run_stages", lambda chain: ChainResult("failed", "not asked for"))
    path = str(chain(low={"sweep": {"operation.speed": ["1000 rpm", "2000 rpm"]}}))
    assert exit_code(["run", path]) == 4
    assert capsys.readouterr().err == (
        f"{path}: the first scene's sweep of 2 cases is ignored, and the scene's own point is used (a sweep of "
        f"two stages stands in the two-stage file)\n"
    )


def test_faults_of_overrides_are_told_with_their_stage_and_both_stages_at_once(chain):
    with pytest.raises(SceneError) as caught:
        read_stages(chain(), ["first.operation.speed=3,000 rpm", "second.speed=3000 rpm"])
    assert caught.value.lines == [
        "--set first.operation.speed=3,000 rpm: first.operation.speed: '3,000 rpm' has a comma that may separate "
        "thousands or decimals (write '3000 rpm', or '3 rpm' if decimals are meant)",
        "--set second.speed=3000 rpm: second.speed: is not known; did you mean 'second.operation.speed'?",
    ]
    with pytest.raises(UsageError, match=r"^--set second\.operation\.speed: is not PATH=VALUE \(write e\.g\. --set s"):
        read_stages(chain(), ["second.operation.speed"])
