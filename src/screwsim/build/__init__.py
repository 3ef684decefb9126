"""Builds the parts that the composer takes (geometry, gas, oil, effects) from a typed scene."""

from screwsim.build.own_modules import faults_of_own, module_to_blame
from screwsim.build.parts import WIDTH, build_parts, parts_of, prepare, regularisation
from screwsim.build.parts_cache import PartsCache, build_gas, build_site, surroundings_of
from screwsim.build.temperatures import (
    Temperatures,
    completed,
    open_temperatures,
    package_of,
    separator_effects,
    temperature_faults,
    with_temperatures,
)
