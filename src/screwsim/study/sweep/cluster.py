"""Workers of a dask scheduler as the pool of a sweep (docs/how-to/clusters.md); extra: `pip install screwsim[dask]`."""

import asyncio
import json
import logging
from collections.abc import Iterable
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Any, Self

from screwsim.inputs.faults import UsageError
from screwsim.inputs.textfiles import Unreadable, read_text
from screwsim.study.pool.workers import SCHEDULER_LOST
from screwsim.study.sweep.agreement import REMEDY, Requirements, what_differs

_TIMEOUT = 60.0  # [s] for the scheduler's answer, for the first worker, and for a lost scheduler to come back
_GRACE = 2.0  # [s] beyond this patience after which a connection that does not respect it is given up
_SHOWN = 3  # workers named in a message
_REMEDY = "give tcp://HOST:PORT, or the file that `dask scheduler --scheduler-file FILE` writes"


class Cluster:
    """A scheduler with its workers, which may come and go while a sweep runs."""

    def __init__(self, where: str, patience: float | None = None, wanted: Requirements | None = None) -> None:
        self._where = where
        self._patience = _TIMEOUT if patience is None else patience
        self._wanted = wanted
        self._asked: set[str] = set()
        self._client: Any = None

    def __enter__(self) -> Self:
        """Connect, and wait for the first worker; raise UsageError, in one line, when that fails."""
        self._client = _connect(self._where, self._patience)
        try:
            try:
                self._client.wait_for_workers(1, timeout=self._patience)
            except TimeoutError:
                remedy = "start some with `dask worker`, and check their logs"
                raise UsageError(f"{self._where}: no worker appeared within {self._patience:g} s ({remedy})") from None
            self.workers()
        except BaseException:
            self._client.close()
            raise
        return self

    def __exit__(self, *error: object) -> None:
        self._client.close()

    def _ask(self, addresses: Iterable[str]) -> None:
        """Raise UsageError, in one line, when workers run code or have files other than this process."""
        new = sorted(set(addresses) - self._asked)
        if self._wanted is None or not new:
            return
        told = self._client.run(what_differs, self._wanted, workers=new, on_error="return")
        wrong = {address: words for address, answer in told.items() if (words := _disagreement_in_words(answer))}
        if wrong:
            shown = ", ".join(f"worker {address} {words}" for address, words in list(wrong.items())[:_SHOWN])
            more = f", and {len(wrong) - _SHOWN} more workers differ" if len(wrong) > _SHOWN else ""
            raise UsageError(f"{self._where}: {shown}{more} ({REMEDY})")
        self._asked |= {address for address, answer in told.items() if answer == ""}

    def executor(self, jobs: int) -> Executor:
        """Return an executor over all workers."""
        return self._client.get_executor(pure=False)

    def workers(self) -> int:
        """Return the present number of threads of all workers; new workers are checked for agreement first."""
        try:
            threads = self._client.nthreads()
            self._ask(threads)
        except OSError:
            raise UsageError(SCHEDULER_LOST) from None
        return max(1, sum(threads.values()))


def _disagreement_in_words(answer: Any) -> str:
    """Return in words how a worker disagrees, from its answer; '' for a worker that is gone."""
    if isinstance(answer, OSError):
        return ""
    if isinstance(answer, BaseException):
        return f"has no screwsim, or a different one: {' '.join(str(answer).split())}"
    return answer


def _connect(where: str, patience: float) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise UsageError("--scheduler needs dask (pip install 'screwsim[dask]')") from None
    address = _address(where)
    # a sweep reports lost workers in one line, so dask need not
    for name in [*logging.root.manager.loggerDict]:
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        with ThreadPoolExecutor(1) as aside:  # the caller's thread may have an event loop of its own, as in a notebook
            aside.submit(asyncio.run, _reach(address, patience)).result()
        return Client(address, timeout=patience, set_as_default=False)
    except (ImportError, OSError, OverflowError, RuntimeError, TypeError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else "no answer"
        raise UsageError(f"{where}: cannot reach a scheduler: {reason} ({_REMEDY})") from None


async def _reach(address: str, patience: float) -> None:
    """Connect and disconnect; raise dask's errors. A `Client` that cannot connect keeps its process from ending."""
    from distributed.comm.core import connect
    from distributed.security import Security

    about = Security().get_connection_args("client")
    comm = await asyncio.wait_for(connect(address, timeout=patience, **about), patience + _GRACE)
    comm.abort()


def _address(where: str) -> str:
    """Return a scheduler's address, given as such or by a scheduler file."""
    if "://" in where:
        return where
    path = Path(where)
    if not path.is_file():
        host, colon, port = where.rpartition(":")
        if colon and host and port.isdigit():
            return f"tcp://{where}"
        raise UsageError(f"{where}: is neither an address nor a file ({_REMEDY})")
    try:
        found = json.loads(read_text(path))["address"]
        if isinstance(found, str) and "://" in found:
            return found
        raise ValueError
    except (Unreadable, ValueError, RecursionError, KeyError, TypeError):
        raise UsageError(f"{where}: is not a scheduler file ({_REMEDY})") from None
