"""What parts of effects can ask of the scene around them."""

from screwsim.effects.base import Around, Site
from screwsim.fluid.gas import Gas
from screwsim.scene.lines import Lines, lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import Scene


def around_of(scene: Scene, at: Lines) -> Around:
    """Return what effects can ask of the scene."""
    oil, supply = scene.oil, scene.oil_supply
    T_oil = supply.temperature if supply is not None else None
    tip_speed = scene.machine.surface_speed(scene.operation.speed)
    known = oil.at(T_oil) if oil is not None and T_oil is not None else None
    return Around(scene.gas.name, at.p_s, at.T_s, at.p_d, tip_speed, T_oil, known)


def build_site(scene: Scene, gas: Gas) -> Site:
    """Return what the state of an effect's own plenum can be made of."""
    at, effect = lines(scene), refrigerating_effect(scene)
    liquid = None if effect is None else suction_enthalpy(scene) - effect
    around = around_of(scene, at)
    return Site(gas, scene.gas.name, at.p_s, at.T_s, at.p_d, liquid, effect, around.T_oil, around.oil)
