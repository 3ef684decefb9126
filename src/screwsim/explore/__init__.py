"""The live page: a machine under sliders in a browser, solved anew while one looks (`screwsim explore`)."""

from importlib.util import find_spec

from screwsim.inputs.faults import UsageError

__all__ = ["check_extra"]

_NEEDED = ("starlette", "uvicorn", "websockets", "jinja2", "plotly")


def check_extra() -> None:
    """Raise UsageError in one line when what the page needs is not installed."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise UsageError(f"the live page needs {', '.join(missing)}: pip install 'screwsim[explore]'")
