"""Cooling and heating capacity of two stages in a row, and the COP of both (docs/model.md M203, M410)."""

from collections.abc import Mapping
from typing import Any

from screwsim.evaluate.performance import NO_POWER, heating

Given = tuple[dict[str, float | None], dict[str, str]]  # figures, and why some are None


def capacities(
    cooling: float, power: float, second: Mapping[str, Any], rejected: float | None, unparted: str = ""
) -> Given:
    """Return both capacities [W] and their COP on the power of both stages [W], or None with the reason.

    `second` has the figures of the second stage, whose gas goes to the condenser and gives off `rejected` [J/kg]
    there; None where gas and oil do not part, with the reason `unparted`.
    """
    cop = cooling / power if power > 0.0 else None
    warming, reasons = heating({"shaft_power": power}, second["gas_mass_flow"], rejected, unparted)
    notes = reasons if cop is not None else {"cop": NO_POWER, **reasons}
    return {"cooling_capacity": cooling, "cop": cop, **warming}, notes
