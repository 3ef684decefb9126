"""Refrigerant that the oil of the chambers gives off and takes up over time: balances, integrators, limits, signs."""

import re

import numpy as np
import pytest
from each_row import each_row
from known_figures import known_solution
from scenes import DROP, OIL_VOLUME, RADAU, SOLUBLE, SOLUBLE_RATE, balanced, make, refusal, run
from vessel import plain

from screwsim.build import build_parts, build_site
from screwsim.effects import refrigerant_solubility as effect
from screwsim.effects.base import OilSolution
from screwsim.explain import explain
from screwsim.fluid.solubility import given_off
from screwsim.model import compiled
from screwsim.model.compose import compose
from screwsim.numerics.spline import pack_curve

NAME = "effects.refrigerant_solubility"
FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature", "trapped_mass", "oil_mass_flow")
FLASH = (*FIGURES, "flash_mass_flow", "discharge_dissolved_gas_ratio")
ACCURACY = 3e-4
REAL = {"gas.model": "real", "operation.suction.temperature": "290 K"}
CASES = {
    "both ways": SOLUBLE_RATE,
    "given off only": {**SOLUBLE_RATE, f"{NAME}.absorption_time": DROP},
    "oil takes room": {**SOLUBLE_RATE, **OIL_VOLUME},
    "real gas": {**SOLUBLE_RATE, **REAL},
    "coupled chambers": {**SOLUBLE_RATE, "numerics": {"closing": "coupled"}},
    "fast": {**SOLUBLE_RATE, f"{NAME}.flash_time": "10 us", f"{NAME}.absorption_time": "10 us"},
}


def timed(flash, absorption=None, **changes):
    times = {"flash_time": flash} | ({"absorption_time": absorption} if absorption else {})
    return run({**SOLUBLE, NAME: {"separator_temperature": "345 K", **times}, **changes})


def change(one, other, names=FLASH):
    """Return the largest difference: of the gas that flashes over the gas that flows, of all else relative."""
    a, b = one.performance, other.performance
    sizes = {name: abs(b[name]) for name in names} | {"flash_mass_flow": b.gas_mass_flow}
    return max(abs(a[name] - b[name]) / sizes[name] for name in names)


def parts_of(changes):
    """Return a scene's parts, what its oil holds, and the site of its plenum."""
    scene = make(changes)
    parts = build_parts(scene)
    assert isinstance(parts.oil_content, OilSolution)
    return parts, parts.oil_content, build_site(scene, parts.gas)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_mass_energy_entropy_and_what_is_dissolved_close(case):
    balanced(run(CASES[case]), "oil_mass")


@each_row("case", CASES)
def test_every_entry_of_the_ledger_but_lines_generates_entropy(case):
    book = run(CASES[case]).ledger
    assert book["entropy_generated_refrigerant_solubility"] > 0.0
    names = [name for name in book if name.startswith("entropy_generated_") and not name.endswith("_line")]
    assert all(book[name] >= 0.0 for name in names)


def test_gas_is_the_difference_of_what_the_oil_brings_and_takes_along():
    p = run(SOLUBLE_RATE).performance
    stays = p.oil_mass_flow * (p.dissolved_gas_ratio - p.discharge_dissolved_gas_ratio)
    assert p.flash_mass_flow == pytest.approx(stays, abs=ACCURACY * p.gas_mass_flow)


def test_coupled_chambers_agree_with_histories():
    assert change(run(CASES["coupled chambers"]), run(SOLUBLE_RATE)) < ACCURACY


@pytest.mark.parametrize("case", ["both ways", "given off only"])
def test_radau_agrees(case):
    assert change(run(CASES[case]), known_solution(make({**CASES[case], "numerics": RADAU}))) < ACCURACY


def test_figures_converge_with_the_accuracy():
    fine = run({**SOLUBLE_RATE, "numerics": {"accuracy": 1e-6}})
    assert fine.status == "ok"
    assert change(run(SOLUBLE_RATE), fine) < ACCURACY
    assert change(run({**SOLUBLE_RATE, "numerics": {"accuracy": 1e-5}}), fine) < 1e-5


