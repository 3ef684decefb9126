"""Answers of CoolProp cached on disk, one file each, named by the question and CoolProp's version."""

import hashlib
import importlib.metadata
import json
import re
from collections.abc import Callable
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.numerics.compiling import begins
from screwsim.numerics.store import keep, read

_LONGEST = 100  # most letters of a question in the name of its file


def cached_answer(name: str, question: Callable[[], Any]) -> Any:
    """Return the answer to a question to CoolProp, from the cache folder if it is there."""
    version = importlib.metadata.version("CoolProp")
    short = re.sub("[^A-Za-z0-9]+", "_", name)
    if len(short) > _LONGEST:
        short = f"{short[:_LONGEST]}_{hashlib.sha256(name.encode()).hexdigest()[:16]}"
    file = f"coolprop-{version}-{short}.answer"
    found = json.loads(read(file) or b"{}")
    if found.get("name") == name:
        return found["answer"]
    begins()
    answer = question()
    keep(file, json.dumps({"name": name, "answer": answer}).encode())
    return answer


def no_fluid(fluid: str, error: ValueError) -> UsageError:
    """Return the exception for a fluid that CoolProp refuses."""
    reason = str(error).splitlines()[0][:120]
    return UsageError(f"gas.fluid: CoolProp has no pure fluid {fluid!r} ({reason}); name one such as R134a")
