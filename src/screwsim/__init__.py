"""Simulate oil-flooded twin-screw compressors, chamber by chamber.

    result = screwsim.simulate("x.yaml")        a path, a dict, YAML text, or a scene of screwsim.load
    result.performance.isothermal_efficiency    the figures with units and meanings: print(result.performance)

Each public name is imported when it is first used, so that `import screwsim` costs nothing.
"""

import importlib
import sys
import time
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from screwsim import plot
    from screwsim.api import (
        calibrate,
        compare,
        datasheet,
        diagnose,
        optimum,
        performance_map,
        plan,
        posterior,
        sobol_indices,
        tabulate,
    )
    from screwsim.inputs.faults import Interrupted, SceneError, UsageError
    from screwsim.outputs import Result
    from screwsim.results import open_results
    from screwsim.scene import Scene, load, loads, schema
    from screwsim.study.maps.map_points import evaluate_map
    from screwsim.study.optimize import optimize
    from screwsim.study.seek import find
    from screwsim.study.sweep import run_sweep, sweep
    from screwsim.study.uncertainty.point import sensitivities, simulate, uncertainty

    __version__: str

BEGAN = time.time()  # [s] before any other file of the package was read

__all__ = [
    "Interrupted",
    "Result",
    "Scene",
    "SceneError",
    "UsageError",
    "__version__",
    "calibrate",
    "compare",
    "datasheet",
    "diagnose",
    "evaluate_map",
    "find",
    "load",
    "loads",
    "open_results",
    "optimize",
    "optimum",
    "performance_map",
    "plan",
    "plot",
    "posterior",
    "run_sweep",
    "schema",
    "sensitivities",
    "simulate",
    "sobol_indices",
    "sweep",
    "tabulate",
    "uncertainty",
]

_HOMES = {
    "Interrupted": "screwsim.inputs.faults",
    "Result": "screwsim.outputs",
    "Scene": "screwsim.scene",
    "SceneError": "screwsim.inputs.faults",
    "UsageError": "screwsim.inputs.faults",
    "calibrate": "screwsim.api",
    "compare": "screwsim.api",
    "datasheet": "screwsim.api",
    "diagnose": "screwsim.api",
    "evaluate_map": "screwsim.study.maps.map_points",
    "find": "screwsim.study.seek",
    "load": "screwsim.scene",
    "loads": "screwsim.scene",
    "open_results": "screwsim.results",
    "optimize": "screwsim.study.optimize",
    "optimum": "screwsim.api",
    "performance_map": "screwsim.api",
    "plan": "screwsim.api",
    "posterior": "screwsim.api",
    "run_sweep": "screwsim.study.sweep",
    "schema": "screwsim.scene",
    "sensitivities": "screwsim.study.uncertainty.point",
    "simulate": "screwsim.study.uncertainty.point",
    "sobol_indices": "screwsim.api",
    "sweep": "screwsim.study.sweep",
    "tabulate": "screwsim.api",
    "uncertainty": "screwsim.study.uncertainty.point",
}


def __getattr__(name: str) -> Any:
    """Return a public name from the module that defines it."""
    if name == "plot":
        return importlib.import_module("screwsim.plot")
    if name == "__version__":  # in a checkout git is asked for it, so only on demand
        return importlib.import_module("screwsim.version").version()
    if name not in _HOMES:
        raise AttributeError(f"module 'screwsim' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names."""
    return list(__all__)


class _Package(ModuleType):
    """This package, in which `simulate` stays the function.

    Importing the module `screwsim.simulate` would bind the package's attribute of that name to the module. The
    function is what users call and is found on first use; the module is reached with `from screwsim.simulate import
    …`.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an attribute, unless it is the module `simulate`."""
        if name != "simulate" or not isinstance(value, ModuleType):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
