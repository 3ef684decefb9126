"""Fakes of results, and the command run in this process."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from screwsim import cli

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent / name) for name in ("results", "report", "hard")]


class Answer(NamedTuple):
    """How a command ended, and what it printed."""

    code: int
    out: str
    err: str


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """Return a function that runs `screwsim ARGUMENTS…` in this process."""

    def call(*arguments: object) -> Answer:
        code = cli.exit_code([str(each) for each in arguments])
        return Answer(code, *capsys.readouterr())

    return call
