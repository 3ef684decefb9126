"""The data sheet of a scene, in the form that its trade uses: each kind has its modules, all one class of sheets."""

from __future__ import annotations

from screwsim.build import package_of
from screwsim.faults import UsageError
from screwsim.scene import Scene
from screwsim.study.datasheet.sheet import Sheet

__all__ = ["Sheet", "sheet_of"]


def sheet_of(scene: Scene) -> Sheet:
    """Return the data sheet of a scene; raise UsageError, in one line, where none is known for its kind."""
    if package_of(scene) is not None:
        from screwsim.study.datasheet.air_rating import rating
        from screwsim.study.datasheet.air_sheet import air_sheet

        return air_sheet(scene, rating(scene))
    if scene.operation.condensing_temperature is not None:
        remedy = "screwsim run gives its point, screwsim map the coefficients of a sweep"
        raise UsageError(f"datasheet: knows air packages, and no sheet of a refrigeration machine yet ({remedy})")
    raise UsageError("datasheet: the scene is no air package (name effects.air_package)")
