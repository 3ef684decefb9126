"""Let the tests, and the workers they start, import `result_fakes` and `sweep_fakes`, whatever the import mode."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "results"), str(HERE.parent / "tools")]
