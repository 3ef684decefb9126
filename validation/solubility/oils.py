"""Oils whose solubilities were measured: molar masses, and the equation that each source fitted to its own points."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from screwsim.study.validation import sibling

own = sibling(Path(__file__).with_name("own.py"))


class Oil(NamedTuple):
    """An oil of a source: names in the file, words, kind of its rows, molar mass [kg/mol] or its bounds, own law."""

    source: str
    oil: str
    words: str
    kind: str
    molar_mass: tuple[float, ...]
    pressure: own.Pressure

    @property
    def ester(self) -> bool:
        """Tell whether it is an ester of known molar mass."""
        return "ester" in self.words and len(self.molar_mass) == 1


# molar masses: of the pure esters, by their formulas; of the others as SorpPropLib has them, or bounds
ESTERS = (0.4726, 0.6970)  # of pentaerythritol and acids of 5 to 9 carbon atoms
BENZENES = (0.2464, 0.4147)  # one or two chains of 12 carbon atoms
POE, PAG = (61.387, 0.024138), (62.365, 0.024864)  # density [lb/ft³], and its fall per °F
WAHLSTROM, TAKIGAWA = "Wahlström & Vamling 2000, ester", "Takigawa et al. 2002, alkylbenzene"
OILS = (
    Oil("Grebner", "POE", "Grebner 1992, ester oil", "calibrated", (0.590,), own.heil(948.0, 3993.0, 0.590, POE)),
    Oil("Martz", "POE", "Martz & Jacobi 1994, ester oil", "published", (0.590,), own.heil(1122.0, 4417.0, 0.590, POE)),
    Oil(
        "Yokozeki",
        "POE32",
        "Yokozeki 2001, ester oil ISO VG 32",
        "published",
        ESTERS,
        own.redlich_kwong(8.74e5, 864.0, 0.913, -0.0106, 0.0561, 0.0254),
    ),
    Oil("Wahlström", "PEC9", f"{WAHLSTROM} PEC9", "estimate", (0.69704,), own.flory_huggins(10.41, 938.0, -176.0)),
    Oil("Wahlström", "PEB6", f"{WAHLSTROM} PEB6", "estimate", (0.52872,), own.flory_huggins(7.03, 973.0, -233.0)),
    Oil("Wahlström", "PEB8", f"{WAHLSTROM} PEB8", "estimate", (0.64093,), own.flory_huggins(6.94, 808.0, -203.0)),
    Oil("Martz", "PAG", "Martz & Jacobi 1994, PAG", "estimate", (2.0,), own.heil(1667.0, -4626.0, 2.0, PAG)),
    Oil(
        "Takigawa",
        "BAB15",
        f"{TAKIGAWA} ISO VG 15",
        "estimate",
        BENZENES,
        own.alkylbenzene(1.199e6, 763.35, 0.716075, -0.1331, 0.1496),
    ),
    Oil(
        "Takigawa",
        "BAB32",
        f"{TAKIGAWA} ISO VG 32",
        "estimate",
        BENZENES,
        own.alkylbenzene(1.138e6, 772.89, 0.694728, -0.0986, 0.1598),
    ),
)
OPEN = ("Yokozeki", "HC16")  # n-hexadecane: the unit of its loadings is not settled
