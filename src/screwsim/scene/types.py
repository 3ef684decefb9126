"""A scene: everything that one simulation or sweep needs, typed and in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Generic, NoReturn, TypeVar

from screwsim.effects.base import Effect, PressureLosses
from screwsim.fluid.settings import GasSettings, OilLine, OilSettings, oil_temperature
from screwsim.inputs.arguments import MAPPING, checked_arguments
from screwsim.inputs.declare import FoundWithCycle, choice, number, optional, quantity, word
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.numerics.settings import NumericsSettings
from screwsim.outputs.display import About, Brief

K = TypeVar("K")
V = TypeVar("V")
NO_SUPERHEAT = (
    "0 K is saturated vapour; for wet gas state operation.suction.quality instead, with gas.model: real and "
    "gas.two_phase: equilibrium"
)
STANDARD_ATMOSPHERE = 101325.0  # [Pa], ISO 2533
COVERAGE = 2.0  # standard uncertainties in a tolerance: 95 % of a normal distribution (GUM)
_superheat = partial(
    quantity, "temperature_difference", default=None, ge=0.0, hardly=(None, 150.0), remedy=NO_SUPERHEAT
)


class FixedDict(dict[K, V], Generic[K, V]):
    """A dict of a scene that agrees with its text: any attempt to change it raises TypeError with the remedy."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("a scene cannot be changed: with_ and without return a new one")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = _refuse
    setdefault = update = _refuse  # pyrefly: ignore[bad-override, bad-assignment] - of more forms than one

    def __reduce__(self) -> tuple[Any, ...]:
        return FixedDict, (dict(self),)


@dataclass(frozen=True)
class SuctionState:
    """The state of the suction line; its pressure is stated here or by operation.evaporating_temperature."""

    pressure: float | None = quantity("pressure", "absolute pressure p_s", None, ge=1.0, le=1e9, hardly=(1e3, 1e7))
    temperature: float | None = quantity("temperature", "temperature T_s", None, gt=0.0, le=2500.0, hardly=(4.0, 700.0))
    superheat: float | None = _superheat("superheat above saturation, instead of temperature")
    quality: float | None = number(
        "wet suction: mass fraction of vapour, instead of temperature or superheat (gas.two_phase: equilibrium)",
        None,
        ge=0.0,
        le=1.0,
        hardly=(0.3, None),
    )


@dataclass(frozen=True)
class DischargeState:
    """The state of the discharge line; its pressure is stated here or by operation.condensing_temperature."""

    pressure: float | None = quantity("pressure", "absolute pressure p_d", None, ge=1.0, le=1e9, hardly=(1e3, 4e7))
    temperature: float | None = quantity(
        "temperature",
        "temperature of gas that flows back through the port (default: that of the outflow, iterated)",
        None,
        gt=0.0,
        le=2500.0,
        hardly=(4.0, 800.0),
    )


@dataclass(frozen=True)
class GasCooler:
    """A gas cooler in place of a condenser: above the critical pressure nothing condenses, so two numbers state it."""

    pressure: float = quantity("pressure", "absolute pressure p_d in the gas cooler", ge=1.0, le=1e9, hardly=(1e3, 2e7))
    outlet_temperature: float = quantity(
        "temperature",
        "temperature of the fluid after the gas cooler, for the cooling capacity",
        gt=0.0,
        le=2500.0,
        hardly=(200.0, 400.0),
    )


@dataclass(frozen=True)
class Operation:
    """Speed, surroundings and the states of both lines, by pressures or by saturation temperatures."""

    speed: float = quantity("speed", "speed of the male rotor, or of the crank", None, gt=0.0, otherwise=("tip_speed",))
    tip_speed: float | None = quantity(
        "velocity", "speed of the male rotor's tips, in place of speed (twin_screw)", None, gt=0.0, hardly=(None, 150.0)
    )
    ambient_temperature: float = quantity(
        "temperature",
        "temperature T_0 of the surroundings, reference of the ledger",
        298.15,
        ge=50.0,
        le=1000.0,
        hardly=(200.0, 350.0),
    )
    ambient_pressure: float = quantity(
        "pressure",
        "pressure of the surroundings, reference of gauge pressures such as bar(g) (the default is the standard "
        "atmosphere)",
        STANDARD_ATMOSPHERE,
        ge=1e3,
        le=2e5,
        hardly=(5e4, 1.1e5),
    )
    suction: SuctionState = SuctionState()
    discharge: DischargeState = DischargeState()
    evaporating_temperature: float | None = optional(
        "temperature", "evaporating temperature: dew point at p_s (instead of suction.pressure)"
    )
    condensing_temperature: float | None = optional(
        "temperature",
        "condensing temperature: bubble point, of a blend dew point, at p_d (instead of discharge.pressure)",
    )
    superheat: float | None = _superheat(
        "superheat of the suction gas above evaporating_temperature, which needs it (or suction.quality, for wet "
        "suction)"
    )
    subcooling: float | None = quantity(
        "temperature_difference",
        "subcooling of the liquid below condensing_temperature, for the cooling capacity (default: 0 K)",
        None,
        ge=0.0,
        hardly=(None, 60.0),
    )
    aftercooler_temperature: float | None = quantity(
        "temperature",
        "temperature of the delivered air after an aftercooler, in which its water condenses (with "
        "gas.relative_humidity; for a package: effects.air_package.aftercooler)",
        None,
        ge=273.16,
        le=700.0,
        hardly=(275.0, 350.0),
    )
    gas_cooler: GasCooler | None = None


