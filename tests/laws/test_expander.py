"""An expander is the machine run backwards: mirrored laws, the ideal cycle, figures (M151, M152) and their nulls."""

import math
from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from scenes import DROP, balanced, make, run

from screwsim.build import build_parts
from screwsim.cycle.pitch import _slopes
from screwsim.inputs.faults import SceneError
from screwsim.machine.geometry import Geometry
from screwsim.outputs import ledger_entries
from screwsim.scene import load
from screwsim.scene.left_out import suitable_effects
from screwsim.simulate import simulate

POINT = Path(__file__).parents[2] / "configs" / "expander" / "point.yaml"
OIL = POINT.with_name("oil.yaml")
K, OPENS = 1.3, 625.0
DRY = {"oil": DROP, "oil_supply": DROP}
LINES = {
    "machine.mode": "expander",
    "operation.suction": {"pressure": "10 bar", "temperature": "400 K"},
    "operation.discharge": {"pressure": "3 bar"},
}
IDEAL = {  # wide ports, no leaks, slow
    **DRY,
    **LINES,
    "effects": {"suction_port": {}, "discharge_port": {}},
    "gas": {"fluid": "Nitrogen", "model": "ideal", "isentropic_exponent": K},
    "operation.speed": "300 rpm",
    "machine.suction_port": {"law": "paper", "area": "600 cm^2", "phi_B": "20 deg"},
    "machine.discharge_port": {
        "law": "paper",
        "area": "600 cm^2",
        "opens": f"{OPENS} deg",
        "phi_C": f"{OPENS + 2} deg",
    },
}


def volumes(scene):
    """Return the volume [m³] at the inlet's closing, the largest and the smallest one."""
    geometry = Geometry(scene.machine)
    law = geometry.volume_law()
    at = [
        law.volume(math.radians(angle), *(law.values[n] for n in ("V_max", "V_min", "phi_A")))
        for angle in (OPENS, 360.0)
    ]
    return *at, law.values["V_min"]


@pytest.mark.parametrize(("p_d", "what"), [(3.0, "over-expanded"), (2.0, "under-expanded")])
def test_the_ideal_cycle_has_its_work(p_d, what):
    """M153: filling at p_s, isentropic expansion by the built-in ratio, pushing out at p_d; the dead volume swings."""
    changes = {**IDEAL, "operation.discharge": {"pressure": f"{p_d} bar"}}
    V_in, V_end, V_min = volumes(make(changes))
    p_s, p_d = 10e5, p_d * 1e5
    p_end = p_s * (V_in / V_end) ** K
    assert (p_end < p_d) == (what == "over-expanded")
    work = p_s * (V_in - V_min) + (p_s * V_in - p_end * V_end) / (K - 1.0) - p_d * (V_end - V_min)
    found = run(changes).performance
    assert -found.work_per_cycle == pytest.approx(work, rel=0.01)  # ports of 600 cm² throttle by this much
    assert found.filling_factor == pytest.approx(1.0, abs=0.02)


def test_an_ideal_cycle_that_expands_to_the_line_has_efficiency_one():
    V_in, V_end, _ = volumes(make(IDEAL))
    p_d = 10.0 * (V_in / V_end) ** K
    found = run({**IDEAL, "operation.discharge": {"pressure": f"{p_d!r} bar"}}).performance
    assert found.isentropic_efficiency == pytest.approx(1.0, abs=0.01)


def test_mass_energy_and_entropy_close():
    result = balanced(simulate(load(POINT)))
    assert all(entry["exergy_destroyed"] > -1e-3 for entry in ledger_entries(result.ledger).values())
    p = result.performance
    assert 0.6 < p.isentropic_efficiency < 0.9
    assert p.output_power == -p.shaft_power > -p.electrical_power > 0.0


def test_leaks_lower_the_efficiency_and_raise_the_filling():
    tight, wide = (simulate(load(POINT, [f"effects.tip_leakage.gap={gap} um"])).performance for gap in (20, 80))
    assert wide.isentropic_efficiency < tight.isentropic_efficiency
    assert wide.filling_factor > tight.filling_factor