def test_slow_oil_is_a_machine_without_dissolved_gas():
    """The flash is as small as life over time constant, and so is its effect."""
    without = run({**SOLUBLE, NAME: DROP})
    slow = timed("1e4 s", "1e4 s")
    p = slow.performance
    assert p.discharge_dissolved_gas_ratio == pytest.approx(p.dissolved_gas_ratio, rel=ACCURACY)
    assert change(slow, without, FIGURES) < ACCURACY
    powers = [timed(time).performance.shaft_power / without.performance.shaft_power - 1.0 for time in ("1 s", "10 s")]
    assert powers[0] / powers[1] == pytest.approx(10.0, rel=0.1)


def equilibrium(changes):
    """Return what the oil of every chamber would hold in equilibrium, over the angle, from traces and tables (M232)."""
    parts, content, _ = parts_of(changes)
    cycle, gas = run(changes).cycle, parts.gas
    curve = pack_curve(content.entropy[::-1], content.log_held[::-1])
    held = []
    for p, T, T_oil in zip(cycle["pressure"], cycle["gas_temperature"], cycle["oil_temperature"], strict=True):
        vapour = gas.vapour(p, T)
        rate = given_off(1.0, 0.0, vapour.s, vapour.h, T_oil, curve, 0, content.enthalpy, 1.0, 1.0, 1.0)
        held.append(-rate[0])
    return np.array(held)


def test_fast_oil_is_in_equilibrium_with_the_gas():
    """Off by no more than goes with the time that it takes to follow."""
    apart = []
    for case in ({**CASES["fast"]}, {**CASES["fast"], f"{NAME}.flash_time": "1 us", f"{NAME}.absorption_time": "1 us"}):
        cycle, held = run(case).cycle, equilibrium(case)
        closed = (cycle["angle"] > 460.0) & (cycle["angle"] < 600.0)
        apart.append(np.max(np.abs(cycle["dissolved_gas_ratio"][closed] / held[closed] - 1.0)))
    assert apart[0] < 3e-3
    assert apart[1] < ACCURACY


def test_traces_give_the_gas_of_a_chamber_with_what_its_oil_gives_off():
    """Where ports are open, too, whose flow is taken from it: off the breakpoints, by differences over a degree."""
    case = CASES["given off only"]
    cycle, excess = run(case).cycle, run(case).cycle["dissolved_gas_ratio"] - equilibrium(case)
    time = np.radians(cycle["angle"]) / (2.0 * np.pi * 50.0)
    released = cycle["oil_mass"] * np.maximum(excess, 0.0) / 5e-3
    flows = sum(values for name, values in cycle.items() if name.startswith("mass_flow_"))
    change_of_gas = np.gradient(cycle["gas_mass"], time)
    filled = (cycle["angle"] > 70.0) & (cycle["angle"] < 340.0)
    off = np.abs(change_of_gas - flows - released)[filled]
    assert np.mean(off) < 0.1 * np.mean(released[filled])
    assert np.mean(released[filled]) > 0.0


def test_figures_tend_to_a_limit_as_oil_becomes_fast():
    """The limit of the flash: halved times halve what is left, and 1 us is the limit to the accuracy."""
    figures = [timed(time).performance for time in ("400 us", "200 us", "100 us", "1 us")]
    for name in ("gas_mass_flow", "flash_mass_flow"):
        left = [abs(each[name] - figures[-1][name]) for each in figures[:-1]]
        assert left[0] > 1.5 * left[1] > 2.25 * left[2], name


def test_a_fast_flash_is_near_that_in_the_port():
    """It ends at the chamber's temperatures and the rate's heat of solution, not at those of the oil in the port."""
    fast, port = timed("1 us").performance, run(SOLUBLE).performance
    assert fast.flash_mass_flow == pytest.approx(port.flash_mass_flow, rel=0.1)
    assert fast.gas_mass_flow == pytest.approx(port.gas_mass_flow, rel=5e-3)
    assert fast.shaft_power == pytest.approx(port.shaft_power, rel=0.02)


