"""Rules of gas and operation: one way to state the lines, what the fluid allows, and each fault with its remedy."""

import pytest

from screwsim.fluid import constants
from screwsim.inputs.faults import SceneError
from screwsim.scene import case, case_count, lines, loads

PRESSURES = "  suction:\n    pressure: 1.5 bar\n    temperature: 283 K\n  discharge:\n    pressure: 12 bar\n"
TEMPERATURES = """\
  evaporating_temperature: 2 degC
  condensing_temperature: 45 degC
  superheat: 10 K
"""


@pytest.fixture(scope="module")
def rated(example):
    """Return the text of the example with saturation temperatures in place of pressures."""
    assert PRESSURES in example
    return example.replace(PRESSURES, TEMPERATURES)


def faults_of(text, *overrides):
    with pytest.raises(SceneError) as error:
        loads(text, "x.yaml", overrides=overrides)
    return error.value.lines


def fault_of(text, *overrides):
    """Return the one fault, without its place."""
    (line,) = faults_of(text, *overrides)
    return line.removeprefix(f"--set {overrides[-1]}: ") if overrides else line


def test_temperatures_stand_for_the_pressures_of_saturation(rated):
    CP = pytest.importorskip("CoolProp.CoolProp")
    found = lines(loads(rated))
    assert found.p_s == pytest.approx(CP.PropsSI("P", "T", 275.15, "Q", 1, "R134a"), rel=1e-12)
    assert found.p_d == pytest.approx(CP.PropsSI("P", "T", 318.15, "Q", 0, "R134a"), rel=1e-12)
    assert found.T_s == 285.15


def test_a_pseudo_pure_fluid_evaporates_at_dew_and_condenses_at_bubble(rated):
    CP = pytest.importorskip("CoolProp.CoolProp")
    found = lines(loads(rated, overrides=["gas.fluid=R407C"]))
    assert found.p_s == pytest.approx(CP.PropsSI("P", "T", 275.15, "Q", 1, "R407C"), rel=1e-12)
    assert found.p_d == pytest.approx(CP.PropsSI("P", "T", 318.15, "Q", 0, "R407C"), rel=1e-12)


def test_pressures_stand_for_themselves(example):
    found = lines(loads(example))
    assert (found.p_s, found.T_s, found.p_d, found.quality) == (1.5e5, 283.0, 12e5, None)


def test_superheat_is_over_the_dew_point(example):
    found = lines(loads(example.replace("temperature: 283 K", "superheat: 5 K")))
    assert found.T_s == constants.saturation_temperature("R134a", 1.5e5) + 5.0


def test_units_of_temperature(rated):
    assert loads(rated).operation.evaporating_temperature == 275.15
    assert loads(rated.replace("2 degC", "275.15 K")).operation.evaporating_temperature == 275.15
    given = loads(rated, overrides=["operation.evaporating_temperature=-10 °C"])
    assert given.operation.evaporating_temperature == 263.15


def test_the_text_alone_gives_the_same_scene(rated):
    scene = loads(rated, overrides=["operation.subcooling=5 K", "operation.discharge.temperature=330 K"])
    assert loads(scene.text) == scene


def test_null_removes_what_a_base_states(example, scene_file):
    scene_file(example, "base.yaml")
    from screwsim.scene import load

    changed = f"base: base.yaml\noperation:\n  suction: null\n  discharge: null\n{TEMPERATURES}"
    assert load(scene_file(changed)).operation.suction.pressure is None


BESIDE = (
    "is given as well as operation.evaporating_temperature (state the lines by pressures or by saturation "
    "temperatures; remove one of the two; null drops a base's value)"
)


def test_both_ways_are_too_many(example):
    text = example.replace(PRESSURES, PRESSURES + TEMPERATURES)
    assert faults_of(text) == [
        f"x.yaml:22:15: operation.suction.pressure: {BESIDE}",
        f"x.yaml:23:18: operation.suction.temperature: {BESIDE}",
        f"x.yaml:25:15: operation.discharge.pressure: {BESIDE}",
    ]


def test_a_mixture_of_both_ways_is_refused(rated):
    text = rated.replace("  condensing_temperature: 45 degC\n", "  discharge: {pressure: 12 bar}\n")
    assert faults_of(text) == [f"x.yaml:22:25: operation.discharge.pressure: {BESIDE}"]


