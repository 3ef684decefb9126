"""Energy of an air package over a profile of demands: hours at flows of free air (M470).

Between the points of a package of variable speed its power is interpolated over the flow. Below the lowest point, or
below full flow at fixed speed, the package loads and unloads; one without an unloaded point stops in between.
"""

import re
from collections.abc import Iterator, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.numerics.pchip import Pchip
from screwsim.outputs.customary import HOUR, MINUTE
from screwsim.outputs.us_units import CFM, FOOT
from screwsim.scene.units import NUMBER, Refused, parse_quantity, refused_at
from screwsim.study.datasheet.air_points import Point
from screwsim.study.datasheet.air_rating import Rating
from screwsim.study.datasheet.load_unload import OPTION as RECEIVER
from screwsim.study.datasheet.load_unload import PATH as UNLOADED_POINT
from screwsim.study.datasheet.load_unload import LoadUnload, Receiver
from screwsim.study.datasheet.motor_starts import IN_WORDS, USUAL_POLES, most_starts
from screwsim.study.datasheet.motor_starts import SOURCE as STARTS_SOURCE
from screwsim.study.datasheet.sheet import Table
from screwsim.study.datasheet.units import METRIC

OPTION = "--profile"
KWH, WHOLE = 3.6e6, 8760.0  # J, h
DEMAND_TOLERANCE = 1e-3  # of full flow: excess of a demand that still counts as met
_FLOW = re.compile(r"flow\s*\[([^\]]+)\]")
_EXAMPLE = "a first line 'flow [m^3/min], hours', then e.g. '6.5, 2000'"


class Demand(NamedTuple):
    """A flow of free air [m³/s], or a share of the full flow, demanded for so many hours."""

    flow: float
    hours: float
    of_full: bool = False

    def of(self, full: float) -> "Demand":
        """Return the demand as a flow [m³/s] on a package of a full flow [m³/s]."""
        return Demand(self.flow * full, self.hours) if self.of_full else self


class DemandShare(NamedTuple):
    """A demand, the flow [m³/s] delivered for it, mean power [W], share of the time on load, and cycles per second.

    The last is None where no receiver is stated.
    """

    demand: Demand
    given: float
    power: float
    loaded: float
    rate: float | None = None

    @property
    def energy(self) -> float:
        """Energy [J]."""
        return self.power * self.demand.hours * HOUR

    @property
    def volume(self) -> float:
        """Free air [m³]."""
        return self.given * self.demand.hours * HOUR


def read_profile(name: str) -> tuple[Demand, ...]:
    """Return the demands of a CSV file; raise UsageError in one line."""
    where = f"{OPTION} {name}"
    with sheet_or_usage_error(f"name a CSV file: {_EXAMPLE}", where):
        sheet = read_sheet(name)
    heads = [_FLOW.fullmatch(text) for text in sheet.names]
    flow = next((i for i, match in enumerate(heads) if match), None)
    if flow is None or "hours" not in sheet.names or len(sheet.names) != 2 or not sheet.rows:
        raise UsageError(f"{where}: is not a table of flows (with unit) and hours (write {_EXAMPLE})")
    match = heads[flow]
    assert match is not None
    unit = match[1]
    found = []
    for row in sheet.rows:
        at, hours = f"{where} line {row.line}", row.cells[1 - flow]
        with refused_at(f"{at}: flow"):
            asked = _flow_or_share(row.cells[flow], unit)
        if not re.fullmatch(NUMBER, hours) or not 0.0 <= float(hours) <= WHOLE:
            raise UsageError(f"{at}: hours {hours!r} is not a number from 0 to {WHOLE:g} (write e.g. 2000)")
        if asked < 0.0:
            raise UsageError(f"{at}: a flow of {row.cells[flow]} is below 0 (write 0 for idling)")
        found.append(Demand(asked, float(hours), unit == "%"))
    total = sum(each.hours for each in found)
    if not 0.0 < total <= WHOLE + 24.0:
        raise UsageError(f"{where}: has {total:g} hours in all (a year has {WHOLE:g})")
    return tuple(found)


