"""What oils dissolve of R134a by M195, beside measured points; and what an error of it does to a machine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.fluid.solubility_laws import ESTER
from screwsim.study.validation import Comparison, Panel, Row, Series, equal, sibling

_HERE = Path(__file__).parent
points, oils, measured = (sibling(_HERE / f"{name}.py") for name in ("points", "oils", "deviations"))
machine, fitted = sibling(_HERE / "machine.py"), sibling(_HERE / "fitted.py")

TITLE = "R134a dissolved in oils"
CITATION = (
    "Grebner 1992; Martz & Jacobi 1994; Yokozeki 2001 (Int. J. Thermophys. 22, 1057); Wahlström & Vamling 2000 (J. "
    "Chem. Eng. Data 45, 97); Takigawa, Sandler, Yokozeki 2002 (Int. J. Refrig. 25, 1014); points as in SorpPropLib"
)
ABOUT = """\
M195 was fitted to Grebner's points. Those of Martz and Jacobi are of another ester oil of the same molar mass, and the
only ones that judge it. Other oils show what it means to take M195 for them. How to read the rows:

- A content is kilograms per kilogram of oil at the measured temperature and pressure, up to 0.8 of the saturation
  pressure: above, a percent of pressure is several percent of content.
- ± is how far the source's own equation (first picture) lies from its points (root mean square): a mean inside it
  cannot be told from their scatter. That equation also settles in which unit loadings are stored: they are mole
  fractions.
- M195 is often handed on with pressures in place of the vapour's fugacities; the notes say what it has with those, and
  the same constants.
- The measured points are no part of this checkout: the environment variable SCREWSIM_SOLUBILITY_POINTS names their file
  (validation/solubility/points.py says where they are and in which form)."""
WARM = 333.0  # [K] from where on oil is as warm as in a separator
SEPARATOR = 338.15  # [K] of the picture
Found = Sequence[tuple[Any, Any]]  # oils with their deviations


def percent(values: np.ndarray) -> str:
    """Return the ends of deviations."""
    return f"{100.0 * values.min():+.0f} to {100.0 * values.max():+.0f} %"


def rms(values: np.ndarray) -> float:
    """Return the root mean square [%] of those that are known."""
    return 100.0 * float(np.sqrt(np.nanmean(values**2)))


def noted(found: Any, least: float) -> str:
    """Return what else is known of an oil's contents; `least`: by what its own equation misses them as masses."""
    told = [f"{percent(found.content)} at single points"]
    warm = found.content[found.T > WARM]
    if len(warm):
        told.append(f"{100.0 * warm.mean():+.0f} % from 60 °C on")
    told.append(f"with pressures {percent(found.ideal)}, mean {100.0 * found.ideal.mean():+.0f} %")
    over = f"pressure at all {len(found.pressure)} contents: mean {100.0 * found.pressure.mean():+.1f} %"
    own = f"its own equation misses these by {100.0 * found.mole:.1f} % with mole fractions"
    told += [over, f"{own}, by {100.0 * least:.0f} % or more with masses"]
    if found.slips:
        told.append(f"{found.slips} left out, off that equation more than twofold")
    return "; ".join(told)


def content_row(oil: Any, each: Sequence[Any]) -> Row:
    """Return the mean deviation of the content; of an oil of unknown molar mass between its bounds, without verdict."""
    means = [100.0 * float(found.content.mean()) for found in each]
    quantity = f"content, {oil.words}: mean of {len(each[0].content)} points"
    spread, note = rms(each[0].scatter), noted(each[-1], min(found.mass for found in each))
    if len(means) > 1:
        low, high = (1e3 * molar_mass for molar_mass in oil.molar_mass)
        note = f"molar mass not stated, taken as {low:.0f} to {high:.0f} g/mol; with the larger: {note}"
        ours = " to ".join(f"{mean:+.0f}" for mean in means) + " %"
        return Row(quantity, ours, None, oil.kind, "no verdict", "%", spread, note=note)
    basis = "scatter about its own equation"
    judged = oil.kind != "estimate"
    return equal(quantity, means[0], 0.0, spread, oil.kind, unit="%", basis=basis, note=note, comparable=judged)


def pressure_row(oil: Any, found: Any, stored: Sequence[Any]) -> Row:
    """Return the mean deviation of the pressure over all measured contents of an oil like M195's."""
    scatter = rms(measured.misses(oil.pressure, stored, "mole", oil.molar_mass[0]))
    quantity = f"pressure, {oil.words}: mean of {len(found.pressure)} points"
    mean, ideal = 100.0 * float(found.pressure.mean()), found.ideal_pressure
    note = (
        f"{percent(found.pressure)} at single points, mean size {100.0 * np.abs(found.pressure).mean():.1f} %; with "
        f"pressures mean {100.0 * ideal.mean():+.1f} %, mean size {100.0 * np.abs(ideal).mean():.1f} %"
    )
    basis = "scatter about its own equation"
    return equal(quantity, mean, 0.0, scatter, oil.kind, unit="%", basis=basis, note=note)


