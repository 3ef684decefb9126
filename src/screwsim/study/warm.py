"""A simulator of scenes that come one by one, each cycle begun from the one before."""

from collections.abc import Iterator

from screwsim.outputs import Result
from screwsim.scene import Scene


class Warm:
    """Simulate a scene when called, without traces, from the scene of the last call where that is near."""

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._course: Iterator[Result] | None = None

    def __call__(self, scene: Scene) -> Result:
        from screwsim.simulate import simulate_many

        self._scene = scene
        self._course = self._course or iter(simulate_many(self._scenes(), trace=False))
        try:
            return next(self._course)
        except Exception:
            self._course = None
            raise

    def _scenes(self) -> Iterator[Scene]:
        while self._scene is not None:
            yield self._scene
