"""What a simulation gives: the names, units and meanings of all results, and the record that carries them.

One table serves the JSON of `run`, the HDF5 file and the labels of figures. SI units. Figures are the core's own; what
an effect gives it declares itself. A result has those that its scene calls for: one of them without a value is None
(null in JSON, NaN with its fill value in HDF5).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from screwsim import tables
from screwsim.display import Shown, table_html, table_text


class Variable(NamedTuple):
    """Unit (SI, CF style) and meaning of one result."""

    units: str
    long_name: str


TIMES = {"": "", "ideal": "ideal_isothermal_efficiency", "filling": "volumetric_efficiency"}  # figures of factors


@dataclass(frozen=True)
class Scale:
    """What the relative error of a figure is relative to: its size, at the least `least` times the figures `of`.

    `alone`: that, whatever its size. It counts only where the figure `where` is there. `times` is a factor: 'ideal' the
    larger of 1 and the ideal isothermal efficiency; 'filling', of what passes through zero with the net gas flow,
    that by which the volumetric efficiency falls short of 0.1. `unasked`: it has none, as a residual.
    """

    least: float = 0.0
    of: tuple[str, ...] = ()
    alone: bool = False
    where: str = ""
    times: str = ""
    unasked: bool = False


ITSELF = Scale()


class Trace(NamedTuple):
    """A curve of a cycle over the angle: its name, unit (SI, CF style) and meaning."""

    name: str
    units: str
    long_name: str


def over(name: str, alone: bool = False) -> Scale:
    """Return the scale of a figure whose mean may vanish: at the least, or alone, the figure of a name."""
    return Scale(1.0, (name,), alone)


@dataclass(frozen=True)
class Figure:
    """A figure of a result: name, unit (SI, CF style), meaning, and what its estimated error is relative to.

    `needs` are keys of a scene of which one has to be there for the figure to be called for, '.key' of the effect that
    declares it, 'key: word' with that value; several joined by ' and '. `by_flow`: it errs as the net gas flow does.
    `shown` is the unit in which people write it (`engineering.SCALES`), where that is not the one of its SI unit.
    """

    name: str
    units: str
    long_name: str
    scale: Scale = ITSELF
    needs: tuple[str, ...] = ()
    by_flow: bool = False
    shown: str = ""


STATUSES = ("ok", "not_closed", "failed")  # HDF5 stores the index

POWER = Scale(least=1.0, of=("shaft_power",), alone=True, times="ideal")
EFFICIENCY = Scale(least=0.1)
LEAST_OIL = 1e-4  # oil per gas below which its error is that of nothing


def power_figure(name: str, long_name: str, **more: Any) -> Figure:
    """Return the figure of a power [W]: its error counts over the shaft's power or the ideal one."""
    return Figure(name, "W", long_name, POWER, **more)


def efficiency(name: str, long_name: str, **more: Any) -> Figure:
    """Return the figure of an efficiency, shown in percent: its error counts over at least 0.1."""
    return Figure(name, "1", long_name, EFFICIENCY, **more)


def names_of(figures: Iterable[Figure]) -> tuple[str, ...]:
    """Return the names of figures."""
    return tuple(each.name for each in figures)


# what calls for a figure of the core, beside keys of a scene (`figures.called_for`)
OILED, EXPANDED = ("oil_supply",), ("machine.mode: expander",)
HEATED = ("an effect that gives the oil a temperature, such as effects.oil_heat",)
COOLED = ("operation.condensing_temperature and machine.mode: compressor", "operation.gas_cooler")
CHANGED = ("effects.suction_line", "effects.suction_throttle", "effects.bypass.share", "another effect with an Intake")
WALLED = ("effects.wall_heat", "effects.cylinder_heat", "another effect with a Wall")
HELD = ("oil that gives its gas off over time, as effects.refrigerant_solubility.flash_time says",)

HUMID = ("gas.relative_humidity",)
HUMID_PACKAGE = ("gas.relative_humidity and effects.air_package",)
# of what condenses: saturation changes by 15 and more times what the temperature does
CONDENSED = Scale(15.0, ("water_flow",))