def test_the_slower_the_less_gas_to_compress():
    results = [timed(time).performance for time in ("1 ms", "10 ms", "100 ms")]
    for name in ("flash_mass_flow", "shaft_power"):
        assert [r[name] for r in results] == sorted((r[name] for r in results), reverse=True), name
    assert [r.volumetric_efficiency for r in results] == sorted(r.volumetric_efficiency for r in results)


def test_no_transfer_destroys_entropy():
    """Wherever gas and oil stand to each other (M233)."""
    parts, content, site = parts_of(SOLUBLE_RATE)
    gas, c = parts.gas, compose(parts)
    module, names = compiled.load(c.text), plain(c.text)
    release = next(call for call in re.findall(r"solubility__given_off\([^()]*\)", c.text) if "w_gas" in call)
    assert site.oil is not None
    generator = np.random.default_rng(5)
    for _ in range(400):
        p, T, T_oil = generator.uniform((0.5e5, 260.0, 280.0), (14e5, 400.0, 380.0))
        w = np.exp(generator.uniform(np.log(0.01), np.log(1.0)))
        state = gas.vapour(p, T)
        values = {"m_oil": 1.0, "w_gas": w, "s": state.s, "h": state.h, "T_oil": T_oil, "P": c.P, "TAB": c.TAB}
        flow, _h, heat = eval(release, {**names, **values})
        s, total = module.solution_entropy(w, c.P, c.TAB)
        heat *= site.oil.heat_capacity
        assert heat == pytest.approx(flow * (state.h - content.enthalpy), rel=1e-9)
        generated = flow * (state.s - s) - heat / T_oil
        assert generated >= -1e-7 * abs(flow * s)
        other = w * generator.uniform(0.2, 5.0)
        mixing = total + s * (other - w) - module.solution_entropy(other, c.P, c.TAB)[1]
        assert mixing >= -1e-9 * abs(total)


def test_entropy_of_all_is_the_integral_of_that_of_each():
    c = compose(parts_of(SOLUBLE_RATE)[0])
    of = compiled.load(c.text).solution_entropy
    for w in (1e-3, 0.05, 0.3, 1.0):
        above, below = (of(w * (1.0 + sign * 1e-3), c.P, c.TAB)[1] for sign in (1, -1))
        assert (above - below) / (2e-3 * w) == pytest.approx(of(w, c.P, c.TAB)[0], abs=1e-3)  # of 80 J/(kg K) per ln w


def test_explain_names_state_times_and_equations():
    text = " ".join(str(explain(make(SOLUBLE_RATE))).replace("\u00a0", " ").split())
    assert "w_gas dissolved gas per mass of oil" in text
    assert "state w_gas, plenum oil_gas" in text
    assert "M230, M231, M232, M233" in text
    assert "flash_time 5 ms, absorption_time 50 ms" in text


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({f"{NAME}.flash_time": DROP}, "absorption_time: has no meaning where the oil flashes at once in the port"),
        ({f"{NAME}.flash_time": "0 s"}, "must be greater than 0 ms"),
        ({"oil.transport": "paper"}, "oil.transport"),
        ({f"{NAME}.separator_temperature": "319.6 K"}, "and the rate is known from 1e-06 to 20"),
    ],
)
def test_what_does_not_go_together_is_said(changes, words):
    assert words in refusal({**SOLUBLE_RATE, **changes})


def test_the_effect_without_times_has_neither_state_nor_trace():
    result = run(SOLUBLE)
    assert "w_gas" not in result.states
    assert "dissolved_gas_ratio" not in result.cycle
    assert result.performance.get("discharge_dissolved_gas_ratio") is None
    assert effect.EFFECT.parameters.__dataclass_fields__["flash_time"].default is None
