"""Heat transfer of droplets: transfer units, the trend of the discharge temperature, and sizes that jets give."""

from __future__ import annotations

from pathlib import Path

import CoolProp.CoolProp as coolprop
import numpy as np
from scipy.optimize import brentq

from screwsim.effects.droplets import merrington_richardson, varde
from screwsim.study.validation import Comparison, Panel, Row, Series, equal, read_table, solved

TITLE = "Droplets: heat transfer and size"
CITATION = (
    "Nu = 2 (Ranz–Marshall without slip); trend of the discharge temperature: He et al. 2018; jets: Merrington & "
    "Richardson 1947, Varde 1984"
)
ABOUT = """\
α and r enter the paper's law as α/r only, and its r is a fitted parameter. What was found:

- Correlations for jets differ by more than tenfold, and the finer droplets are still coarser than those that cool the
  paper's gas within a revolution.
- configs/r134a takes the finer one (Varde) with α of a moving droplet (M154), of the bores that its oil needs: two, one
  to each rotor, that pass a kilogram per kilogram of gas at 2/45 °C under 8.4 bar with a discharge coefficient of 0.7,
  D = sqrt(4/π · V/2 / (0.7 sqrt(2 Δp/ρ_o))) = 5.6 mm.
- The measured trend is that of an air machine, whose gas gets far hotter than its oil. R134a at 2/45 °C is another
  case: its oil must stay above saturation at the discharge pressure and is warmer than the gas for most of the
  compression."""
RHO_OIL, T, P = 1000.0, 310.0, 6e5
JETS = ((3e5, RHO_OIL, 3e-3), (8.4e5, 960.0, 5.6e-3))  # pressure drop [Pa], density of the oil [kg/m³], bore [m]
DISCHARGE = 0.7  # coefficient of the bores' orifice equation
RADII = (10e-6, 30e-6, 50e-6, 100e-6)


RATIOS = {"air": (2.0, 4.0, 7.0, 12.0, 20.0), "R134a, 2/45 °C": (0.25, 0.5, 1.0, 2.0, 4.0)}
GASES = {"air": "Air", "R134a, 2/45 °C": "R134a"}


def conductivity(fluid: str = "R134a") -> float:
    """Return that of R134a [W/(m K)]."""
    return float(coolprop.PropsSI("L", "T", T, "P", P, fluid))


def transfer_units(radius: float, rpm: float, c_v: float) -> float:
    """Return 3 α/(r ρ_o c_v) times the time of half a turn (M3 over the gas's heat capacity), α at Nu = 2."""
    alpha = conductivity() / radius
    return 3.0 * alpha / (radius * RHO_OIL * c_v) * 30.0 / rpm


def unit_rows(here: Path, c_v: float) -> list[Row]:
    """Return transfer units against those of the table."""
    rows = []
    for row in read_table(here / "transfer_units.csv"):
        theirs = float(row["transfer_units"])
        digit = 0.05 if theirs < 1.0 else 0.0
        rows.append(
            equal(
                f"transfer units, r = {row['radius_um']} µm, {row['speed_rpm']} rpm",
                transfer_units(1e-6 * float(row["radius_um"]), float(row["speed_rpm"]), c_v),
                theirs,
                max(0.1 * theirs, digit),
                "cross-code",
                basis="two digits or fewer; properties not stated: 10 %",
            )
        )
    return rows


def temperatures(scene_file: Path, radius: float, name: str) -> list[float]:
    """Return discharge temperatures [°C] over the oil ratio for droplets of a radius [m] at Nu = 2."""
    found = []
    for ratio in RATIOS[name]:
        values = {
            "oil_supply.ratio": ratio,
            "effects.oil_heat.droplet_radius": radius,
            "effects.oil_heat.heat_transfer_coefficient": conductivity(GASES[name]) / radius,
        }
        found.append(solved(scene_file, values=values).performance.discharge_temperature - 273.15)
    return found


def temperature_row(name: str, radius: float, values: list[float]) -> Row:
    """Return the trend over the oil ratio: judged on air, shown on R134a."""
    falls = bool(np.all(np.diff(values) < 0.0))
    judged = name == "air"
    return Row(
        f"discharge temperature over the oil ratio, {name}, r = {1e6 * radius:.0f} µm",
        ", ".join(f"{value:.1f}" for value in values) + " °C",
        "falls with the oil flow" if judged else None,
        "published" if judged else "estimate",
        ("holds" if falls else "fails") if judged else "no verdict",
        note=f"at d = {', '.join(f'{ratio:g}' for ratio in RATIOS[name])}",
    )


