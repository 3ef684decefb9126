"""Let the tests import the scenes of the laws, the cases beside them and the search for more of them."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "laws"), str(HERE.parent / "tools")]