def test_vapour_that_enters_late_could_have_expanded_too():
    """M151 by CoolProp: all that comes in, each from its own state to the outlet's pressure."""
    port = "effects.economizer={pressure: 12 bar, superheat: 20 K, opens: 150 deg, closes: 200 deg, area: 2 cm^2}"
    p = simulate(load(POINT, [port])).performance
    fluid = "R134a"

    def work(p_1, T):
        h, s = (PropsSI(each, "P", p_1, "T", T, fluid) for each in "HS")
        return h - PropsSI("H", "P", p.discharge_pressure, "S", s, fluid)

    late = p.economizer_mass_flow * work(12e5, PropsSI("T", "P", 12e5, "Q", 1, fluid) + 20.0)
    all_of_it = p.gas_mass_flow * work(20e5, 373.15) + late
    assert late > 0.05 * all_of_it, (late, all_of_it)
    assert p.isentropic_efficiency == pytest.approx(p.output_power / all_of_it, rel=1e-6)


def test_what_has_no_meaning_is_null_with_its_reason():
    result = run(IDEAL)
    for name in ("isothermal_efficiency", "volumetric_efficiency", "specific_power", "peak_pressure"):
        assert result.performance[name] is None and result.notes[name], name
    assert "cop" not in result.performance
    assert "output_power" not in run().performance  # a compressor


def test_an_expander_whose_losses_take_all_has_no_efficiency():
    changes = {**IDEAL, "effects": {"suction_port": {}, "discharge_port": {}, "mechanical": {"fraction": 1.5}}}
    result = run(changes)
    assert result.performance.isentropic_efficiency is None
    assert "gives no power" in result.notes["isentropic_efficiency"]


def test_the_gas_drives_the_shaft_and_presses_from_the_higher_pressure():
    torque = {"male_share": 0.9, "axial_area": "30 cm^2"}
    p = run({**IDEAL, "effects": {"suction_port": {}, "discharge_port": {}, "gas_torque": torque}}).performance
    assert (
        p.gas_torque_mean == pytest.approx(p.indicated_power / (300.0 * math.pi / 30.0), rel=1e-12)
        and p.gas_torque_mean < 0
    )
    assert 0.0 < p.axial_gas_force < p.axial_gas_force_peak


# ---- oil that comes in with the gas (M490, M491) ----


def test_fine_droplets_make_the_expansion_polytropic():
    """M153 with n = 1 + R/(c_v + d c_o) in place of k; the oil's flow work is added."""
    ratio, c_oil, rho_oil, p_s, T = 2.0, 2000.0, 1000.0, 10e5, 400.0
    fine = {"droplet_radius": "2 um", "heat_transfer_coefficient": "5 kW/(m^2 K)"}
    changes = {
        **IDEAL,
        "oil": {"density": f"{rho_oil} kg/m^3", "heat_capacity": f"{c_oil} J/(kg K)", "transport": "carried"},
        "oil_supply": {"kind": "pump", "ratio": ratio, "temperature": f"{T} K"},
        "effects": {"suction_port": {}, "discharge_port": {}, "oil_heat": fine},
    }
    R = 8.314462618 / 28.0134e-3
    n = 1.0 + R / (R / (K - 1.0) + ratio * c_oil)
    V_in, V_end, V_min = volumes(make(changes))
    p_d = p_s * (V_in / V_end) ** n  # it expands to the line
    found = run({**changes, "operation.discharge": {"pressure": f"{p_d!r} Pa"}}).performance
    work = p_s * (V_in - V_min) + (p_s * V_in - p_d * V_end) / (n - 1.0) - p_d * (V_end - V_min)
    assert -found.work_per_cycle == pytest.approx(work, rel=0.01)
    assert found.oil_discharge_temperature == pytest.approx(T * (V_in / V_end) ** (n - 1.0), abs=0.5)
    assert found.discharge_temperature == pytest.approx(found.oil_discharge_temperature, abs=0.5)
    lift = found.oil_mass_flow / rho_oil * (p_s - p_d)
    assert found.oil_mass_flow == pytest.approx(ratio * found.gas_mass_flow, rel=1e-3)
    assert found.output_power == pytest.approx(lift - found.indicated_power, rel=1e-9)
    isentropic = found.gas_mass_flow * K / (K - 1.0) * R * T * (1.0 - (p_d / p_s) ** (1.0 - 1.0 / K))
    assert found.isentropic_efficiency == pytest.approx(found.output_power / (isentropic + lift), rel=1e-3)
    assert found.isentropic_efficiency > 1.05  # by the heat of the oil


