"""One parameter at a time against measured points: what its best change leaves over, and how probable that makes it.

With residuals r over their uncertainties, slopes j over the place u of the parameter (0 … 1 between its bounds) and
C = 1 + M Mᵀ, where the columns of M are what one standard uncertainty of each input of the unchanged machine makes of
the residuals, the likelihood is exp(-½ (r + j s)ᵀ C⁻¹ (r + j s)) over steps s. The evidence is its integral over the
places, even between the bounds (MacKay 2003, chapter 28): what fits as well with less room is the more probable.
"""

from dataclasses import dataclass

import numpy as np

from screwsim.study.calibration.residuals import Array


@dataclass(frozen=True)
class Along:
    """The likelihood along one place, from residuals and slopes at a place: best place, its chi², how sharp it is.

    `information` is one over the variance of the place; 0 where the residuals do not depend on it.
    """

    place: float
    chi_squared: float
    information: float

    @property
    def estimate(self) -> float:
        """The best place between the bounds."""
        return float(np.clip(self.place, 0.0, 1.0))

    @property
    def misfit(self) -> float:
        """Chi² at the best place between the bounds."""
        return self.chi_squared + self.information * (self.estimate - self.place) ** 2

    @property
    def log_evidence(self) -> float:
        """Logarithm of the mean likelihood between the bounds."""
        if self.information <= 0.0:
            return -0.5 * self.chi_squared
        sharp = self.information**0.5
        width = float(log_mass(-self.place * sharp, (1.0 - self.place) * sharp))
        return -0.5 * self.chi_squared + 0.5 * float(np.log(2.0 * np.pi / self.information)) + width

    def interval(self, level: float) -> tuple[float, float]:
        """Return the places between which the parameter lies with a probability."""
        from scipy.stats import truncnorm

        tails = 0.5 - 0.5 * level, 0.5 + 0.5 * level
        if self.information <= 0.0:
            return tails
        deviation = self.information**-0.5
        ends = (0.0 - self.place) / deviation, (1.0 - self.place) / deviation
        low, high = (float(each) for each in truncnorm.ppf(tails, *ends, loc=self.place, scale=deviation))
        return low, high


def along(place: float, residuals: Array, slopes: Array) -> Along:
    """Return the likelihood along a place from whitened residuals and slopes (n,) there."""
    information, chi_squared = float(slopes @ slopes), float(residuals @ residuals)
    if information <= 1e-12:
        return Along(place, chi_squared, 0.0)
    step = -float(slopes @ residuals) / information
    return Along(place + step, max(0.0, chi_squared - information * step**2), information)


def whitener(inputs: Array) -> Array:
    """Return W (n, n) with WᵀW the inverse of 1 + M Mᵀ, of the columns M (n, inputs)."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(np.eye(len(inputs)) + inputs @ inputs.T)), float)


def log_mass(low: float | Array, high: float | Array) -> Array:
    """Return the logarithm of the standard normal distribution's mass between two ends, of tails too."""
    from scipy.special import log_ndtr

    right = np.greater(low, 0.0)
    low, high = np.where(right, -np.asarray(high), low), np.where(right, -np.asarray(low), high)
    below, above = log_ndtr(low), log_ndtr(high)
    inside = above > below
    share = -np.exp(np.minimum(np.where(inside, below - above, -1.0), -1e-300))
    return np.where(inside, above + np.log1p(share), -np.inf)
