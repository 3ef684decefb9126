"""Let the tests import the scenes of the laws and the cases beside them; keep what they compile in one folder."""

import os
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "laws")]
os.environ.setdefault("SCREWSIM_CACHE", str(Path(tempfile.gettempdir()) / f"screwsim-tests-{os.getuid()}"))
