"""What a simulation gives: the names, units and meanings of all results, and the record that carries them.

One table serves the JSON of `run`, the HDF5 file and the labels of figures. SI units. Figures are the core's own; what
an effect gives it declares itself. A result has those that its scene calls for: one of them without a value is None
(null in JSON, NaN with its fill value in HDF5).
"""

from screwsim.outputs.core import (
    AFTERCOOLED,
    CHANGED,
    CONDENSED,
    COOLED,
    HEATED,
    HELD,
    HUMID,
    PERFORMANCE,
    WALLED,
)
from screwsim.outputs.declared import (
    BESIDE,
    BESIDE_RATIO,
    EFFICIENCY,
    ITSELF,
    LEAST_OIL,
    POWER,
    TIMES,
    Figure,
    Scale,
    Trace,
    Variable,
    efficiency,
    names_of,
    over,
    power_figure,
)
from screwsim.outputs.figures import Figures, shown, shown_of
from screwsim.outputs.result import Result
from screwsim.outputs.stages import STAGES
from screwsim.outputs.variables import (
    BALANCE,
    CYCLE,
    KNOCK_OUT,
    KNOCK_OUT_STATUSES,
    LEDGER,
    LEDGER_ENTRY,
    NUMERICS,
    NUMERICS_TEXT,
    STATUSES,
    cycle_variable,
    ledger_entries,
    ledger_variable,
    sorted_entries,
)

__all__ = [
    "AFTERCOOLED",
    "BALANCE",
    "BESIDE",
    "BESIDE_RATIO",
    "CHANGED",
    "CONDENSED",
    "COOLED",
    "CYCLE",
    "EFFICIENCY",
    "HEATED",
    "HELD",
    "HUMID",
    "ITSELF",
    "KNOCK_OUT",
    "KNOCK_OUT_STATUSES",
    "LEAST_OIL",
    "LEDGER",
    "LEDGER_ENTRY",
    "NUMERICS",
    "NUMERICS_TEXT",
    "PERFORMANCE",
    "POWER",
    "STAGES",
    "STATUSES",
    "TIMES",
    "WALLED",
    "Figure",
    "Figures",
    "Result",
    "Scale",
    "Trace",
    "Variable",
    "cycle_variable",
    "efficiency",
    "ledger_entries",
    "ledger_variable",
    "names_of",
    "over",
    "power_figure",
    "shown",
    "shown_of",
    "sorted_entries",
]
