"""What pages, programs and scenes name by its path in the checkout is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("docs", "src", "scripts", "benchmarks", "tests", "validation", "configs")
NAMED = re.compile(rf"(?<![\w./<-])(?:{'|'.join(FOLDERS)})/[a-z0-9_./-]*\.(?:md|py|sh|yaml|json|csv|png)\b")
ELSEWHERE = {  # in folders that tests make, or that a page lets its reader write
    "validation/none.csv",
    "validation/trap/compare.py",
    "configs/two_stage/grid.stages.yaml",
    "configs/two_stage/package.stages.yaml",
    "configs/two_stage/speeds.stages.yaml",
}
TEXTS = {".md", ".py", ".sh", ".yaml", ".csv", ".json", ""}


def texts(folder: str) -> list[Path]:
    return [path for path in sorted((ROOT / folder).rglob("*")) if path.is_file() and path.suffix in TEXTS]


@pytest.mark.parametrize("folder", FOLDERS)
def test_what_is_named_by_its_path_is_there(folder):
    named = {
        (str(path.relative_to(ROOT)), found)
        for path in [*texts(folder), ROOT / "README.md", ROOT / "pyproject.toml"]
        for found in NAMED.findall(path.read_text(encoding="utf-8"))
    }
    assert named
    assert {(where, found) for where, found in named if not (ROOT / found).exists() and found not in ELSEWHERE} == set()
