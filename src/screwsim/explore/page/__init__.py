"""The live page: one self-contained HTML text that loads nothing."""

import json
from importlib import resources
from typing import Any

from screwsim.explore.changes import SceneArguments
from screwsim.explore.controls import document as controls
from screwsim.explore.machine import document as machine
from screwsim.outputs.customary import with_printed_units

_SCRIPTS = [
    f"{name}.js" for name in ("number", "chart", "machine", "controls", "show", "around", "state", "line", "start")
]
_SHARED = ("dom.js", "numbers.js", "ledger.js", "theme.js")  # with the report's page


def page_text(base: SceneArguments, slopes: bool = True) -> str:
    """Return the page of a scene; @NONCE@ marks the place of its policy's single-use number.

    `slopes` tells whether the server has a separate worker for derivatives.
    """
    import jinja2

    from screwsim import __version__

    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    scripts = [*(_shared(each) for each in _SHARED), *(_own(each) for each in _SCRIPTS)]
    return environment.from_string(_own("page.html")).render(
        title=with_printed_units(base.scene.title) or base.file,
        file=base.file,
        version=__version__,
        style=_shared("theme.css") + _own("page.css"),
        script="\n".join(scripts),
        document=_embedded({**document(base), "slopes": slopes}),
    )


def document(base: SceneArguments) -> dict[str, Any]:
    """Return the initial data of the page's script."""
    from screwsim.explore.answer import about_figure
    from screwsim.figures import known

    return {
        "file": base.file,
        "title": with_printed_units(base.scene.title),
        **controls(base),
        "machine": machine(base.scene.machine),
        "figures": [about_figure(figure) for figure in known().values()],
    }


def _embedded(data: Any) -> str:
    """Return JSON that cannot end an HTML element."""
    return json.dumps(data, allow_nan=False).replace("<", "\\u003c")  # JSON is ASCII otherwise


def _own(name: str) -> str:
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")


def _shared(name: str) -> str:
    return resources.files("screwsim.report.page").joinpath(name).read_text(encoding="utf-8")
