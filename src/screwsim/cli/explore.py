"""The command that shows a machine as a live page: settings under sliders, solved anew while one looks."""

from typing import Annotated

import typer

from screwsim.cli.options import Overrides, SceneFile, Without, option
from screwsim.screen import say

Port = Annotated[int | None, option("N", "Port (default: 8421, or any that is free).", "--port", min=0, max=65535)]


def explore(
    scene_file: SceneFile,
    overrides: Overrides = None,
    without: Without = None,
    port: Port = None,
    host: Annotated[
        str, option("ADDRESS", "Address to listen on; any but the loopback one asks for a token.", "--host")
    ] = "127.0.0.1",
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")] = True,
) -> None:
    """Show a scene as a live page in the browser: sliders, rotors that turn, p–V that follows; Ctrl-C ends it."""
    from screwsim.explore import check_extra

    check_extra()
    from screwsim.explore.serve import serve

    serve(scene_file, overrides or (), without or (), host, port, browser, say)
