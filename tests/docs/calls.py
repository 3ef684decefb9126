"""A command of screwsim on a page, held against the command line as it is: subcommand, options, values, files."""

import re
import shlex
from functools import cache
from pathlib import Path

import typer

from screwsim import cli
from screwsim.scene import load
from screwsim.study.calibration.read import read_fit
from screwsim.study.stages import read_stages

# what stands for what in a synopsis: something that the command takes
STANDS = {
    "SCENE.yaml": "configs/r134a/point.yaml",
    "SCENE": "configs/r134a/point.yaml",
    "PLANT.stages.yaml": "configs/two_stage/plant.stages.yaml",
    "FIT.yaml": "configs/calibration/leakage.fit.yaml",
    "SCENE|SWEEP": "configs/r134a/map.yaml",
    "LOW/HIGH": "0/40 degC",
    "PATH=LOW..HIGH": "oil_supply.ratio=0.5..2",
    "PATH=VALUE": "operation.speed=3000 rpm",
    "FIGURE=VALUE": "cooling_capacity=220 kW",
    "KIND": "refrigeration",
    "F": "R134a",
    "FLOW": "600 m^3/h",
    "POWER": "45 kW",
    "PRESSURE": "7.5 bar(g)",
    "GROUP": "leaks",
    "PATH": "oil_supply.ratio",
    "FIGURE": "isothermal_efficiency",
    "EFFECT": "tip_leakage",
    "N": "2",
    "SHARE": "0.5",
    "ODDS": "0.1",
    "SECONDS": "10",
    "ADDRESS|FILE": "s.json",
    "SEPR|points.csv": "SEPR",
    "OUT.html|pdf": "OUT.html",
}
NAMES = {"NAME": {"optimum": "cop", "validate": "cagi"}}
AS_THEY_ARE = {"OUT.h5", "A.h5", "B.h5", "OUT.html", "DIR", "OUT"}  # names of files that need not be there
ALTERNATIVES = re.compile(r"\[([^\[\]]*?) \| ([^\[\]]*?)\]")


def is_synopsis(command: str) -> bool:
    """Tell whether words of a command stand for others."""
    command = command.partition("  #")[0]
    words = set(re.split(r"[\s\[\]]+", command))
    return bool(words & (STANDS.keys() | NAMES.keys() | AS_THEY_ARE)) or "PATH" in command or "…" in words


def written_out(command: str) -> list[str]:
    """Return the commands that a synopsis stands for, with all of its options in them."""
    found = ALTERNATIVES.search(command)
    if found:
        return [each for way in found.groups() for each in written_out(command.replace(found[0], way, 1))]
    command = command.replace("]...", "]").replace("]…", "]")
    command = re.sub(r"(?:--[a-z-]+ )?…", "", command)  # an option whose value is left open, and more of the same
    command = command.replace("[=LOW..HIGH]", "=LOW..HIGH").replace("[", " ").replace("]", " ")
    words = shlex.split(command, comments=True)
    standing = STANDS | {name: by.get(words[1], name) for name, by in NAMES.items()}
    return [shlex.join(standing.get(word, word) for word in words)]


@cache
def line():
    """Return the command line with all its commands."""
    return typer.main.get_command(cli.app)


def taken(arguments: list[str]) -> dict:
    """Return the parameters of a command as its own parser reads them; raise where it does not take them."""
    command, words = line(), list(arguments)
    while hasattr(command, "commands"):
        command = command.commands[words.pop(0)]
    return command.make_context("screwsim", words).params


def exists(command: str) -> None:
    """Raise where words that begin with `screwsim` name a command or an option that is not there."""
    words = [word.strip("[],") for word in command.split()[1:]]
    found = line()
    while hasattr(found, "commands") and words and re.fullmatch(r"[a-z_]+", words[0]):
        found = found.commands[words.pop(0)]
    if hasattr(found, "commands"):  # any of a group
        return
    options = {name for each in found.params for name in each.opts} | {"--help"}
    assert {word.partition("=")[0] for word in words if word.startswith("-") and word != "-"} <= options, command


def check(arguments: list[str], promised: set[str]) -> dict:
    """Return the parameters; raise where the command line is not one of screwsim, a file is not there, a scene is bad.

    Files that are promised need not be there: a command that is not run would have written them.
    """
    params = taken(arguments)
    read = [value for name, value in params.items() if isinstance(value, str) and name.endswith(("file", "source"))]
    for file in read:
        if file in promised and not Path(file).is_file():
            continue
        assert Path(file).is_file(), f"{file} is not there"
        if file.endswith(".fit.yaml"):
            read_fit(file)
        elif file.endswith(".stages.yaml"):
            read_stages(file, params.get("overrides") or ())
        elif file.endswith(".yaml"):
            load(file, params.get("overrides") or (), params.get("without") or ())
    return params
