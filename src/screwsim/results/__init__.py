"""Results to HDF5 and back, in one schema."""

from screwsim.results.read import Group, Results, open_results
from screwsim.results.write import save

__all__ = ["Group", "Results", "open_results", "save"]
