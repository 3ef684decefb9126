"""What another solubility does to the machine of configs/r134a/separator.yaml."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from screwsim.effects import refrigerant_solubility as effect
from screwsim.fluid.solubility import RefrigerantOilPair
from screwsim.fluid.solubility_laws import ESTER, Ester
from screwsim.outputs import Result
from screwsim.study.validation import Row, solved

SCENE = "configs/r134a/separator.yaml"
FACTORS = {"a quarter more": 1.25, "a fifth less": 0.8}


class _Dissolving(Ester):
    """The ester's law with so many times its content at the same pressure."""

    def __init__(self, factor: float) -> None:
        super().__init__(ESTER.fluid, ESTER.low, ESTER.high, ESTER.most)
        self.factor = factor

    def pair(self, T: float) -> RefrigerantOilPair:
        known = super().pair(T)
        return known._replace(mass_ratio=self.factor * known.mass_ratio)


@contextmanager
def dissolving(factor: float) -> Iterator[Ester]:
    """Let oils hold so many times what M195 has at the same pressure, as oils of a smaller molar mass do."""
    effect.ESTER = _Dissolving(factor)
    try:
        yield effect.ESTER
    finally:
        effect.ESTER = ESTER


def machine_rows(root: Path) -> list[Row]:
    """Return the change of the isentropic efficiency with another content."""

    def found(factor: float) -> Result:
        with dissolving(factor):
            return solved(root / SCENE)

    plain, rows = found(1.0).performance, []
    for words, factor in FACTORS.items():
        other = found(factor).performance
        note = (
            f"oil holds {other.dissolved_gas_ratio:.3f} for {plain.dissolved_gas_ratio:.3f} kg/kg; λ "
            f"{100.0 * (other.volumetric_efficiency - plain.volumetric_efficiency):+.2f} points; all of it flashes in "
            "the port, the most that it can cost; viscosity is that of pure oil in each"
        )
        rise = 100.0 * (other.isentropic_efficiency - plain.isentropic_efficiency)
        quantity = f"{SCENE}: isentropic efficiency, oil that dissolves {words}"
        rows.append(Row(quantity, rise, None, "estimate", "no verdict", "points", note=note))
    return rows
