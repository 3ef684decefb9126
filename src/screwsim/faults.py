"""Faults that a person can mend: each says where, what and the remedy."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One fault of a scene: `path` is dotted (`machine.volume.phi_A`), `what` ends with the remedy."""

    path: str
    what: str


class SceneError(Exception):
    """Report every fault of a scene; `lines` are ready to print (`FILE:LINE:COLUMN: PATH: what`)."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__("\n".join(lines))
        self.lines = lines


class UsageError(Exception):
    """Report a wrong use of a command, or of a function, in one line."""
