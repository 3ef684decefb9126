"""The page on files states the limits that hold."""

from pathlib import Path

from screwsim.inputs.sheets import MOST_ROWS
from screwsim.inputs.textfiles import MOST_TABLE, MOST_YAML
from screwsim.scene.load import MOST_BASES
from screwsim.scene.yaml_tree import MOST_LEVELS, MOST_NODES

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "sweeps.md"


def test_the_page_states_the_limits_of_files():
    text = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert f"at most {MOST_YAML // 1_000_000} MB, {MOST_NODES} values" in text
    assert f"{MOST_LEVELS} levels, and {MOST_BASES} bases one above the other" in text
    assert f"a table at most {MOST_TABLE // 1_000_000} MB and {MOST_ROWS} rows" in text