def _flow_or_share(text: str, unit: str) -> float:
    """Return a flow [m³/s], or a share of full flow stated in percent; raise `Refused`."""
    if unit != "%":
        return parse_quantity(KINDS["volume_flow"], f"{text} {unit}")
    if not re.fullmatch(NUMBER, text):
        raise Refused(f"{text!r} is not a number (write e.g. 75, percent of full flow)")
    return 0.01 * float(text)


def year(rated: Rating, demands: Sequence[Demand]) -> tuple[DemandShare, ...]:
    """Return the power of a rated package for each demand (M470, M471); raise UsageError where a point is not known."""
    points = sorted((point for point in rated.points if point.flow > 0.0), key=lambda point: point.flow)
    if not points or not rated.full.ok:
        raise UsageError(f"{OPTION}: the package has no point of full flow ({rated.full.result.told})")
    idle = 0.0
    if rated.unloaded is not None:
        if not rated.unloaded.ok:
            raise UsageError(f"{OPTION}: the power unloaded is not known ({rated.unloaded.result.told})")
        idle = rated.unloaded.power
    flows, powers = (np.array(each) for each in zip(*((at.flow, at.power) for at in points), strict=True))
    curve = Pchip(flows, powers) if len(points) > 1 else None
    if rated.receiver is not None and rated.control is None:
        raise UsageError(f"{RECEIVER}: the power with the inlet valve shut is not known (leave {RECEIVER} out)")
    return tuple(_share(points, curve, idle, demand.of(rated.full.flow), rated.control) for demand in demands)


def _share(
    points: Sequence[Point], curve: Pchip | None, idle: float, demand: Demand, control: LoadUnload | None
) -> DemandShare:
    least, most = points[0], points[-1]
    given = min(demand.flow, most.flow)
    if given < least.flow and control is not None:
        return DemandShare(demand, given, *control.cycle(given))
    if given < least.flow:
        loaded = given / least.flow
        return DemandShare(demand, given, loaded * least.power + (1.0 - loaded) * idle, loaded)
    power = most.power if curve is None else float(curve(given))
    return DemandShare(demand, given, power, 1.0, None if control is None else 0.0)


def year_table(rated: Rating, shares: Sequence[DemandShare], motors: Sequence[Any]) -> Table:
    """Return the table of a profile, with totals in its last row; `motors` are the settings of the package's motors."""
    metric = rated.units == METRIC
    size = 1.0 if metric else 1e3 * FOOT**3
    rows = [
        [
            *(_flow(share.demand.flow, metric), f"{share.demand.hours:g}", f"{100.0 * share.loaded:.0f}"),
            *([] if share.rate is None else [f"{HOUR * share.rate:.1f}"]),
            *(f"{1e-3 * share.power:.1f}", f"{share.energy / KWH:.0f}", _specific(share.energy, share.volume / size)),
        ]
        for share in shares
    ]
    hours, energy, volume = (sum(column) for column in zip(*map(_sums, shares), strict=True))
    mean = 1e-3 * energy / (hours * HOUR)
    blank = ["", ""] if rated.receiver else [""]
    rows.append(["all", f"{hours:g}", *blank, f"{mean:.1f}", f"{energy / KWH:.0f}", _specific(energy, volume / size)])
    note = "; ".join([*_notes(rated, shares), *_too_often(rated, shares, motors)])
    flow, per = ("m³/min", "kWh/m³") if metric else ("acfm", "kWh/ 1000 ft³")
    often = ("cycles/h",) if rated.receiver else ()
    return Table("Energy over the profile", (flow, "hours", "% on load", *often, "mean kW", "kWh", per), rows, note)


