"""What figures of two stages together need: a motor in each scene, air, a condenser behind the second one."""

from collections.abc import Mapping

from screwsim.scene import Scene
from screwsim.scene.lines import condensate_enthalpy
from screwsim.study.asked.figures import figures_of
from screwsim.study.stages.axes import STAGE_NAMES

_MOTORS, _AIR, _CONDENSER = "motors", "air", "condenser"


def absences(first: Scene, second: Scene) -> dict[str, str]:
    """Return in words, by need, what both scenes do not have of what some figures of both together need."""
    found, scenes = {}, zip(STAGE_NAMES, (first, second), strict=True)
    still = [name for name, scene in scenes if "electrical_power" not in figures_of(scene)]
    if still:
        found[_MOTORS] = f"a motor in the {still[0]} scene" if len(still) == 1 else "a motor in both scenes"
    if not first.gas.is_air:
        found[_AIR] = "air for its gas"
    if condensate_enthalpy(second) is None:
        found[_CONDENSER] = "operation.condensing_temperature or gas_cooler in the second scene"
    return found


def lacked(name: str, absent: Mapping[str, str]) -> tuple[str, ...]:
    """Return what is absent of that which a figure of both together needs."""
    package = name.startswith(("package", "free_air"))
    needed = {
        _MOTORS: package or name.startswith("electrical"),
        _AIR: package,
        _CONDENSER: name.endswith(("capacity", "cop")),
    }
    return tuple(words for need, words in absent.items() if needed[need])
