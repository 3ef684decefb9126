"""Builds the parts that the composer takes (geometry, gas, oil, effects) from a typed scene."""

from screwsim.build.own import blamed, faults_of_own
from screwsim.build.parts import WIDTH, build_parts, parts_of, prepare, regularisation
from screwsim.build.stock import Stock, build_gas, build_site
from screwsim.build.temperatures import (
    Temperatures,
    completed,
    filled,
    in_separator,
    open_temperatures,
    package_of,
    temperature_faults,
)
