"""Let the tests import `scenes` of tests/laws, and effects of their own beside them."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "laws")]
