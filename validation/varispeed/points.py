"""Write fit.csv: ratings of the reciprocating compressor at 50 Hz, three for the fit, the others to be predicted.

    python validation/varispeed/points.py
    screwsim calibrate validation/varispeed/machine.fit.yaml -o validation/varispeed/fitted

Fitted are -5/35, -10/45 and -10/55 degC at 50 Hz, which span the pressure ratios from 3.6 to 7.4.
"""

from __future__ import annotations

from pathlib import Path

from screwsim.study.validation import sibling

HERE = Path(__file__).parent
FITTED = ("-5/35", "-10/45", "-10/55")
POLES = 4
COMMENT = "# Made by validation/varispeed/points.py from points.csv; uncertainty: half of what is asked.\n"

rated = sibling(HERE.parent / "hsk" / "ratings.py")

if __name__ == "__main__":
    rated.write_fit(HERE, rated.ratings(HERE, POLES), FITTED, COMMENT)