def test_neither_way_is_too_few(example):
    assert faults_of(example.replace(PRESSURES, "")) == [
        "x.yaml:19:1: operation: states neither suction nor discharge (write suction and discharge, or "
        "evaporating_temperature, condensing_temperature and superheat)"
    ]


@pytest.mark.parametrize(
    ("path", "what"),
    [
        (
            "evaporating_temperature",
            "is missing (write e.g. evaporating_temperature: 2 degC; the lines are stated by saturation temperatures)",
        ),
        (
            "condensing_temperature",
            "is missing (write e.g. condensing_temperature: 45 degC; the lines are stated by saturation temperatures)",
        ),
        ("superheat", "is missing (write e.g. superheat: 10 K; the state of the suction gas)"),
    ],
)
def test_temperatures_need_one_another(rated, path, what):
    assert fault_of(rated, f"operation.{path}=null") == f"operation.{path}: {what}"


@pytest.mark.parametrize("line", ["suction", "discharge"])
def test_pressures_need_one_another(example, line):
    path = f"operation.{line}.pressure"
    example_of = {"suction": "2 bar", "discharge": "12 bar"}[line]
    what = f"is missing (write e.g. pressure: {example_of}; the lines are stated by pressures)"
    assert fault_of(example, f"{path}=null") == f"{path}: {what}"


EVAPORATING = "the evaporating temperature 2 degC"


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        (
            ["operation.condensing_temperature=-5 degC"],
            f"operation.condensing_temperature: -5 degC is below {EVAPORATING} "
            "(raise it, or write machine.mode: expander)",
        ),
        (
            ["operation.condensing_temperature=2 degC"],
            "operation.condensing_temperature: 2 degC equals the evaporating temperature (choose another)",
        ),
        (
            ["machine.mode=expander", "operation.condensing_temperature=45 degC"],
            f"operation.condensing_temperature: 45 degC is above {EVAPORATING} "
            "(lower it, or write machine.mode: compressor)",
        ),
        (
            ["operation.condensing_temperature=120 degC"],
            "operation.condensing_temperature: 120 degC is not below the critical temperature of R134a, "
            "101.062 degC (lower it, or write operation.gas_cooler: {pressure: …, outlet_temperature: …} instead)",
        ),
        (
            ["operation.evaporating_temperature=-150 degC"],
            "operation.evaporating_temperature: -150 degC is below the triple point of R134a, -103.3 degC (raise it)",
        ),
        (
            ["operation.superheat=300 K"],
            "operation.superheat: makes suction gas of 302 degC; the equation of state of R134a ends at "
            "181.85 degC (choose a smaller one)",
        ),
        (
            ["operation.subcooling=200 K"],
            "operation.subcooling: makes liquid of -155 degC; R134a freezes at -103.3 degC (choose a smaller one)",
        ),
        (
            ["operation.superheat=5 degC"],
            "operation.superheat: '5 degC' is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        (
            ["gas.fluid=R407C", "gas.two_phase=equilibrium", "gas.model=real"],
            "--set gas.two_phase=equilibrium: gas.two_phase: R407C is a mixture described as if it were pure, "
            "although its two phases differ in composition; use two_phase: refuse, or a pure fluid, or the blend "
            "itself (such as R410A.mix)",
        ),
        (
            [
                "gas.fluid=R407C",
                "machine.mode=expander",
                "operation.evaporating_temperature=45 degC",
                "operation.condensing_temperature=44 degC",
            ],
            # colder, and yet at a higher pressure: the bubble point of a fluid with a glide
            "operation.condensing_temperature: gives 19.259 bar, which is above the suction pressure 17.535 bar "
            "(lower it, or write machine.mode: compressor)",
        ),
    ],
)
def test_temperatures_must_suit_fluid_and_machine(rated, overrides, line):
    assert fault_of(rated, *overrides) == line


def test_an_expander_condenses_below_its_evaporation(rated):
    changes = ["operation.evaporating_temperature=80 degC", "operation.condensing_temperature=30 degC"]
    dry = ["oil=null", "oil_supply=null", "effects=null"]
    found = lines(loads(rated, overrides=["machine.mode=expander", *dry, *changes]))
    assert found.p_d < found.p_s