def test_with_oil_everything_that_comes_in_goes_out():
    """Gas by CoolProp: what gas and oil lose on their way is the shaft's, the pump's and the motor's apart."""
    result = balanced(simulate(load(OIL, ["effects.separator=off"])), "oil_mass")
    p = result.performance
    assert all(entry["exergy_destroyed"] > -1e-3 for entry in ledger_entries(result.ledger).values())
    assert p.oil_mass_flow == pytest.approx(0.5 * p.gas_mass_flow, rel=3e-4)
    h_in, h_out = (PropsSI("H", "P", at, "T", T, "R134a") for at, T in ((20e5, 373.15), (7e5, p.discharge_temperature)))
    volume = p.oil_mass_flow / 950.0
    oil = p.oil_mass_flow * 2100.0 * (368.15 - p.oil_discharge_temperature) + volume * (20e5 - 7e5)
    assert -p.indicated_power == pytest.approx(p.gas_mass_flow * (h_in - h_out) + oil, rel=2e-3)
    assert p.oil_pump_power == pytest.approx(volume * (20e5 + 0.5e5 - 7e5) / 0.6, rel=1e-9)
    losses = p.oil_pump_power + p.hydromechanical_power + p.mechanical_power
    assert p.output_power == pytest.approx(-p.indicated_power - losses, rel=1e-9)


@pytest.mark.parametrize("changed", [(), ("effects.oil_volume=off",), ("oil_supply.temperature=null",)])
def test_what_warms_the_oil_again_and_the_gas_give_the_output(changed):
    """M281 by CoolProp: gas leaves the separator, and all friction stays in the oil."""
    result = simulate(load(OIL, [*changed]))
    p = result.performance
    assert result.status == "ok" and not any("would have to heat" in warning for warning in result.warnings)
    h_in, h_out = (PropsSI("H", "P", at, "T", T, "R134a") for at, T in ((20e5, 373.15), (7e5, p.separator_temperature)))
    assert p.gas_mass_flow * (h_in - h_out) - p.oil_cooler_duty == pytest.approx(p.output_power, rel=5e-4)
    assert abs(result.ledger.residue) < 5e-4 * p.output_power
    if p.oil_cooler_duty == 0.0:  # it comes back as warm as it left
        assert p.oil_supply_temperature == pytest.approx(p.separator_temperature, abs=0.01)
    else:
        assert p.oil_cooler_duty < -0.5 * p.output_power


@pytest.mark.parametrize("changed", [(), ("effects.oil_volume=off",)])
def test_what_flows_back_into_the_inlet_takes_its_heat_from_the_balance(changed):
    """M492: where the gas is over-expanded and compressed again, warm gas and oil flow back through the inlet."""
    p = run_of(OIL, "operation.discharge.pressure=19.5 bar", *changed)
    T = p.separator_temperature
    h_in, h_out = (PropsSI("H", "P", at, "T", each, "R134a") for at, each in ((20e5, 373.15), (19.5e5, T)))
    gone = p.gas_mass_flow * (h_out - h_in) + p.oil_cooler_duty + p.inlet_backflow_heat
    assert p.inlet_backflow_heat > 3e-3 * p.shaft_power
    assert gone == pytest.approx(p.shaft_power, rel=1e-4)
    assert run_of(OIL).inlet_backflow_heat == 0.0


