"""Let the tests, and the workers they start, import the fakes and `true_error`, whatever the import mode."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "results"), str(HERE.parent / "tools")]
