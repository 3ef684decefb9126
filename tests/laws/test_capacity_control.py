"""Capacity control: throttle, bypass, slide valve: conservation, limits, signs, and what they cost."""

import json
import math
from functools import cache, partial
from pathlib import Path

import pytest
from each_row import each_row
from scenes import ECONOMIZER, balanced, make, refusal, run

from screwsim.build import build_parts
from screwsim.inputs.faults import SceneError
from screwsim.outputs import ledger_entries
from screwsim.scene import load
from screwsim.scene.grid import case, case_count
from screwsim.simulate import simulate, simulate_many

THROTTLED = {"effects.suction_throttle": {"pressure_ratio": 0.6}}
RETURNED = {"effects.bypass": {"share": 0.4}}
SLIDE = {
    "slot_area": "40 cm^2",
    "closes": "560 deg",
    "radial_area": "6 cm^2",
    "radial_opens": "600 deg",
    "radial_opens_moved": "650 deg",
}
MOVED = {"effects.slide_valve": {**SLIDE, "position": 1}}
NAMES = {"throttle": "suction_throttle", "bypass": "bypass"}
WAYS = {"throttle": THROTTLED, "bypass": RETURNED, "both": {**THROTTLED, **RETURNED}, "slide valve": MOVED}


@pytest.mark.parametrize("way", WAYS)
def test_mass_energy_and_entropy_close(way):
    result = balanced(run(WAYS[way]))
    assert abs(result.ledger.relative_residue) < 1e-3


@pytest.mark.parametrize("way", WAYS)
def test_each_takes_capacity_and_costs_efficiency(way):
    full, part = run().performance, run(WAYS[way]).performance
    assert part.gas_mass_flow < 0.8 * full.gas_mass_flow
    assert part.isentropic_efficiency < full.isentropic_efficiency
    assert part.shaft_power < full.shaft_power
    assert part.discharge_temperature > full.discharge_temperature


# ---- throttle ----


LINE = {"intake_pressure": 1.5e5, "intake_temperature": 283.0}  # what is sucked in is the suction line's gas


def test_an_open_throttle_is_none_bit_for_bit():
    assert run({"effects.suction_throttle": {"pressure_ratio": 1}}).performance == {**run().performance, **LINE}


def test_a_throttled_machine_sucks_from_a_line_of_that_pressure():
    """The same machine on a line of 0.6 p_s: an ideal gas keeps its temperature; efficiency is of the real line."""
    throttled = run({**THROTTLED}).performance
    own = run({"operation.suction": {"pressure": f"{0.6 * 1.5!r} bar", "temperature": "283 K"}}).performance
    assert throttled.gas_mass_flow == pytest.approx(own.gas_mass_flow, rel=1e-3)  # two widths of the regularisation
    assert throttled.shaft_power == pytest.approx(own.shaft_power, rel=1e-3)
    assert throttled.intake_pressure == pytest.approx(0.9e5)
    work = [math.log(12.0 / p) for p in (1.5, 0.9)]
    ratio = throttled.isothermal_efficiency / own.isothermal_efficiency
    assert ratio == pytest.approx(work[0] / work[1], rel=1e-3)


def test_throttling_destroys_r_t_0_ln_of_the_ratio():
    """Ideal gas, isenthalpic: ṁ T_0 R ln(1/π), of the gas that goes through."""
    result = run(THROTTLED)
    R = 81.4889  # R134a
    destroyed = ledger_entries(result.ledger)["suction_throttle"]["exergy_destroyed"]
    expected = result.performance.gas_mass_flow * 298.15 * R * math.log(1.0 / 0.6)
    assert destroyed == pytest.approx(expected, rel=1e-3)


# ---- bypass ----


def test_a_bypass_of_nothing_is_none_bit_for_bit():
    assert run({"effects.bypass": {"share": 0}}).performance == {**run().performance, **LINE}


def test_the_bypass_mixes_enthalpies():
    p = run(RETURNED).performance
    assert p.intake_temperature == pytest.approx(0.6 * 283.0 + 0.4 * p.discharge_temperature, rel=1e-4)  # c_p constant
    assert p.intake_pressure == pytest.approx(1.5e5)


def test_what_an_economizer_adds_is_counted_by_the_gas_that_comes_from_the_line():
    p = run({**ECONOMIZER, "effects.bypass": {"share": 0.5}}).performance
    assert p.economizer_flow_ratio == pytest.approx(p.economizer_mass_flow / p.gas_mass_flow, rel=1e-12)


def test_a_bypassed_machine_compresses_warmer_gas_and_delivers_its_share():
    part = run(RETURNED).performance
    suction = {"pressure": "1.5 bar", "temperature": f"{float(part.intake_temperature)!r} K"}
    own = run({"operation.suction": suction, "gas.isentropic_exponent": k_at(283.0)}).performance
    assert part.gas_mass_flow == pytest.approx(0.6 * own.gas_mass_flow, rel=1e-3)
    assert part.shaft_power == pytest.approx(own.shaft_power, rel=1e-3)


