"""Oil flow for a temperature at discharge, economizer in equilibrium: found with the cycle, as if stated."""

import pytest
from each_row import each_row
from folders import POINT
from scenes import DROP, ECONOMIZER, make, run

import screwsim
from screwsim.derivatives.solving import scene_derivatives
from screwsim.explain import explain
from screwsim.explain.parameters import parameters
from screwsim.inputs.faults import SceneError
from screwsim.scene import loads, with_values
from screwsim.scene.fields import value_at
from screwsim.simulate import simulate, simulate_many
from screwsim.study.uncertainty.point import sensitivities
from screwsim.template import new_scene, request_of

ACCURACY = 3e-4
SHARE = 1e-3  # of a number, for differences
SLOPES = 5e-4  # of a slope: with the economizer held, 2 and more
LINES = {
    "operation.suction": DROP,
    "operation.discharge": DROP,
    "operation.evaporating_temperature": "-18 degC",
    "operation.condensing_temperature": "46 degC",
    "operation.superheat": "27 K",
}
MACHINE = {**ECONOMIZER, **LINES, "oil.transport": "carried", "effects.separator": {}}
AUTO = {**MACHINE, "effects.economizer.temperature": "auto"}
OIL = {**MACHINE, "oil_supply.ratio": DROP, "oil_supply.discharge_temperature": "315 K"}
SEEN = ("gas_mass_flow", "shaft_power", "cooling_capacity", "mixture_discharge_temperature", "oil_ratio")


def same(one, other):
    """Tell whether two results have the same figures, within both of their errors."""
    return all(one.performance[name] == pytest.approx(other.performance[name], rel=2 * ACCURACY) for name in SEEN)


@pytest.fixture(scope="module")
def settled():
    return run(AUTO)


def test_an_economizer_settles_where_its_port_draws_what_the_liquid_gives_off(settled):
    assert (settled.status, settled.warnings) == ("ok", ())
    assert settled.performance.economizer_draw_ratio == pytest.approx(1.0, abs=ACCURACY)
    T = settled.performance.economizer_temperature
    assert same(settled, run({**MACHINE, "effects.economizer.temperature": f"{T} K"}))


def test_it_is_no_other_temperature(settled):
    """Warmer, its pressure is higher and its liquid gives off less: the port draws more than that; colder, less."""
    T = settled.performance.economizer_temperature
    ratios = [
        run({**MACHINE, "effects.economizer.temperature": f"{T + off} K"}).performance.economizer_draw_ratio
        for off in (-3.0, 3.0)
    ]
    assert ratios[0] < 0.95 and ratios[1] > 1.05


def test_a_flash_tank_settles_and_a_larger_port_makes_it_colder(settled):
    tank = run({**AUTO, "effects.economizer.kind": "flash_tank"})
    wide = run({**AUTO, "effects.economizer.area": "3 cm^2"})
    for result in (tank, wide):
        assert (result.status, result.warnings) == ("ok", ())
        assert result.performance.economizer_draw_ratio == pytest.approx(1.0, abs=ACCURACY)
    assert wide.performance.economizer_temperature < settled.performance.economizer_temperature - 1.0


def test_a_port_that_draws_little_of_much_that_passes_both_ways_settles():
    """A kelvin changes its draw sixfold, close to the end of the range: 0.014 of the flow was left open."""
    machine = loads(new_scene("refrigeration", request_of(fluid="R134a", capacity="300 kW", economizer=True)))
    warm = {"operation.evaporating_temperature": 283.15, "operation.condensing_temperature": 298.15}
    warm |= {"effects.economizer.area": 200e-6}
    found = simulate(with_values(machine, warm), trace=False)
    assert found.status == "ok"
    assert found.performance.economizer_draw_ratio == pytest.approx(1.0, abs=ACCURACY)


def test_where_no_temperature_agrees_a_warning_says_so():
    """A port that opens where the chamber's pressure is that of the condenser draws nothing at any temperature."""
    late = run({**AUTO, "effects.economizer.opens": "640 deg", "effects.economizer.closes": "690 deg"})
    told = [
        each for each in late.warnings if each.startswith("at no economizer temperature does the port draw as much")
    ]
    assert late.status == "ok" and len(told) == 1
    assert told[0].endswith("(a larger port, or one that opens earlier)") and "the highest, it draws" in told[0]


