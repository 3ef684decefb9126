"""The live page: one self-contained HTML text that loads nothing."""

import json
from typing import Any

from screwsim.explore.answer import about_figure
from screwsim.explore.changes import SceneArguments
from screwsim.explore.controls import document as controls
from screwsim.explore.machine import document as machine
from screwsim.figures import known
from screwsim.outputs.customary import with_printed_units
from screwsim.report.page import rendered

_SHARED = ("dom", "numbers", "ledger", "theme")  # with the report's page
_SCRIPTS = (*_SHARED, "number", "chart", "machine", "controls", "show", "around", "state", "line", "start")


def page_text(base: SceneArguments, slopes: bool) -> str:
    """Return the page of a scene; @NONCE@ marks the place of its policy's single-use number.

    `slopes` tells whether the server has a separate worker for derivatives.
    """
    text = json.dumps({**document(base), "slopes": slopes}, allow_nan=False)
    embedded = text.replace(
        "<", "\\u003c"
    )  # JSON in a page must not end the element that it is in; it is ASCII otherwise
    title = with_printed_units(base.scene.title) or base.file
    return rendered(__name__, _SCRIPTS, title=title, file=base.file, document=embedded)


def document(base: SceneArguments) -> dict[str, Any]:
    """Return the initial data of the page's script."""
    return {
        "file": base.file,
        "title": with_printed_units(base.scene.title),
        **controls(base),
        "machine": machine(base.scene.machine),
        "figures": [about_figure(figure) for figure in known().values()],
    }
