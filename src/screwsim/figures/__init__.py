"""Figures that a scene calls for (`registry`), their numerical errors (`errors`) and their customary units."""

from screwsim.figures.registry import (
    Performance,
    called_for,
    declaration,
    declared,
    figures_declared_elsewhere,
    known,
    known_traces,
    merged,
    needs_of,
    packed,
    scale_of,
    trace_variable,
    unpacked,
)
