"""What the comparisons of all sources ask for: solved scenes, tables of data, a module beside them."""

import importlib.util
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from screwsim.inputs.sheets import BadSheet, read_sheet
from screwsim.inputs.textfiles import Unreadable
from screwsim.outputs import Result
from screwsim.scene import load, with_values
from screwsim.simulate import simulate
from screwsim.study.validation.record import NotRun


def solved(
    scene_file: Path, overrides: Sequence[str] = (), values: Mapping[str, Any] | None = None, trace: bool = False
) -> Result:
    """Return the result of a scene that must close; `values` are in SI units. Raises NotRun where it does not."""
    scene = load(scene_file, overrides)
    result = simulate(with_values(scene, dict(values or {})), trace=trace)
    if result.status != "ok":
        raise NotRun(f"{scene_file.name} {' '.join(overrides)}: {result.told}")
    return result


def read_table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file whose lines `#` say where its numbers come from. Raises NotRun."""
    try:
        return read_sheet(path).records()
    except (BadSheet, Unreadable) as fault:
        raise NotRun(f"{path}: {fault}") from None


def sibling(path: Path) -> ModuleType:
    """Return a Python file of the checkout as a module, loaded once."""
    name = f"screwsim_validation_{path.parent.name}_{path.stem}"
    if name in sys.modules and sys.modules[name].__file__ == str(path):
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise NotRun(f"{path}: is no Python module")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
