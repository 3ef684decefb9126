"""Effects say what they are to the core: roles that are true, and what scenes of a machine usually name."""

from dataclasses import fields, replace

import pytest
from each_row import each_row
from folders import CONFIGS, ROOT

from screwsim.build import build_parts
from screwsim.effects import catalogue, having, stating
from screwsim.effects.base import CoolsOil, FlowPath, LosesPressure
from screwsim.effects.parts.usual import LEAK, OIL_ROOM, PUMPS, SLIDES, SUCTION_BACK, USUAL, WAY_IN, WAY_OUT
from screwsim.figures import called_for, known, needs_of
from screwsim.machine.kinds import MACHINES
from screwsim.outputs import AFTERCOOLED, CHANGED, HEATED, HELD, PERFORMANCE, WALLED
from screwsim.scene import load
from screwsim.study.validation import sibling

each = sibling(ROOT / "docs" / "tools" / "each_effect.py")
PISTON = CONFIGS / "slider_crank" / "r134a.yaml"
HUMID = CONFIGS / "air" / "humid_package.yaml"
OF_FIGURES = (CHANGED[0], WALLED[0], HELD[0], AFTERCOOLED[1])  # heated are more than say so: whoever has T_oil
OF_CORE = {WAY_IN, WAY_OUT, SUCTION_BACK, OIL_ROOM, PUMPS, SLIDES}  # which texts and names of the core ask for
KEYS = {  # with which an effect has a role that it has by a key
    ("refrigerant_solubility", HELD[0]): ("effects.refrigerant_solubility.flash_time=5 ms",),
}
WITH_ROLES = [(name, role) for name, effect in catalogue().items() for role in effect.roles if role in OF_FIGURES]


def scene_with(name, role):
    """Return a scene in which an effect has a role, and none without it."""
    if name == "air_package":
        return load(HUMID)
    if name == "cylinder_heat":
        return load(PISTON)
    return each.with_it(name, KEYS.get((name, role), ()))


def called(scene):
    return called_for(scene, build_parts(scene))


@each_row(("name", "role"), WITH_ROLES)
def test_an_effect_with_a_role_calls_for_the_figures_of_it_and_the_scene_without_it_does_not(name, role):
    scene = scene_with(name, role)
    figures = {figure.name for figure in PERFORMANCE.values() if role in figure.needs}
    assert figures and figures <= set(called(scene))
    others = {other: active for other, active in scene.effects.items() if role not in active.effect.roles}
    assert not figures & set(called(replace(scene, effects=others)))


def test_every_role_that_an_effect_has_is_one_that_somebody_asks_for():
    asked = {need for figure in known().values() for need in figure.needs} | OF_CORE
    for name, effect in catalogue().items():
        assert set(effect.roles) <= asked, name
        for key in filter(None, effect.roles.values()):
            assert key.removeprefix(".") in {item.name for item in fields(effect.parameters)}, f"{name}{key}"
    assert all(having(role) for role in (*OF_FIGURES, HEATED[0], *OF_CORE))


@pytest.mark.parametrize(("role", "line"), [(WAY_IN, "suction"), (WAY_OUT, "discharge")])
def test_an_effect_that_opens_a_way_leads_to_its_line(role, line):
    for name in (name for name, effect in catalogue().items() if role in effect.roles):
        kind = "twin_screw" if catalogue()[name].fits(MACHINES["twin_screw"]) else "slider_crank"
        scene = load(CONFIGS / "paper" / "point.yaml") if kind == "twin_screw" else load(PISTON)
        if name in scene.effects:
            paths = [path for path in build_parts(scene).effects[name] if isinstance(path, FlowPath)]
            assert line in {path.to for path in paths}, name


def test_a_figure_tells_which_effects_call_for_it():
    told = "an effect with a SuctionChange, such as effects.bypass.share or effects.suction_line or "
    told += "effects.suction_throttle"
    assert needs_of("intake_pressure") == f"{told} or effects.air_package.inlet_filter"


def test_one_effect_cools_the_oil_and_one_puts_a_package_around_the_machine():
    assert stating(CoolsOil) == "separator" and stating(LosesPressure) == "air_package"


@pytest.mark.parametrize("kind", MACHINES)
def test_what_scenes_usually_name_fits_their_machine(kind):
    machine, found = MACHINES[kind], set()
    for name, effect in catalogue().items():
        for offer, what in effect.usual.items():
            assert what in (LEAK, *USUAL), name
            if offer in machine.offers:
                assert effect.fits(machine), f"a {kind} cannot have {name}"
                assert effect.needs_oil <= what.oiled, name
                found.add(what)
    assert LEAK in found
