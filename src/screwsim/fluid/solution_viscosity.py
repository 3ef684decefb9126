"""Viscosity of oil that holds dissolved refrigerant, from those of oil and liquid refrigerant (M199).

Source: A. Yokozeki, Solubility and viscosity of refrigerant-oil mixtures, Int. Compressor Eng. Conf., Purdue 1994; the
exponent as in R. A. Schwentker's thesis (University of Maryland, 2005).
"""

from math import exp, log

EXPONENT = 0.58  # of the molar masses, by which Yokozeki weights the mole fractions


def solution_viscosity(
    ratio: float, refrigerant: float, oil: float, molar_mass_refrigerant: float, molar_mass_oil: float
) -> float:
    """Return the viscosity [Pa s] of oil that holds `ratio` [kg per kg of oil] (M199).

    Arguments: viscosities of liquid refrigerant and oil [Pa s] and their molar masses, both in one unit.
    """
    weighted = ratio * (molar_mass_oil / molar_mass_refrigerant) ** (1.0 - EXPONENT)
    share = weighted / (weighted + 1.0)
    return exp(share * log(refrigerant) + (1.0 - share) * log(oil))
