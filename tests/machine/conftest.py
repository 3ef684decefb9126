"""Let the tests import machines as a user's own."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