def k_at(T):
    from screwsim.fluid.constants import isentropic_exponent

    return isentropic_exponent("R134a", T)


def test_every_entry_of_the_intake_destroys():
    entries = ledger_entries(run({**THROTTLED, **RETURNED}).ledger)
    assert entries["bypass"]["exergy_destroyed"] > 0.0
    assert entries["suction_throttle"]["exergy_destroyed"] > 0.0


@pytest.mark.parametrize("way", ["throttle", "bypass"])
def test_flow_against_a_throttle_or_bypass_is_warned_of(way):
    told = "gas flows back to the suction line, but throttle, filter and bypass"
    leaky = {"operation.speed": "60 rpm"}
    found = run({**WAYS[way], **leaky})
    assert found.performance.gas_mass_flow < 0.0 > found.ledger[f"exergy_destroyed_{NAMES[way]}"]
    assert any(each.startswith(told) for each in found.warnings)
    for fine in (run(WAYS[way]), run(leaky)):
        assert not any(each.startswith(told) for each in fine.warnings)


def test_a_sweep_over_the_share_finds_what_each_point_finds_alone():
    scenes = [make({"effects.bypass": {"share": share}}) for share in (0.1, 0.2, 0.3, 0.4)]
    last = list(simulate_many(scenes, trace=False))[-1].performance
    alone = run(RETURNED).performance
    assert last.shaft_power == pytest.approx(alone.shaft_power, rel=5e-4)
    assert last.discharge_temperature == pytest.approx(alone.discharge_temperature, rel=5e-4)


def test_gas_of_a_chamber_goes_back_through_a_bore():
    bore = {"source": "chamber", "area": "3 cm^2", "opens": "380 deg", "passage": "90 deg"}
    with_it, without = run({"effects.bypass": bore}), run()
    balanced(with_it)
    flow, angle = with_it.cycle["mass_flow_bypass"], with_it.cycle["angle"]
    assert (flow[(angle > 395) & (angle < 460)] < 0.0).all() and (flow[(angle < 379) | (angle > 471)] == 0.0).all()
    assert with_it.performance.gas_mass_flow < without.performance.gas_mass_flow
    shut = run({"effects.bypass": {**bore, "area": "1e-6 mm^2"}}).performance
    assert shut.gas_mass_flow == pytest.approx(without.performance.gas_mass_flow, rel=3e-4)  # numerics.accuracy


# ---- slide valve ----


def test_a_slide_at_full_load_without_a_radial_port_is_none():
    slide = {"position": 0, "slot_area": "40 cm^2", "closes": "560 deg"}
    found = run({"effects.slide_valve": {**SLIDE, "position": 0, "radial_area": "1e-6 mm^2"}}).performance
    for name in ("gas_mass_flow", "shaft_power", "discharge_temperature"):
        assert found[name] == pytest.approx(run().performance[name], rel=3e-4), name  # numerics.accuracy
    assert make({"effects.slide_valve": slide}).effects["slide_valve"].parameters.radial_area is None


def test_the_built_in_volume_ratio_is_that_of_the_slides_edges():
    """M162: of the volume where the slot closes, over that where the first of both discharge ports opens."""
    from screwsim.machine.paper_law import volume

    def ratio(closes, opens):
        at = [volume(math.radians(angle), 600e-6, 6e-8, math.radians(60.0)) for angle in (closes, opens)]
        return at[0] / at[1]

    axial, radial = 600.0, {"radial_opens": "560 deg", "radial_opens_moved": "640 deg"}
    for x in (0.0, 0.3, 0.6):  # the axial port is the first one at the last
        found = run({"effects.slide_valve": {**SLIDE, **radial, "position": x}}).performance.built_in_volume_ratio
        assert found == pytest.approx(ratio(360.0 + 200.0 * x, min(560.0 + 80.0 * x, axial)), rel=1e-6)
    slot = {name: SLIDE[name] for name in ("slot_area", "closes")}
    found = run({"effects.slide_valve": {**slot, "position": 0.3}}).performance.built_in_volume_ratio
    assert found == pytest.approx(ratio(420.0, axial), rel=1e-6)


def test_the_load_follows_the_slide():
    flows = [run({"effects.slide_valve": {**SLIDE, "position": x}}).performance.gas_mass_flow for x in (0, 0.3, 0.6, 1)]
    assert flows == sorted(flows, reverse=True)
    assert flows[-1] / flows[0] == pytest.approx(0.63, abs=0.08)  # V(560°)/V_max; leaks take more of less