# ---- superheat over a pressure without saturation, wet suction ----


@pytest.mark.parametrize(
    ("low", "high", "what"),
    [
        ("50 bar", "60 bar", "50 bar: its critical pressure is 40.5928 bar"),
        ("1 Pa", "2 bar", "1e-05 bar: its triple-point pressure is 0.00389564 bar"),
    ],
)
def test_superheat_needs_saturation_at_the_pressure(example, low, high, what):
    text = example.replace("temperature: 283 K", "superheat: 5 K").replace("1.5 bar", low).replace("12 bar", high)
    assert fault_of(text) == (
        f"x.yaml:23:16: operation.suction.superheat: R134a has no saturation at the suction pressure {what} "
        "(give operation.suction.temperature, or another pressure)"
    )


def test_wet_suction_needs_two_phases(rated, example):
    what = "needs gas.model: real and gas.two_phase: equilibrium (write both, or give a superheat)"
    wet = rated.replace("  superheat: 10 K\n", "  suction: {quality: 0.9}\n")
    assert fault_of(wet) == f"x.yaml:23:22: operation.suction.quality: {what}"
    assert fault_of(wet, "gas.model=real").endswith(what)
    wet = example.replace("temperature: 283 K", "quality: 0.9")
    assert fault_of(wet) == f"x.yaml:23:14: operation.suction.quality: {what}"


@pytest.mark.parametrize("value", ["1.2", "-0.1"])
def test_quality_is_a_fraction(example, value):
    assert fault_of(example.replace("temperature: 283 K", f"quality: {value}")) == (
        f"x.yaml:23:14: operation.suction.quality: {value} is out of range (it must be at least 0 and at most 1)"
    )


def test_wet_suction_is_at_saturation(rated):
    both = ["gas.model=real", "gas.two_phase=equilibrium"]
    found = lines(loads(rated.replace("superheat: 10 K", "suction: {quality: 0.9}"), overrides=both))
    assert (found.T_s, found.quality) == (275.15, 0.9)


def test_the_state_of_suction_is_stated_once(rated, example):
    both = ["gas.model=real", "gas.two_phase=equilibrium", "operation.suction.quality=0.9"]
    what = "operation.suction.quality: is given as well as"
    assert fault_of(rated, *both) == f"{what} operation.superheat (remove one of the two)"
    assert fault_of(example, *both) == f"{what} temperature (remove one of the two)"


# ---- gas ----


NAMED = "such as R134a, R1234yf, R32, R744, Ammonia or R454B)"
NO_FLUID = "is not a fluid or predefined blend of CoolProp"


@pytest.mark.parametrize(
    ("fluid", "what"),
    [
        ("r-134A", f"{NO_FLUID}; did you mean 'R134a'?"),
        ("r134A", f"{NO_FLUID}; did you mean 'R134a'?"),
        ("R 744", f"{NO_FLUID}; did you mean 'R744'?"),
        ("carbon dioxide", f"{NO_FLUID}; did you mean 'CarbonDioxide'?"),
        ("R1234ze", f"{NO_FLUID}; did you mean 'R1234ze(E)' or 'R1234ze(Z)'?"),  # which both exist
        ("R134z", f"{NO_FLUID} (name one of them, {NAMED}"),  # R134a is another fluid
        ("R134", f"{NO_FLUID} (name one of them, {NAMED}"),  # and so is its isomer
        ("Propan", f"{NO_FLUID} (name one of them, {NAMED}"),
        ("qqqqqqqq", f"{NO_FLUID} (name one of them, {NAMED}"),
        ("r-454b", f"{NO_FLUID}; did you mean 'R454B'?"),
        ("r407c.mix", f"{NO_FLUID}; did you mean 'R407C.mix'?"),
        (
            "R499B",
            f"{NO_FLUID}; R4xx and R5xx are blends, and CoolProp has none of this number "
            "(write its components as fluid: [NAME, NAME], with mass_fractions)",
        ),
        (
            "R32&R125",
            f"{NO_FLUID}; write a blend of your own as fluid: [NAME, NAME], with mass_fractions or mole_fractions",
        ),
    ],
)
def test_for_an_unknown_fluid_no_other_fluid_is_offered(example, fluid, what):
    (line,) = faults_of(example.replace("fluid: R134a", f"fluid: {fluid}"))
    assert line == f"x.yaml:12:10: gas.fluid: '{fluid}' {what}"


