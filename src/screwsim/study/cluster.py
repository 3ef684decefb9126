"""Workers of a dask scheduler as the pool of a sweep (docs/clusters.md); an extra: `pip install screwsim[dask]`."""

from __future__ import annotations

import json
import logging
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from screwsim.faults import UsageError
from screwsim.results.schema import version
from screwsim.study.workers import LOST
from screwsim.textfiles import Unreadable, read_text

_PATIENCE = 60.0  # [s] for the scheduler's answer, and again for the first worker
_REMEDY = "give tcp://HOST:PORT, or the file that `dask scheduler --scheduler-file FILE` writes"


class Cluster:
    """A scheduler with its workers, which may come and go while a sweep runs."""

    def __init__(self, where: str, patience: float = _PATIENCE) -> None:
        self._where = where
        self._patience = patience
        self._client: Any = None

    def __enter__(self) -> Cluster:
        """Connect, and wait for the first worker; raise UsageError, in one line, when that fails."""
        self._client = _connect(self._where, self._patience)
        try:
            self._await_worker()
        except BaseException:
            self._client.close()
            raise
        return self

    def __exit__(self, *error: object) -> None:
        self._client.close()

    def _await_worker(self) -> None:
        try:
            self._client.wait_for_workers(1, timeout=self._patience)
            found = self._client.submit(version, pure=False).result(self._patience)
        except TimeoutError:
            remedy = "start some with `dask worker`, and look at their logs"
            raise UsageError(f"{self._where}: no worker came within {self._patience:g} s ({remedy})") from None
        except ImportError as error:
            raise UsageError(f"{self._where}: its workers lack screwsim: {error} (install it where they run)") from None
        if found != version():
            raise UsageError(f"{self._where}: its workers have screwsim {found}, not {version()} (install one version)")

    def executor(self, jobs: int) -> Executor:
        """Return an executor over all workers."""
        return self._client.get_executor(pure=False)

    def workers(self) -> int:
        """Return the number of threads of all workers, at the moment."""
        try:
            return max(1, sum(self._client.nthreads().values()))
        except OSError:
            raise UsageError(LOST) from None


def _connect(where: str, patience: float) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise UsageError("--scheduler needs dask (pip install 'screwsim[dask]')") from None
    address = _address(where)
    _silence()
    try:
        return Client(address, timeout=patience, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error).splitlines()[0] if str(error) else "no answer"
        raise UsageError(f"{where}: no scheduler can be reached: {reason} ({_REMEDY})") from None


def _silence() -> None:
    """Keep dask's own messages off the terminal: what they tell of lost workers, a sweep tells in one line."""
    for name in [*logging.root.manager.loggerDict]:
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _address(where: str) -> str:
    """Return the address of a scheduler from itself or from a scheduler file."""
    if "://" in where:
        return where
    path = Path(where)
    if not path.is_file():
        host, colon, port = where.rpartition(":")
        if colon and host and port.isdigit():
            return f"tcp://{where}"
        raise UsageError(f"{where}: is neither an address nor a file ({_REMEDY})")
    try:
        return str(json.loads(read_text(path))["address"])
    except (Unreadable, ValueError, RecursionError, KeyError, TypeError):
        raise UsageError(f"{where}: is no scheduler file ({_REMEDY})") from None
