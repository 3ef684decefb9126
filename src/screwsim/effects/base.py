"""What an effect is: a declaration of flow paths, plenums, oil ports, heat rates, power losses, readings; kernels.

An effect adds to the rates of a chamber and never assigns. It is one file of this package, or of a user's own,
with a module variable `EFFECT`. A kernel's argument names say what it needs: a parameter of the effect itself,
or one of the symbols of docs/nomenclature.md (`phi`, `T`, `m`, `T_oil`, `omega`, `rotor_diameter` …).

Source: screwsim, docs/adding-an-effect.md.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from screwsim.faults import Fault
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.settings import OilProperties
from screwsim.numerics.kernel import Kernel


@dataclass(frozen=True)
class FlowPath:
    """An opening between a chamber and a plenum, or between two chambers `offset` lobe pitches apart.

    `to` is 'suction', 'discharge', the name of a `Plenum` that an effect of the scene declares, or 'neighbour'.

    `area` returns the cross-section [m²] over the angle `phi` [rad] of the chamber; for two chambers, of the
    trailing one: one area function an interface, so that both sides see the same opening. Beyond the first
    chamber there is no interface, beyond the last one lies the discharge plenum.

    `values` are the numbers [SI] behind the kernel's argument names that are not symbols; `knots` [rad] are
    the angles at which the area is not smooth; `own_knots` those of them that only the chambers of this path feel, and
    not their neighbours; `tables` hold curves as (angle [rad], area [m²]), or with slopes (`numerics.spline`). Where
    `mirror` [rad] is given, the area at `phi` is that of the kernel at mirror − phi (an expander, M150).
    """

    to: str
    area: Kernel
    values: Mapping[str, float]
    knots: Sequence[float] = ()
    own_knots: Sequence[float] = ()
    offset: int = 0  # lobe pitches from the trailing to the leading chamber
    flow_coefficient: float = 1.0
    tables: Mapping[str, Any] = field(default_factory=dict)
    mirror: float | None = None

    def mirrored(self, life: float, pitch: float) -> FlowPath:
        """Return the path of the machine run backwards: angles turned round, both lines exchanged (M150)."""
        mirror = life - self.offset * pitch
        to = {"suction": "discharge", "discharge": "suction"}.get(self.to, self.to)
        knots, own = (tuple(mirror - knot for knot in each) for each in (self.knots, self.own_knots))
        return replace(self, to=to, mirror=mirror, knots=knots, own_knots=own)


@dataclass(frozen=True)
class Site:
    """What the state of a plenum can be made of (SI units).

    `gas` is the gas model (`screwsim.fluid.real_gas`, `ideal_gas`), `fluid` its CoolProp name; `liquid_enthalpy` is
    that of the real fluid's liquid behind the condenser, `refrigerating_effect` what it takes up in the evaporator
    (M43): None where the scene does not state evaporating and condensing temperature.
    """

    gas: Any
    fluid: str
    p_s: float
    T_s: float
    p_d: float
    liquid_enthalpy: float | None
    refrigerating_effect: float | None


@dataclass(frozen=True)
class Drawn:
    """What a plenum gave during the closed cycle: net mass flows [kg/s] from it and from the suction line."""

    flow: float
    suction_flow: float
    reservoir: Reservoir
    site: Site

    @property
    def ratio(self) -> float | None:
        """Flow from the plenum over suction flow; None where nothing is sucked in."""
        return self.flow / self.suction_flow if self.suction_flow > 0.0 else None


@dataclass(frozen=True)
class Plenum:
    """A reservoir of the working fluid beside the two lines; its state is held constant.

    `state` makes that state, `figures` the effect's own figures of the closed cycle (names of `outputs.PERFORMANCE`),
    both in plain Python, once a run.
    """

    name: str
    state: Callable[[Site], Reservoir]
    figures: Callable[[Drawn], Mapping[str, float | None]] | None = None


@dataclass(frozen=True)
class OilPort:
    """Oil that enters a chamber continuously, in place of the injection at one angle.

    `flow` returns oil [kg/s] into a chamber at angle `phi` [rad] and pressure `p` [Pa], 0 where it does not face the
    port; `width` [Pa] is that below which pressure differences may be smoothed. `pressure_loss` [Pa] lies between the
    oil's source and the bore, `closes` [rad] is where the injection ends. Needs oil.transport: carried.
    """

    flow: Kernel
    values: Mapping[str, float]
    closes: float
    knots: Sequence[float] = ()
    pressure_loss: float = 0.0


@dataclass(frozen=True)
class OilRoom:
    """The oil takes room in the chambers (docs/model.md M106). Needs oil.transport: carried."""


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
class Reading:
    """Figures and traces [SI] read from a closed cycle and its powers; they change nothing of it (plain Python).

    `read` returns the values of `figures`, all losses known; `traces` curves over the points of one pitch
    (`model.pitch.POINTS`), which repeat every pitch.
    """

    figures: tuple[str, ...]
    read: Callable[[Any], Mapping[str, float | None]]
    traces: Callable[[Any], Mapping[str, Any]] | None = None


@dataclass(frozen=True)
class Shaft:
    """A speed that is not constant over a pitch (M210–M217).

    `respond` returns the periodic motion of the drive (`machine.drive.response.Response`) under the torque of a closed
    cycle, and raises `NoMotion`; `judge` returns (what forbids that motion, or an empty text; warnings; the relative
    residue of its powers).
    """

    train: Callable[[float], Any]  # of the speed that the scene states
    respond: Callable[[Any], Any]
    judge: Callable[[Any], tuple[str, tuple[str, ...], float]]


@dataclass(frozen=True)
class Intake:
    """What lies between suction line and machine (M160, M161).

    A throttle leaves `pressure_ratio` of the pressure; the share `returned` of the delivered gas is mixed in before it.
    """

    pressure_ratio: float = 1.0
    returned: float = 0.0


Part = FlowPath | Plenum | OilPort | OilRoom | HeatRate | PowerLoss | Reading | Shaft | Intake


class Around(NamedTuple):
    """What an effect can ask of a scene before it is composed; SI units. `oil` has density and viscosity."""

    fluid: str
    p_s: float
    T_s: float
    p_d: float
    tip_speed: float
    T_oil: float | None = None
    oil: OilProperties | None = None


@dataclass(frozen=True)
class Effect:
    """One physical effect, named in a scene under `effects`.

    `build(parameters, machine)` returns its parts; `check(parameters, facts)` returns faults that only the whole scene
    shows. `numbers(parameters, around)` returns numbers behind argument names of its kernels that follow from the
    scene.
    """

    name: str
    title: str
    equations: tuple[str, ...]
    source: str
    parameters: type
    build: Callable[[Any, Any], Sequence[Part]]
    needs_oil: bool = False
    states: tuple[str, ...] = ()
    check: Callable[[Any, Any], list[Fault]] | None = None
    numbers: Callable[[Any, Around], Mapping[str, float]] | None = None
