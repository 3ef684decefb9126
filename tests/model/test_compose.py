"""Composition: what a scene does not name leaves no trace; every kernel's text counts in the module's name."""

import numpy as np
import pytest
from each_row import each_row
from scenes import DROP, make

from screwsim.build import build_parts
from screwsim.codegen.modules import module_name
from screwsim.effects import base, tip_leakage
from screwsim.fluid import nozzle
from screwsim.model import compose as composing
from screwsim.model.compose import compose
from screwsim.model.network import network
from screwsim.numerics import rodas
from screwsim.numerics.kernel import kernel

LEAKS = ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage")


def composition(**changes):
    return compose(build_parts(make({name.replace("__", "."): value for name, value in changes.items()})))


@pytest.mark.parametrize("name", [*LEAKS, "suction_port", "discharge_port", "oil_heat"])
def test_an_effect_that_is_not_named_is_not_in_the_text(name):
    without = composition(**{f"effects__{name}": DROP})
    kernel_name = f"paper_law__{name.removesuffix('_port')}_area" if name.endswith("_port") else f"{name}__"
    assert kernel_name in composition().text
    assert kernel_name not in without.text


def test_without_oil_heat_there_is_no_oil_temperature():
    assert composition(effects__oil_heat=DROP).states == ("T", "rho")


@pytest.mark.parametrize(
    ("transport", "states"), [("paper", ("T", "rho", "T_oil")), ("carried", ("T", "rho", "T_oil", "x_oil"))]
)
def test_states_are_those_of_the_transport(transport, states):
    assert composition(oil__transport=transport).states == states


def test_without_leaks_no_neighbour_is_read():
    found = composition(**{f"effects__{name}": DROP for name in LEAKS})
    assert "\nN_FILMS = 0\n" in found.text and "read_neighbour" not in found.text.split("def chamber__surroundings")[1]
    assert found.gaps == ()
    assert found.n_E == 4 + 2  # own angle terms and two ports


def test_without_leaks_no_neighbours_breakpoint_cuts_the_steps():
    breakpoints = composition(**{f"effects__{name}": DROP for name in LEAKS}).breakpoints
    own = [0, 60, 300, 360, 600, 640, 660, 680, 720]  # φ_A, φ_B, φ_C and their mirrors (φ_B has 60 and 300 too)
    assert all(np.min(np.abs(np.degrees(at) - own)) < 1e-6 for at in breakpoints)


def test_losses_alone_leave_the_text_as_it_is():
    """Pump, hydromechanical and mechanical losses are figures of the closed cycle: no compiling for them."""
    gone = {f"effects__{name}": DROP for name in ("oil_pump", "hydromechanical", "mechanical")}
    assert composition(**gone).text == composition().text


@each_row(
    "changes",
    [
        {"operation__speed": "1234 rpm"},
        {"machine__volume": {"law": "paper", "max": "500 cm^3", "phi_A": "70 deg"}},
        {"effects__tip_leakage": {"gap": "10 um", "reading": "interface"}},
        {"oil_supply__ratio": 5},
        {"gas__isentropic_exponent": 1.3},
        {"numerics": {"accuracy": 1e-5}},
    ],
)
def test_numbers_are_not_in_the_text(changes):
    assert composition(**changes).text == composition().text


def test_structure_is_in_the_text():
    assert composition(machine__male_lobes=5).text != composition().text


def test_both_forms_of_equation_12_have_their_own_text():
    heat = {"droplet_radius": "100 um", "heat_transfer_coefficient": "500 W/(m^2 K)", "equation_12": "printed"}
    assert composition(effects__oil_heat=heat).text != composition().text


def forget():
    """Let texts be written anew."""
    composing.structure_of.cache_clear()
    composing.module_text.cache_clear()


@pytest.mark.parametrize("edited", [nozzle.flow, tip_leakage.all_tips, rodas.attempt], ids=lambda item: item.flat_name)
def test_an_edit_in_any_file_makes_another_module(edited, monkeypatch):
    """No stale compiled code: the module's name is the hash of all text, other files' included."""
    forget()
    before = composition().text
    monkeypatch.setattr(edited, "source", edited.source.replace('"""', '"""Edited. ', 1))
    forget()
    after = composition().text
    forget()
    assert module_name(after, "model") != module_name(before, "model")


def test_the_same_scene_has_the_same_text():
    before = composition().text
    forget()
    assert composition().text == before


def test_a_kernel_that_asks_for_an_unknown_name_is_told_what_is_known():
    from dataclasses import replace

    from screwsim.effects.base import FlowPath

    @kernel
    def odd(phi, nonsense):
        return phi * nonsense

    parts = build_parts(make())
    path = FlowPath(to="neighbour", area=odd, values={}, offset=1)
    with pytest.raises(TypeError, match=r"nothing is called 'nonsense'; known here: .*omega"):
        compose(replace(parts, effects={**parts.effects, "odd": [path]}))


def test_breakpoints_are_sorted_and_inside_the_life():
    breakpoints = composition().breakpoints
    assert breakpoints[0] == 0.0 and np.all(np.diff(breakpoints) > 0.0)
    assert breakpoints[-1] == pytest.approx(4 * np.pi, rel=1e-15)


def test_oil_is_injected_at_a_breakpoint():
    assert np.min(np.abs(composition().breakpoints - 2 * np.pi)) == 0.0  # bit for bit: the jump is looked for there


def test_texts_and_effects_call_the_lines_alike():
    """Texts are written by code that knows no effects: what it is made of is all in the digest by which it is kept."""
    assert network.SYMBOLS == base.LINES


@pytest.mark.parametrize("opens", ["359.999999 deg", "360 deg", "360.000001 deg"])
def test_a_step_ends_where_the_oil_comes_whatever_opens_beside_it(opens):
    """Angles closer together than a step are one, and it is that of the injection, which would not be met otherwise."""
    bore = {"source": "chamber", "opens": opens, "passage": "60 deg", "area": "1 mm^2"}
    found = composition(effects__bypass=bore)
    assert np.abs(found.breakpoints - 2.0 * np.pi).min() < 1e-9
    assert np.diff(found.breakpoints).min() > 1e-7