_oiled, _cooled, _changed = (partial(Figure, needs=needs) for needs in (OILED, COOLED, CHANGED))
_humid = partial(Figure, needs=HUMID)
_CORE = (
    efficiency("isothermal_efficiency", "isothermal efficiency of the shaft power", by_flow=True),
    efficiency(
        "ideal_isothermal_efficiency",
        "ideal-gas isothermal power at suction temperature over shaft power",
        by_flow=True,
    ),
    efficiency("isentropic_efficiency", "isentropic efficiency of the shaft power", by_flow=True),
    efficiency("volumetric_efficiency", "volumetric efficiency", by_flow=True),
    Figure("gas_mass_flow", "kg s-1", "net gas mass flow from the suction line", Scale(times="filling"), by_flow=True),
    _oiled("oil_mass_flow", "kg s-1", "injected oil mass flow", Scale(LEAST_OIL, ("gas_mass_flow",))),
    _oiled(
        "oil_ratio",
        "1",
        "oil to gas mass ratio in the chamber at 360 degrees (rotors: where suction closes; oil_injection: its end)",
        Scale(LEAST_OIL),
    ),
    _oiled("oil_flow_ratio", "1", "injected oil over net suction gas", Scale(LEAST_OIL, times="filling"), by_flow=True),
    power_figure("indicated_power", "indicated power"),
    power_figure("oil_lift_power", "power that lifts the oil to discharge, beside the indicated power", needs=OILED),
    power_figure("shaft_power", "shaft power"),
    Figure("shaft_torque", "N m", "mean torque at the shaft: shaft power over speed", Scale(times="ideal")),
    Figure("discharge_temperature", "K", "flow-weighted mean gas temperature at discharge"),
    Figure("oil_discharge_temperature", "K", "flow-weighted mean oil temperature at discharge", needs=HEATED),
    Figure("peak_pressure", "Pa", "highest chamber pressure up to the widest opening of the discharge port"),
    Figure("work_per_cycle", "J", "work on the gas of one chamber per cycle, minus the integral of p dV"),
    Figure("trapped_mass", "kg", "gas mass in a chamber at 360 degrees (rotors: where suction closes)"),
    _oiled(
        "injection_pressure",
        "Pa",
        "chamber pressure where oil is injected: at 360 degrees (rotors: where suction closes; oil_injection: mean)",
    ),
    Figure("suction_pressure", "Pa", "pressure of the suction line"),
    Figure("suction_temperature", "K", "temperature of the suction line"),
    Figure("discharge_pressure", "Pa", "pressure of the discharge line, in a package before its separator element"),
    Figure("pressure_ratio", "1", "pressure of the discharge line over that of the suction line (expander: inverse)"),
    Figure("displacement", "m3", "swept volume of all chambers in a revolution of the male rotor or the crank"),
    Figure("displacement_flow", "m3 s-1", "displacement times speed"),
    Figure(
        "built_in_volume_ratio",
        "1",
        "chamber volume where suction closes over that where the discharge port opens (profiles: as stated)",
        needs=("machine.kind: twin_screw",),
    ),
    Figure("specific_power", "W s m-3", "shaft power over the volume flow of suction gas", by_flow=True),
    _cooled(
        "cooling_capacity",
        "W",
        "cooling capacity: net gas flow times the real fluid's refrigerating effect",
        by_flow=True,
    ),
    _cooled("cop", "1", "coefficient of performance: cooling capacity over shaft power", by_flow=True),
    _cooled("volumetric_cooling_capacity", "J m-3", "cooling capacity over the volume flow of suction gas"),
    _changed("intake_pressure", "Pa", "pressure of what the machine sucks, behind filter, valve, throttle and bypass"),
    _changed("intake_temperature", "K", "temperature of what the machine sucks, with all that is mixed in"),
    _humid("humidity_ratio", "1", "water vapour per dry air in the suction line"),
    _humid("pressure_dew_point", "K", "dew point of the delivered air at discharge pressure"),
    _humid("lowest_safe_oil_temperature", "K", "pressure dew point and gas.dew_point_margin: of gas and oil, at least"),
    _humid(
        "water_flow",
        "kg s-1",
        "water that the net gas flow brings",
        Scale(times="filling"),
        by_flow=True,
        shown="kg h-1",
    ),
    _humid(
        "condensate_flow",
        "kg s-1",
        "water that condenses where gas and oil have mixed, in the separator (dry machine: at discharge temperature)",
        CONDENSED,
        shown="kg h-1",
    ),
    _humid("vapour_flow", "kg s-1", "water that leaves as vapour behind the separator", CONDENSED, shown="kg h-1"),
    Figure(
        "aftercooler_condensate_flow",
        "kg s-1",
        "water that condenses in the aftercooler",
        CONDENSED,
        ("operation.aftercooler_temperature", "gas.relative_humidity and effects.air_package.aftercooler"),
        shown="kg h-1",
    ),
    Figure(
        "package_vapour_flow",
        "kg s-1",
        "water that leaves as vapour at the package's outlet",
        CONDENSED,
        HUMID_PACKAGE,
        shown="kg h-1",
    ),
    Figure("package_dew_point", "K", "dew point of the air at the package's outlet", needs=HUMID_PACKAGE),
    _humid(
        "chamber_condensate_share",
        "1",
        "largest share of the water trapped in a chamber that is liquid",
        Scale(1.0, alone=True, unasked=True),
    ),
    _humid(
        "water_residual",
        "1",
        "water that comes less what leaves as vapour and condensate, over what comes",
        Scale(1.0, alone=True, unasked=True),
    ),
    power_figure("output_power", "power that an expander gives at its shaft", needs=EXPANDED),
    Figure(
        "filling_factor",
        "1",
        "net gas flow of an expander over that which fills its chambers at the inlet's closing",
        needs=EXPANDED,
    ),
    Figure("wall_heat", "W", "net heat from walls into the gas", POWER, WALLED),
    Figure(
        "discharge_dissolved_gas_ratio",
        "1",
        "refrigerant dissolved in oil that leaves to discharge, per oil",
        needs=HELD,
    ),
)
PERFORMANCE = {figure.name: figure for figure in _CORE}  # the core's own; effects declare theirs

