"""What an effect reads of a closed cycle, what power it takes beside the gas work, how its shaft answers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Given = Mapping[str, float | str | None]  # figures by name; a text says why there is none


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
