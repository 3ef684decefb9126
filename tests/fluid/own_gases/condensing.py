"""The gas of `dilute`, which condenses where the fluid does: lines stated below its saturation are refused."""

from own_gases.dilute import GAS as DILUTE
from screwsim.fluid.models import GasModel

GAS = GasModel(DILUTE.make, condenses=True)
