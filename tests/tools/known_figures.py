"""Stored figures of much more accurate solutions, and of other integrators (`known`)."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from known import known
from true_error import reference

from screwsim.figures.errors import relative_errors
from screwsim.outputs import Figures
from screwsim.scene import Scene, scene_text
from screwsim.simulate import simulate

ANEW = 0.1  # of the wanted accuracy: allowed change of a reference that is computed again


def known_reference(scene: Scene, radau: float | None = None) -> tuple[str, Figures]:
    """Return status and figures of a scene's reference, stored or computed; arguments are those of `reference`."""

    def find() -> dict[str, object]:
        status, figures = reference(scene, radau)
        return {"status": status, **figures}

    what, within = "coupled" if radau is None else f"Radau, {radau:g}", ANEW * scene.numerics.accuracy
    figures = known("true_figures", what, scene_text(scene), find, within)
    return figures["status"], Figures({name: value for name, value in figures.items() if name != "status"})


def known_solution(scene: Scene) -> SimpleNamespace:
    """Return an object with the `performance` of a scene by its own integrator and accuracy, stored or computed.

    It is a reference for others: scipy's Radau, or a solution far more accurate than theirs. Computed again it may
    differ by its own accuracy: other processors give other last bits, and so other steps.
    """
    asked = scene.numerics

    def find() -> dict[str, object]:
        found = simulate(scene, trace=False)
        assert (found.status, found.numerics.integrator) == ("ok", asked.integrator), found.message
        return {name: float(value) for name, value in found.performance.items() if value is not None}

    subject = "radau" if asked.integrator == "scipy-radau" else "true_figures"
    what = f"{asked.integrator}, {asked.accuracy:g}"
    return SimpleNamespace(performance=Figures(known(subject, what, scene_text(scene), find, asked.accuracy)))


def known_finer(scene: Scene, within: float, only: tuple[str, ...] = ()) -> Figures:
    """Return the figures of a scene, or some only, stored or computed: it is a much more accurate one than another.

    Computed again they may differ by `within`, as errors of figures are counted: those of machines that deliver little
    vary with the last bits of a processor by more than of themselves.
    """
    solved: list[Figures] = []

    def find() -> dict[str, object]:
        found = simulate(scene, trace=False)
        assert found.status == "ok", found.message
        solved.append(found.performance)
        return {
            name: float(value)
            for name, value in found.performance.items()
            if value is not None and (name in only or not only)
        }

    def too_far(stored: Mapping[str, Any]) -> list[str]:
        (found,) = solved
        off = relative_errors(found, Figures(stored))
        missing = [name for name, value in found.items() if value is not None and not only and name not in stored]
        missing += [name for name in stored if found.get(name) is None]
        return [name for name, error in off.items() if error is not None and error > within] + missing

    what = f"{scene.numerics.closing}, {scene.numerics.accuracy:g}"
    return Figures(known("finer", what, scene_text(scene), find, too_far))