def warm_rows(found: Found) -> list[Row]:
    """Return how far the contents of ester oils lie off where separators work; no row without points there."""
    means, others = [], []
    for oil, each in found:
        if oil.ester and (each.T > WARM).any():
            means.append(each.content[each.T > WARM].mean())
            others.append(each.ideal[each.T > WARM].mean())
    if not means:
        return []
    quantity = "content at 60 to 90 °C, as in separators: means of ester oils"
    note = f"{len(means)} oils of known molar mass; with pressures {percent(np.array(others))}"
    return [Row(quantity, percent(np.array(means)), None, "estimate", "no verdict", note=note)]


def laws() -> Panel:
    """Return contents of a warm separator by M195 and by the own equations of the ester oils' sources."""
    T, fractions = SEPARATOR, np.linspace(0.05, 0.9, 60)
    p_sat = ESTER.p_sat(T)
    shares = [float(share) for share in np.linspace(0.03, 0.9, 60)]
    series = [
        Series("M195", shares, [ESTER.content(share * p_sat, T) for share in shares]),
        Series("M195, pressures", shares, [measured.by_pressures(share * p_sat, T) for share in shares]),
    ]
    for oil in oils.OILS:
        if oil.ester and oil.kind != "calibrated":  # that one's own equation is M195
            molar_mass = oil.molar_mass[0]
            at = [(oil.pressure(T, float(x)) / p_sat, measured.ratio(float(x), molar_mass)) for x in fractions]
            at = [(share, held) for share, held in at if shares[0] < share < shares[-1]]
            series.append(Series(f"{oil.source} {oil.oil}", *map(list, zip(*at, strict=True))))
    return Panel(f"pressure over saturation pressure, {T - 273.15:.0f} °C", "R134a per oil / kg/kg", series, log_y=True)


def by_temperature(found: Found) -> Panel:
    """Return the mean deviations of isotherms."""
    series = []
    for oil, each in found:
        temperatures = sorted({float(T) for T in each.T})
        means = [100.0 * float(each.content[each.T == T].mean()) for T in temperatures]
        series.append(Series(f"{oil.source} {oil.oil}", [T - 273.15 for T in temperatures], means, points=True))
    return Panel("temperature / °C", "M195 less measured, content / %", series)


def left_out(oil: Any, count: int) -> Row:
    """Return the row of an oil of which no point can be compared."""
    note = (
        f"left out: none of its {count} points lies below {measured.MOST:g} of the saturation pressure and within "
        "twofold of the source's own equation"
    )
    return Row(f"content, {oil.words}", None, None, oil.kind, "no verdict", note=note)


def measured_rows(stored: Any) -> tuple[list[Row], list[Panel]]:
    """Return the rows of all oils of a file, and the picture of those whose molar mass is known, if there are some."""
    rows, known = [], []
    for oil in oils.OILS:
        of_oil = stored.get((oil.source, oil.oil))
        if not of_oil:
            continue
        each = [measured.deviations(oil.pressure, of_oil, molar_mass) for molar_mass in oil.molar_mass]
        if None in each:  # which points are left does not depend on the molar mass
            rows.append(left_out(oil, len(of_oil)))
            continue
        rows.append(content_row(oil, each))
        if len(each) == 1:
            known.append((oil, each[0]))
            if oil.kind != "estimate":
                rows.append(pressure_row(oil, each[0], of_oil))
        rows.append(fitted.fitted_row(oil, of_oil))
    if not rows:
        raise points.NotRun(f"{points.FILE}={points.named()}: holds none of the oils ({points.REMEDY})")
    if oils.OPEN in stored:
        note = (
            f"{len(stored[oils.OPEN])} points left out: whether loadings are mole or mass fractions is not settled, as "
            "no form of the source's equation was found that its points follow with either"
        )
        rows.append(Row("content, Yokozeki 2001, n-hexadecane", None, None, "published", "no verdict", note=note))
    return [*rows, *warm_rows(known)], [by_temperature(known)] if known else []


def compare(here: Path) -> Comparison:
    """Return the deviations from all measured points, where their file is named, and what they do to a machine."""
    file, panels = points.named(), [laws()]
    if file is None:
        note = f"not compared: {points.FILE} names no file of the measured points ({points.REMEDY})"
        rows = [Row("content and pressure at measured points", None, None, "published", "no verdict", note=note)]
    else:
        rows, drawn = measured_rows(points.read(file, {(oil.source, oil.oil) for oil in oils.OILS}))
        panels += drawn
    return Comparison(TITLE, CITATION, ABOUT, [*rows, *machine.machine_rows(here.parents[1])], panels)
