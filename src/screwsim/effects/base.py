"""What an effect is: a declaration of flow paths, heat rates and power losses, and their kernels.

An effect adds to the rates of a chamber and never assigns. It is one file of this package, or of a user's own,
with a module variable `EFFECT`. A kernel's argument names say what it needs: a parameter of the effect itself,
or one of the symbols of docs/nomenclature.md (`phi`, `T`, `m`, `T_oil`, `omega`, `rotor_diameter` …).

Source: screwsim, docs/adding-an-effect.md.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from screwsim.faults import Fault
from screwsim.numerics.kernel import Kernel


@dataclass(frozen=True)
class FlowPath:
    """An opening between a chamber and a plenum, or between two chambers `offset` lobe pitches apart.

    `area` returns the cross-section [m²] over the angle `phi` [rad] of the chamber; for two chambers, of the
    trailing one: one area function an interface, so that both sides see the same opening. Beyond the first
    chamber there is no interface, beyond the last one lies the discharge plenum.

    `values` are the numbers [SI] behind the kernel's argument names that are not symbols; `knots` [rad] are
    the angles at which the area is not smooth; `own_knots` those of them that only the chambers of this path feel, and
    not their neighbours; `tables` hold curves as (angle [rad], area [m²]), or with slopes (`numerics.spline`).
    """

    to: str  # 'suction' | 'discharge' | 'neighbour'
    area: Kernel
    values: Mapping[str, float]
    knots: Sequence[float] = ()
    own_knots: Sequence[float] = ()
    offset: int = 0  # lobe pitches from the trailing to the leading chamber
    flow_coefficient: float = 1.0
    tables: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class HeatRate:
    """Heat [W] from the oil to the gas; the kernel's arguments are symbols or `values`.

    `oil_factor` multiplies the heat that the oil gives away (1: energy is conserved).
    """

    kernel: Kernel
    values: Mapping[str, float]
    oil_factor: str = "one"  # 'one' | 'printed': the misprint of the paper's eq. (12)


@dataclass(frozen=True)
class PowerLoss:
    """Power [W] beside the gas work, from figures of the closed cycle (plain Python, once a run).

    `kept` is what of it stays in the oil as pressure; the rest is dissipated at ambient temperature.
    """

    figure: str
    power: Callable[[Any], float]
    kept: Callable[[Any], float] | None = None


@dataclass(frozen=True)
class Effect:
    """One physical effect, named in a scene under `effects`.

    `build(parameters, machine)` returns flow paths, heat rates and power losses; `check(parameters, facts)`
    returns faults that only the whole scene shows.
    """

    name: str
    title: str
    equations: tuple[str, ...]
    source: str
    parameters: type
    build: Callable[[Any, Any], Sequence[FlowPath | HeatRate | PowerLoss]]
    needs_oil: bool = False
    states: tuple[str, ...] = ()
    check: Callable[[Any, Any], list[Fault]] | None = None