def test_heat_that_flows_back_into_the_inlet_is_what_shaft_and_outlet_leave_without_oil():
    """M492: shaft and outlet against what comes in, by CoolProp."""
    changes = "operation.discharge.pressure=14 bar", "machine.volume.min=3 cm^3"
    p = run_of(POINT, *changes)
    h_in, h_out = (
        PropsSI("H", "P", p_, "T", T, "R134a") for p_, T in ((20e5, 373.15), (14e5, p.discharge_temperature))
    )
    left = p.indicated_power - p.gas_mass_flow * (h_out - h_in)
    assert p.inlet_backflow_heat > 0.0
    assert p.inlet_backflow_heat == pytest.approx(left, abs=1e-4 * abs(p.indicated_power))
    returned = run_of(POINT, *changes, "effects.suction_line={}")
    assert returned.inlet_backflow_heat == 0.0


@pytest.mark.parametrize("case", ["1.32e-6, 4014 rpm, 8.64 bar", "7.71e-6, 4167 rpm, 8.20 bar"])
def test_the_temperature_of_a_trace_of_oil_is_as_accurate_as_stated(case):
    """That of the line is not closed with less oil than 1e-4, and most of what flows out has flowed back from there."""
    ratio, speed, p_d = case.split(", ")
    changes = [f"oil_supply.ratio={ratio}", f"operation.speed={speed}", f"operation.discharge.pressure={p_d}"]
    found, exact = (simulate(load(OIL, [*changes, f"numerics.accuracy={each}"])) for each in (1e-3, 1e-6))
    T, error = exact.performance.oil_discharge_temperature, found.error.oil_discharge_temperature
    off = abs(found.performance.oil_discharge_temperature / T - 1.0)
    assert off < 1.5 * error + exact.error.oil_discharge_temperature
    held = simulate(load(OIL, [*changes, "numerics={accuracy: 1e-3, rtol: 7.5e-5}"]))  # nothing is tightened
    assert abs(held.performance.oil_discharge_temperature / T - 1.0) < held.error.oil_discharge_temperature


def test_what_no_cycle_changes_has_no_error():
    result = simulate(load(OIL), trace=False)
    for name in ("displacement", "displacement_flow", "built_in_volume_ratio", "suction_pressure", "pressure_ratio"):
        assert result.error[name] == 0.0, name
    assert min(result.error[name] for name in ("gas_mass_flow", "oil_mass_flow", "trapped_mass", "shaft_power")) > 0.0


def test_pressure_that_the_shaft_gives_the_oil_is_not_counted_as_brought():
    """M491: a pump without loss takes from the output what the oil's flow work adds to it, so that 1 stays 1."""
    pumped, given = "effects.oil_pump={efficiency: 1, pressure_loss: 0 bar}", "oil_supply.source=suction"
    bare = "effects.separator=off"
    free, paid, sump = (
        run_of(OIL, *each) for each in (["effects.oil_pump=off", bare], [pumped, bare], [pumped, given, bare])
    )
    brought = [p.output_power / p.isentropic_efficiency for p in (free, paid, sump)]
    assert paid.oil_pump_power == pytest.approx(paid.oil_mass_flow / 950.0 * (20e5 - 7e5), rel=1e-9)
    assert free.output_power - paid.output_power == pytest.approx(paid.oil_pump_power, rel=1e-9)
    assert brought[0] - brought[1] == pytest.approx(paid.oil_pump_power, rel=1e-6)
    assert sump.oil_pump_power == 0.0 and brought[2] == pytest.approx(brought[0], rel=1e-9)


