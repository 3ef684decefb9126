"""Let the tests import `tight` and `closed_points`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
