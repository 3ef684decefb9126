"""The command `export`: a machine's map, loads and spectra in the formats of other tools.

A format is a command of `app` in one of these modules; they are listed in the order of its help.
"""

from screwsim.cli.export import maps  # isort: skip
from screwsim.cli.export import cases, polynomials, loads  # isort: skip
from screwsim.cli.export.shared import app

__all__ = ["app", "cases", "loads", "maps", "polynomials"]