def test_coupled_chambers_have_the_same_figures_and_losses_that_need_no_heat_have_their_oil():
    one, other = (run_of(OIL, f"numerics.closing={way}") for way in ("histories", "coupled"))
    for name in ("gas_mass_flow", "oil_mass_flow", "output_power", "oil_discharge_temperature"):
        assert one[name] == pytest.approx(other[name], rel=3e-4), name
    cold = run_of(OIL, "effects.oil_heat=off", "effects.oil_volume=off")
    assert cold.oil_mass_flow == pytest.approx(0.5 * cold.gas_mass_flow, rel=1e-9)
    assert cold.oil_ratio == 0.5 and cold.oil_pump_power > 0.0


def test_oil_that_a_gap_drags_into_a_chamber_of_an_expander_replaces_none_of_the_inlets():
    """Only a compressor injects less, and says so, where leaks bring a chamber more oil than the ratio asks for."""
    film = "effects.tip_leakage={model: oil_film, filled_from: 0.3, passage: 2 mm}"
    result = simulate(load(OIL, [film]), trace=False)
    assert result.performance.oil_ratio > 0.5 + 1e-4
    assert result.performance.oil_flow_ratio == pytest.approx(0.5, rel=0.02)
    assert [text for text in result.warnings if "no oil is injected" in text] == []


def test_an_expander_without_oil_in_its_gas_is_dry():
    dry = run_of(OIL, "oil_supply.ratio=0")
    other = run_of(POINT, "machine.volume.min=3 cm^3")
    for name in ("gas_mass_flow", "indicated_power", "discharge_temperature"):
        assert dry[name] == pytest.approx(other[name], rel=1e-4), name


@pytest.mark.parametrize("changed", ["effects.oil_volume={}", "effects.oil_volume=off", "effects.oil_pump=off"])
def test_moist_gas_and_oil_of_an_expander_part_at_the_temperature_of_their_mixture(changed):
    """M281 with next to no water: what bearings, shear and pump lose is theirs (M282)."""
    changes = ["effects.separator=off", "oil_supply={temperature: 90 degC, ratio: 4}", changed]
    changes += ["gas={fluid: Air, model: ideal, relative_humidity: 0.001, dew_point_margin: 150 K}"]
    changes += ["operation.suction={pressure: 20 bar, temperature: 60 degC}", "operation.discharge.pressure=5 bar"]
    result = simulate(load(OIL, changes), trace=False)
    p = result.performance
    told = next(float(words.split()[5]) for words in result.warnings if words.startswith("gas and oil separate at "))
    c_gas = PropsSI("CP0MASS", "P", 8e5, "T", 333.15, "Air")
    gas, oil = p.gas_mass_flow * c_gas, p.oil_mass_flow * 2100.0
    heat = gas * p.discharge_temperature + oil * p.oil_discharge_temperature
    heat += p.hydromechanical_power + p.mechanical_power
    if "oil_pump_power" in p:
        heat += p.oil_pump_power - p.oil_mass_flow / 950.0 * (20e5 - 5e5)
    assert told == pytest.approx(heat / (gas + oil) - 273.15, abs=0.15)
    assert p.condensate_flow == 0.0 and abs(p.water_residual) < 3e-4


def run_of(path, *overrides):
    """Return the figures of a scene that closes."""
    result = simulate(load(path, list(overrides)), trace=False)
    assert result.status == "ok", result.message
    return result.performance


# ---- mirrored laws ----


def area(part, angle, parts):
    """Return a path's area [m²] at an angle [rad], its mirror taken."""
    from screwsim.model.numbers import symbols_of

    numbers = {**symbols_of(parts), **part.values}
    at = angle if part.mirror is None else part.mirror - angle
    return part.area(at, *(numbers[name] for name in part.area.arguments if name != "phi"))


