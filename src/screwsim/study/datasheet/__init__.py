"""The data sheet of a scene, in the form that its trade uses: each kind has its modules, all one class of sheets."""

from __future__ import annotations

from collections.abc import Sequence

from screwsim.build import package_of
from screwsim.faults import UsageError
from screwsim.scene import Scene
from screwsim.study.datasheet.sheet import Sheet
from screwsim.study.progress import Progress

__all__ = ["Sheet", "sheet_of"]


def sheet_of(
    scene: Scene,
    *,
    evaporating: str | None = None,
    condensing: str | None = None,
    limits: Sequence[str] = (),
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Sheet:
    """Return the data sheet of a scene; raise UsageError, in one line, where none is known for its kind.

    Of a refrigeration machine `evaporating` and `condensing` are ranges ('-10 degC..10 degC') in place of those of the
    scene's sweep, `limits` what is to hold ('discharge_temperature<110 degC'); a package of air has neither.
    """
    operation = scene.operation
    if package_of(scene) is not None and scene.gas.name.lower() == "air":
        from screwsim.study.datasheet.air_rating import rating
        from screwsim.study.datasheet.air_sheet import air_sheet

        given = {"--evaporating": evaporating, "--condensing": condensing, "--limit": tuple(limits) or None}
        wrong = next((option for option, value in given.items() if value is not None), None)
        if wrong is not None:
            what = "belongs to a refrigeration machine, and the scene is an air package"
            raise UsageError(f"{wrong}: {what} (remove it)")
        return air_sheet(scene, rating(scene))
    states_lines = operation.condensing_temperature is not None or operation.gas_cooler is not None
    if states_lines and scene.machine.mode == "compressor":
        from screwsim.study.datasheet import refrigeration
        from screwsim.study.datasheet.bounds import limits_of
        from screwsim.study.datasheet.refrigeration_sheet import refrigeration_sheet

        asked = refrigeration.asked_of(scene, evaporating, condensing, limits_of(scene, limits))
        return refrigeration_sheet(refrigeration.rating(asked, jobs, progress))
    raise UsageError(
        "datasheet: the scene is neither an air package (name effects.air_package) nor a refrigeration compressor "
        "(state its lines by operation.evaporating_temperature and condensing_temperature)"
    )
