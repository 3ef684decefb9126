"""The process that solves for pages: it reads jobs from a pipe and answers each; it may be killed at any time.

Its output to stderr during compilation is sent to the page as notes.
"""

import contextlib
import io
import os
import re
import signal
import sys
import tempfile
import threading
import zlib
from collections.abc import Callable, Mapping
from functools import lru_cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

from screwsim.explore import answer
from screwsim.explore.changes import (
    SceneArguments,
    open_base,
    overrides_of,
    python_text,
    read_changes,
    scene_of,
    shell_command,
    yaml_text,
)
from screwsim.explore.machine import document as drawn_machine
from screwsim.inputs.faults import SceneError, UsageError, in_one_line
from screwsim.numerics.folder import adopt_worker_state
from screwsim.scene.types import Scene
from screwsim.scene.units import Refused
from screwsim.simulate import simulate
from screwsim.study.pool.workers import end_with_parent

NOTE, DONE = "note", "done"
SECTIONS = ("machine", "gas", "oil", "operation", "oil_supply", "effects", "numerics", "output", "sweep")
MOST_DRAWINGS = 8  # most drawings of machines that are cached
MEMORY_LIMIT = 4 << 30  # [byte] of address space beyond the initial one, where the system can limit it


class Job(NamedTuple):
    """A request to a worker: a kind of `JOBS`, a page's changes as received, and the key of the drawn machine.

    `tag` comes back in the head of the answer.
    """

    kind: str
    changes: Any
    tag: Mapping[str, Any]
    machine: str = ""


class _PageStream(io.TextIOBase):
    """Replacement for stderr that sends each line to the page."""

    def __init__(self, pipe: Connection) -> None:
        super().__init__()
        self._pipe = pipe

    def write(self, text: str, /) -> int:
        line = text.strip().removeprefix("screwsim: ")
        if line:
            self._pipe.send((NOTE, line[:300]))
        return len(text)


def serve_jobs(pipe: Connection, file: str, overrides: tuple[str, ...], known: Any) -> None:
    """Answer jobs until the pipe ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    adopt_worker_state(known)
    sys.stderr = _PageStream(pipe)
    threading.Thread(target=end_with_parent, daemon=True).start()
    _bound_memory()
    with contextlib.suppress(EOFError, OSError):
        while True:
            job = pipe.recv()
            pipe.send((DONE, answer_job((file, overrides), job)))


def _bound_memory() -> None:
    """Limit the memory, so that a scene that needs too much fails by itself."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        with open("/proc/self/statm", encoding="ascii") as file:
            used = int(file.read().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY_LIMIT, resource.getrlimit(resource.RLIMIT_AS)[1]))


_base = lru_cache(maxsize=1)(open_base)
_drawn = lru_cache(maxsize=MOST_DRAWINGS)(drawn_machine)


def answer_job(named: tuple[str, tuple[str, ...]], job: Job) -> bytes:
    """Return the answer to a job on the named scene; every failure is an answer too."""
    try:
        base = _base(*named)
        overrides = overrides_of(base, read_changes(job.changes))
        return JOBS[job.kind](base, overrides, scene_of(base, overrides), job)
    except SceneError as error:
        # path and fault only, as a page has neither file nor line
        matches = (re.search(rf"(?:^|: )((?:{'|'.join(SECTIONS)})(?:\.[\w.]+)?): (.*)$", line) for line in error.lines)
        found = zip(matches, error.lines, strict=True)
        faults = [[match[1], match[2]] if match else ["", line] for match, line in found]
        text = "\n".join(": ".join(filter(None, fault)) for fault in faults)
        return answer.refused_answer(text, {**job.tag, "faults": faults})
    except (Refused, UsageError) as error:
        return answer.refused_answer(str(error), job.tag)
    except MemoryError:
        return answer.refused_answer("the solution needs too much memory (change the settings)", job.tag)
    except Exception as error:  # noqa: BLE001 - the page reports it and continues
        what = f"internal error: {in_one_line(error)}; please report it with these settings"
        return answer.refused_answer(what, job.tag)


def _point(base: SceneArguments, overrides: list[str], scene: Scene, job: Job) -> bytes:
    """Return the complete answer for one point, with commands and texts that reproduce it."""
    text = {
        "overrides": overrides,
        "shell": shell_command(base, overrides),
        "python": python_text(base, overrides),
        "yaml": yaml_text(base, overrides),
    }
    key = f"{zlib.crc32(repr(scene.machine).encode()):08x}"  # a short text that differs between machines
    about = {**job.tag, "texts": text, "machine_key": key, "process": os.getpid()}
    about |= {} if key == job.machine else {"machine": _drawn(scene.machine)}
    return answer.result_answer(simulate(scene), about)


def _curve(base: SceneArguments, overrides: list[str], scene: Scene, job: Job) -> bytes:
    """Return the answer for a point of a small sweep: only its figures."""
    found = simulate(scene, trace=False)
    return answer.pack_message({"kind": answer.CURVE, **answer.figures_document(found), **job.tag})


def _slopes(base: SceneArguments, overrides: list[str], scene: Scene, job: Job) -> bytes:
    """Return the exact derivatives of all figures by the numbers of the scene, as far as they exist.

    They come with the uncertainties due to the tolerances of the scene.
    """
    from screwsim.derivatives.solving import scene_derivatives
    from screwsim.study.uncertainty.slopes import numeric_paths
    from screwsim.study.uncertainty.spreads import spreads_of

    values = numeric_paths(scene)[0]
    by_path = scene_derivatives(scene, values).derivatives
    by_figure: dict[str, dict[str, float]] = {}
    for path, each in by_path.items():
        for name, slope in each.items():
            by_figure.setdefault(name, {})[path] = slope
    there = {path: value for path, value in values.items() if path in by_path}
    halves = {name: spread.expanded for name, spread in spreads_of(scene, there, by_figure).items()}
    lost = [path for path in scene.uncertain if path not in by_path]
    slopes = {path: answer.finite(each) for path, each in by_path.items()}  # [SI], by path and figure
    return answer.pack_message({"kind": answer.SLOPES, "slopes": slopes, **job.tag, "halves": halves, "lost": lost})


def _report(base: SceneArguments, overrides: list[str], scene: Scene, job: Job) -> bytes:
    """Return the page of a results file of one point."""
    from screwsim.report.page import page_of
    from screwsim.results import open_results, save
    from screwsim.study.uncertainty.point import with_uncertainty

    with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
        path = Path(folder) / "explored.h5"
        save(path, scene, with_uncertainty(scene, simulate(scene)))
        return answer.file_answer(page_of(open_results(path)))


def _complete_scene(base: SceneArguments, overrides: list[str], scene: Scene, job: Job) -> bytes:
    """Return the scene as YAML that needs no base."""
    return answer.file_answer(scene.text)


JOBS: Mapping[str, Callable[[SceneArguments, list[str], Scene, Job], bytes]] = {
    "point": _point,
    "curve": _curve,
    "slopes": _slopes,
    "report": _report,
    "scene": _complete_scene,
}
