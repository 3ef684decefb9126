"""Print one table of every effect, alone on the paper's machine: what its source says, what we find, where it vanishes.

Run: .venv/bin/python scripts/each_effect.py [NAME]… Each row is a scene with the effect against the same without it.
The machine is that of configs/paper/point.yaml, 1000 rpm; "carried" lets leaks carry oil, "condenser" gives it R134a as
a real gas between -21.6 and 44.7 °C, the saturation temperatures of the paper's pressures.
tests/effects/test_each_effect.py holds that each row closes, and that the effect vanishes in its limit.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ruamel.yaml import YAML

from screwsim.outputs import Result
from screwsim.scene import Scene, load
from screwsim.simulate import simulate

TABLE = Path(__file__).resolve().with_suffix(".yaml")
POINT = TABLE.parent.parent / "configs" / "paper" / "point.yaml"
CARRIED = ("oil.transport=carried",)
CONDENSER = (
    *CARRIED,
    "gas={model: real, two_phase: equilibrium}",
    "operation.suction=null",
    "operation.discharge=null",
    "operation.evaporating_temperature=-21.6 degC",
    "operation.condensing_temperature=44.7 degC",
    "operation.superheat=27.4 K",
    "oil_supply.temperature=325 K",
    "oil_supply.ratio=1",
)
BORE = (*CARRIED, "oil_supply={kind: displacement, ratio: null, orifice_diameter: 6 mm}", "effects.oil_pump=off")
WALLS = "effects.wall_heat={rotor_area: 400 cm^2, housing_area: 150 cm^2, characteristic_length: 58 mm}"
NO_HEAT = "effects.oil_heat=off"
RETURNING = (*CARRIED, "effects.suction_line={}")
SLIDING = (*CARRIED, "effects.slide_valve={slot_area: 60 cm^2, closes: 640 deg, position: 0.5}")
TABLE_HEAD = "| effect | scene | its source says | source | ours | vanishes with | evaluations | balance over bound |"


BASES = {
    "": (),
    "carried": CARRIED,
    "condenser": CONDENSER,
    "bore": BORE,
    "walls": (WALLS,),
    "no_heat": (NO_HEAT,),
    "returning": RETURNING,
    "sliding": SLIDING,
}


class Row(NamedTuple):
    """One effect as each_effect.yaml states it; `base` is what both scenes set, `sets` and `limit` overrides of it."""

    base: tuple[str, ...]
    sets: tuple[str, ...]
    limit: tuple[str, ...]
    scene: str
    says: str
    source: str
    own: tuple[str, ...]
    zero: tuple[str, ...]
    whole: bool
    plain: bool


def overrides(values: Mapping[str, Any], before: str = "") -> tuple[str, ...]:
    """Return values by path, or by the name of a parameter of the effect `before`, as `load` takes them."""
    return tuple(f"{path if '.' in path else before + path}={flow(value)}" for path, value in values.items())


def flow(value: Any) -> str:
    """Return a value as it stands in one line of YAML."""
    if isinstance(value, str):
        return value
    return "{" + ", ".join(f"{name}: {flow(part)}" for name, part in value.items()) + "}"


def read_rows() -> dict[str, Row]:
    """Return the rows of the table by their names."""
    rows = {}
    for name, of in YAML(typ="base").load(TABLE).items():  # all values are texts
        path = f"effects.{effect_of(name)}"
        sets = overrides({path: of["sets"]}) if "sets" in of else ()
        words = (of.get("scene", "paper"), of["says"], of["source"])
        figures = (tuple(of.get(key, ())) for key in ("own", "zero"))
        base = BASES[of.get("on", "")] + overrides(of.get("base", {}))
        limit = overrides(of.get("limit", {}), f"{path}.")
        rows[name] = Row(base, sets, limit, *words, *figures, "whole" in of, "plain" in of)
    return rows


def effect_of(name: str) -> str:
    """Return the effect of a row."""
    return name.split(",")[0]


ROWS = read_rows()
SEEN = ("shaft_power", "indicated_power", "gas_mass_flow", "isentropic_efficiency", "discharge_temperature")


def with_it(name: str, more: tuple[str, ...] = ()) -> Scene:
    """Return a row's scene with its effect, and what more is set."""
    row = ROWS[name]
    return load(POINT, (*row.base, *row.sets, *more))


def without_it(name: str, more: tuple[str, ...] = ()) -> Scene:
    """Return a row's scene without its effect, or with that in its plain form."""
    row, effect = ROWS[name], effect_of(name)
    common = tuple(each for each in more if not each.startswith(f"effects.{effect}"))
    if row.plain:
        return load(POINT, (*row.base, *common))
    return load(POINT, (*row.base, *row.sets, *common), [effect])


def changes(one: Result, other: Result) -> str:
    """Return how figures differ that differ by more than the accuracy."""
    found = []
    for title, name in (("P", "shaft_power"), ("ṁ", "gas_mass_flow"), ("Q̇₀", "cooling_capacity"), ("COP", "cop")):
        a, b = one.performance.get(name), other.performance.get(name)
        if a is not None and b is not None:
            found.append(f"{title} {100.0 * (a / b - 1.0):+.2f} %")
    a, b = one.performance.isothermal_efficiency, other.performance.isothermal_efficiency
    if a is not None and b is not None:
        found.append(f"η {100.0 * (a - b):+.2f} points")
    found.append(f"T_d {one.performance.discharge_temperature - other.performance.discharge_temperature:+.1f} K")
    return ", ".join(found)


def line(name: str) -> str:
    """Return a row of the table."""
    row, one = ROWS[name], simulate(with_it(name))
    if one.status != "ok":
        return f"| {name} | {one.status}: {one.message} |"
    own = ", ".join(f"{each} {one.performance[each]:.4g}" for each in row.own)
    balance = one.balance
    worst = max(x for x in (balance.mass, balance.energy, balance.entropy, balance.oil_mass) if x is not None)
    other = simulate(without_it(name)) if not row.whole else None
    ours, price = "the machine's way in or out", "–"
    if other is not None:
        ours = changes(one, other) if other.status == "ok" else f"without it {other.status}"
        price = f"{100.0 * (one.numerics.rhs_evaluations / other.numerics.rhs_evaluations - 1.0):+.0f} %"
    limit = ", ".join(each.split(".", 1)[1] if each.startswith("effects.") else each for each in row.limit) or "–"
    cells = (name, row.scene, row.says, row.source, "; ".join(filter(None, (ours, own))), limit, price)
    return f"| {' | '.join(cells)} | {worst / balance.bound:.2f} |"


def main() -> None:
    """Print the rows whose names begin with those asked for, or all."""
    asked = sys.argv[1:] or [""]
    print(f"{TABLE_HEAD}\n|{'---|' * (TABLE_HEAD.count('|') - 1)}")
    for name in ROWS:
        if any(name.startswith(each) for each in asked):
            print(line(name), flush=True)


if __name__ == "__main__":
    main()
