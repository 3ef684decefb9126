"""Faults of user modules (gases, machines, effects) that a scene names."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from numbers import Real
from traceback import walk_tb
from types import FunctionType
from typing import Any, get_args

from screwsim.effects.base import Part
from screwsim.inputs.faults import UsageError
from screwsim.numerics.kernel import Kernel
from screwsim.scene.types import Scene

MOST_SHOWN = 60  # largest number of characters of a value in a message


def module_to_blame(error: BaseException, own: Iterable[str]) -> str | None:
    """Return the user module in which an error was raised; None if it was raised elsewhere."""
    modules = [frame.f_globals.get("__name__", "") for frame, _ in walk_tb(error.__traceback__)]
    tops = {module.partition(".")[0] for module in modules}
    exact = [name for name in own if name in modules]
    near = [name for name in own if name.partition(".")[0] in tops]
    return next(iter((*exact, *near)), None)


@contextmanager
def faults_of_own(scene: Scene) -> Iterator[None]:
    """Turn any error from building and compiling user modules into a one-line UsageError."""
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
        what = f"cannot be built or compiled ({type(error).__name__}: {text}); fix that module"
        raise UsageError(f"{', '.join(own)}: {what}") from error


def checked_parts(built: Any) -> list[Any]:
    """Return the parts that `build` of a user's effect returned; raise TypeError where they are not valid parts."""
    if not isinstance(built, Sequence) or isinstance(built, str):
        raise TypeError(f"build returned {_shown(built)}, not a list of parts")
    for part in built:
        if not isinstance(part, get_args(Part)):
            raise TypeError(f"build returned {_shown(part)} among its parts, not a FlowPath, PowerLoss or the like")
        for each in fields(part):
            wrong = _wrong(str(each.type), getattr(part, each.name))
            if wrong:
                raise TypeError(f"{each.name} of its {type(part).__name__} {wrong}")
    return list(built)


def _wrong(kind: str, value: Any) -> str:
    """Return what is wrong with a field of a part, given the type declared for it; '' if it is right."""
    if "Kernel" in kind:
        right = value is None or isinstance(value, Kernel)
        return "" if right else f"is {_shown(value)}, no kernel: put @kernel of screwsim.numerics.kernel above its def"
    wrong: list[str] = []
    if kind == "Mapping[str, float]":
        wrong = [f"{name} = {_shown(number)}" for name, number in value.items() if not isinstance(number, Real)]
    elif kind == "Sequence[float]":
        wrong = [_shown(number) for number in value if not isinstance(number, Real)]
    elif kind == "float" and not isinstance(value, Real):
        wrong = [_shown(value)]
    return f"holds {wrong[0]}, which is no number" if wrong else ""


def _shown(value: Any) -> str:
    text = f"the function {value.__name__}" if isinstance(value, FunctionType) else repr(value)
    return text if len(text) <= MOST_SHOWN else f"a {type(value).__name__}"
