"""The coverage factor behind a stated uncertainty: `± 1 kW (k=1)` is one standard uncertainty, `± 2 kW (k=2)` two.

Where none is written, the one of the place holds: 2 behind a ± or ×/÷, which is half of a 95 % interval; 1 in a column
of measured points, which holds standard uncertainties.

Source: JCGM 100:2008 (GUM), sections 2.3.5 and 2.3.6.
"""

import re

from screwsim.scene.units import NUMBER, Refused

LARGEST_COVERAGE = 10.0  # nobody states more standard uncertainties than these
COVERAGE_FACTOR = re.compile(rf"\s*\(\s*k\s*=\s*({NUMBER})\s*\)\s*$")


def split_coverage(text: str, otherwise: float) -> tuple[str, float]:
    """Return a text without the coverage factor at its end, and that factor, `otherwise` where none is written.

    Raise `Refused` for a factor that is none.
    """
    match = COVERAGE_FACTOR.search(text)
    if match is None:
        return text, otherwise
    factor = float(match[1])
    if not 0.0 < factor <= LARGEST_COVERAGE:
        raise Refused(
            f"k={match[1]} is not a coverage factor (write k=1 for a standard uncertainty, k=2 for half of a 95 % "
            f"interval)"
        )
    return text[: match.start()], factor
