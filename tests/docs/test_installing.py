"""What pages say of installing is done, in environments of their own: with a network alone, where .ci/run asks for it.

Packages come from the index of pip's own settings. Where it does not answer, the tests are left out, and say so.
"""

import os
import re
import shlex
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest
from shown import commands
from snippets import PAGES, ROOT, blocks

INSTALLS = ("pip install", "python3 -m venv", ".venv/bin/pip", ". .venv/bin/activate")
RELEASE = re.compile(r"screwsim-(\d+\.\d+\.\d+)")
pytestmark = [
    pytest.mark.around,
    pytest.mark.skipif(not os.environ.get("SCREWSIM_LONG_SNIPPETS"), reason="SCREWSIM_LONG_SNIPPETS is not set"),
]


def installing(page: Path) -> list[str]:
    """Return the lines of a page that install, as they stand there."""
    shells = [block.text for block in blocks(page) if block.kind == "shell"]
    return [line for text in shells for line, _ in commands(text) if line.startswith(INSTALLS)]


def released() -> list[str]:
    """Return the blocks that build a release and look at it."""
    found = [block.text for block in blocks(ROOT / "docs" / "how-to" / "releasing.md") if "not run," in block.notes]
    assert len(found) == 2 and all(RELEASE.search(text) for text in found)
    return found


def environment(**more: str) -> dict[str, str]:
    """Return the variables: this Python under the names that pages call it by, and the pins of the repository."""
    kept = {
        name: value for name, value in os.environ.items() if name not in ("VIRTUAL_ENV", "PYTHONPATH", "SCREWSIM_CACHE")
    }
    path = os.pathsep.join([str(Path(sys.executable).parent), kept["PATH"]])
    return {**kept, "PATH": path, "PIP_CONSTRAINT": str(ROOT / "constraints.txt"), "MPLBACKEND": "Agg", **more}


def shell(text: str, folder: Path, **more: str) -> str:
    """Run lines in a folder, and return what they print; raise with what went wrong."""
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", text],
        cwd=folder, env=environment(**more), capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, f"{text}\n{done.stdout[-1000:]}{done.stderr[-2000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def index(tmp_path_factory) -> None:
    """Leave the test out where no package can be had."""
    pinned = re.search(r"^typer==\S+", (ROOT / "constraints.txt").read_text(encoding="utf-8"), re.M)
    ask = [
        sys.executable,
        "-m",
        "pip",
        "download",
        "-q",
        "--no-deps",
        "--no-cache-dir",
        "--retries",
        "0",
        "--timeout",
        "20",
    ]
    asked = [*ask, "-d", str(tmp_path_factory.mktemp("asked")), pinned[0]]
    done = subprocess.run(asked, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"no package index answers: {done.stderr.strip().splitlines()[-1]}")


@pytest.fixture(scope="module")
def release(tmp_path_factory) -> Path:
    """Return a checkout of what is here, tagged as the page of releasing has it, with what it builds in `dist`."""
    folder = tmp_path_factory.mktemp("release")
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", str(folder)], cwd=ROOT, check=True)
    (packed,) = folder.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(folder, filter="data")
    checkout = folder / packed.name.removesuffix(".tar.gz")
    (checkout / "PKG-INFO").unlink()  # a checkout has none: its version is that of the tag
    version = RELEASE.search(released()[0])[1]
    who = "git -c user.name=test -c user.email=test@localhost"
    shell(f"git init -q; git add -A -f; {who} commit -q -m all; {who} tag -a v{version} -m {version}", checkout)
    shell(released()[0], checkout)
    return checkout


@pytest.mark.parametrize(
    "page", [page for page in PAGES if installing(page)], ids=lambda page: page.relative_to(ROOT).as_posix()
)
def test_lines_that_install_do(page, index, release, tmp_path):
    lines = installing(page)
    made = any("-m venv" in line for line in lines)
    where = release if made else tmp_path  # in a checkout, or anywhere
    before = "" if made else "python3 -m venv .venv; . .venv/bin/activate\n"
    quick = {
        "PIP_NO_COMPILE": "1",
        "PIP_FIND_LINKS": f"{os.environ.get('PIP_FIND_LINKS', '')} {release / 'dist'}".strip(),
    }
    shell(f"rm -rf .venv\n{before}" + "\n".join(lines), where, **quick)
    version = RELEASE.search(released()[0])[1]
    assert shell(f"{shlex.quote(str(where))}/.venv/bin/screwsim --version", tmp_path) == f"screwsim {version}\n"
    extras = re.findall(r"\[([a-z]+)\]", " ".join(lines))
    if extras:
        brings = {"report": "jinja2, plotly", "explore": "starlette, uvicorn, websockets"}
        shell("\n".join(f".venv/bin/python -c 'import {brings[each]}'" for each in extras), where)


def test_the_wheel_runs_what_commands_name_in_an_empty_environment(index, release, tmp_path):
    """Nothing but the wheel and its dependencies: the page's lines, then other commands that name what is shipped."""
    empty, folder = tmp_path / "empty", tmp_path / "folder"
    folder.mkdir()
    lines = released()[1].replace("/tmp/empty", str(empty)).replace("cd /tmp ", f"cd {folder} ")
    cache = {"SCREWSIM_CACHE": str(tmp_path / "cache"), "PIP_NO_COMPILE": "1"}
    (tmp_path / "cache").mkdir(mode=0o700)
    told = shell(lines, release, **cache)
    assert "status: ok" in told and "limits" in told
    found = shell(f"{empty}/bin/python -c 'import screwsim; print(screwsim.__file__)'", folder)
    assert found.startswith(str(empty))
    for command in (
        "new refrigeration --fluid R134a --displacement '600 m^3/h' --condition '0/40 degC' -o mine.yaml",
        "run mine.yaml -o mine.h5",
        "plot mine.h5 -o pictures",
        "run configs/r134a/point.yaml --json",
        "explain configs/two_stage/plant.stages.yaml",
        "tolerance configs/slider_crank/air.yaml",
        "validate limits --jobs 1",
    ):
        assert shell(f"{empty}/bin/screwsim {command}", folder, **cache).strip()
