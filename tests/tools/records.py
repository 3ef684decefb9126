"""Stored outcomes as JSON with a record on each line, so that one can see at a glance which of them changed."""

import json
from typing import Any


def by_records(value: Any, depth: int) -> str:
    """Return a value as JSON text: what is nested `depth` deep, and what holds nothing else, is on one line each."""
    if depth == 0 or not value or not isinstance(value, dict | list):
        return json.dumps(value, ensure_ascii=False)
    keys = (
        [f"{json.dumps(key, ensure_ascii=False)}: " for key in value] if isinstance(value, dict) else [""] * len(value)
    )
    each = value.values() if isinstance(value, dict) else value
    rows = [key + by_records(one, depth - 1).replace("\n", "\n ") for key, one in zip(keys, each, strict=True)]
    first, last = "{}" if isinstance(value, dict) else "[]"
    return "\n ".join([first, ",\n ".join(rows)]) + f"\n{last}"