def test_the_oil_flow_is_the_one_that_brings_the_mixture_to_its_temperature():
    found = run(OIL)
    assert (found.status, found.warnings) == ("ok", ())
    assert found.performance.mixture_discharge_temperature == pytest.approx(315.0, abs=1e-2)
    ratio = found.performance.oil_ratio
    assert same(found, run({**MACHINE, "oil_supply.ratio": ratio}))
    warmer = run({**OIL, "oil_supply.discharge_temperature": "325 K"})
    assert warmer.performance.oil_ratio < ratio


@pytest.mark.parametrize("speed", [1500, 3000])
def test_a_stated_oil_flow_is_what_is_injected_at_any_speed(speed):
    flowing = {"oil_supply.ratio": DROP, "oil_supply.flow": "45 L/min", "operation.speed": f"{speed} rpm"}
    found = run(flowing)
    assert (found.status, found.warnings) == ("ok", ())
    assert found.performance.oil_mass_flow == pytest.approx(1000.0 * 45e-3 / 60, rel=ACCURACY)
    stated = run({"oil_supply.ratio": found.performance.oil_ratio, "operation.speed": f"{speed} rpm"})
    for name in ("gas_mass_flow", "shaft_power", "oil_mass_flow"):
        assert found.performance[name] == pytest.approx(stated.performance[name], rel=2 * ACCURACY)


def test_an_oil_flow_beside_another_statement_or_out_of_reach_is_told():
    with pytest.raises(SceneError, match=r"oil_supply\.flow: is given as well as oil_supply\.ratio"):
        make({"oil_supply.flow": "45 L/min"})
    with pytest.raises(SceneError, match=r"oil_supply\.flow: is given as well as oil_supply\.discharge_temperature"):
        make({**OIL, "oil_supply.flow": "45 L/min"})
    displaced = {"kind": "displacement", "temperature": "293 K", "orifice_diameter": "6 mm", "flow": "45 L/min"}
    with pytest.raises(SceneError, match=r"oil_supply\.flow: applies only to kind: pump; displaced oil"):
        make({"oil_supply": displaced, "effects.oil_pump": DROP})
    (told,) = [
        each
        for each in run({"oil_supply.ratio": DROP, "oil_supply.flow": "0.05 L/min"}).warnings
        if each.startswith("with 0.02 kg of oil per kg of gas, the least ratio tried, ")
    ]
    assert told.endswith("times oil_supply.flow is injected (choose another oil_supply.flow)")


FLOWING = {"oil_supply.ratio": DROP, "oil_supply.flow": "45 L/min"}


@pytest.mark.parametrize(
    ("changes", "path", "figures"),
    [
        (FLOWING, "oil_supply.flow", ("oil_mass_flow", "shaft_power", "isentropic_efficiency")),
        (AUTO, "operation.condensing_temperature", ("economizer_temperature", "cooling_capacity", "shaft_power")),
        (OIL, "oil_supply.discharge_temperature", ("oil_ratio", "shaft_power", "mixture_discharge_temperature")),
        (
            {**OIL, "effects.economizer.temperature": "auto"},
            "effects.economizer.area",
            ("oil_ratio", "economizer_temperature", "cooling_capacity"),
        ),
    ],
)
def test_exact_derivatives_do_not_hold_fixed_what_is_found_with_the_cycle(changes, path, figures):
    """Compared with differences of solutions; an economizer that holds its temperature gives other slopes."""
    scene = make(changes)
    found, value = sensitivities(scene, [path], figures), value_at(scene, path)
    step, fine = SHARE * value, with_values(scene, {"numerics.accuracy": 1e-6})
    high, low = (simulate(with_values(fine, {path: value + by}), trace=False) for by in (step, -step))
    assert found.method[path] == "exact"
    for name in figures:
        slope = (high.performance[name] - low.performance[name]) / (2.0 * step)
        assert found.derivatives[name][path] == pytest.approx(slope, rel=SLOPES), name


