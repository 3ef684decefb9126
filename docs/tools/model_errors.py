"""Keep what `screwsim validate` states of the model's error, for scenes that name it (`uncertainty: {model: NAME}`).

    screwsim validate bitzer cagi energyplus hsk varispeed -o results/validation
    python docs/tools/model_errors.py results/validation

Every number of src/screwsim/scene/model_errors.json comes from there; a test holds it to validation/results.json.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from screwsim.scene import model_errors

KEPT = Path(model_errors.__file__).with_name(model_errors.FILE)
DEEP = 3  # machine, what is said of it, figure: a line each


def in_lines(told: Any, deep: int, indent: str = "") -> str:
    """Return a document as JSON whose mappings have a line an entry, as deep as that, and stand in one line below."""
    if not deep or not isinstance(told, dict):
        return json.dumps(told, ensure_ascii=False)
    below = f"{indent} "
    lines = (f"{below}{json.dumps(name)}: {in_lines(each, deep - 1, below)}" for name, each in told.items())
    return "{\n" + ",\n".join(lines) + f"\n{indent}}}"


def main() -> None:
    """Keep the statements of a folder that the command wrote."""
    told = json.loads((Path(sys.argv[1]) / model_errors.FILE).read_text(encoding="utf-8"))
    KEPT.write_text(in_lines(told, DEEP) + "\n", encoding="utf-8")
    print(KEPT)


if __name__ == "__main__":
    main()
