"""Call functions of a text in lanes."""

import numpy as np

from screwsim.codegen.kinds import FLOATS, LANES
from screwsim.codegen.modules import load

HEADER = "import math\nimport numpy as np\n"
ALL = (1 << LANES) - 1


def in_lanes(text, *rows, mask=ALL, results=1, name="f"):
    """Return what a function of a text gives for rows of numbers, one of each lane."""
    entry = load(HEADER + text, "lanes").of_lanes(name, (FLOATS,) * len(rows))
    words = np.concatenate([np.array([mask], np.int64).view(float), *(np.asarray(row, float) for row in rows)])
    out = np.full(results * LANES, -1.0)
    entry(words.ctypes.data, out.ctypes.data)
    return out.reshape(results, LANES)
