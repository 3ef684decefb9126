"""Where the files of the checkout lie that tests read."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
CONFIGS = ROOT / "configs"
POINT = CONFIGS / "paper" / "point.yaml"
