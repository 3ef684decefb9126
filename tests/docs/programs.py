"""Lines of pages that start something else than screwsim's commands: programs of the repository, and the live page."""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import urllib.request
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from snippets import ROOT

SECONDS = 300.0  # until a program is taken to hang


@dataclass(frozen=True)
class Program:
    """How a line of a page is run: whether among what runs long, as another line, or by another program; and why."""

    long: bool = False
    instead: str = ""
    by: str = ""  # a file of the repository with `instead` in it
    why: str = ""


PROGRAMS = {  # by the words of the line
    "scripts/reproduce": Program(long=True),
    "scripts/test": Program(
        instead='scripts/test --all "$@"', by=".ci/run", why="whatever runs this test is started by it"
    ),
    "python scripts/admissible.py sample 256": Program(
        long=True, instead="python scripts/admissible.py sample 2", why="256 machines take an hour"
    ),
    "python scripts/fit_paper.py COUNT": Program(
        long=True,
        instead="""python -c "import sys; sys.path.insert(0, 'scripts'); import fit_paper as it
print(it.Paper().residuals(it.starts(1)[0][1]))" """,
        why="one start takes many minutes: what it asks at its first step, once",
    ),
    "python validation/bitzer/points.py": Program(),
    "python benchmarks/export_map.py": Program(
        long=True,
        instead="python benchmarks/export_map.py configs/r134a/map.yaml 0.02",
        why="a coarser map, made sooner",
    ),
    "python scripts/coupling.py": Program(),
    "python scripts/drive.py": Program(long=True),
    "python scripts/tolerance_study.py": Program(long=True),
    "python scripts/connecting_rod.py": Program(long=True),
    "python docs/tools/slider_crank_numbers.py": Program(long=True),
    "python docs/tools/new_valves.py": Program(long=True),
    "python docs/tools/oil_ratio.py": Program(long=True),
    "python docs/tools/economizer_port.py": Program(long=True),
    "python docs/tools/package_coolers.py": Program(long=True),
}


def environment(folder: Path) -> dict[str, str]:
    """Return the variables for a program: `python` is this one, and a browser that is opened is none."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "MPLBACKEND": "Agg", "BROWSER": "true", "MPLCONFIGDIR": str(folder / "mpl")}


def make_environment(folder: Path) -> None:
    """Give a folder a .venv with the packages of this one and marks of what is installed, but with files its own."""
    own, here = folder / ".venv", Path(sys.prefix)
    own.mkdir()
    for name in ("bin", "lib", "include", "pyvenv.cfg"):
        if (here / name).exists():
            os.symlink(here / name, own / name)
    for name in ("pyproject.toml", "constraints.txt"):
        shutil.copyfile(ROOT / name, folder / name)
    stamp = f". scripts/environment.sh; wanted >.venv/screwsim-stamp-report; ln -s {shlex.quote(str(ROOT / 'src'))} src"
    subprocess.run(["bash", "-c", stamp], cwd=folder, env=environment(folder), check=True)
    if "SCREWSIM_CACHE" in os.environ:  # models compiled already
        os.symlink(os.environ["SCREWSIM_CACHE"], own / "screwsim-cache")


def run(line: str, folder: Path, run_long: bool) -> None:
    """Run a line in a folder with copies of what the repository has; raise where it fails or prints nothing."""
    program = PROGRAMS[line]
    if program.by:
        assert program.instead in (ROOT / program.by).read_text(encoding="utf-8")
        return
    words, written = shlex.split(program.instead or line), shlex.split(line)
    assert (folder / written[written[0] == "python"]).is_file()
    if program.long and not run_long:
        return
    if words[0] != "python":
        make_environment(folder)
    done = subprocess.run(
        words, cwd=folder, env=environment(folder), capture_output=True, text=True, timeout=SECONDS, check=False
    )
    assert done.returncode == 0, f"{words}: {done.stderr[-2000:]}"
    assert done.stdout.strip(), f"{words} says nothing"


def run_script(text: str, folder: Path) -> None:
    """Run lines of a shell in a folder, and end what they leave in the background; raise where one fails."""
    pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    command = ["bash", "-euc", text]
    with subprocess.Popen(command, cwd=folder, env=environment(folder), start_new_session=True, **pipes) as process:
        try:
            code = process.wait(SECONDS)
        finally:
            with suppress(ProcessLookupError):  # nothing is left
                os.killpg(process.pid, signal.SIGTERM)
        assert code == 0, process.stderr.read().decode()[-2000:]


def open_page(words: list[str], folder: Path) -> None:
    """Start the live page as its line says, load it, and end it as a hand would."""
    command = [sys.executable, "-m", *words]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=folder, env=environment(folder), text=True, **pipes) as process:
        try:
            said = process.stdout.readline()
            address = re.match(r"(http://\S+) shows ", said)
            assert address is not None, said or process.stderr.read()
            with urllib.request.urlopen(address[1], timeout=60.0) as answer:
                page = answer.read().decode()
            assert "<title>" in page and "</html>" in page
            process.send_signal(signal.SIGINT)
            assert process.wait(30.0) == 130
        finally:
            with suppress(ProcessLookupError):
                process.kill()
