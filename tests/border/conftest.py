"""The command run in this process."""

from collections.abc import Callable
from typing import NamedTuple

import pytest

from screwsim import cli


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
