"""How a scene states a blend, what it writes back, and what it says of a blend that cannot be."""

import re
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from screwsim.fluid.composition import is_blend, predefined
from screwsim.fluid.settings import GasSettings
from screwsim.inputs.faults import SceneError
from screwsim.scene import load, loads
from screwsim.scene.fluids import fluid_faults

CONFIG = Path(__file__).parents[2] / "configs" / "r454b" / "point.yaml"
OWN = "gas.fluid=[R32, R1234yf]"
REFRIGERANTS = sorted({*predefined(), "R134a", "R1234yf", "R1234ze(E)", "R32", "R744", "R717", "R290", "R245fa", "Air"})
PRESSURES = [
    *(
        f"operation.{key}=null"
        for key in ("evaporating_temperature", "condensing_temperature", "superheat", "subcooling")
    ),
    "operation.suction.pressure=4 bar",
    "operation.discharge.pressure=12 bar",
]
LETTERS = "0123456789aAbBcCyYzZfE(). "
NO_FLUID = "is not a fluid or predefined blend of CoolProp"


def fault_of(*overrides):
    """Return the one fault of the shipped scene with these overrides, without what gave it."""
    with pytest.raises(SceneError) as caught:
        load(CONFIG, overrides=overrides)
    (line,) = str(caught.value).splitlines()
    return line[line.index(": gas.") + 2 :] if ": gas." in line else line[line.index(": effects.") + 2 :]


def test_a_blend_of_ones_own_reads_and_writes():
    scene = load(CONFIG, overrides=[OWN, "gas.mass_fractions=[0.689, 0.311]"])
    assert scene.gas.fluid == ("R32", "R1234yf") and scene.gas.mass_fractions == (0.689, 0.311)
    assert scene.gas.name == "R32/R1234yf (0.689/0.311)"
    assert 'fluid: ["R32", "R1234yf"]' in scene.text and "mass_fractions: [0.689, 0.311]" in scene.text
    assert loads(scene.text).gas == scene.gas


def test_a_blend_by_mole_is_another():
    scene = load(CONFIG, overrides=[OWN, "gas.mole_fractions=[0.8, 0.2]"])
    assert scene.gas.name == "R32/R1234yf (mole 0.8/0.2)"


@pytest.mark.parametrize(
    ("overrides", "what"),
    [
        ((OWN,), "gas.mass_fractions: is missing (write one number for each of R32, R1234yf)"),
        (
            (OWN, "gas.mass_fractions=[0.689, 0.211]"),
            "gas.mass_fractions: add up to 0.9, not to 1 (if they are ratios, write [0.765556, 0.234444])",
        ),
        (
            (OWN, "gas.mass_fractions=[0.5, 0.3, 0.2]"),
            "gas.mass_fractions: has 3 numbers for 2 components (write one for each of R32, R1234yf)",
        ),
        ((OWN, "gas.mass_fractions=0.5"), "gas.mass_fractions: 0.5 is not a list of numbers (write e.g. [0.6, 0.4])"),
        (
            (OWN, "gas.mass_fractions=[0.7, 0.3]", "gas.mole_fractions=[0.8, 0.2]"),
            "gas.mole_fractions: is given as well as mass_fractions (remove one of the two)",
        ),
        (
            ("gas.mass_fractions=[0.7, 0.3]",),
            "gas.mass_fractions: applies only to the components of a blend of your own (write fluid: [NAME, NAME], or "
            "remove it; null drops a base's value)",
        ),
        (
            ("gas.fluid=[R32, R9999]", "gas.mass_fractions=[0.7, 0.3]"),
            f"gas.fluid: component 'R9999' {NO_FLUID} (name one of them, such as R134a, R1234yf, R32, R744 or Ammonia)",
        ),
        (
            ("gas.fluid=[R32, R410A]", "gas.mass_fractions=[0.7, 0.3]"),
            "gas.fluid: component 'R410A' is a mixture described as if it were pure (list its components)",
        ),
        (
            ("gas.fluid=[R32, R32]", "gas.mass_fractions=[0.7, 0.3]"),
            "gas.fluid: component 'R32' is listed twice (remove one)",
        ),
        (
            ("gas.fluid=R32/R125 (1/0)",),
            "gas.fluid: 'R32/R125 (1/0)': has a share of 0 for R125 (leave that component out)",
        ),
        (
            ("gas.fluid=[R22, R124]", "gas.mole_fractions=[0.5, 0.5]"),
            "gas.fluid: R22/R124 (mole 0.5/0.5): CoolProp has no data of the pair R124 and R22; choose another blend, "
            "such as R454B, R513A or R448A, or a pure fluid",
        ),
        (
            ("gas.fluid=R401A",),
            "gas.fluid: R401A: CoolProp has no data of the pair R124 and R22; choose another blend, such as R454B, "
            "R513A or R448A, or a pure fluid",
        ),
        (("gas.fluid=R454D",), None),
        (
            ("gas.fluid=[CarbonDioxide, n-Butane]", "gas.mole_fractions=[0.5, 0.5]", "gas.two_phase=equilibrium"),
            "gas.two_phase: CarbonDioxide/n-Butane (mole 0.5/0.5): no equilibrium of its two phases is found (write "
            "refuse, or another blend, such as R454B, R513A or R448A)",
        ),
        (
            ("effects.refrigerant_solubility={}",),
            "effects.refrigerant_solubility: covers R134a in POE oil only, not R454B (state points_file, with measured "
            "points of R454B, or remove the effect)",
        ),
        (
            ("effects.economizer={area: 2 cm^2, opens: 1 rad, closes: 2 rad, temperature: 288 K, kind: flash_tank}",),
            "effects.economizer.kind: the vapour that boils off R454B, a blend, has a different composition from the "
            "blend (write kind: heat_exchanger, or name a pure fluid)",
        ),
        (
            (
                "gas.fluid=R407C",
                "effects.economizer={area: 2 cm^2, opens: 1 rad, closes: 2 rad, temperature: 288 K, kind: flash_tank}",
            ),
            "effects.economizer.kind: the vapour that boils off R407C, a blend, has a different composition from the "
            "blend (write kind: heat_exchanger, or name a pure fluid)",
        ),
    ],
)
def test_what_is_wrong_with_a_blend_is_one_line(overrides, what):
    found = fault_of(*overrides)
    if what is None:  # no other blend is offered for it
        assert "did you mean" not in found and "R5xx are blends" in found
    else:
        assert found == what


