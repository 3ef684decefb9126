"""Solve the carried point of validation/plain by plain.py anew: python tests/tools/plain_figures.py

Writes tests/validation/plain_figures.json: its figures in SI units, and a digest of plain.py and of its input numbers.
Takes some 20 s; tests compare the package with the stored figures, and `scripts/test --all` solves it again.
"""

import hashlib
import json
from pathlib import Path
from types import ModuleType
from typing import Any

from screwsim.scene import load
from screwsim.study.validation import sibling

ROOT = Path(__file__).parents[2]
PLAIN = ROOT / "validation" / "plain"
KEPT = ROOT / "tests" / "validation" / "plain_figures.json"
REMEDY = "plain.py or its point has changed since its figures were kept: python tests/tools/plain_figures.py"


def carried(module: ModuleType) -> Any:
    """Return the point of validation/plain whose oil is carried along."""
    (point,) = [point for point in module.points(PLAIN) if "carried" in point.name]
    return point


def digest(machine: Any) -> str:
    """Return a digest of plain.py and of a machine's numbers to twelve digits: beyond, gases differ by platform."""
    numbers = {name: f"{value:.12g}" for name, value in vars(machine).items()}
    text = (PLAIN / "plain.py").read_text(encoding="utf-8")
    return hashlib.sha256(f"{json.dumps(numbers, sort_keys=True)}\n{text}".encode()).hexdigest()


def solved_now(module: ModuleType) -> dict[str, Any]:
    """Return the content of the stored file, solved now: digest and figures [SI units]."""
    machine = module.machine_of(load(*carried(module).asked))
    return {"digest": digest(machine), "figures": module.plain_figures(machine)}


if __name__ == "__main__":
    found = solved_now(sibling(PLAIN / "compare.py"))
    KEPT.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(f"{KEPT.relative_to(ROOT)}: {len(found['figures'])} figures")
