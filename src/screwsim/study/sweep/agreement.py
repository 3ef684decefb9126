"""Checks, by content, that workers run the code with which a sweep began and that the scene's files did not change."""

import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.inputs.textfiles import stamp
from screwsim.results.identity import Files, Identity, code_identity, disagreement, file_identity, files_of
from screwsim.results.schema import named_files
from screwsim.scene.types import Scene

Requirements = Mapping[str, Any]  # of plain types: a worker of another version must be able to read it
REMEDY = "install the same versions and files there as here, and start it again; the sweep resumes"


def requirements_of(scene: Scene) -> Requirements:
    """Return what workers must have: names of own modules, paths of files, and the identity of all code and files."""
    own, files = list(scene.own), named_files(scene)
    return {"own": own, "files": files, "identity": code_identity(own) | file_identity(files)}


def what_differs(wanted: Requirements) -> str:
    """Return in words how this process differs from what is wanted; '' when it does not."""
    try:
        found = code_identity(wanted["own"])
    except ImportError as error:
        return f"cannot import an effect of the scene: {error}"
    return disagreement(found | file_identity(wanted["files"]), wanted["identity"])


def refuse_to_differ(wanted: Requirements) -> None:
    """Raise UsageError, in one line that names this worker, unless it agrees with what is wanted."""
    what = what_differs(wanted)
    if what:
        raise UsageError(f"worker {_own_name()} {what} ({REMEDY})")


def _own_name() -> str:
    """Return the address of a dask worker, else the process number."""
    dask = sys.modules.get("distributed")
    if dask is not None:
        with suppress(ValueError):  # this process is not a dask worker
            return dask.get_worker().address
    return str(os.getpid())


class FileWatch:
    """Watch over the contents of files: results from before and after a change must not mix.

    They began as `identity` has them, by default as they are now.
    """

    def __init__(self, files: Files, identity: Identity | None = None) -> None:
        self._files = files
        self._stamps = {name: stamp(path) for name, path in files.items()}
        self._began = file_identity(files) if identity is None else files_of(identity)

    def changed(self) -> list[str]:
        """Return the names of the files that have another content than at the beginning."""
        stamps = {name: stamp(path) for name, path in self._files.items()}
        if stamps == self._stamps:
            return []
        now = file_identity(self._files)
        names = [name for name, key in zip(self._files, now, strict=True) if now[key] != self._began[key]]
        self._stamps = self._stamps if names else stamps
        return names

    def look(self) -> None:
        """Raise UsageError, in one line, when the content of a file has changed since a sweep began."""
        if self.changed():
            what = disagreement(file_identity(self._files), self._began)
            raise UsageError(
                f"this machine {what}: it was changed during the sweep, whose cases must not mix (undo the change and "
                f"start the sweep again to resume it, or start over with --restart)"
            )
