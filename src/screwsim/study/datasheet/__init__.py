"""The data sheet of a scene, in the form that its trade uses: each kind has its modules, all one class of sheets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from screwsim.build import package_of
from screwsim.figures import declared
from screwsim.figures.engineering import shown_name
from screwsim.inputs.faults import UsageError
from screwsim.outputs import EFFICIENCY, Result
from screwsim.scene import Scene
from screwsim.study.datasheet.sheet import Sheet
from screwsim.study.progress import Progress

__all__ = ["Sheet", "sheet_of"]


FIGURES = ("gas_mass_flow", "cooling_capacity", "shaft_power", "electrical_power", "cop", "specific_power")


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
    Where the scene gives tolerances, or names the validation of its model, lines say what these make of its own point.
    """
    sheet = _sheet(scene, evaporating, condensing, limits, jobs, progress)
    return _with_uncertainty(scene, sheet) if scene.uncertain or scene.model_error else sheet


def _with_uncertainty(scene: Scene, sheet: Sheet) -> Sheet:
    """Return a sheet that says how sure the figures of the scene's own point are, each part by itself."""
    from screwsim.simulate import simulate
    from screwsim.study.uncertain import with_uncertainty

    result = with_uncertainty(scene, simulate(scene, trace=False))
    if result.status != "ok":
        return replace(sheet, lines=[*sheet.lines, ("uncertain", f"not known: {result.told}")])
    told, model = result.uncertainty, result.uncertainty.get("model", {})
    lines = [("uncertain", _by_inputs(result, told["figures"]))] if "figures" in told else []
    lines += [("model", _by_model(result, model))] if model else []
    return replace(sheet, lines=[*sheet.lines, *lines], document={**sheet.document, "uncertainty": told})


def _by_inputs(result: Result, figures: Mapping[str, Any]) -> str:
    parts = [
        f"{shown_name(name)} ± {100.0 * figures[name]['expanded'] / abs(result.performance[name]):.2g} %"
        for name in FIGURES
        if name in figures and result.performance[name]
    ]
    told = "at the scene's point, 95 %, by the tolerances of the inputs alone"
    return f"{', '.join(parts)} {told}" if parts else "nothing is said of these figures"


def _by_model(result: Result, model: Mapping[str, Any]) -> str:
    """Return the ends of the error of the model, of efficiencies in points and of others over their size."""
    parts = []
    for name, each in model["figures"].items():
        about, size = declared(name, result.performance), abs(result.performance[name])
        factor, unit = (100.0, "points") if about.scale == EFFICIENCY else (100.0 / size, "%")
        ends = " … ".join(f"{factor * each[end]:+.2g}" for end in ("low", "high"))
        parts.append(f"{shown_name(name)} {ends} {unit}")
    outside = f"; this scene is another: {'; '.join(model['outside'])}" if model["outside"] else ""
    return f"ours less measured, {', '.join(parts) or 'no figure of this scene'} by validate {model['of']}{outside}"


def _sheet(
    scene: Scene,
    evaporating: str | None,
    condensing: str | None,
    limits: Sequence[str],
    jobs: int | None,
    progress: Progress | None,
) -> Sheet:
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