_STAGES = (  # of two stages in a row
    Figure("intermediate_pressure", "Pa", "pressure between both stages, of the first one's discharge line"),
    Figure("second_suction_temperature", "K", "temperature of what the second stage sucks"),
    Figure("intercooler_heat", "W", "heat taken from the gas between both stages"),
    Figure("vapour_mass_flow", "kg s-1", "vapour of the flash tank that mixes in between both stages"),
    Figure("gas_mass_flow", "kg s-1", "net mass flow that the first stage sucks"),
    Figure("first_shaft_power", "W", "shaft power of the first stage"),
    Figure("second_shaft_power", "W", "shaft power of the second stage"),
    Figure("shaft_power", "W", "shaft power of both stages"),
    Figure("first_separator_temperature", "K", "temperature of gas and oil in the separator of the first stage"),
    Figure("second_separator_temperature", "K", "temperature of gas and oil in the separator of the second stage"),
    Figure("first_oil_cooler_duty", "W", "heat that the oil cooler of the first stage takes, its supply as stated"),
    Figure("second_oil_cooler_duty", "W", "heat that the oil cooler of the second stage takes, its supply as stated"),
    Figure("first_pressure_ratio", "1", "pressure ratio of the first stage"),
    Figure("second_pressure_ratio", "1", "pressure ratio of the second stage"),
    Figure("discharge_temperature", "K", "flow-weighted mean gas temperature at discharge of the second stage"),
    efficiency("isothermal_efficiency", "isothermal efficiency of the whole"),
    efficiency("ideal_isothermal_efficiency", "isothermal efficiency of the whole, with an ideal gas's work"),
    efficiency("isentropic_efficiency", "isentropic efficiency of the whole, without cooling between the stages"),
    Figure("cooling_capacity", "W", "cooling capacity of the whole"),
    Figure("cop", "1", "coefficient of performance of the whole"),
    Figure("flow_mismatch", "1", "what comes to the second stage against what it takes, relative difference"),
)
STAGES = {figure.name: figure for figure in _STAGES}

BALANCE = {
    "mass": Variable("1", "relative residual of the gas mass balance"),
    "energy": Variable("1", "relative residual of the energy balance"),
    "entropy": Variable("1", "relative residual of the entropy balance: of the ledger, over shaft power and losses"),
    "oil_mass": Variable("1", "relative residual of the oil mass balance (oil.transport: carried)"),
    "oil_residue": Variable(
        "W", "heat taken up by the oil beyond what injected oil carries to discharge (oil.transport: paper)"
    ),
    "drive": Variable("1", "relative residual of the drive's powers: motor, coupling, shaft"),
    "bound": Variable("1", "bound on the residuals of mass, energy and entropy"),
}

