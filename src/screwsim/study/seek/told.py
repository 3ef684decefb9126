"""What simulates, and counts its solutions in a progress: of one search, how many it takes is not known before."""

from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.study.optimum import Simulate
from screwsim.study.progress import Progress


class Told:
    """Simulates as another does; within `with`, each solution is one of those expected, or of as many again."""

    def __init__(self, simulate: Simulate, progress: Progress, expected: int) -> None:
        self._simulate = simulate
        self._progress = progress
        self._expected = self._left = expected

    def __enter__(self) -> None:
        self._progress.start(self._expected, 0)

    def __call__(self, scene: Scene) -> Result:
        result = self._simulate(scene)
        if not self._left:
            self._progress.more(self._expected)
            self._left = self._expected
        self._left -= 1
        self._progress.advance(1, int(result.status != "ok"))
        return result

    def __exit__(self, *error: object) -> None:
        self._progress.more(-self._left)
        self._progress.stop()
