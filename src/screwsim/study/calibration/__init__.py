"""Calibration: parameters of a scene fitted to measured operating points, and how well the data determine them."""

from screwsim.study.calibration.read import read_fit
from screwsim.study.calibration.solve import calibrate, cost_in_words
