"""A scene given as a dict, written as the text of a file."""

import json
import os
from collections.abc import Mapping
from typing import Any

from screwsim.inputs.faults import UsageError

DICT_NAME = "<dict>"  # takes the place of a file name in messages


def yaml_text(given: Mapping[str, Any]) -> str:
    """Return a dict as YAML, one key a line, so that faults have a line; raise UsageError for what no file can hold."""
    lines: list[str] = []
    _write(given, "", "", lines)
    return "\n".join(lines) + "\n"


def _write(given: Mapping[str, Any], indent: str, path: str, lines: list[str]) -> None:
    for name, value in given.items():
        below = f"{path}.{name}" if path else str(name)
        if isinstance(value, Mapping) and value:
            lines.append(f"{indent}{json.dumps(str(name))}:")
            _write(value, indent + "  ", below, lines)
        else:
            lines.append(f"{indent}{json.dumps(str(name))}: {flow_text(value, below)}")


def flow_text(value: Any, path: str) -> str:
    """Return a value as YAML in one line; raise UsageError for a type that no file can hold."""
    try:
        return json.dumps(value, default=_plain, ensure_ascii=False, allow_nan=False)
    except (TypeError, ValueError):
        what = f"{str(value)[:40]} ({type(value).__name__}) cannot be written into a scene"
        raise UsageError(f"{path}: {what} (pass a number, a text such as '3000 rpm', a list or a dict)") from None


def _plain(value: Any) -> Any:
    """Return a numpy number or array, or a path, as a type that JSON knows; raise TypeError for anything else."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return os.fspath(value)