def jet_rows() -> list[Row]:
    """Return droplet radii [µm] that correlations give for a jet of the literature and for that of configs/r134a."""
    mu, sigma = 20e-3, 0.03
    rows = []
    for drop, density, bore in JETS:
        u = (2.0 * drop / density) ** 0.5
        sizes = {
            "Merrington & Richardson": merrington_richardson(bore, mu / density, u),
            "Varde": varde(bore, density, mu, sigma, u),
        }
        note = (
            f"M155, M156: bore {1e3 * bore:g} mm, {1e-5 * drop:g} bar, {density:g} kg/m³, 20 mPa s, 0.03 N/m; "
            "configs/r134a has Varde's at 8.4 bar, configs/paper 9.5 µm"
        )
        for name, size in sizes.items():
            quantity = f"droplet radius of a jet of {1e-5 * drop:g} bar, {name}"
            rows.append(Row(quantity, 1e6 * 0.5 * size, None, "estimate", "no verdict", "µm", note=note))
    return rows


def falling(diameter: float, T: float, p: float) -> float:
    """Return at what share of the tip speed u a droplet falls outwards in the field u²/R, gas at rest (Newton's drag).

    Drag 24 (1 + 0.15 Re^0.687)/Re to Re = 1000 (Schiller and Naumann 1935), then 0.44.
    """
    R, u = 0.08, 24.7
    rho, mu = (float(coolprop.PropsSI(name, "T", T, "P", p, "R134a")) for name in ("D", "V"))

    def surplus(w: float) -> float:
        Re = rho * w * diameter / mu
        drag = 24.0 / Re * (1.0 + 0.15 * Re**0.687) if Re < 1000.0 else 0.44
        return w * w * drag - 4.0 / 3.0 * diameter * 960.0 / rho * u * u / R

    return float(brentq(surplus, 1e-3, 1e3)) / u


def bore(oil: float, drop: float, density: float) -> float:
    """Return the diameter [m] of each of two bores that pass an oil flow [kg/s] under a pressure drop [Pa]."""
    speed = DISCHARGE * (2.0 * drop / density) ** 0.5
    return (4.0 / np.pi * 0.5 * oil / density / speed) ** 0.5


def bore_row(oil: float) -> Row:
    """Return the bores that pass the oil of configs/r134a [kg/s], beside what its jets are stated with."""
    drop, density, stated = JETS[1]
    return Row(
        "configs/r134a: each of two bores that pass its oil",
        1e3 * bore(oil, drop, density),
        1e3 * stated,
        "estimate",
        "no verdict",
        "mm",
        note=f"{oil:.2f} kg/s at 2/45 °C, {1e-5 * drop:g} bar, discharge coefficient {DISCHARGE:g}; theirs: as stated",
    )


def shipped_rows(root: Path) -> list[Row]:
    """Return what the droplets of the shipped machines do: how they fall, how far apart gas and oil leave."""
    machines = {name: solved(root / "configs" / "r134a" / f"{name}.yaml").performance for name in ("point", "compact")}
    diameter = machines["compact"].droplet_diameter
    rows = [bore_row(machines["compact"].oil_mass_flow)]
    for T, p, where in ((290.0, 3.2e5, "as suction closes"), (335.0, 11.6e5, "at discharge")):
        size = f"{1e6 * diameter:.0f} µm"
        note = f"{size}, tips at 24.7 m/s, R = 80 mm; the scenes state a slip of 0.1, as walls stop them"
        share = falling(diameter, T, p)
        rows.append(Row(f"speed outwards over tip speed, {where}", share, None, "estimate", "no verdict", note=note))
    for name, found in machines.items():
        T, T_oil, T_mix = (found[f"{what}discharge_temperature"] - 273.15 for what in ("", "oil_", "mixture_"))
        rows.append(
            Row(
                f"configs/r134a/{name}.yaml: gas warmer than oil at the discharge port",
                T - T_oil,
                None,
                "estimate",
                "no verdict",
                "K",
                note=f"gas {T:.1f}, oil {T_oil:.1f}, mixed, with what friction leaves in it, {T_mix:.1f} °C",
            )
        )
    return rows


def compare(here: Path) -> Comparison:
    """Return transfer units, trends and sizes."""
    root = here.parents[1]
    scene_file = root / "tests" / "plain" / "r134a.yaml"
    c_v = float(coolprop.PropsSI("CVMASS", "T", T, "P", P, "R134a"))
    files = {"air": here.parent / "he2018" / "machine.yaml", "R134a, 2/45 °C": scene_file}
    curves = {name: {r: temperatures(file, r, name) for r in RADII} for name, file in files.items()}
    rows = [
        equal(
            "heat transfer coefficient, Nu = 2, diameter 20 µm",
            conductivity() / 10e-6,
            1463.0,
            15.0,
            "cross-code",
            unit="W/m²K",
            basis="CoolProp's conductivity of R134a now, and when the number was stated: 1 %",
        ),
        *unit_rows(here, c_v),
    ]
    for name, machine in curves.items():
        for radius, values in machine.items():
            rows.append(temperature_row(name, radius, values))
    panels = [
        Panel(
            f"oil ratio d, {name}",
            "discharge temperature / °C",
            [Series(f"r = {1e6 * radius:.0f} µm", RATIOS[name], values) for radius, values in machine.items()],
            log_x=True,
        )
        for name, machine in curves.items()
    ]
    return Comparison(TITLE, CITATION, ABOUT, [*rows, *jet_rows(), *shipped_rows(root)], panels)
