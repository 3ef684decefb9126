"""Anderson's mixtures of the turns of waveform relaxation, with their histories (docs/explanation/closing.md)."""

import numpy as np

from screwsim.model.run import Machinery
from screwsim.numerics.anderson import Anderson

Array = np.ndarray
DEPTH = 5  # of Anderson's method
TOO_FAR = 0.3  # distance of a mixture from the newest image, in coordinates, above which it is refused


class TurnMixing:
    """The next point of the iteration from the last turns, whose histories are blended as the points are."""

    def __init__(self, machinery: Machinery) -> None:
        self.machinery, self.accelerate = machinery, Anderson(DEPTH)
        self.histories: list[tuple[Array, Array, int]] = []
        self.seen: list[tuple[float, float]] = []

    def restart(self) -> None:
        """Forget the points of earlier turns: corrections have begun."""
        self.accelerate.restart()

    def next(
        self, point: Array, image: Array, seen: tuple[float, float], wanted: bool
    ) -> tuple[Array, tuple[float, float] | None]:
        """Return the point after a turn mapped `point` to `image`, and its mass and work if it is a mixture.

        `seen` are mass and work of the image. Corrected images are not mixed (`wanted` False) while corrections make
        progress: blending histories of different steps leaves a mass residual. Mixtures too far from the image are
        refused.
        """
        self.histories = [*self.histories, self.machinery.lives.image()][-DEPTH - 1 :]
        self.seen = [*self.seen, seen][-DEPTH - 1 :]
        weights, mixed = self.accelerate.mix(point, image)
        if not wanted or len(weights) == 1 or not np.max(np.abs(mixed - image)) < TOO_FAR:
            return image, None
        self.machinery.lives.blend(self.histories[-len(weights) :], weights)
        mass, work = (weights @ np.array(self.seen[-len(weights) :])).tolist()
        return mixed, (mass, work)