def test_every_opening_is_that_of_the_compressor_at_the_mirrored_angle():
    dry = {**DRY, **{f"effects.{name}": DROP for name in ("oil_heat", "oil_pump", "hydromechanical")}}
    forward, backward = build_parts(make(dry)), build_parts(make({**dry, **LINES}))
    life, pitch = 4.0 * math.pi, math.pi / 2.0
    lines = {"suction": "discharge", "discharge": "suction", "neighbour": "neighbour"}
    for name in ("suction_port", "discharge_port", "tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage"):
        for own, turned in zip(forward.effects[name], backward.effects[name], strict=True):
            assert turned.to == lines[own.to] and turned.offset == own.offset
            for leading in np.linspace(0.01, life - 0.01, 50):
                # the same two chambers: the one that leads forwards trails backwards
                trailing = leading - own.offset * pitch
                assert area(turned, life - leading, backward) == pytest.approx(
                    area(own, trailing, forward), rel=1e-9, abs=1e-15
                )


def test_volume_and_slope_are_mirrored():
    forward, backward = (Geometry(make({**DRY, **changes, "effects": {}}).machine) for changes in ({}, LINES))
    pitch = 360  # points of it
    (slope, _), (turned, _) = _slopes(forward), _slopes(backward)
    whole = slope.T.ravel()  # a life, from 0°
    assert len(whole) == 8 * pitch
    assert turned.T.ravel()[1:] == pytest.approx(-whole[:0:-1], abs=1e-18)


def test_a_profiled_expander_mirrors_its_life():
    import dataclasses

    machine = load(POINT.parents[1] / "rotors" / "a.yaml").machine
    forward, backward = Geometry(machine), Geometry(dataclasses.replace(machine, mode="expander"))
    assert backward.injection_angle == pytest.approx(forward.life - forward.injection_angle)
    assert backward.inlet_closes == pytest.approx(forward.life - forward.profile.opens, abs=math.radians(1.0))


# ---- faults ----


REFUSED = {
    "oil_supply.kind: displacement needs machine.mode: compressor": "oil_supply={kind: displacement, ratio: null}",
    "oil_supply.flow: needs machine.mode: compressor": "oil_supply={flow: 40 L/min, ratio: null}",
    "oil.transport: needs machine.mode: compressor": "oil.transport=paper",
    "oil_supply.discharge_temperature: .*with its gas.*remove it.": "oil_supply.discharge_temperature=80 degC",
    "effects.oil_injection: .*mode: compressor .remove it": "effects.oil_injection={opens: 9 deg, closes: 99 deg}",
    "effects.refrigerant_solubility: .*mode: compressor .remove it": "effects.refrigerant_solubility={}",
    "effects.suction_line: .*or to an expander without oil .remove it": "effects.suction_line={}",
    "effects.plenums: applies only to": "effects.plenums={discharge_volume: 5 l}",
    "effects.separator: lies behind an expander's outlet": "effects.oil_pump=off",
    "oil_supply.source: .* lies behind an expander's outlet": "oil_supply.source=suction",
    "effects.slide_valve: applies only to machine.mode: compressor .remove it": "effects.slide_valve={}",
}


@pytest.mark.parametrize(("told", "changed"), REFUSED.items(), ids=lambda each: each.partition(" ")[0])
def test_what_an_expander_with_oil_cannot_have_is_told(told, changed):
    with pytest.raises(SceneError, match=told):
        load(OIL, [changed])


def test_no_expander_is_offered_what_needs_oil_and_is_refused_with_it():
    """One without oil was told to add oil, one with oil to remove it."""
    dry = suitable_effects(load(POINT))
    assert "oil_pump" in dry and not {name for name, effect in dry.items() if effect.needs_oil} - {
        *suitable_effects(load(OIL))
    }


def test_a_way_of_oil_that_an_expander_lacks_is_not_asked_for_what_it_needs():
    with pytest.raises(SceneError) as caught:
        load(OIL, ["oil_supply={kind: displacement, ratio: null}", "effects.oil_pump=off", "effects.separator=off"])
    assert str(caught.value).count("\n") == 0 and "write kind: pump" in str(caught.value)


def test_an_expander_needs_a_lower_discharge():
    with pytest.raises(SceneError, match="is above the suction pressure"):
        make({**DRY, "machine.mode": "expander", "effects": {}})
