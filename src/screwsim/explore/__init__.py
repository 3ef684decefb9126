"""The live page: a machine with sliders in a browser, solved again at each change (`screwsim explore`)."""

from importlib.util import find_spec

from screwsim.inputs.faults import UsageError

__all__ = ["check_extra"]

_NEEDED = ("starlette", "uvicorn", "websockets", "jinja2", "plotly")


def check_extra() -> None:
    """Raise UsageError, in one line, when a package that the page needs is not installed."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise UsageError(f"the live page needs {', '.join(missing)}: pip install 'screwsim[explore]'")
