"""Compiling a composition: what is said of it."""

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from types import ModuleType

from screwsim.codegen import modules
from screwsim.numerics import compiling

COMPILED = {  # what each driver is, and about how long its compilation takes
    "one": ("this combination of effects", "a second or two"),
    "all": ("coupled chambers of this combination", "a second or two"),
    "tangents": ("derivatives of coupled chambers of this combination", "a second"),
    "lanes": ("points of this combination side by side", "some seconds"),
    "device": ("points of this combination for a GPU", "some seconds"),
    "numbers": ("derivatives by numbers of this combination", "some seconds"),
    "ledger": ("the ledger of this combination", "a second"),
}

alone = threading.RLock()  # held while compiling: another thread that needs the same finds it ready


def load(text: str) -> ModuleType:
    """Return the module of a composition's text."""
    return modules.load(text, "model")


def warm(module: ModuleType) -> set[str]:
    """Return the drivers of a module that this process has compiled or loaded, to be added to."""
    return module.__dict__.setdefault("drivers_ready", set())


@contextmanager
def first(module: ModuleType, driver: str) -> Iterator[None]:
    """Say on stderr that a driver's first compilation takes its time; silent when done before."""
    if driver in warm(module):
        yield
        return
    with alone, compiling.announced(driver, *COMPILED[driver]):
        yield
    warm(module).add(driver)


def equation_announced(fluid: str) -> AbstractContextManager[None]:
    """Say on stderr that a fluid's equation of state is written and compiled, when a real gas is new."""
    return compiling.announced("equation", f"the equation of state of {fluid}", "some seconds")