PUMP, SUMP = "pump", "suction"  # values of `oil_supply.kind` and `.source`


@dataclass(frozen=True)
class OilSupply:
    """How the oil gets into the chamber at 360°."""

    kind: str = choice(
        "pump: the ratio is given; displacement: separator pressure pushes the oil through an orifice",
        (PUMP, "displacement"),
    )
    ratio: float | None = number(
        "d: oil-to-gas mass ratio in the chamber at 360 deg (pump; expander: in the gas that comes in)",
        None,
        ge=0.0,
        hardly=(None, 1000.0),
    )
    discharge_temperature: float | None = oil_temperature(
        "temperature of gas and oil after the discharge port, for which the oil flow is found (M370), in place of ratio"
    )
    flow: float | None = optional("volume_flow", "volume flow of the oil pump, e.g. 60 L/min, in place of ratio (M393)")
    temperature: float | None = oil_temperature("temperature of the injected oil (absent: effects.separator finds it)")
    source: str = choice(
        "where the pump draws from: separator (p_d) or a sump at suction pressure", ("separator", SUMP), "separator"
    )
    orifice_diameter: float | None = optional("length", "bore of the injection orifice (displacement)")
    orifice_length: float | None = optional("length", "length of that bore (default: 2 diameters)")
    orifice_count: float = number("number of such bores", 1.0, gt=0.0, le=1e6, hardly=(None, 100.0))
    line: OilLine | None = None

    @property
    def pumped(self) -> bool:
        """Tell whether a pump delivers the oil; otherwise the discharge pressure displaces it."""
        return self.kind == PUMP

    @property
    def from_sump(self) -> bool:
        """Tell whether the pump draws from a sump at suction pressure rather than from the separator."""
        return self.source == SUMP


CYCLE, ALL = "cycle", "all"  # values of `output.keep` and `.derivatives`


@dataclass(frozen=True)
class Output:
    """What a sweep stores of each point; derivatives are stored for a run as well."""

    keep: str = choice("performance figures only, or the cycle traces as well", ("performance", CYCLE), "performance")
    derivatives: str = choice("derivatives of each point by none or by all numbers of the scene", ("none", ALL), "none")

    @property
    def keeps_cycle(self) -> bool:
        """Tell whether the traces of each point are stored."""
        return self.keep == CYCLE

    @property
    def keeps_slopes(self) -> bool:
        """Tell whether the derivatives of each point are stored."""
        return self.derivatives == ALL


@dataclass(frozen=True)
class ActiveEffect:
    """An effect that the scene names, with its parameters [SI]."""

    effect: Effect
    parameters: Any


@IdentityCache
def parameters_of_type(effects: Mapping[str, ActiveEffect], kind: type) -> dict[str, Any]:
    """Return the parameters of a given type among those of the effects, by effect name."""
    every = ((name, active.parameters) for name, active in effects.items())
    return {name: parameters for name, parameters in every if isinstance(parameters, kind)}


