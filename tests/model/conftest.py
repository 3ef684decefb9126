"""Let the tests import `scenes` of tests/laws, and keep what they compile in one folder for all runs."""

import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "laws"))
os.environ.setdefault("SCREWSIM_CACHE", str(Path(tempfile.gettempdir()) / f"screwsim-tests-{os.getuid()}"))