def test_the_trapped_gas_is_that_of_the_slots_closing():
    """A wide slot leaves the chamber at suction pressure until it closes: flow about as the volume there."""
    wide = {**SLIDE, "slot_area": "400 cm^2", "position": 1, "closes": "540 deg"}
    from screwsim.machine.paper_law import volume

    V = volume(math.radians(540.0), 600e-6, 6e-8, math.radians(60.0))
    full = run({"effects.slide_valve": {**SLIDE, "position": 0}}).performance.gas_mass_flow
    part = run({"effects.slide_valve": wide}).performance.gas_mass_flow
    assert part / full == pytest.approx(V / 600e-6, abs=0.1)  # leaks take more of the smaller charge; ramps of 10°


# ---- the study ----

CONFIGS = Path(__file__).parents[2] / "configs" / "control"


@cache
def full_capacity(supply):
    full = simulate(load(CONFIGS / ("displaced.yaml" if supply else "point.yaml")), trace=False)
    return full.performance.cooling_capacity


@pytest.mark.slow
@pytest.mark.parametrize("supply", ["", "_displaced"])
@pytest.mark.parametrize("way", ["speed", "slide_valve", "throttle", "bypass"])
def test_the_study_goes_from_full_load_to_a_quarter_of_it(way, supply):
    """One machine at full load, whichever way; at the end of each way at most a quarter, closed, at a lower COP."""
    scene = load(CONFIGS / f"{way}{supply}.yaml")
    first, last = simulate_many([case(scene, i) for i in (0, case_count(scene) - 1)], trace=False)
    assert first.status == last.status == "ok"
    assert first.performance.cooling_capacity == pytest.approx(full_capacity(supply), rel=3e-4)
    assert last.performance.cooling_capacity <= 0.25 * first.performance.cooling_capacity
    assert last.performance.cop < first.performance.cop
    assert last.performance.electrical_cop < last.performance.cop
    assert ("oil_pump_power" not in last.performance) == bool(supply)


# ---- faults ----


@each_row(
    ("changes", "words"),
    [
        ({"effects.bypass": {}}, "effects.bypass.share: is missing (source: discharge needs it"),
        ({"effects.bypass": {"share": 0.2, "area": "1 cm^2"}}, "effects.bypass.area: applies only to source: chamber"),
        (
            {**RETURNED, "operation.discharge": {"pressure": "12 bar", "temperature": "340 K"}},
            "operation.discharge.temperature: is given, but the returned gas has the temperature of the outflow",
        ),
        (
            {"effects.slide_valve": {"position": 0.5, "slot_area": "9 cm^2", "closes": "300 deg"}},
            "effects.slide_valve.closes: 300 deg lies outside (360 deg, 700 deg)",
        ),
        (
            {
                "effects.slide_valve": {
                    "position": 0,
                    "slot_area": "9 cm^2",
                    "closes": "500 deg",
                    "radial_area": "9 cm^2",
                }
            },
            "effects.slide_valve.radial_opens: is missing (these are stated together",
        ),
        ({"effects.suction_throttle": {"pressure_ratio": 1.2}}, "effects.suction_throttle.pressure_ratio"),
    ],
)
def test_a_fault_is_found_with_its_remedy(changes, words):
    assert words in refusal(changes)


def _bypass(life):
    return {"bypass": {"source": "chamber", "area": "1 cm^2", "opens": f"{life - 80.0!r} deg", "passage": "90 deg"}}


def _slide(life, **angles):
    return {"slide_valve": {**SLIDE, "position": 0.5, **{name: f"{life + at} deg" for name, at in angles.items()}}}


def _window(life):
    window = {"opens": f"{life - 60.0!r} deg", "closes": f"{life + 10.0!r} deg", "area": "1 mm^2"}
    return {"economizer": {"temperature": "20 degC", **window}}


@pytest.mark.parametrize(("machine", "life"), [("point", 720.0), ("compact", 900.0)])  # the paper's laws; rotors
@pytest.mark.parametrize(
    ("effects", "path"),
    [
        (_bypass, "bypass.passage"),
        (partial(_slide, closes=-20.0), "slide_valve.closes"),
        (partial(_slide, closes=-160.0, radial_opens_moved=-40.0), "slide_valve.radial_opens_moved"),
        (_window, "economizer.closes"),
    ],
)
def test_an_angle_beyond_the_chambers_life_is_a_fault_of_the_scene_at_its_line(machine, life, effects, path, tmp_path):
    """The life of rotors follows from their profile."""
    scene = tmp_path / "x.yaml"
    inside = {"base": str(CONFIGS.with_name("r134a") / f"{machine}.yaml"), "effects": effects(life - 80.0)}
    scene.write_text(json.dumps(inside))
    assert build_parts(load(scene)).geometry.life == pytest.approx(math.radians(life), abs=1e-9)
    beyond = json.dumps({**inside, "effects": effects(life)}).replace('"effects"', '\n"effects"')
    scene.write_text(beyond)
    with pytest.raises(SceneError, match=rf"x\.yaml:2:\d+: effects\.{path}: "):
        load(scene)
