"""The fluid of a results file's scene."""

from ruamel.yaml import YAML

from screwsim.fluid.settings import GasSettings
from screwsim.results.read import STAGES, Results


def fluid_name(results: Results) -> str:
    """Return the fluid of a file's scene, a blend of one's own with its fractions; of two stages that of both."""
    alone = results.stages.get(STAGES[0], results)
    gas = YAML(typ="safe", pure=True).load(alone.scene_yaml)["gas"]
    return GasSettings(**{key: gas.get(key) for key in ("fluid", "mass_fractions", "mole_fractions")}).name
