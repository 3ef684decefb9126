"""Writing results to HDF5 and reading them back, with one schema."""

from screwsim.results.group import Group
from screwsim.results.read import Results, open_results
from screwsim.results.write import save
