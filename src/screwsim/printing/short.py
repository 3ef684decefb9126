"""The essentials of a result, on one screen of 80 columns and 24 lines (`run --short`)."""

from collections.abc import Iterator, Sequence

from screwsim.figures import declared
from screwsim.figures.engineering import engineering, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Result
from screwsim.outputs.customary import small_number_text
from screwsim.printing import impossible_figures
from screwsim.printing.tables import heading, print_table, print_text, print_wrapped, wrapped
from screwsim.screen import printable, say

MOST_FIGURES = 10  # most figures
MOST_LINES = 3  # most lines of warnings and of a message, each
GAS_OUT, MIXTURE, OUTLET = "discharge_temperature", "mixture_discharge_temperature", "package_discharge_pressure"
# in reading order: what the machine delivers, what it takes, how well, how hot, how much oil
FIRST_FIGURES = (
    *("free_air_delivered", "cooling_capacity", "heating_capacity", "gas_mass_flow", "output_power", "shaft_power"),
    *("electrical_power", "package_input_power", "package_specific_power", "cop", "electrical_cop"),
    *("heating_cop", "electrical_heating_cop"),
    *("isentropic_efficiency", "isothermal_efficiency", "volumetric_efficiency"),
    *(MIXTURE, GAS_OUT, OUTLET, "pressure_ratio"),
    *("oil_flow_volume", "oil_flow_ratio", "peak_pressure", "specific_power", "shaft_torque"),
)
REPLACED_FIGURES = {  # the first is left out, if one of the others is present
    "cop": ("electrical_cop",),
    "heating_cop": ("electrical_heating_cop",),
    "electrical_power": ("package_input_power",),
    "isothermal_efficiency": ("cooling_capacity", "package_specific_power"),
    "oil_flow_ratio": ("oil_flow_volume",),
    "gas_mass_flow": ("free_air_delivered", "electrical_heating_cop"),
    "pressure_ratio": (OUTLET,),
}


def print_short(title: str, result: Result, changed: Sequence[str] = (), ambient: float | None = None) -> None:
    """Print title, all changes by the command line, status, the first warning, ten figures, and the balances.

    The figures have their numerical errors, if there are any. `ambient` is the pressure [Pa] over which that at a
    package's outlet is given, too.
    """
    first, doubted = heading(title, changed), impossible_figures(result)
    marked = ": ".join(filter(None, (first, doubted)))
    if len(wrapped(printable(marked)).splitlines()) == 1:  # else the status has the mark, which a title would push out
        first, doubted = marked, ""
    if first:
        say(_cut_to_lines(printable(first), 1))
    if changed:
        print_text(", ".join(changed))
    status = "; ".join(filter(None, (result.status, doubted, result.message)))
    say(_cut_to_lines(printable(f"status: {status}"), MOST_LINES))
    if result.warnings:
        say(_cut_to_lines(printable(f"warning: {result.warnings[0]}"), MOST_LINES))
    there = [name for name in FIRST_FIGURES if result.performance.get(name) is not None]
    names = [name for name in there if not set(REPLACED_FIGURES.get(name, ())) & set(there)][:MOST_FIGURES]
    if names:
        say()
        print_table(("figure", "value", "unit", "error"), _rows(result, names, ambient), 1)
    say()
    print_wrapped(_last_line(result, names))


def _rows(result: Result, names: Sequence[str], ambient: float | None) -> Iterator[list[str]]:
    for name in names:
        number, unit = engineering(declared(name, result.performance), result.performance[name])
        error = result.error.get(name)  # exactly zero for a stated quantity, such as the pressure ratio
        if name == OUTLET and ambient is not None:
            unit = f"{unit} ({1e-5 * (result.performance[name] - ambient):.4g} bar(g))"
        shown = f"{shown_name(name)}, gas alone" if name == GAS_OUT and MIXTURE in names else shown_name(name)
        yield [shown, number, unit, small_number_text(error) if error else ""]


def _last_line(result: Result, names: Sequence[str]) -> Iterator[str]:
    if result.balance:
        mass, energy = (result.balance[name] for name in ("mass", "energy"))
        yield f"balance: mass {mass:.1e}, energy {energy:.1e} (bound {result.balance['bound']:.1e})"
    valued = sum(value is not None for value in result.performance.values())
    more = [f"{valued - len(names)} more figures"] if valued > len(names) else []
    others = len(result.warnings) - 1
    more += [counted(others, "more warning")] if others > 0 else []
    more += ["where the power goes"] if result.ledger else []
    more += ["uncertainties"] if result.uncertainty else []
    if more:
        yield f"without --short: {', '.join(more)}"


def _cut_to_lines(text: str, most: int) -> str:
    """Return a text limited to `most` lines."""
    lines = wrapped(text).splitlines()
    return "\n".join(lines if len(lines) <= most else [*lines[: most - 1], f"{lines[most - 1][:76]} …"])
