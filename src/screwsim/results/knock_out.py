"""What a knock-out found, in the results of one run: figures over the effects that were left out in turn."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from screwsim.outputs import KNOCK_OUT, KNOCK_OUT_STATUSES, Figures
from screwsim.results.netcdf import Layout, flag_attributes, number_attributes, text_lines

EFFECT = "effect"  # the dimension


def write_knock_out(layout: Layout, costs: Sequence[Figures]) -> None:
    """Write the group `knock_out`; its `effect` numbers the names, which its attribute `labels` holds."""
    group, shape = layout.group("knock_out"), (len(costs),)
    layout.coordinate(group, EFFECT, np.arange(len(costs), dtype=np.int8), _effects([cost.effect for cost in costs]))
    status = np.array([KNOCK_OUT_STATUSES.index(cost.status) for cost in costs], np.int8)
    layout.variable(group, "status", status, (EFFECT,), flag_attributes(KNOCK_OUT_STATUSES, "how it ended"))
    for name, variable in KNOCK_OUT.items():
        if name not in costs[0]:
            continue
        values = np.array([cost[name] for cost in costs], float)  # None becomes NaN
        layout.variable(group, name, values, (EFFECT,), number_attributes(variable))
    messages = [text_lines(cost.message) for cost in costs]
    words = sorted(set(messages))
    data = layout.texts(group, "message", words, shape, (EFFECT,), "why there are no figures, or what to doubt")
    data.write([words.index(message) for message in messages])


def _effects(names: Sequence[str]) -> Mapping[str, Any]:
    return flag_attributes(names, "effect that is left out") | {"labels": "\n".join(names)}
