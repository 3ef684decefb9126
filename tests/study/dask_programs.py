"""Programs of dask, forked from one process that has imported what each of them needs half a second to import."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# a program reads its own variables where it asks for them; those of dask's settings count when the server starts
SERVER = """\
import json, os, signal, sys
import distributed.cli.dask_scheduler, distributed.cli.dask_worker
from dask.cli import run_cli

def reap(*_):
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass

signal.signal(signal.SIGCHLD, reap)
for line in sys.stdin:
    if number := os.fork():
        print(number, flush=True)
        continue
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    asked = json.loads(line)
    os.environ.clear()
    os.environ.update(asked["variables"])
    sys.path[:0] = os.environ["PYTHONPATH"].split(os.pathsep)
    os.chdir(asked["folder"])
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    log = os.open("dask.log", os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.dup2(log, 1), os.dup2(log, 2)
    sys.argv = ["dask", *asked["arguments"]]
    sys.exit(run_cli())
"""


class Program:
    """A program that runs, with the methods of a `subprocess.Popen` that the tests need."""

    def __init__(self, number: int) -> None:
        self.number = number

    def _runs(self) -> bool:
        try:
            os.kill(self.number, 0)
        except ProcessLookupError:
            return False
        return True

    def _send(self, sign: int) -> None:
        if self._runs():
            os.kill(self.number, sign)

    def terminate(self) -> None:
        self._send(signal.SIGTERM)

    def kill(self) -> None:
        self._send(signal.SIGKILL)

    def wait(self, seconds: float) -> None:
        deadline = time.monotonic() + seconds
        while self._runs():
            assert time.monotonic() < deadline, "the program does not end"
            time.sleep(0.01)


class Server:
    """Starts programs of dask; their output goes to dask.log of their folder."""

    def __init__(self, variables: dict[str, str]) -> None:
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self.process = subprocess.Popen([sys.executable, "-c", SERVER], env=variables, text=True, **pipes)

    def start(self, *arguments: str, variables: dict[str, str], folder: Path) -> Program:
        assert self.process.stdin is not None and self.process.stdout is not None
        asked = {"arguments": arguments, "variables": variables, "folder": str(folder)}
        self.process.stdin.write(json.dumps(asked) + "\n")
        self.process.stdin.flush()
        return Program(int(self.process.stdout.readline()))


@contextmanager
def server(variables: dict[str, str]) -> Iterator[Server]:
    """Give a server that ends with the block."""
    found = Server(variables)
    with found.process:
        yield found
        found.process.communicate()
