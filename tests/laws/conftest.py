"""Let the tests import `scenes`, and keep what they compile in one folder for all runs where none is named."""

import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
os.environ.setdefault("SCREWSIM_CACHE", str(Path(tempfile.gettempdir()) / f"screwsim-tests-{os.getuid()}"))
