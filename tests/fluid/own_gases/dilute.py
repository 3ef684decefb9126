"""The gas of `covolume` whose molecules take no room: the ideal one, as another back end."""

from own_gases.covolume import CovolumeGas
from screwsim.fluid.constants import gas_constant
from screwsim.fluid.models import GasModel

GAS = GasModel(lambda asked: CovolumeGas(gas_constant(asked.fluid), asked.isentropic_exponent, 0.0))
