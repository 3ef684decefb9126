"""Transport properties of dilute gas mixtures (M318)."""

import pytest

from screwsim.fluid import transport
from screwsim.fluid.transport import mixed, weights
from screwsim.inputs.faults import UsageError

AIR = "Nitrogen/Oxygen/Argon (mole 0.7812/0.2096/0.0092)"


def test_methane_with_butane_has_the_viscosity_that_was_measured():
    """B. E. Poling et al., The Properties of Gases and Liquids, 2001, example 9-5: 93.35 uP at 293 K."""
    viscosities, x = (109.4e-7, 72.74e-7), (0.697, 0.303)
    found = mixed(x, viscosities, weights(viscosities, (16.043e-3, 58.123e-3)))
    assert found == pytest.approx(92.26e-7, rel=1e-3)  # Wilke's rule there
    assert found == pytest.approx(93.35e-7, rel=0.02)


def test_a_mixture_of_one_gas_with_itself_is_that_gas():
    phi = weights((1.3e-5, 1.3e-5), (0.03, 0.03))
    assert mixed((0.4, 0.6), (1.3e-5, 1.3e-5), phi) == pytest.approx(1.3e-5, rel=1e-15)


def test_weights_obey_the_symmetry_of_wilkes_rule():
    (_, phi_12), (phi_21, _) = weights((1.1e-5, 2.3e-5), (0.016, 0.044))
    assert phi_21 == pytest.approx(phi_12 * 2.3e-5 / 1.1e-5 * 0.016 / 0.044, rel=1e-14)


def test_air_of_its_components_conducts_and_rubs_as_air():
    ours, air = transport.transport(AIR, 1e5, 330.0), transport.transport("Air", 1e5, 330.0)
    assert ours == pytest.approx(air, rel=0.02)


@pytest.mark.parametrize(
    ("fluid", "bounds"),  # of conductivity, viscosity and Prandtl number, as stated with M318
    [
        ("R404A", ((0.085, 0.165), (-0.03, -0.02), (-0.165, -0.10))),
        ("R410A", ((0.045, 0.10), (0.02, 0.045), (-0.065, -0.005))),
    ],
)
@pytest.mark.parametrize("T", [300.0, 350.0, 400.0])
def test_refrigerants_differ_from_coolprops_fits_of_them_as_much_as_the_documentation_says(fluid, bounds, T):
    ours, fitted = transport.transport(f"{fluid}.mix", 1e4, T), transport.transport(fluid, 1e4, T)
    for mixed_value, value, (low, high) in zip(ours, fitted, bounds, strict=True):
        assert low < mixed_value / value - 1.0 < high


@pytest.mark.parametrize(("fluid", "conductivity", "prandtl"), [("R134a", 0.13, 0.35), ("Propane", 0.10, 0.22)])
def test_pressure_that_the_mixing_leaves_out_has_the_effect_that_is_stated(fluid, conductivity, prandtl):
    dilute, dense = transport.transport(fluid, 1e3, 350.0), transport.transport(fluid, 20e5, 350.0)
    assert dense[0] / dilute[0] - 1.0 == pytest.approx(conductivity, abs=0.006)
    assert dense[2] / dilute[2] - 1.0 == pytest.approx(prandtl, abs=0.006)


def test_the_viscosity_alone_needs_no_conductivity_of_a_component():
    fluid = "Methane/H2S (mole 0.97/0.03)"
    assert transport.viscosity(fluid, 1e5, 330.0) == pytest.approx(transport.viscosity("Methane", 1e3, 330.0), rel=0.02)
    with pytest.raises(UsageError, match="CoolProp has no conductivity of HydrogenSulfide, a component of Methane/H2S"):
        transport.transport(fluid, 1e5, 330.0)
