"""Results that an effect reads from a closed cycle, power that it takes beside the gas work, and its shaft's motion."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Given = Mapping[str, float | str | None]  # figures by name; a text in place of a value says why there is none


@dataclass(frozen=True)
class PowerLoss:
    """Power [W] beside the gas work, computed from figures of the closed cycle (plain Python, once a run).

    `kept` is the part of it that stays in the oil as pressure; the rest is dissipated at ambient temperature. With a
    separator all of it heats the outflow, except that of a loss with `friction` (bearings, seals, gears) only the share
    that the separator states does.
    """

    figure: str
    power: Callable[[Any], float]
    kept: Callable[[Any], float] | None = None
    friction: bool = False


@dataclass(frozen=True)
class Reading:
    """Figures and traces [SI] read from a closed cycle and its powers, which they do not change (plain Python).

    `read` returns the values of `figures`, with all losses known, or a text that says why there is none. `traces`
    returns curves over the points of one pitch (`cycle.pitch.POINTS`), which repeat every pitch. `judge` returns a text
    that says why the point has failed (empty: it has not), and warnings.
    """

    figures: tuple[str, ...]
    read: Callable[[Any], Given]
    traces: Callable[[Any], Mapping[str, Any]] | None = None
    judge: Callable[[Any], tuple[str, tuple[str, ...]]] | None = None


@dataclass(frozen=True)
class Shaft:
    """A speed that varies over a pitch (M210–M217).

    `respond` returns the periodic motion of the drive (`machine.drive.response.Response`) under the torque of a closed
    cycle, or raises `NoMotion`. `judge` returns a text that says why that motion is ruled out (empty: it is not),
    warnings, and the relative residual of its powers.
    """

    train: Callable[[float], Any]  # of the speed [rad/s] that the scene states
    respond: Callable[[Any], Any]
    judge: Callable[[Any], tuple[str, tuple[str, ...], float]]
