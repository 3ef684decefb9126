"""The gas that a scene names."""

from screwsim.fluid.gas import Gas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.models import Asked, find_gas_model, lacking
from screwsim.fluid.moist_air import moist_air
from screwsim.fluid.real_gas import RealGas
from screwsim.scene.lines import lines
from screwsim.scene.types import Scene


def build_gas(scene: Scene) -> Gas:
    """Return the gas of a scene."""
    dry, humidity = _dry_gas(scene), scene.gas.relative_humidity
    if humidity is None:
        return dry
    assert isinstance(dry, IdealGas | RealGas)  # `scene.humidity` refuses others
    at = lines(scene)
    return moist_air(dry, at.p_s, at.T_s, humidity)


def asked_of(scene: Scene) -> Asked:
    """Return what a scene says of its gas."""
    said = scene.gas
    return Asked(said.name, said.isentropic_exponent, said.two_phase, lambda: lines(scene).T_s)


def _dry_gas(scene: Scene) -> Gas:
    said = scene.gas
    gas = find_gas_model(said.model).make(asked_of(scene))
    missing = lacking(gas) if "." in said.model else []
    if missing:
        raise TypeError(f"its gas has no {', '.join(missing)}")
    return gas
