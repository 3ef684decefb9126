"""`screwsim explore` from its arguments to a server that runs: the address, the token, the browser."""

from __future__ import annotations

import ipaddress
import os
import secrets
import socket
import threading
import webbrowser
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import uvicorn

from screwsim.explore.changes import Base, open_base
from screwsim.explore.crew import Crew, Patience
from screwsim.explore.guard import App, Rules
from screwsim.explore.page import page_text
from screwsim.explore.pages import LONGEST
from screwsim.explore.server import Desk, application
from screwsim.inputs.faults import UsageError
from screwsim.study.workers import cores

LOOPBACK = "127.0.0.1"
PORT = 8421  # where it is free
MOST_WORKERS = 4
MOST_LINES = 128  # connections at once
CLOSING = 2  # [s] that pages have at the end


@dataclass(frozen=True)
class Address:
    """A socket that listens, and how it is reached."""

    socket: socket.socket
    url: str
    rules: Rules


def listen(host: str, port: int | None) -> Address:
    """Return where the page is served: on the loopback address by its own names alone, elsewhere by a token.

    Without a port it is `PORT`, or any that is free; raise UsageError where one that is asked for is not.
    """
    bound = _bound(host, port)
    number = bound.getsockname()[1]
    shown = f"[{host}]" if ":" in host else host
    if is_loopback(host):
        names = frozenset(f"{name}:{number}" for name in (shown, LOOPBACK, "localhost", "[::1]"))
        return Address(bound, f"http://{shown}:{number}/", Rules(names))
    token = secrets.token_urlsafe(24)
    name = socket.gethostname() if host in ("0.0.0.0", "::") else shown
    return Address(bound, f"http://{name}:{number}/?token={token}", Rules(frozenset(), token))


def is_loopback(host: str) -> bool:
    """Tell whether only this machine reaches an address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _bound(host: str, port: int | None) -> socket.socket:
    wanted = [port] if port is not None else [PORT, 0]
    for number in wanted:
        try:
            family = socket.AF_INET6 if ":" in host else socket.AF_INET
            bound = socket.create_server((host, number), family=family, backlog=64)
        except (OSError, OverflowError) as error:
            number_of = getattr(error, "errno", None)
            reason = os.strerror(number_of) if number_of else str(error)
            if number == wanted[-1]:
                raise UsageError(
                    f"--host {host} --port {number}: cannot be listened on: {reason} (choose another --port, or none)"
                ) from None
        else:
            return bound
    raise AssertionError


def prepared(base: Base, rules: Rules, workers: int | None = None, patience: Patience = Patience()) -> App:  # noqa: B008
    """Return the server of a scene."""
    count = workers or max(1, min(cores(), MOST_WORKERS))
    return application(Desk(page_text(base, slopes=count > 1), Crew(base, count, patience)), rules)


def configured(app: App) -> uvicorn.Config:
    """Return how the server runs: what it takes is bounded, and nothing is logged."""
    return uvicorn.Config(
        app,
        http="h11",
        ws="websockets-sansio",
        loop="asyncio",
        ws_max_size=LONGEST,
        ws_per_message_deflate=False,  # it takes longer than the loopback does
        limit_concurrency=MOST_LINES,
        timeout_graceful_shutdown=CLOSING,
        log_config=None,
        access_log=False,
        proxy_headers=False,
        server_header=False,
    )


def serve(
    file: str,
    overrides: Sequence[str],
    without: Sequence[str],
    host: str = LOOPBACK,
    port: int | None = None,
    browser: bool = True,
    say: Callable[[str], None] = print,
) -> None:
    """Serve the page of a scene until Ctrl-C."""
    base = open_base(file, overrides, without)
    address = listen(host, port)
    say(f"{address.url} shows {base.scene.title or file} (Ctrl-C ends it)")
    if browser:
        threading.Timer(0.5, webbrowser.open, (address.url,)).start()
    uvicorn.Server(configured(prepared(base, address.rules))).run(sockets=[address.socket])
