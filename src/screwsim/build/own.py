"""Faults of modules of the user's own: gases, machines, effects, which a scene names."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from traceback import walk_tb

from screwsim.inputs.faults import UsageError
from screwsim.scene.types import Scene


def blamed(error: BaseException, own: Iterable[str]) -> str | None:
    """Return in which of the user's own modules an error was raised; None in none of them."""
    modules = [frame.f_globals.get("__name__", "") for frame, _ in walk_tb(error.__traceback__)]
    tops = {module.partition(".")[0] for module in modules}
    exact = [name for name in own if name in modules]
    near = [name for name in own if name.partition(".")[0] in tops]
    return next(iter((*exact, *near)), None)


@contextmanager
def faults_of_own(scene: Scene) -> Iterator[None]:
    """Raise UsageError, in one line, for what fails while modules of the user's own are built and compiled."""
    try:
        yield
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        own = scene.own.values()
        if not own:
            raise
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        text = lines[0] if lines else ""
        what = f"cannot be built or compiled ({type(error).__name__}: {text}); mend that module"
        raise UsageError(f"{', '.join(own)}: {what}") from error