@pytest.mark.parametrize("fluid", ["R744", "CO2", "R1234yf", "R410A"])
def test_any_name_of_a_fluid_is_known(example, fluid):
    assert loads(example.replace("fluid: R134a", f"fluid: {fluid}")).gas.fluid == fluid


def test_what_belongs_to_one_gas_model_is_refused_with_the_other(example):
    assert fault_of(example, "gas.two_phase=equilibrium") == (
        "gas.two_phase: equilibrium needs model: real (write that, or remove two_phase)"
    )
    assert fault_of(example, "gas.model=real", "gas.isentropic_exponent=1.1") == (
        "gas.isentropic_exponent: applies only to model: ideal (remove it, or write model: ideal)"
    )
    assert loads(example, overrides=["gas.two_phase=refuse"]).gas.model == "ideal"


# ---- sweeps ----


def test_a_sweep_over_condensing_temperature_gives_its_pressures(rated):
    axis = "sweep.operation.condensing_temperature={from: 30 degC, to: 50 degC, count: 3}"
    scene = loads(rated, overrides=[axis])
    assert scene.sweep["operation.condensing_temperature"] == pytest.approx((303.15, 313.15, 323.15), rel=1e-15)
    found = [lines(case(scene, index)) for index in range(case_count(scene))]
    assert len({line.p_s for line in found}) == 1
    assert found[0].p_d < found[1].p_d < found[2].p_d


@pytest.mark.parametrize(
    ("path", "values", "counterpart"),
    [
        ("suction.pressure", "[2 bar, 3 bar]", "evaporating_temperature"),
        ("suction.temperature", "[280 K, 290 K]", "superheat"),
        ("discharge.pressure", "[10 bar, 12 bar]", "condensing_temperature"),
    ],
)
def test_a_sweep_over_pressures_has_no_meaning_beside_temperatures(rated, path, values, counterpart):
    assert fault_of(rated, f"sweep.operation.{path}={values}") == (
        f"sweep.operation.{path}: has no meaning where the scene states saturation temperatures "
        f"(vary operation.{counterpart}, or restate the lines)"
    )


def test_a_sweep_over_temperatures_has_no_meaning_beside_pressures(example):
    assert fault_of(example, "sweep.operation.evaporating_temperature=[2 degC]") == (
        "sweep.operation.evaporating_temperature: has no meaning where the scene states pressures "
        "(vary operation.suction.pressure, or restate the lines)"
    )
    assert fault_of(example, "sweep.operation.subcooling=[2 K]") == (
        "sweep.operation.subcooling: has no meaning where the scene states pressures "
        "(remove this axis, or restate the lines)"
    )


def test_what_both_ways_have_is_swept_in_either(rated):
    scene = loads(rated, overrides=["sweep.operation.discharge.temperature=[320 K, 330 K]"])
    assert case(scene, 1).operation.discharge.temperature == 330.0


@pytest.mark.parametrize("T", ["1 K", "10 K", "30 K"])
def test_an_exponent_is_found_only_where_the_heat_capacity_is_known(example, T):
    at = f"operation.suction.temperature={T}"
    remedy = "(raise it, or state gas.isentropic_exponent)"
    for fluid in ("R134a", "Air") if T != "30 K" else ("R134a",):
        what = f"operation.suction.temperature: CoolProp's heat capacity of {fluid} as an ideal gas does not reach {T}"
        assert f"{what} {remedy}" in faults_of(example, f"gas.fluid={fluid}", at)[0]
    assert loads(example, overrides=["gas.isentropic_exponent=1.1", at]).gas.isentropic_exponent == 1.1


def test_every_gas_has_at_least_the_heat_capacity_of_atoms():
    assert constants.has_ideal_heat_capacity("Helium", 3.0) and constants.has_ideal_heat_capacity("CO2", 200.0)
    assert not constants.has_ideal_heat_capacity("R134a", 5.0)  # k would be -0.7
    assert not constants.has_ideal_heat_capacity("Air", 5.0)  # CoolProp raises ValueError
