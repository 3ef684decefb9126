"""Results of a posterior: spreads of parameters and discrepancies, and predicted measurements, with intervals."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from screwsim.outputs.display import About, Brief
from screwsim.study.asked.inputs import shown_value
from screwsim.study.calibration.fit import Fit, Point
from screwsim.study.calibration.residuals import Array

LEVEL = 0.9  # probability of the intervals
QUANTILES = (0.5 - 0.5 * LEVEL, 0.5, 0.5 + 0.5 * LEVEL)


@dataclass(frozen=True)
class ParameterInterval:
    """Spread of a parameter or width: median, interval of `LEVEL`, standard deviation [SI], that over the prior's."""

    name: str
    low: float
    median: float
    high: float
    deviation: float
    of_prior: float | None = None


@dataclass(frozen=True)
class PredictiveCheck:
    """A measured figure [SI] beside the posterior's prediction of a measurement of it: median and interval."""

    point: str
    figure: str
    fitted: bool
    measured: float
    low: float
    median: float
    high: float

    @property
    def inside(self) -> bool:
        return self.low <= self.measured <= self.high


@dataclass(frozen=True)
class Prediction:
    """Predicted measurement of a figure at another point [SI]: median, interval of `LEVEL`, parts of its width.

    The parts are standard deviations, whose squares add up: `parameters` due to their posterior, `discrepancy` due to
    what the model cannot follow, `measuring`, and `polynomials` due to those that replace the model. `measured` is the
    measured value where there is one.
    """

    point: str
    figure: str
    low: float
    median: float
    high: float
    parameters: float
    discrepancy: float
    measuring: float
    polynomials: float
    measured: float | None = None

    @property
    def inside(self) -> bool | None:
        return None if self.measured is None else self.low <= self.measured <= self.high


@dataclass(frozen=True, repr=False)
class Predictions(Brief):
    """Predicted measurements at other points. `reasons` are those of points without a solution.

    `off` is the largest error of the polynomials at draws that were solved, over the measurement's uncertainty.
    `status` ok | not converged | failed.
    """

    status: str
    message: str
    points: tuple[Point, ...] = ()
    figures: tuple[Prediction, ...] = ()
    reasons: Mapping[str, str] = field(default_factory=dict)
    off: float | None = None
    solutions: int = 0
    failed: int = 0

    def _about(self) -> About:
        columns = ("point", "figure", "median [SI]", f"{LEVEL:.0%} interval")
        rows = [(p.point, p.figure, f"{p.median:.5g}", f"{p.low:.5g} … {p.high:.5g}") for p in self.figures]
        notes = [text for text in (self.message, *self.reasons.values()) if text]
        return About(f"Predictions: {self.status}; {len(self.points)} points", notes, columns, rows)


@dataclass(frozen=True, repr=False)
class Posterior(Brief):
    """The posterior: spreads of parameters and discrepancy widths, predictions, and whether the chains converged.

    `samples` (n, parameters) are values [SI], `widths` (n, figures) those of the discrepancy [SI]. `off` is the largest
    error of the polynomials that was found, over the figures' uncertainties; they hold within `region`, places of the
    parameters. `predictions` are those at other points, where requested. `status` ok | not converged | failed.
    """

    fit: Fit
    status: str
    message: str
    parameters: tuple[ParameterInterval, ...] = ()
    discrepancies: tuple[ParameterInterval, ...] = ()
    predicted: tuple[PredictiveCheck, ...] = ()
    samples: Array | None = None
    widths: Array | None = None
    r_hat: float | None = None
    autocorrelation: float | None = None
    steps: int = 0
    effective: float | None = None
    off: float | None = None
    solutions: int = 0
    failed: int = 0
    region: tuple[Array, Array] | None = None
    predictions: Predictions | None = None

    def _about(self) -> About:
        scene, rows = self.fit.scene, []
        for parameter in self.parameters:
            ends = (parameter.low, parameter.median, parameter.high)
            low, median, high = (shown_value(scene, parameter.name, value, 4) for value in ends)
            share = "" if parameter.of_prior is None else f"{parameter.of_prior:.2f}"
            rows.append((parameter.name, median, f"{low} … {high}", share))
        chains = "" if self.r_hat is None else f"; R-hat {self.r_hat:.3f}, {self.effective:.0f} effective samples"
        notes = [text for text in (self.fit.title, self.message) if text]
        columns = ("parameter", "median", f"{LEVEL:.0%} interval", "of prior")
        return About(f"Posterior: {self.status}{chains}", notes, columns, rows)
