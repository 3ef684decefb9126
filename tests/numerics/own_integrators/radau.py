"""Radau, as a check of one's own: a class in place of the name."""

from scipy.integrate import Radau

from screwsim.numerics.integrators import Check

INTEGRATOR = Check(Radau)
