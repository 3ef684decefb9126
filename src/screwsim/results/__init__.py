"""Results to HDF5 and back, in one schema."""

from screwsim.results.group import Group
from screwsim.results.read import Results, open_results
from screwsim.results.write import save