NUMERICS = {
    "rtol": Variable("1", "relative tolerance of a step"),
    "turns": Variable("1", "chamber lives integrated until closed (coupled chambers: pitches over chambers alive)"),
    "steps": Variable("1", "accepted integration steps"),
    "rhs_evaluations": Variable("1", "evaluations of the right-hand side of one chamber, those for Jacobians included"),
    "jacobians": Variable("1", "Jacobians of one chamber"),
    "wall_time": Variable("s", "time of the solution alone, compiled and warm"),
    "estimating_time": Variable("s", "time of estimating the errors, on top of the solution"),
}
NUMERICS_TEXT = {"integrator": "integrator", "closing": "way in which the cycle was closed"}

CYCLE = {
    "angle": Variable("degree", "angle of the male rotor, or of the crank"),
    "volume": Variable("m3", "chamber volume"),
    "pressure": Variable("Pa", "chamber pressure"),
    "gas_temperature": Variable("K", "gas temperature"),
    "oil_temperature": Variable("K", "oil temperature"),
    "gas_mass": Variable("kg", "gas mass in the chamber"),
    "oil_mass": Variable("kg", "oil mass in the chamber"),
    "dissolved_gas_ratio": Variable("1", "refrigerant dissolved in the chamber's oil, per oil"),
    "work": Variable("J", "work on the gas since 0 degrees"),
}


LEDGER = {
    "ambient_temperature": Variable("K", "ambient temperature of the ledger"),
    "shaft_power": Variable("W", "shaft power"),
    "gas_exergy_rise": Variable("W", "exergy rise of the delivered gas from suction to discharge state"),
    "oil_exergy_rise": Variable("W", "exergy rise of the oil from its supply to discharge"),
    "exergy_destroyed": Variable("W", "exergy destroyed by all effects together"),
    "residue": Variable("W", "shaft power less exergy rises and exergy destroyed: numerical"),
    "relative_residue": Variable("1", "residue of the ledger over shaft power"),
}
LEDGER_ENTRY = {  # of each effect, `<name>_<effect>`
    "gas_moved": Variable("kg s-1", "gas moved"),
    "energy_moved": Variable("W", "energy moved"),
    "entropy_generated": Variable("W K-1", "entropy generated"),
    "exergy_destroyed": Variable("W", "exergy destroyed"),
}

KNOCK_OUT_STATUSES = (*STATUSES, "needed")  # the scene cannot do without the effect
KNOCK_OUT = {  # of each effect that is left out, with what that changes
    name: Variable(units, f"{meaning} without the effect")
    for name, units, meaning in (
        ("shaft_power", "W", "shaft power"),
        ("specific_work", "J kg-1", "shaft power over net gas flow"),
        ("cooling_capacity", "W", "cooling capacity"),
        ("cop", "1", "coefficient of performance"),
    )
}
KNOCK_OUT |= {
    f"change_of_{name}": each._replace(long_name=f"{each.long_name}, less that with it")
    for name, each in KNOCK_OUT.items()
}


def ledger_variable(name: str) -> Variable:
    """Return unit and meaning of a ledger's total, or of an entry `<quantity>_<effect>`."""
    if name in LEDGER:
        return LEDGER[name]
    quantity = next(quantity for quantity in LEDGER_ENTRY if name.startswith(f"{quantity}_"))
    units, meaning = LEDGER_ENTRY[quantity]
    return Variable(units, f"{meaning}, {name.removeprefix(f'{quantity}_').replace('_', ' ')}")


