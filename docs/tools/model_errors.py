"""Keep what `screwsim validate` states of the model's error, for scenes that name it (`uncertainty: {model: NAME}`).

    screwsim validate bitzer cagi energyplus -o results/validation
    python docs/tools/model_errors.py results/validation

Every number of src/screwsim/scene/model_errors.json comes from there; a test holds it to validation/results.json.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from screwsim.scene import model_errors

KEPT = Path(model_errors.__file__).with_name(model_errors.FILE)


def main() -> None:
    """Keep the statements of a folder that the command wrote."""
    shutil.copyfile(Path(sys.argv[1]) / model_errors.FILE, KEPT)
    print(KEPT)


if __name__ == "__main__":
    main()