def test_no_other_refrigerant_is_offered_for_a_name():
    for name in ("R454Z", "R134", "R1234zf", "R45B", "R404", "R32A", "R454", "R513", "R1234y", "R744A", "R407"):
        assert "did you mean" not in fault_of(f"gas.fluid={name}")
    assert fault_of("gas.fluid=r454b") == f"gas.fluid: 'r454b' {NO_FLUID}; did you mean 'R454B'?"


@given(st.sampled_from(REFRIGERANTS), st.integers(0, 2), st.integers(0, 20), st.sampled_from(LETTERS))
def test_whatever_is_written_another_refrigerant_is_never_offered(fluid, edit, place, letter):
    """A name with a letter or a digit left out, changed or added is another refrigerant, or none: it is not mended."""
    at = place % len(fluid)
    written = fluid[:at] + letter * (edit != 0) + fluid[at + (edit != 2) :]
    assume(not is_blend(written))
    for fault in fluid_faults(GasSettings(fluid=written, model="real")):
        offered = re.findall(r"did you mean '(.+?)'", fault.what)
        assert all(_bare(name) == _bare(written) for name in offered)


def _bare(name):
    return re.sub(r"[^0-9a-z]", "", name.lower())


@pytest.mark.parametrize(
    ("path", "overrides"),
    [
        ("operation.suction.superheat", [*PRESSURES, "operation.suction.superheat=5 K"]),
        ("operation.evaporating_temperature", []),
        ("operation.condensing_temperature", []),
    ],
)
def test_a_line_of_a_blend_known_as_a_gas_only_is_stated_by_pressure_and_temperature(path, overrides):
    gas = ["gas.fluid=[Methane, Ethane, CO2]", "gas.mass_fractions=null", "gas.mole_fractions=[0.93, 0.05, 0.02]"]
    with pytest.raises(SceneError) as caught:
        load(CONFIG, overrides=[*gas, *overrides])
    (line,) = (each for each in str(caught.value).splitlines() if f": {path}: " in each)
    assert "has no known saturation: it is known as a gas only, from -56.558 degC on" in line
    assert line.endswith("(state pressures and operation.suction.temperature)")
    load(CONFIG, overrides=[*gas, *PRESSURES, "operation.suction.temperature=20 degC"])
