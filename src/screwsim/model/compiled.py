"""Load the compiled modules of compositions, and announce what takes time to compile."""

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from types import ModuleType

from screwsim.codegen import modules
from screwsim.numerics import compiling

COMPILED = {  # by driver: its description, and roughly its time to compile
    "one": ("this combination of effects", "a second or two"),
    "all": ("coupled chambers of this combination", "a second or two"),
    "tangents": ("derivatives of coupled chambers of this combination", "a second"),
    "lanes": ("points of this combination side by side", "some seconds"),
    "device": ("points of this combination for a GPU", "some seconds"),
    "numbers": ("derivatives by numbers of this combination", "some seconds"),
    "ledger": ("the ledger of this combination", "a second"),
}

compiling_lock = threading.RLock()  # held while compiling, so that another thread finds the result


def load(text: str) -> ModuleType:
    """Return the module of a composition's text."""
    return modules.load(text, "model")


def warm_drivers(module: ModuleType) -> set[str]:
    """Return the set of a module's drivers that this process has compiled or loaded; callers add to it."""
    return module.__dict__.setdefault("drivers_ready", set())


@contextmanager
def announce_first(module: ModuleType, driver: str) -> Iterator[None]:
    """Announce on stderr that a driver's first compilation takes time; silent once it is done."""
    if driver in warm_drivers(module):
        yield
        return
    with compiling_lock, compiling.announced(driver, *COMPILED[driver]):
        yield
    warm_drivers(module).add(driver)


def equation_announced(fluid: str) -> AbstractContextManager[None]:
    """Announce on stderr that a real gas's equation of state is being written and compiled, where it is new."""
    return compiling.announced("equation", f"the equation of state of {fluid}", "some seconds")