def test_where_no_temperature_agrees_it_stays_at_the_end_of_its_range_which_a_number_may_move():
    """What moves that end would move the temperature to one side alone."""
    late = make({**AUTO, "effects.economizer.opens": "640 deg", "effects.economizer.closes": "690 deg"})
    area, condensing = "effects.economizer.area", "operation.condensing_temperature"
    found = sensitivities(late, [area, condensing], ["economizer_temperature"])
    assert found.method == {area: "exact", condensing: "differences"}
    assert "moves the end of the range" in found.why[condensing]
    assert found.derivatives["economizer_temperature"][area] == 0.0


def test_a_valve_that_the_last_steps_of_a_search_shut_stays_shut_in_exact_derivatives():
    """The cycle that the search hands over has it a little open."""
    number, figures = "operation.superheat", ("shaft_power", "cooling_capacity")
    scene = screwsim.load(
        POINT.parents[1] / "r134a" / "point.yaml",
        [
            "effects.economizer={temperature: auto, opens: 400 deg, closes: 500 deg, area: 5 mm^2, kind: flash_tank}",
            "effects.economizer.backflow=evaporates",
            "effects.liquid_injection={opens: 500 deg, closes: 600 deg, area: 4 mm^2, discharge_temperature: 75 degC}",
        ],
    )
    found, value = scene_derivatives(scene, {number: value_at(scene, number)}), value_at(scene, number)
    fine = with_values(scene, {"numerics.accuracy": 1e-6})
    high, low = (simulate(with_values(fine, {number: value + by}), trace=False) for by in (0.2, -0.2))
    assert max(each.performance.liquid_injection_opening for each in (high, low)) < 1.001e-4
    for name in figures:
        slope = (high.performance[name] - low.performance[name]) / 0.4
        assert found.derivatives[number][name] == pytest.approx(slope, rel=SLOPES), name


def test_both_are_found_together():
    both = run({**OIL, "effects.economizer.temperature": "auto"})
    assert both.status == "ok"
    assert both.performance.mixture_discharge_temperature == pytest.approx(315.0, abs=1e-2)
    assert both.performance.economizer_draw_ratio == pytest.approx(1.0, abs=ACCURACY)


def test_a_search_goes_back_from_a_state_without_net_flow_where_nothing_is_implied():
    """A slow machine: a port as warm as its range ends fills the chambers, and all that was sucked in flows back."""
    new = loads(new_scene("refrigeration", request_of(condition="2/42 degC", economizer=True)))
    found = simulate(new.with_({"operation.speed": "300 rpm"}))
    assert found.status == "ok" and found.performance.gas_mass_flow > 0.0
    assert found.performance.economizer_draw_ratio == pytest.approx(1.0, abs=ACCURACY)


WIDE = {"effects.economizer.area": "270 mm^2"}  # a port through which chambers push ammonia's vapour back


def test_a_search_begins_colder_where_the_first_economizer_leaves_no_room_for_suction_gas():
    """At part load the first guess fills the chambers: nothing was implied, and the search ended there."""
    asked = request_of(
        fluid="Ammonia", displacement="930 m^3/h", condition="2/35 degC, 5 K", economizer=True, slide=True
    )
    found = simulate(
        loads(new_scene("refrigeration", asked)).with_({"machine.slide_valve.position": "0.9", **WIDE}), trace=False
    )
    assert found.status == "ok" and found.performance.volumetric_efficiency > 0.2
    assert any("the lowest, it draws" in each for each in found.warnings)


def test_a_number_held_at_the_end_of_its_range_does_not_keep_the_oil_from_its_temperature():
    """Steps of the oil's temperature moved it off its end, and the step back moved the oil, without end."""
    asked = request_of(
        fluid="Ammonia", displacement="930 m^3/h", condition="2/35 degC, 5 K", economizer=True, slide=True
    )
    mild = {"operation.evaporating_temperature": "10 degC", "operation.condensing_temperature": "25 degC"}
    found = simulate(loads(new_scene("refrigeration", asked)).with_({**mild, **WIDE}), trace=False)
    assert found.status == "ok" and found.performance.economizer_draw_ratio < 0.0
    assert any(
        each.endswith("(open it earlier, or leave it out here: the chambers' pressure is above its own)")
        for each in found.warnings
    )


