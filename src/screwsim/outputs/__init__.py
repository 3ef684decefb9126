"""Results of a simulation: names, units and meanings of all of them, and the record that carries them.

One table serves the JSON of `run`, the HDF5 file and the labels of figures. SI units. The core declares its own
figures, each effect those that it gives. A result has the figures that its scene calls for: one without a value is None
(null in JSON, NaN with its fill value in HDF5).
"""

from screwsim.outputs.core import (
    AFTERCOOLED,
    CHANGED,
    CONDENSED,
    HEATED,
    HELD,
    HUMID,
    NEEDS_CONDENSER,
    PERFORMANCE,
    STAGES,
    WALLED,
    cooling_figure,
)
from screwsim.outputs.declared import (
    BESIDE,
    BESIDE_RATIO,
    EFFICIENCY,
    ITSELF,
    LEAST_OIL,
    NET_FLOW,
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
from screwsim.outputs.variables import (
    BALANCE,
    CYCLE,
    KNOCK_OUT,
    KNOCK_OUT_STATUSES,
    LEDGER,
    LEDGER_ENTRY,
    LEDGER_SUMMARY,
    NUMERICS,
    NUMERICS_TEXT,
    STATUSES,
    effect_words,
    ledger_entries,
    ledger_variable,
    sorted_entries,
    words_of_effects,
)

# names for authors of effects
__all__ = ["Figure", "Scale", "Trace", "efficiency", "over", "power_figure"]