def _flow(flow: float, metric: bool) -> str:
    return f"{MINUTE * flow:.2f}" if metric else f"{flow / CFM:.1f}"


def _sums(share: DemandShare) -> tuple[float, float, float]:
    return share.demand.hours, share.energy, share.volume


def _specific(energy: float, volume: float) -> str:
    return f"{energy / KWH / volume:.4f}" if volume > 0.0 else ""


def _notes(rated: Rating, shares: Sequence[DemandShare]) -> Iterator[str]:
    full = rated.full.flow
    missing = [share for share in shares if share.demand.flow > (1.0 + DEMAND_TOLERANCE) * full]
    if missing:
        hours = sum(each.demand.hours for each in missing)
        metric = rated.units == METRIC
        most = f"{_flow(full, metric)} {'m³/min' if metric else 'acfm'}"
        yield f"during {hours:g} h it delivers less than demanded, {most}"
    if any(share.loaded < 1.0 for share in shares):
        with_receiver = f", with {rated.receiver.in_words(rated.units)}" if rated.receiver else ""
        if rated.unloaded is None:
            stops = f"below its lowest flow it starts and stops{with_receiver}"
            yield f"{stops}, drawing no power while stopped (it has no unloaded point)"
        elif rated.control is None:
            uncounted = f"venting and refilling the separator are not counted ({RECEIVER})"
            yield f"below its lowest flow it loads and unloads; {uncounted}"
        else:
            yield f"below its lowest flow it loads and unloads{with_receiver}; {rated.control.words}"


def _too_often(rated: Rating, shares: Sequence[DemandShare], motors: Sequence[Any]) -> Iterator[str]:
    """Yield what switches too often: motors on the mains, or a package that loads before its separator is vented."""
    control, receiver = rated.control, rated.receiver
    switched = [share for share in shares if share.rate]
    if control is None or receiver is None or not switched:
        return
    if rated.unloaded is not None:
        off = min((1.0 - share.loaded) / (share.rate or inf) for share in switched)
        if off < control.venting:
            what = f"it loads again after {off:.0f} s, before its separator is vented in {control.venting:g} s"
            yield f"{what} ({receiver.larger(control.venting / off, rated.units)})"
        return
    often = HOUR * max(share.rate or 0.0 for share in switched)
    on_mains = [(motor, motor.poles or USUAL_POLES) for motor in motors if not motor.inverts]
    limits = [(most_starts(float(motor.rated_power), poles) or inf, motor, poles) for motor, poles in on_mains]
    most, motor, poles = min(limits, key=lambda limit: limit[0], default=(inf, None, USUAL_POLES))
    if motor is not None and often > most:
        size = rated.units.quantity("W", motor.rated_power)
        what = f"it starts up to {often:{'.0f' if often >= 100.0 else '.3g'}} times an hour"
        may = f"a {IN_WORDS[poles]} motor of {size} may {most:g} times"
        venting = f", or {UNLOADED_POINT}" if len(motors) == 1 else ""  # two stages have no point unloaded
        yield f"{what}, and {may} ({STARTS_SOURCE}; {receiver.larger(often / most, rated.units)}{venting})"


def year_document(shares: Sequence[DemandShare], receiver: Receiver | None = None) -> dict[str, Any]:
    """Return a profile for `--json`, in SI units; hours stay hours."""
    hours, energy, volume = (sum(column) for column in zip(*map(_sums, shares), strict=True))
    rows = [
        {"flow": share.demand.flow, "hours": share.demand.hours, "given_flow": share.given, "power": share.power,
         "loaded": share.loaded, "energy": share.energy,
         **({} if share.rate is None else {"cycles_per_hour": HOUR * share.rate})}
        for share in shares
    ]  # fmt: skip
    stored = {} if receiver is None else {"receiver": {"volume": receiver.volume, "band": receiver.band}}
    return {"demands": rows, "hours": hours, "energy": energy, "volume": volume, **stored}
