"""Calibration: parameters of a scene fitted to measured operating points, and how far the data fix them."""

from screwsim.study.calibration.fit import Fit, Measured, Parameter, Point, Prior, Tie
from screwsim.study.calibration.read import read_fit
from screwsim.study.calibration.scene import BEGINS, fitted_text
from screwsim.study.calibration.solve import Calibration, Compared, Start, calibrate

__all__ = [
    "BEGINS",
    "Calibration",
    "Compared",
    "Fit",
    "Measured",
    "Parameter",
    "Point",
    "Prior",
    "Start",
    "Tie",
    "calibrate",
    "fitted_text",
    "read_fit",
]
