"""An expander is the machine run backwards: mirrored laws, the ideal cycle, figures (M151, M152) and their nulls."""

import math
from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from scenes import DROP, make, run

from screwsim.build import build_parts
from screwsim.cycle.pitch import _slopes
from screwsim.inputs.faults import SceneError
from screwsim.machine.geometry import Geometry
from screwsim.outputs import ledger_entries
from screwsim.scene import load
from screwsim.simulate import simulate

POINT = Path(__file__).parents[2] / "configs" / "expander" / "point.yaml"
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
    result = simulate(load(POINT))
    assert result.status == "ok"
    assert max(result.balance.mass, result.balance.energy, result.balance.entropy) <= result.balance.bound
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


def test_oil_belongs_to_a_compressor():
    with pytest.raises(SceneError, match=r"oil_supply: needs machine.mode: compressor"):
        make(LINES)


def test_an_expander_needs_a_lower_discharge():
    with pytest.raises(SceneError, match="is above the suction pressure"):
        make({**DRY, "machine.mode": "expander", "effects": {}})
