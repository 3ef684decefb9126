"""Figures of much finer solutions, as they are stored (`known`)."""

from known import known
from true_error import reference

from screwsim.outputs import Figures
from screwsim.scene import Scene, scene_text

ANEW = 0.1  # of the wanted accuracy: how far a reference may be another when it is found again


def known_reference(scene: Scene, radau: float | None = None) -> tuple[str, Figures]:
    """Return status and figures of a scene's reference, stored or found anew; arguments are those of `reference`."""

    def find() -> dict[str, object]:
        status, figures = reference(scene, radau)
        return {"status": status, **figures}

    what, within = "coupled" if radau is None else f"Radau, {radau:g}", ANEW * scene.numerics.accuracy
    figures = known("true_figures", what, scene_text(scene), find, within)
    return figures["status"], Figures({name: value for name, value in figures.items() if name != "status"})