def ledger_entries(ledger: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return {effect: {quantity: value}} of a ledger, in its order."""
    entries: dict[str, dict[str, Any]] = {}
    for name, value in ledger.items():
        for quantity in LEDGER_ENTRY:
            if name not in LEDGER and name.startswith(f"{quantity}_"):
                entries.setdefault(name.removeprefix(f"{quantity}_"), {})[quantity] = value
    return entries


def sorted_entries(ledger: Mapping[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return the entries of a ledger by the exergy that they destroy, the dearest first."""
    return sorted(ledger_entries(ledger).items(), key=lambda entry: -float(entry[1]["exergy_destroyed"]))


def cycle_variable(name: str) -> Variable:
    """Return unit and meaning of a cycle trace, of flow paths too (`mass_flow_<effect>[_leading]`, `oil_flow_…`)."""
    if name.startswith("mass_flow_"):
        return Variable("kg s-1", f"mass flow into the chamber, {name.removeprefix('mass_flow_').replace('_', ' ')}")
    if name.startswith("oil_flow_"):
        gap = name.removeprefix("oil_flow_").replace("_", " ")
        return Variable("kg s-1", f"oil that flows into the chamber without gas, {gap}")
    return CYCLE.get(name) or Variable("1", name.replace("_", " "))


class Figures(dict[str, Any]):
    """A mapping whose names are attributes too: `result.performance.isothermal_efficiency`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"no figure {name!r}; known: {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        """Return the figures beside the methods: what an editor completes."""
        return sorted({*super().__dir__(), *self})


def shown(figures: Mapping[str, Any]) -> list[Shown]:
    """Return figures as they are shown, with what is declared of each where that is known."""
    about: Mapping[str, Figure] = getattr(figures, "about", PERFORMANCE)
    found = []
    for name, value in figures.items():
        each = about.get(name) or PERFORMANCE.get(name) or Figure(name, "1", "")
        found.append(Shown(name, value, each.units, each.long_name, each.shown, each.scale == EFFICIENCY))
    return found


@dataclass(frozen=True)
class Result:
    """One simulated operating point; every mapping has the names of the tables above.

    `cycle` holds arrays of one length over `angle` [degree]; empty when the run failed before a whole life.
    `notes` say why a figure is None although its effect is simulated. `failure_angle` is in degrees.
    """

    status: str
    message: str = ""
    warnings: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    performance: Figures = field(default_factory=Figures)
    balance: Figures = field(default_factory=Figures)
    error: Figures = field(default_factory=Figures)
    numerics: Figures = field(default_factory=Figures)
    notes: Mapping[str, str] = field(default_factory=dict)
    cycle: Mapping[str, np.ndarray] = field(default_factory=dict)
    ledger: Figures = field(default_factory=Figures)  # empty without the cycle
    knock_out: tuple[Figures, ...] = ()  # what leaving each effect out changes, where it was asked for
    uncertainty: Mapping[str, Any] = field(default_factory=dict)  # of the inputs, where the scene gives tolerances

    @property
    def told(self) -> str:
        """How it ended, in words: `not closed: …`."""
        return f"{self.status.replace('_', ' ')}: {self.message}"

    def lacks(self, names: Iterable[str]) -> list[str]:
        """Return why it has no figures of these names, a text for each that it does not have."""
        none = (name for name in names if self.performance.get(name) is None)
        return [f"no {name}: {self.notes.get(name, 'it is not simulated')}" for name in none]

    def __repr__(self) -> str:
        return f"Result: {self.told if self.message else self.status}\n{table_text(shown(self.performance))}".rstrip()

    def _repr_html_(self) -> str:
        """Return what a notebook shows: how it ended, warnings, and all figures with units and meanings."""
        heading = self.told if self.message else self.status
        return table_html(heading, [f"warning: {text}" for text in self.warnings], shown(self.performance))

    def to_pandas(self) -> Any:
        """Return the cycle as a pandas.DataFrame over the angle [degree], SI units; figures are in its `attrs`."""
        return tables.frame(self.cycle, dict(self.performance))

    def to_xarray(self) -> Any:
        """Return figures and cycle as an xarray.Dataset, units and meanings as attributes."""
        about = {each.name: Variable(each.units, each.long_name) for each in shown(self.performance)}
        return tables.dataset(self.performance, about, self.cycle, {name: cycle_variable(name) for name in self.cycle})

    def as_json(self) -> dict[str, Any]:
        """Return what `run --json` prints (the cycle stays in the HDF5 file)."""
        asked: dict[str, Any] = {"knock_out": [dict(cost) for cost in self.knock_out]} if self.knock_out else {}
        asked |= {"uncertainty": dict(self.uncertainty)} if self.uncertainty else {}
        return {
            "status": self.status,
            "message": self.message,
            "warnings": list(self.warnings),
            "effects": list(self.effects),
            "states": list(self.states),
            "performance": dict(self.performance),
            "balance": dict(self.balance),
            "error": dict(self.error),
            "ledger": dict(self.ledger),
            "numerics": dict(self.numerics),
            "notes": dict(self.notes),
            **asked,
        }
