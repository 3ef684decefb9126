"""A new kind of flow takes two files, its law and the effect that uses it, or one; all else follows from them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from known_figures import known_solution
from own_flows import layers, viscous

import screwsim
from screwsim.build import PartsCache, build_parts
from screwsim.effects.base import GAS, NEIGHBOUR, OIL, ChamberState, FlowKind, FlowPath, PathStream, Resistance
from screwsim.explain import explain
from screwsim.fluid.gap_flow import open_share
from screwsim.model.compose import compose
from screwsim.model.renumbering import renumbered
from screwsim.numerics.kernel import kernel

CONFIGS = Path(__file__).parents[2] / "configs"
SLOT = "effects={own_flows.slot: {height: 60 um}}"


@pytest.fixture(scope="module")
def of_closings():
    found = {}

    def solved(closing, *changes):
        key = closing, *changes
        if key not in found:
            found[key] = screwsim.simulate(closed_by(closing, *changes))
        return found[key]

    return solved


def closed_by(closing, *changes):
    wanted = [f"numerics.closing={closing}", "numerics.accuracy=1e-5", SLOT, *changes]
    return screwsim.load(CONFIGS / "paper" / "point.yaml", wanted)


def test_explain_names_the_law_of_a_path_and_keeps_the_nozzle_to_the_others():
    lines = dict(explain(closed_by("histories")).sections)["Flow paths"]
    laws = [" ".join(line.split()) for line in "\n".join(lines).replace("\n" + 22 * " ", " ").splitlines()]
    slots = [line for line in laws if line.startswith("own_flows.slot ")]
    assert len(slots) == 2 and all(line.endswith(", flow by slot_flux") for line in slots)
    assert [line for line in laws if "nozzle flow" in line] == [
        "other paths nozzle flow in both directions, choking included (M12, M13)"
    ]
    alone = dict(explain(screwsim.load(CONFIGS / "paper" / "point.yaml")).sections)["Flow paths"]
    assert any(line.strip().startswith("every path") for line in alone)


def test_the_flow_through_a_slot_is_that_of_its_law(of_closings):
    result = of_closings("histories", "numerics.accuracy=2e-6")  # its traces are slopes of the states
    assert result.status == "ok"
    cycle = result.cycle
    p, rho = cycle["pressure"], cycle["gas_mass"] / cycle["volume"]
    line = result.performance.suction_pressure, rho[len(p) // 8]  # of a chamber that is wide open to it
    closed = cycle["mass_flow_suction_port"] == 0.0
    flux = viscous.slot_flux(p, rho, *line, 60e-6, 20e-3, 2e-5) * 60e-6 * 0.1
    found = cycle["mass_flow_own_flows.slot"]
    assert np.count_nonzero(closed) > 100 and np.max(np.abs(found[closed])) > 0.01
    np.testing.assert_allclose(found[closed], flux[closed], rtol=2e-3, atol=1e-4 * np.max(np.abs(found)))


def test_its_balances_close_and_its_entropy_is_generated(of_closings):
    for closing in ("histories", "coupled"):
        result = of_closings(closing)
        assert max(result.balance.mass, result.balance.energy, result.balance.entropy) < 1e-5
        assert result.ledger["entropy_generated_own_flows.slot"] > 0.0


@pytest.mark.parametrize("figure", ["volumetric_efficiency", "isothermal_efficiency", "indicated_power"])
def test_both_closings_and_radau_agree_on_it(of_closings, figure):
    alone = of_closings("histories").performance[figure]
    assert of_closings("coupled").performance[figure] == pytest.approx(alone, rel=3e-5)
    radau = known_solution(closed_by("coupled", "numerics.integrator=scipy-radau")).performance[figure]
    assert radau == pytest.approx(alone, rel=3e-5)


def test_a_law_may_take_the_enthalpies_of_both_sides(of_closings):
    wanted = "numerics.closing=coupled", "numerics.accuracy=1e-5", SLOT.replace("slot", "warm_slot")
    dense, warm = of_closings("coupled"), screwsim.simulate(screwsim.load(CONFIGS / "paper" / "point.yaml", wanted))
    for name in ("volumetric_efficiency", "indicated_power"):
        assert warm.performance[name] == pytest.approx(dense.performance[name], rel=1e-5)
    expected = dense.cycle["mass_flow_own_flows.slot_trailing"]
    found = warm.cycle["mass_flow_own_flows.warm_slot_trailing"]
    np.testing.assert_allclose(found, expected, atol=1e-4 * np.max(np.abs(expected)))


# ---- gas and oil in layers ------------------------------------------------------------------------------------------

LAYERS = "effects.own_flows.layers"
WIPED = f"{LAYERS}.wiped=0.02"
SCENES = {  # each with the slots, and a wall that wipes oil along
    "plain": ("paper/point.yaml", "oil.transport=carried", "oil_supply.ratio=5"),
    "oil takes room": ("paper/point.yaml", "oil.transport=carried", "oil_supply.ratio=5", "effects.oil_volume={}"),
    "speed varies": ("drive/point.yaml", "oil.transport=carried"),
    "all effects": ("everything.yaml",),
    "expander": ("expander/oil.yaml",),
}


def layered(name, *changes):
    scene, *more = SCENES[name]
    wanted = ["numerics.accuracy=1e-5", "effects={own_flows.layers: {height: 60 um}}", *more, *changes]
    return screwsim.load(CONFIGS / scene, wanted)


@pytest.mark.parametrize("name", SCENES)
def test_balances_close_with_oil_that_passes_gaps_and_ports_beside_the_gas(name):
    found = {}
    for closing in ("histories", "coupled"):
        result = screwsim.simulate(layered(name, WIPED, f"numerics.closing={closing}"))
        assert result.status == "ok"
        balance = result.balance
        assert max(balance.mass, balance.energy, balance.oil_mass, balance.entropy) < 1e-5
        assert result.ledger["entropy_generated_own_flows.layers"] > 0.0
        found[closing] = result.performance.indicated_power
    assert found["coupled"] == pytest.approx(found["histories"], rel=3e-5)


def test_both_layers_are_traced_and_are_those_of_their_laws():
    scene = layered("plain", "numerics.accuracy=2e-6")  # its traces are slopes of the states
    result = screwsim.simulate(scene)
    cycle, area = result.cycle, 60e-6 * 0.1
    p, rho, ratio = cycle["pressure"], cycle["gas_mass"] / cycle["volume"], cycle["oil_mass"] / cycle["gas_mass"]
    drop = p - result.performance.suction_pressure
    shut = (cycle["mass_flow_suction_port"] == 0.0) & (drop > 1e4)  # gas and oil leave the chamber
    assert np.count_nonzero(shut) > 100
    line = rho[len(p) // 8]  # of a chamber that is wide open to it
    where = list(zip(drop[shut], rho[shut], ratio[shut], strict=True))
    gas = [-area * layers.gas_layer(d, 0.5 * (r + line), x, 60e-6, 20e-3, 2e-5) for d, r, x in where]
    oil = [-area * layers.oil_layer(d, x, 60e-6, 20e-3, 5e-3, scene.oil.density) for d, _, x in where]
    for flow, expected in (("mass", gas), ("oil", oil)):
        found = cycle[f"{flow}_flow_own_flows.layers"][shut]
        assert np.max(np.abs(expected)) > 1e-3
        np.testing.assert_allclose(found, expected, rtol=3e-3, atol=2e-3 * np.max(np.abs(expected)))


def test_oil_in_layers_that_leaves_one_chamber_enters_the_one_behind():
    cycle, phi = screwsim.simulate(layered("plain", WIPED)).cycle, np.arange(10.0, 620.0)
    there = np.interp(phi, cycle["angle"], cycle["oil_flow_own_flows.layers_leading"])
    here = np.interp(phi + 90.0, cycle["angle"], cycle["oil_flow_own_flows.layers_trailing"])
    assert there == pytest.approx(-here, rel=2e-3, abs=2e-3 * np.max(np.abs(there)))


@pytest.mark.parametrize("more", [(), (WIPED, "effects.oil_volume={}")])
def test_its_derivatives_are_those_of_closed_cycles(more):
    path, figures = f"{LAYERS}.height", ["volumetric_efficiency", "indicated_power"]

    def at(height):
        tight = "numerics.accuracy=1e-7", "numerics.closing=coupled", f"{path}={height} um"
        return screwsim.simulate(layered("plain", *more, *tight), trace=False).performance

    less, greater = at(59.4), at(60.6)
    found = screwsim.sensitivities(layered("plain", *more), [path], figures)
    assert found.method[path] == "exact"
    for figure in figures:
        assert found.derivatives[figure][path] == pytest.approx((greater[figure] - less[figure]) / 1.2e-6, rel=1e-3)


def test_scenes_that_differ_in_numbers_of_a_kind_of_flow_share_its_text():
    shared, changes = PartsCache(), ((), (f"{LAYERS}.height=70 um",), (WIPED,))
    first, other, wiped = (build_parts(layered("plain", *more), shared) for more in changes)
    composition = compose(first)
    found = renumbered(first, composition, other)
    assert found is not None and np.array_equal(found.P, compose(other).P)
    assert not np.array_equal(found.P, composition.P)
    assert renumbered(first, composition, wiped) is None


def test_a_bounded_kernel_of_a_kind_of_flow_is_checked():
    result = screwsim.simulate(layered("plain", f"{LAYERS}.wiped=-0.001"))
    assert result.status == "failed"
    assert "own_flows.layers: its wiped oil is -4.8" in str(result)


@dataclass(frozen=True)
class Written(FlowKind):
    """A kind of flow of given streams."""

    of: Callable

    def streams(self, calls):
        """Return the streams."""
        return self.of()


GAS_ALONE = PathStream(GAS, (), "{nozzle}")
OIL_BESIDE = PathStream(OIL, (), "1e-3 * ({beyond.p} - {own.p})")


def with_path(flow, to=NEIGHBOUR, *changes, **more):
    parts = build_parts(layered("plain", f"{LAYERS}=off", *changes))
    path = FlowPath(to, layers.cross_section, {"size": 1e-6}, offset=int(to == NEIGHBOUR), flow=flow, **more)
    return replace(parts, effects={**parts.effects, "mine": [path]})


@pytest.mark.parametrize(
    ("streams", "message"),
    [
        ([], "its streams are one of gas, first, and any of oil"),
        ([OIL_BESIDE], "its streams are one of gas, first"),
        ([GAS_ALONE, GAS_ALONE], "its streams are one of gas, first"),
        ([GAS_ALONE, OIL_BESIDE, OIL_BESIDE], "one stream of oil may be driven by pressures"),
        ([PathStream(GAS, ["area = 2.0"], "{nozzle}")], "its text may not set area, which"),
        ([PathStream(GAS, ["rho_ahead = 2.0"], "{nozzle}")], "its text may not set rho_ahead, which"),
        ([PathStream(GAS, (), "{own.speed}")], "its text cannot be read"),
        ([PathStream(GAS, (), "{wall}")], "its text cannot be read"),
        ([PathStream(GAS, ["x = = 2.0"], "x")], "its text cannot be read"),
        (
            [PathStream(GAS, ["x = 2.0"], "x"), PathStream(OIL, (), "x")],
            r"its text cannot be read \(it does not set x\)",
        ),
    ],
)
def test_streams_that_the_network_cannot_take_are_refused(streams, message):
    with pytest.raises(TypeError, match=f"mine: Written: {message}"):
        compose(with_path(Written(lambda: streams)))


def test_a_kernel_in_place_of_a_kind_of_flow_is_refused_with_what_to_write():
    with pytest.raises(TypeError, match=r"not a kind of flow \(for a kernel that returns a flux, write flow=Law"):
        FlowPath(NEIGHBOUR, open_share, {}, flow=open_share)


def test_a_kind_of_flow_where_it_does_not_belong_is_refused():
    with pytest.raises(TypeError, match="mine: a Resistance belongs to a gap between chambers"):
        compose(with_path(Resistance(open_share, values={"filled_from": 1.0}), "suction"))
    beside = Written(lambda: [GAS_ALONE, OIL_BESIDE])
    with pytest.raises(TypeError, match="oil that passes beside the gas needs a temperature of the oil"):
        compose(with_path(beside, NEIGHBOUR, "oil.transport=paper"))
    with pytest.raises(TypeError, match="mine: oil cannot pass beside the gas where the opening depends on the state"):
        compose(with_path(beside, "suction", opening=half_open))


@kernel
def half_open(drop):
    """Return the open share."""
    return 0.5


@kernel
def standing(phi):
    """Return the rate of a state that never changes."""
    return 0.0


@pytest.mark.parametrize(("name", "closing"), [("V", "one"), ("flow", "one"), ("q_crossing", "all")])
def test_a_state_that_is_called_as_a_variable_of_the_text_is_refused(name, closing):
    parts = build_parts(screwsim.load(CONFIGS / "paper" / "point.yaml"))
    named = replace(parts, effects={**parts.effects, "mine": [ChamberState(name, standing, {})]})
    with pytest.raises(TypeError, match=f"a state cannot be called {name}"):
        compose(named).together() if closing == "all" else compose(named)
