"""What an effect is: a declaration of flow paths, plenums, oil ports, heat rates, walls, losses, readings; kernels.

An effect adds to the rates of a chamber and never assigns. It is one file of this package, or of a user's own,
with a module variable `EFFECT`. A kernel's argument names say what it needs: a parameter of the effect itself,
or one of the symbols of docs/reference/nomenclature.md (`phi`, `T`, `m`, `T_oil`, `omega`, `rotor_diameter` …).

Source: screwsim, docs/how-to/adding-an-effect.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, sqrt
from typing import Any, NamedTuple

from screwsim.declare import quantity
from screwsim.faults import Fault
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.separator import Outflow, Separated
from screwsim.fluid.settings import OilProperties
from screwsim.machine.protocol import MachineKind
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.made import Entry
from screwsim.outputs import Figure, Trace


@dataclass(frozen=True)
class Resistance:
    """What holds back the nozzle's flow in a gap between chambers (M190).

    `share` returns the share that passes, 0 to 1, of the nozzle's mass flux `flux` [kg/(m² s)]; it may ask for the
    upstream place's `oil_ratio` and `density` [kg/m³], for numbers of `values`, and for symbols. It must be smooth, and
    flux times share must grow with the flux. `title` says what it is.

    `film`, where given, returns the mass flux of oil [kg/(m² s)] over the gap's area that flows beside the gas's stream
    and the oil in that (M252), at the pressure difference `drop` ≥ 0 [Pa] from the upstream to the downstream place; it
    may ask for the upstream `oil_ratio` and the like, must be smooth, and nothing at no drop and at no oil.

    `drag`, where given, returns the mass flux of oil [kg/(m² s)] that a moving wall takes along, from the leading place
    to the trailing chamber whatever their pressures (M256); it may ask for the leading place's `oil_ratio`, and is
    nothing at no oil. It is that at the mean speed of the rotors, and follows the speed.
    """

    share: Kernel
    values: Mapping[str, float]
    title: str
    film: Kernel | None = None
    drag: Kernel | None = None


@dataclass(frozen=True)
class FlowPath:
    """An opening between a chamber and a plenum, or between two chambers `offset` lobe pitches apart.

    `to` is 'suction', 'discharge', the name of a `Plenum` that an effect of the scene declares, or 'neighbour'.

    `area` returns the cross-section [m²] over the angle `phi` [rad] of the chamber; for two chambers, of the
    trailing one: one area function an interface, so that both sides see the same opening. Beyond the first
    chamber there is no interface, beyond the last one lies the discharge plenum.

    `values` are the numbers [SI] behind the kernel's argument names that are not symbols; `breakpoints` [rad] are the
    angles at which the area is not smooth; `own_breakpoints` those of them that only the chambers of this path feel,
    and not their neighbours; `tables` hold curves as (angle [rad], area [m²]), or with slopes (`numerics.spline`).
    Where `mirror` [rad] is given, the area at `phi` is that of the kernel at mirror − phi (an expander, M150). Only a
    gap ('neighbour') may have a `resistance`.

    `opening` returns the open share of the area of a path to a plenum where that depends on the chamber's state (a
    valve): its arguments are `drop` [Pa], the plenum's pressure less the chamber's, `width` [Pa], below which pressure
    differences may be smoothed, names of the chamber's states, `held` and `values`. A path that is `narrow` never holds
    the chamber's pressure to its plenum's; of ports and valves the widest open one may.

    `one_way` (1: into the chamber, −1: out of it) makes it a switch: the pressure difference tells at the start of a
    step whether it is open, `held` 1 or 0 tells the kernel so, and the step ends where that changes. `held` is FREE
    where no step is held (scipy's integrators), LOOSE where a stored cycle is read (model.slots).

    `law`, where given, is the flow in place of the nozzle's (M12): it returns the mass flux [kg/(m² s)] over the area
    into the chamber, from the numbers of the chamber's own place, `p_1` [Pa], `rho_1` [kg/m³], `h_1` [J/kg],
    `exponent_1` (1/k), `oil_ratio_1` (0 without carried oil), and of the place beyond, `p_2` …; with `width`, `values`
    and symbols. It must be smooth, nothing at equal pressures, and have the sign of p_2 − p_1. Its stream brings what
    the place that it comes from has.
    """

    to: str
    area: Kernel
    values: Mapping[str, float]
    breakpoints: Sequence[float] = ()
    own_breakpoints: Sequence[float] = ()
    offset: int = 0  # lobe pitches from the trailing to the leading chamber
    flow_coefficient: float = 1.0
    tables: Mapping[str, Any] = field(default_factory=dict)
    mirror: float | None = None
    resistance: Resistance | None = None
    opening: Kernel | None = None
    narrow: bool = False
    one_way: int = 0
    law: Kernel | None = None

    def mirrored(self, life: float, pitch: float) -> FlowPath:
        """Return the path of the machine run backwards: angles turned round, both lines exchanged (M150)."""
        mirror = life - self.offset * pitch
        to = {"suction": "discharge", "discharge": "suction"}.get(self.to, self.to)
        breakpoints, own = (tuple(mirror - at for at in each) for each in (self.breakpoints, self.own_breakpoints))
        return replace(self, to=to, mirror=mirror, breakpoints=breakpoints, own_breakpoints=own)


@dataclass(frozen=True)
class Site:
    """What the state of a plenum can be made of (SI units).

    `gas` is the gas model (`screwsim.fluid.real_gas`, `ideal_gas`), `fluid` its CoolProp name; `liquid_enthalpy` is
    that of the real fluid's liquid behind the condenser, `refrigerating_effect` what it takes up in the evaporator
    (M43): None where the scene does not state evaporating and condensing temperature. `T_oil` is that of the oil's
    supply, `oil` has its properties there.
    """

    gas: Any
    fluid: str
    p_s: float
    T_s: float
    p_d: float
    liquid_enthalpy: float | None
    refrigerating_effect: float | None
    T_oil: float | None = None
    oil: OilProperties | None = None


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


Given = Mapping[str, float | str | None]  # figures by name; a text says why there is none
Faults = Iterator[Fault]  # of an effect's `check`


@dataclass(frozen=True)
class Plenum:
    """A reservoir of the working fluid beside the two lines; its state is held constant.

    `state` makes that state, `figures` the effect's own figures of the closed cycle (a text in place of one says why it
    has none), both in plain Python, once a run. `gain` names the one of them by which the cooling capacity grows.
    """

    name: str
    state: Callable[[Site], Reservoir]
    figures: Callable[[Drawn], Given] | None = None
    gain: str = ""
    product: bool = True  # does what it gives count as gas that the machine compresses (M101)


@dataclass(frozen=True)
class OilGas:
    """Gas that oil from a port brings dissolved. Needs an oil port.

    `content(site)` returns what flashes of a kilogram of oil where it enters (M196): by the chamber's pressure, with
    what heat that takes from the oil; the gas has the state of the `plenum`, which the same effect declares. Or it
    returns a solution: what the oil holds is then a state of every chamber, and goes with the oil (M230).
    """

    plenum: str
    content: Callable[[Site], OilContent | OilSolution]


class OilContent(NamedTuple):
    """What flashes [kg per kg of oil] over pressure [Pa], and the heat [J/kg] that it takes from the oil."""

    pressure: Any
    flashed: Any
    latent: float


class OilSolution(NamedTuple):
    """Gas that oil holds dissolved and gives off over time (M230–M233); SI units, per kilogram of oil or of gas.

    `entropy` is that of a kilogram dissolved in oil that holds exp(`log_held`), `slope` its derivative by `log_held`,
    `rest` what all that the oil holds has beyond so much, per kilogram of it. Dissolved gas has one `enthalpy`; oil
    comes with `supply`. `release` and `uptake` [1/s] are the rates at which it approaches equilibrium.
    """

    log_held: Any
    entropy: Any
    slope: Any
    rest: Any
    enthalpy: float
    supply: float
    release: float
    uptake: float


@dataclass(frozen=True)
class OilPort:
    """Oil that enters a chamber continuously, in place of the injection at one angle.

    `flow` returns oil [kg/s] into a chamber at angle `phi` [rad] and pressure `p` [Pa], 0 where it does not face the
    port; `width` [Pa] is that below which pressure differences may be smoothed. `pressure_loss` [Pa] lies between the
    oil's source and the bore, or `pressure` [Pa] is stated there; `closes` [rad] is where the injection ends. Needs
    oil.transport: carried. Where a pump feeds it, `pumped` returns the oil [kg/s] per gas [kg] that a chamber traps, by
    angle alone, for a ratio of one.
    """

    flow: Kernel
    values: Mapping[str, float]
    closes: float
    breakpoints: Sequence[float] = ()
    pressure_loss: float = 0.0
    pumped: Kernel | None = None
    pressure: float | None = None

    def loss(self, source: float) -> float:
        """Return what the oil loses [Pa] between its source at a pressure [Pa] and the bore."""
        return self.pressure_loss if self.pressure is None else source - self.pressure


@dataclass(frozen=True)
class OilRoom:
    """The oil takes room in the chambers (docs/model.md M106). Needs oil.transport: carried.

    `remedy` is what its effect can do where the oil locks a chamber.
    """

    remedy: str = ""


@dataclass(frozen=True)
class ChamberState:
    """A state of its own that an effect gives every chamber, beside those of gas and oil.

    `rate` returns its change [1/s]; its arguments are names of states (`T`, `rho`, `T_oil`, `x_oil`, any effect's own),
    the gas mass `m`, `p`, `V`, `phi` of the chamber, the lines' pressures `p_suction` and `p_discharge`, and `values`.
    A state is measured in a scale of its own, so that 1 is large of it: its errors count against itself, or 0.01 where
    it is less. It begins the first turn at `start`. A `positive` one cannot pass zero.
    """

    name: str
    rate: Kernel
    values: Mapping[str, float]
    start: float = 0.0
    positive: bool = False


@dataclass(frozen=True)
class Stops:
    """Seat and stop of a chamber's state, at 0 and 1, which it meets with impacts and between which it moves.

    `position` and `speed` name states that the same effect declares, neither positive; the speed is the rate of the
    position over a frequency Ω. `push` returns the acceleration at rest over Ω² of the position; its arguments are `p`,
    `p_suction`, `p_discharge`, names of states beyond T and rho, and `values`. `restitution` is the speed after over
    that before an impact, of seat and stop. `remedy` is what to do where it hardly comes to rest.
    """

    position: str
    speed: str
    push: Kernel
    values: Mapping[str, float]
    restitution: tuple[float, float]
    remedy: str = ""


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

    `kept` is what of it stays in the oil as pressure; the rest is dissipated at ambient temperature. With a separator
    all of it heats what comes there, but of a loss that is `friction`, of bearings, seals and gears, what that states.
    """

    figure: str
    power: Callable[[Any], float]
    kept: Callable[[Any], float] | None = None
    friction: bool = False


@dataclass(frozen=True)
class Reading:
    """Figures and traces [SI] read from a closed cycle and its powers; they change nothing of it (plain Python).

    `read` returns the values of `figures`, all losses known, or a text that says why there is none; `traces` curves
    over the points of one pitch (`cycle.pitch.POINTS`), which repeat every pitch. `judge` returns what
    forbids the point (it is `failed`), or an empty text, and warnings of it.
    """

    figures: tuple[str, ...]
    read: Callable[[Any], Given]
    traces: Callable[[Any], Mapping[str, Any]] | None = None
    judge: Callable[[Any], tuple[str, tuple[str, ...]]] | None = None


class LineFlow(NamedTuple):
    """What the chambers give a line over one pitch, at even angles from the youngest chamber's 0° on (SI units).

    `flow` [kg/s] is that of all chambers into the line, its mean that of the turn; `open_volume` [m³] the mean volume
    of what is open to it; p, ρ, and k of isentropic compression are those of the line, without what pulsates.
    """

    flow: Any
    open_volume: float
    p: float
    rho: float
    k: float

    @property
    def sound(self) -> float:
        """Speed of sound [m/s] in the line's gas."""
        return sqrt(self.k * self.p / self.rho)


class Turn(NamedTuple):
    """What a turn of the chambers tells of itself (SI units), of the whole machine and averaged over time.

    `held` are the numbers that the cycle makes, by name, as the turn was integrated with them, `made` the same with
    this turn's images of those declared before. `heat` [W] goes from each wall into the gas, over `conductance` [W/K].
    `gaps` [m] are the stated clearances of the scene's effects, `T_0` is the ambient temperature [K]; `line` tells of
    the flow to a line, `omega` [rad/s] and `pitch` [rad] how fast it repeats. `two_lines`: suction and discharge alone
    give the chambers gas, or take it.
    """

    held: Mapping[str, float]
    made: Mapping[str, float]
    heat: Mapping[str, float]
    conductance: Mapping[str, float]
    gaps: Mapping[str, float]
    T_0: float
    line: Callable[[str], LineFlow]
    omega: float
    pitch: float
    two_lines: bool


@dataclass(frozen=True)
class Made:
    """A number that the cycle makes and that acts back on it, found together with it (docs/explanation/numerics.md).

    Any kernel of the scene can ask for it by the name of its `entry`. `guess` is where it begins; `image` returns what
    a turn makes of it, in plain Python; its fixed point is the answer. It is held at `least`; a cycle that closes there
    has failed, and `beyond` says why and what to do.
    """

    entry: Entry
    guess: Callable[[Site], float]
    image: Callable[[Turn], float]
    least: float = -inf
    beyond: str = ""


@dataclass(frozen=True)
class Wall:
    """A wall that exchanges heat with the gas of the chambers, and not with the oil (M170).

    `conductance` returns α A [W/K] of one chamber; its arguments are symbols (`T`, `m`, `p`, `rho`, `V`, `phi`) or
    `values`. `temperature` [K] is the name of a `Made`, or a number. What the gas gives a wall over a cycle leaves it
    for the surroundings.
    """

    name: str
    conductance: Kernel
    values: Mapping[str, float]
    temperature: str | float


@dataclass(frozen=True)
class Pulsation:
    """The pressure of a line over the angle, made by the cycle: an offset and harmonics of the lobe frequency (M185).

    `to` is 'suction' or 'discharge'; `offset` and `harmonics` name `Made` numbers, over the line's pressure: a_1, b_1,
    a_2 … of cosines and sines, declared one after the other. `shut` tells whether a turn finds the line shut by a check
    valve: nothing passes then, in the mean or ever; `stuck` says why a cycle with that does not close,
    `idle` (with {nothing} for what) what comes of one that does, `swings` that the pressure would fall below none.
    `open_question` returns what the scene leaves open of a cycle, which closed or did not, and what to do; empty where
    it leaves nothing open.
    """

    to: str
    offset: str
    harmonics: tuple[str, ...]
    shut: Callable[[Turn], bool] | None = None
    open_question: Callable[[Turn, bool], str] | None = None
    stuck: str = ""
    idle: str = ""
    swings: str = ""


@dataclass(frozen=True)
class Scaled:
    """The areas of the flow paths of another effect are multiplied by the number of a `Made` (M180).

    Of a `clearance` so is the `gap` that the flow model of the path asks for (M190).
    """

    effect: str
    by: str
    clearance: bool = False


@dataclass(frozen=True)
class Shaft:
    """A speed that is not constant over a pitch (M210–M217).

    `respond` returns the periodic motion of the drive (`machine.drive.response.Response`) under the torque of a closed
    cycle, and raises `NoMotion`; `judge` returns (what forbids that motion, or an empty text; warnings; the relative
    residual of its powers).
    """

    train: Callable[[float], Any]  # of the speed that the scene states
    respond: Callable[[Any], Any]
    judge: Callable[[Any], tuple[str, tuple[str, ...], float]]


@dataclass(frozen=True)
class Separator:
    """Where gas and oil of the discharge line meet and part, and what cools the oil that goes back (M280–M284).

    `balance` returns the temperatures and the cooler's duty that follow from what a cycle gives the separator, and,
    asked whether the supply's temperature is open, how far that is from where the circuit closes.
    """

    balance: Callable[[Outflow, bool], Separated]


@dataclass(frozen=True)
class Intake:
    """What lies between suction line and machine (M160, M161).

    A throttle leaves `pressure_ratio` of the pressure; of what is sucked the share `returned` is delivered gas, mixed
    in before it.
    """

    pressure_ratio: float = 1.0
    returned: float = 0.0


@dataclass(frozen=True)
class SuctionLine:
    """What flows back into the suction line stays in it, mixes with what is sucked in and comes back (M270)."""


@dataclass(frozen=True)
class LineLeak:
    """A leak from the discharge line to the suction line beside the chambers, of an effective area [m²] (M274).

    Needs a `SuctionLine`, to which its gas and oil come. With a `resistance` the share of the nozzle's flow passes that
    this lets (M300); its share alone counts, `values` are further numbers that it asks for.
    """

    area: float
    resistance: Resistance | None = None
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SuctionHeat:
    """Heat [W] that the gas takes up on its way to the machine, by the power of the shaft [W] (M275).

    Needs a `SuctionLine`, into which the warmed gas comes.
    """

    power: Callable[[float], float]


@dataclass(frozen=True)
class InSeparator:
    """Parameters of an effect that asks for the separator's temperature: stated, or found by effects.separator."""

    separator_temperature: float | None = quantity(
        "temperature",
        "of oil and gas in the separator (absent: effects.separator finds it)",
        None,
        ge=150.0,
        le=700.0,
        hardly=(210.0, 450.0),
    )


class CoolsOil:
    """Parameters of an effect that sends the oil back through a cooler, and may find the temperature of its supply."""

    @property
    def outlet(self) -> float | None:
        """Temperature [K] of the oil behind the cooler; None where it is not kept."""
        return None

    @property
    def discharge(self) -> float | None:
        """Temperature [K] of gas and oil at discharge; None where it is not kept."""
        return None


Part = (
    FlowPath | Plenum | OilPort | OilGas | OilRoom | ChamberState | Stops | HeatRate | Wall | Made | Scaled | Pulsation
    | PowerLoss | Reading | Shaft | Separator | Intake | SuctionLine | LineLeak | SuctionHeat
)  # fmt: skip


class Around(NamedTuple):
    """What an effect can ask of a scene before it is composed; SI units. `oil` has density and viscosity.

    `tip_speed` is that of the male rotor, or the mean piston speed.
    """

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

    `figures` are those that it gives where a scene calls for them, `traces` its curves over the angle;
    `warnings(found)` tells from the figures of a cycle what of them hardly can be.

    `build(parameters, machine)` returns its parts; `check(parameters, facts)` returns faults that only the whole scene
    shows. `numbers(parameters, around)` returns numbers behind argument names of its kernels that follow from the
    scene. `needs` is what a machine must offer (`machine.protocol`), of all kinds by default.
    """

    name: str
    title: str
    equations: tuple[str, ...]
    source: str
    parameters: type
    build: Callable[[Any, Any], Sequence[Part]]
    needs_oil: bool = False
    states: tuple[str, ...] = ()
    check: Callable[[Any, Any], Iterable[Fault]] | None = None
    numbers: Callable[[Any, Around], Mapping[str, float]] | None = None
    needs: frozenset[str] = frozenset()
    figures: tuple[Figure, ...] = ()
    traces: tuple[Trace, ...] = ()
    warnings: Callable[[Mapping[str, Any]], Iterable[str]] | None = None

    def fits(self, kind: MachineKind) -> bool:
        """Tell whether a kind of machine can have this effect."""
        return self.needs <= kind.offers
