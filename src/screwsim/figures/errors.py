"""Numerical errors of performance figures, each relative to what its declaration says (contract: error)."""

from collections.abc import Callable, Mapping
from math import prod
from typing import Any

from screwsim.figures.registry import declared
from screwsim.outputs import ITSELF, POWER, TIMES, Figure, Figures, Scale

LEAST_FILLING = 0.1  # volumetric efficiency below which the net gas flow counts as passing through zero


def relative_errors(found: Figures, better: Figures, least_power: float = 0.0, least_work: float = 0.0) -> Figures:
    """Return |found − better| of every figure over its `error_scale`; None where either is, or none is asked for.

    Powers [W] and work [J] below the least ones are rounding. Where the better one is exactly nothing, as the flow of a
    machine that sucks nothing, the scale is that of the other.
    """
    known = {name: 0.0 if value is None else value for name, value in better.items()}
    errors: dict[str, float | None] = dict.fromkeys(found)
    about: Mapping[str, Figure] = getattr(found, "about", {})
    of_powers: float | None = None  # they share one scale
    for name, value in found.items():
        if value is None or (reference := better.get(name)) is None:
            continue
        scale = (about.get(name) or declared(name, found)).scale
        if scale is ITSELF:  # most of them
            size = abs(reference) or abs(value)
        elif scale.unasked:
            continue
        elif scale.alone and scale.times:  # a power
            if of_powers is None:
                of_powers = max(error_scale(name, scale, known), 1e-300, least_power)
            errors[name] = abs(value - reference) / of_powers
            continue
        else:
            size = error_scale(name, scale, known)
            if size == 0.0:
                size = error_scale(name, scale, {of: each or 0.0 for of, each in found.items()})
        least = least_work if name == "work_per_cycle" else 1e-300
        errors[name] = abs(value - reference) / (size if size > least and size > 1e-300 else max(size, least, 1e-300))
    of_power = errors.get("shaft_power")
    if of_power is not None and errors.get("shaft_torque") is not None:
        errors["shaft_torque"] = of_power + (errors.get("mean_speed") or 0.0)
    return Figures(errors)


def flow_errors(found: Figures, lost: float, by: str = "by_flow") -> Figures:
    """Return what a relative error of a flow, `lost`, makes of the figures that are declared to err as it does.

    `by` names what they declare: `by_flow`, `by_oil` … (`outputs.Figure`).
    """
    known = {name: value for name, value in found.items() if value is not None}
    about: Mapping[str, Figure] = getattr(found, "about", {})
    sizes: dict[str, float] = {}
    of_powers: float | None = None  # they share one scale
    for name, value in known.items():
        each = about.get(name) or declared(name, found)
        if not getattr(each, by):
            continue
        if each.scale is not POWER:
            size = error_scale(name, each.scale, known)
        elif of_powers is None:
            size = of_powers = error_scale(name, each.scale, known)
        else:
            size = of_powers
        sizes[name] = lost * abs(value) / max(size, 1e-300)
    return Figures(sizes)


def error_of(name: str, size: float, figures: Mapping[str, Any]) -> float:
    """Return what an error of a figure in its own unit is relative to its `error_scale`."""
    known = {each: 0.0 if value is None else value for each, value in figures.items()}
    return size / max(error_scale(name, declared(name, figures).scale, known), 1e-300)


def needed(name: str, scale: Scale) -> tuple[str, ...]:
    """Return the figures that `error_scale` asks for."""
    return tuple(filter(None, (name, *scale.of, scale.where, TIMES[scale.times])))


def error_scale(name: str, scale: Scale, known: Mapping[str, Any], larger: Callable[[Any, Any], Any] = max) -> Any:
    """Return what the relative error of a figure is relative to; figures that are None count as zero in `known`.

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
    """Return the estimated error of a figure in its own unit; by a relative one, or None, where none is estimated.

    An error is relative to its `error_scale`, which is another than the figure itself of a power, a superheat, a flow
    beside the net one.
    """
    relative = errors.get(name)
    relative = otherwise if relative is None else relative
    if relative is None:
        return None
    known = {each: 0.0 if value is None else value for each, value in performance.items()}
    return float(error_scale(name, declared(name, performance).scale, known) * relative)


def worst(errors: Figures) -> tuple[str, float]:
    """Return the figure of the largest error, and that error."""
    found, largest = "", 0.0
    for name, error in errors.items():
        if error is not None and (error > largest or not found):
            found, largest = name, error
    return found, largest