def test_oil_that_cannot_keep_the_temperature_is_warned_of():
    hot = run({**OIL, "oil_supply.discharge_temperature": "600 K"})
    told = [
        each for each in hot.warnings if each.startswith("no oil flow brings the mixture to 326.9 degC: with 0.02 kg")
    ]
    assert len(told) == 1


def test_neighbours_of_a_sweep_find_what_each_finds_alone():
    scenes = [make({**AUTO, "operation.speed": f"{speed} rpm"}) for speed in (3000, 3200, 3400)]
    for scene, result in zip(scenes, simulate_many(scenes), strict=True):
        assert same(result, simulate(scene))


def test_an_open_pressure_is_an_open_temperature_as_both_are_one_saturation():
    economizer = {**ECONOMIZER["effects.economizer"], "pressure": "auto"}
    del economizer["temperature"]
    opened = make({**MACHINE, "effects.economizer": economizer}).effects["economizer"].parameters
    assert opened == make(AUTO).effects["economizer"].parameters and opened.pressure is None
    with pytest.raises(SceneError, match=r"economizer\.temperature: is given as well as pressure"):
        make({**MACHINE, "effects.economizer.pressure": "auto"})


def test_auto_is_kept_in_the_scene_and_told():
    scene = make(AUTO)
    assert "temperature: auto" in scene.text and screwsim.loads(scene.text).text == scene.text
    assert "temperature auto" in str(explain(scene)).replace("\n", " ")
    words = " ".join(parameters(scene, ["economizer"]).split())
    assert "range: > 0 K, or auto; here: auto" in words
    assert "is found (M370)" in " ".join(str(explain(make(OIL))).split())


@each_row(
    ("changes", "told"),
    [
        (
            {**AUTO, "effects.economizer.pressure": "4 bar"},
            r"effects\.economizer\.temperature: is given as well as pressure \(remove one of the two\)",
        ),
        (
            {**ECONOMIZER, "effects.economizer.temperature": "auto"},
            r"economizer\.temperature: auto needs the liquid of a condenser or gas cooler \(state a compressor's lines",
        ),
        (
            {**AUTO, "operation.subcooling": "60 K"},
            r"effects\.economizer: the liquid, -14 degC, is not warmer than the -13 degC to which it could be cooled",
        ),
        (
            {**MACHINE, "oil_supply.discharge_temperature": "315 K"},
            r"oil_supply\.ratio: is given as well as oil_supply\.discharge_temperature, which finds it \(remove one",
        ),
        (
            {**OIL, "effects.separator": DROP},
            r"oil_supply\.discharge_temperature: needs effects\.separator, where gas and oil have one temperature",
        ),
        (
            {**OIL, "oil_supply.temperature": DROP},
            r"oil_supply\.discharge_temperature: needs oil at a stated temperature \(write oil_supply\.temperature, or "
            r"effects\.separator\.cooler\.outlet_temperature: 50 degC\)",
        ),
        (
            {**OIL, "oil_supply.discharge_temperature": "290 K"},
            r"oil_supply\.discharge_temperature: 16\.85 degC is not above the oil's 19\.85 degC \(raise it, or cool",
        ),
        (
            {**AUTO, "sweep": {"effects.economizer.temperature": ["auto", "280 K"]}},
            r"sweep\.effects\.economizer\.temperature: lists auto, which is not a value \(write values, or a separate",
        ),
        (
            {**AUTO, "effects.economizer.superheat": "auto"},
            r"effects\.economizer\.superheat: 'auto' is not a temperature difference",
        ),
    ],
)
def test_what_cannot_be_found_is_refused(changes, told):
    with pytest.raises(SceneError, match=told):
        make(changes)


def metered(delivered):
    bore = f"effects={{own_effects.metered: {{delivered: {delivered!r}}}}}"
    return simulate(screwsim.load(POINT, [bore]), trace=False)


def test_an_effect_of_ones_own_may_leave_a_number_open_too():
    """The core knows such numbers by what an effect says of them, not by its name."""
    plain = float(simulate(screwsim.load(POINT), trace=False).performance.volumetric_efficiency)
    found = metered(0.9 * plain)
    assert (found.status, found.warnings) == ("ok", ())
    assert found.performance.volumetric_efficiency == pytest.approx(0.9 * plain, rel=ACCURACY)
    assert "the bore stands at its lowest" in metered(1.2 * plain).warnings
