"""Let the tests import machines as a user's own, `scenes`, and `true_error`."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "laws"), str(HERE.parent / "tools")]
