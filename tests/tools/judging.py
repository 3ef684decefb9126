"""Checks common to scripts that solve many hard scenes: a time limit, and numbers that are possible."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from screwsim.outputs import Result


class Stopped(Exception):
    """The work took too long."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise Stopped where the work takes more processor time; only between calls of compiled code."""

    def stop(*_: Any) -> None:
        raise Stopped

    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def finite(result: Result) -> bool:
    """Return whether every number of a result is finite, and every pressure, temperature and mass positive."""
    tables = (result.performance, result.balance, result.error, result.ledger, result.numerics)
    numbers = [value for table in tables for value in table.values() if isinstance(value, float)]
    traces = [trace for name, trace in result.cycle.items() if name != "oil_temperature"]
    positive = [result.cycle[name] for name in ("pressure", "gas_temperature", "gas_mass") if name in result.cycle]
    return bool(
        np.all(np.isfinite(numbers))
        and all(np.all(np.isfinite(trace)) for trace in traces)
        and all(np.all(trace > 0.0) for trace in positive)
    )
