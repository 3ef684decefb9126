"""Let the tests import `scenes`, and the tools whose stored outcome they check."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tools")]
