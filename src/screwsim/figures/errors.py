"""Numerical errors of performance figures, each relative to the scale that its declaration names."""

from collections.abc import Callable, Mapping
from math import prod
from typing import Any

from screwsim.figures import declared
from screwsim.outputs import ITSELF, TIMES, Figure, Figures, Scale, over

FLOW = "gas_mass_flow"
OVER_FLOW = over(FLOW)
LEAST_FILLING = 0.1  # volumetric efficiency below which the net gas flow is treated as passing through zero


def relative_errors(found: Figures, better: Figures, least_power: float = 0.0, least_work: float = 0.0) -> Figures:
    """Return |found − better| of each figure over its `error_scale`; None where a value or the scale is missing.

    Differences of powers and work are never taken relative to less than `least_power` [W] and `least_work` [J], below
    which they are rounding. Where the better value is exactly zero, as the flow of a machine that draws in nothing, the
    scale is that of the other one.
    """
    known = zeros_for_none(better)
    errors: dict[str, float | None] = dict.fromkeys(found)
    about: Mapping[str, Figure] = getattr(found, "about", {})
    for name, value in found.items():
        if value is None or (reference := better.get(name)) is None:
            continue
        scale = (about.get(name) or declared(name, found)).scale
        if scale is ITSELF:  # most of them
            size = abs(reference) or abs(value)
        elif scale.unasked:
            continue
        elif scale.alone and scale.times:  # a power
            size = max(error_scale(name, scale, known), least_power)
        else:
            size = error_scale(name, scale, known) or error_scale(name, scale, zeros_for_none(found))
        least = least_work if name == "work_per_cycle" else 1e-300
        errors[name] = abs(value - reference) / max(size, least, 1e-300)
    of_power = errors.get("shaft_power")
    if of_power is not None and errors.get("shaft_torque") is not None:
        errors["shaft_torque"] = of_power + (errors.get("mean_speed") or 0.0)
    return Figures(errors)


def flow_errors(found: Figures, lost: float, by: str = "by_flow") -> Figures:
    """Return the errors of the figures that depend on a flow, given the flow's relative error `lost`.

    `by` is the field by which figures declare that dependence: `by_flow`, `by_oil` … (`outputs.Figure`). They are in
    proportion to the flow; one whose scale is at least the flow is that flow and what comes and goes beside it.
    """
    known = {name: value for name, value in found.items() if value is not None}
    about: Mapping[str, Figure] = getattr(found, "about", {})
    errors: dict[str, float] = {}
    for name, value in known.items():
        figure = about.get(name) or declared(name, found)
        if not getattr(figure, by):
            continue
        size = error_scale(name, figure.scale, known)
        amount = max(abs(value), abs(known.get(FLOW, 0.0))) if figure.scale == OVER_FLOW else abs(value)
        errors[name] = lost * amount / max(size, 1e-300)
    return Figures(errors)


def zeros_for_none(figures: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of figures as `error_scale` needs them: zero for those that are None."""
    return {name: 0.0 if value is None else value for name, value in figures.items()}


def error_of(name: str, size: float, figures: Mapping[str, Any]) -> float:
    """Return the error of a figure, given in its own unit, relative to its `error_scale`."""
    return size / max(error_scale(name, declared(name, figures).scale, zeros_for_none(figures)), 1e-300)


def figures_for_scale(name: str, scale: Scale) -> tuple[str, ...]:
    """Return the figures that `error_scale` needs."""
    return tuple(filter(None, (name, *scale.of, scale.where, TIMES[scale.times])))


def error_scale(name: str, scale: Scale, known: Mapping[str, Any], larger: Callable[[Any, Any], Any] = max) -> Any:
    """Return the scale of a figure's relative error; `known` must have zero for figures that are None.

    For arrays `larger` is numpy's maximum.
    """
    size = abs(known[name])
    if scale.times == "filling":
        filling = abs(known.get("volumetric_efficiency", 0.0))
        size = size * larger(filling, LEAST_FILLING) / (filling + LEAST_FILLING * (filling == 0.0))
    if scale.least:
        least = scale.least * prod([abs(known.get(each, 0.0)) for each in scale.of])
        least = least * (known.get(scale.where, 0.0) != 0.0) if scale.where else least
        size = least if scale.alone else larger(size, least)
    return size * larger(1.0, abs(known.get(TIMES["ideal"], 0.0))) if scale.times == "ideal" else size


def error_in_unit(
    name: str, performance: Mapping[str, Any], errors: Mapping[str, Any], otherwise: float | None = None
) -> float | None:
    """Return the estimated error of a figure in its own unit: `otherwise`, a relative one, replaces a missing estimate.

    None without either. An error is relative to its `error_scale`, which differs from the figure itself for a power, a
    superheat, or a flow beside the net flow.
    """
    relative = errors.get(name)
    relative = otherwise if relative is None else relative
    if relative is None:
        return None
    return float(error_scale(name, declared(name, performance).scale, zeros_for_none(performance)) * relative)


def worst(errors: Figures) -> tuple[str, float]:
    """Return the figure with the largest error, and that error."""
    known = {name: error for name, error in errors.items() if error is not None}
    found = max(known, key=lambda name: known[name], default="")
    return found, known.get(found, 0.0)