@dataclass(frozen=True)
class Tolerance:
    """Half the interval [SI] that contains the value in 95 of 100 cases; or the factor to either end of the interval.

    If written as `percent` of the value, `size` is that at the scene's own value, and `around` gives that at others.
    """

    size: float
    factor: bool = False
    percent: float | None = None

    @property
    def standard(self) -> float:
        """Standard uncertainty: of the value [SI], or of its logarithm."""
        return math.log(self.size) / COVERAGE if self.factor else self.size / COVERAGE

    def around(self, value: float) -> Tolerance:
        """Return the tolerance of another value [SI] of the same input, such as one of a sweep."""
        return self if self.percent is None else replace(self, size=0.01 * self.percent * abs(value))

    def standard_at(self, value: float) -> float:
        """Return the standard uncertainty [SI] at a value [SI]; for a factor that of small changes."""
        return self.standard * value if self.factor else self.around(value).standard

    def ends(self, value: float) -> tuple[float, float]:
        """Return the ends [SI] of the interval around a value."""
        return (value / self.size, value * self.size) if self.factor else (value - self.size, value + self.size)

    def at(self, value: float, deviation: float) -> float:
        """Return the value [SI] that lies `deviation` standard uncertainties away."""
        return value * math.exp(self.standard * deviation) if self.factor else value + self.standard * deviation


@dataclass(frozen=True)
class Sample:
    """How values were drawn: `over` has (path, ("any", values)) or (path, ("linear" or "log", first, last)) [SI]."""

    kind: str  # sobol, latin_hypercube
    count: int
    seed: int
    over: tuple[tuple[str, tuple[Any, ...]], ...]


@dataclass(frozen=True)
class Joint:
    """Paths that vary together as one dimension of a sweep; results files use its `name`, no `sample` means zipped."""

    name: str
    paths: tuple[str, ...]
    sample: Sample | None = None


@dataclass(frozen=True, repr=False)
class Scene(Brief):
    """One scene. `effects` keeps the order of the catalogue, whatever the order in the file.

    `losses` are those of a package around the machine, where the search for them stands; no file states them.
    """

    machine: Any  # the settings of one kind (`machine.protocol.MachineSettings`)
    gas: GasSettings
    operation: Operation
    oil: OilSettings | None = None
    oil_supply: OilSupply | None = None
    effects: Mapping[str, ActiveEffect] = field(default_factory=dict)
    numerics: NumericsSettings = NumericsSettings()
    output: Output = Output()
    sweep: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)  # dotted path -> values in SI units
    joints: tuple[Joint, ...] = ()  # paths of the sweep that vary together; any other path is an axis by itself
    title: str = word("what is simulated", "")
    text: str = ""  # canonical YAML of the whole scene, overrides included
    folder: str = "."  # files are relative to it
    losses: PressureLosses | None = None
    uncertain: Mapping[str, Tolerance] = field(default_factory=dict)  # dotted path -> tolerance of its value
    correlated: tuple[tuple[str, ...], ...] = ()  # paths whose values err together
    model_error: str = ""  # validation from which the model's error is reported (`scene.model_errors`)

    @property
    def own(self) -> dict[str, str]:
        """User-defined modules that this scene names, and where it names them."""
        if "." not in "".join([self.machine.kind, self.gas.model, self.numerics.integrator, *self.effects]):
            return {}
        named = {"machine.kind": self.machine.kind, "gas.model": self.gas.model}
        named["numerics.integrator"] = self.numerics.integrator
        found = {name: f"{path}: {name}" for path, name in named.items() if "." in name}
        return found | {name: f"effects.{name}" for name in self.effects if "." in name}

    def _about(self) -> About:
        """Return what is printed of the scene: one row per section of its text; of effects only the names."""
        rows = [(name, ", ".join(self.effects) if name == "effects" else text) for name, text in _sections(self.text)]
        return About(f"Scene: {self.title or 'without a title'}", (), ("section", "states"), rows)

    @checked_arguments(values=MAPPING)
    def with_(self, values: Mapping[str, Any] | None = None, /, **more: Any) -> Scene:
        """Return this scene with other values at dotted paths, read and checked as by `--set`; this one is unchanged.

            scene.with_({"operation.speed": "1000 rpm"})        scene.with_(operation__speed="1000 rpm")

        A text is read as in a file, with its unit; None removes a value, 'off' an effect. Raise `SceneError`, with one
        line per fault, or `UsageError`.
        """
        from screwsim.scene.load import changed_scene

        named = {name.replace("__", "."): value for name, value in more.items()}
        return changed_scene(self, {**(values or {}), **named})

    def without(self, *effects: str) -> Scene:
        """Return this scene without some of its effects."""
        from screwsim.scene.load import changed_scene

        return changed_scene(self, {}, effects)


def _sections(text: str) -> list[tuple[str, str]]:
    """Return (name, contents on one line) of each section of a canonical text, except its title."""
    found: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if line[:1].isalpha():
            name, _, rest = line.partition(":")
            found.append((name, [rest.strip()] if rest.strip() else []))
        elif found and line.strip():
            found[-1][1].append(line.strip())
    return [(name, ", ".join(lines).replace(":,", ":")) for name, lines in found if name != "title"]
