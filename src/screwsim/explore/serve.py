"""`screwsim explore` from its arguments to a running server: the address, the token, the browser.

The server delivers the page, keeps its connection for settings and answers, and makes requested files.
"""

import asyncio
import ipaddress
import json
import os
import secrets
import socket
import threading
import webbrowser
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from functools import partial

import uvicorn
from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket, WebSocketDisconnect

from screwsim.explore.answer import FILE, unpack_message
from screwsim.explore.changes import SceneArguments, open_base
from screwsim.explore.guard import AccessRules, Guard
from screwsim.explore.page import page_text
from screwsim.explore.pages import LONGEST_MESSAGE, InvalidMessage, Page, RateLimit
from screwsim.explore.worker import Job
from screwsim.explore.worker_pool import Timeouts, WorkerPool, start_fork_server
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import with_printed_units
from screwsim.study.pool.workers import cores

MOST_PAGES = 32  # most pages open at once
WRONG, FULL = 1008, 1013  # close codes of a connection
SEND_TIMEOUT = 30.0  # [s] within which a page must accept an answer
FILE_TYPES = {"report": "text/html; charset=utf-8", "scene": "application/yaml; charset=utf-8"}
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
LOOPBACK = "127.0.0.1"
PORT = 8421  # if it is free
MOST_WORKERS = 4
MOST_CONNECTIONS = 128  # most connections at once
CLOSE_TIMEOUT = 2  # [s] left to pages at the end


@dataclass(frozen=True)
class Address:
    """A listening socket, and how to reach it."""

    socket: socket.socket
    url: str
    rules: AccessRules


def listen(host: str, port: int | None) -> Address:
    """Return where the page is served: on loopback under its own names only, elsewhere with a token.

    Without a port, `PORT` or any free one is used; raise UsageError where a requested port is not free.
    """
    bound = _bound(host, port)
    number = bound.getsockname()[1]
    shown = f"[{host}]" if ":" in host else host
    if is_loopback(host):
        names = frozenset(f"{name}:{number}" for name in (shown, LOOPBACK, "localhost", "[::1]"))
        return Address(bound, f"http://{shown}:{number}/", AccessRules(names))
    token = secrets.token_urlsafe(24)
    name = socket.gethostname() if host in ("0.0.0.0", "::") else shown
    return Address(bound, f"http://{name}:{number}/?token={token}", AccessRules(frozenset(), token))


def is_loopback(host: str) -> bool:
    """Tell whether an address can be reached only from this machine."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _bound(host: str, port: int | None) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    if port is None:
        with suppress(OSError):
            return socket.create_server((host, PORT), family=family, backlog=64)
    port = port or 0
    try:
        return socket.create_server((host, port), family=family, backlog=64)
    except (OSError, OverflowError) as error:
        number = getattr(error, "errno", None)
        told = f"--host {host} --port {port}: cannot listen there: {os.strerror(number) if number else error}"
        raise UsageError(f"{told} (choose another --port, or omit it)") from None


def configured(app: ASGIApp) -> uvicorn.Config:
    """Return the server's configuration: all inputs are bounded, and only its own faults are logged."""
    return uvicorn.Config(
        app,
        http="h11",
        ws="websockets-sansio",
        loop="asyncio",
        ws_max_size=LONGEST_MESSAGE,
        ws_per_message_deflate=False,  # takes longer than the loopback transfer
        limit_concurrency=MOST_CONNECTIONS,
        timeout_graceful_shutdown=CLOSE_TIMEOUT,
        log_config=None,
        log_level="error",  # not each request that is not HTTP, of which anyone can send many
        access_log=False,
        proxy_headers=False,
        server_header=False,
    )


def serve(
    file: str,
    overrides: Sequence[str],
    without: Sequence[str],
    host: str,
    port: int | None,
    browser: bool,
    say: Callable[[str], None],
) -> None:
    """Serve the page of a scene until Ctrl-C."""
    base = open_base(file, overrides, without)
    address = listen(host, port)
    start_fork_server()
    say(f"{address.url} shows {with_printed_units(base.scene.title) or file} (Ctrl-C ends it)")
    if browser:
        threading.Timer(0.5, webbrowser.open, (address.url,)).start()
    uvicorn.Server(configured(prepared_server(base, address.rules))).run(sockets=[address.socket])


@dataclass
class ServerState:
    """State of the server: the page's text, the workers, the open pages."""

    text: str  # with @NONCE@ in place of its policy's nonce
    crew: WorkerPool
    pages: set[Page] = field(default_factory=set)
    files: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(2))


def prepared_server(
    base: SceneArguments,
    rules: AccessRules,
    workers: int | None = None,
    patience: Timeouts = Timeouts(),  # noqa: B008
) -> ASGIApp:
    """Return the server of a scene as an ASGI application."""
    count = workers or max(1, min(cores(), MOST_WORKERS))
    desk = ServerState(page_text(base, slopes=count > 1), WorkerPool(base, count, patience))

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        await desk.crew.start()
        try:
            yield
        finally:
            await desk.crew.stop()

    routes = [
        Route("/", partial(_page, desk), methods=["GET"]),
        Route("/make/{kind}", partial(_file_response, desk), methods=["POST"]),
        WebSocketRoute("/line", partial(_line, desk)),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), rules)


async def _page(desk: ServerState, request: Request) -> Response:
    """Return the page; its policy forbids loading anything, and allows connections to this server only."""
    nonce, host = secrets.token_urlsafe(16), request.headers.get("host", "")
    policy = (
        f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data: blob:; "
        f"connect-src 'self' ws://{host} wss://{host}; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
    )
    return HTMLResponse(desk.text.replace("@NONCE@", nonce), headers={**HEADERS, "Content-Security-Policy": policy})


async def _line(desk: ServerState, socket: WebSocket) -> None:
    """Serve the connection of a page while it is open."""
    await socket.accept()
    if len(desk.pages) >= MOST_PAGES:
        await socket.close(FULL, f"{MOST_PAGES} pages are open")
        return
    sending = asyncio.Lock()

    async def send(message: bytes) -> None:
        async with sending, asyncio.timeout(SEND_TIMEOUT):
            await socket.send_bytes(message)

    page = Page(desk.crew, send)
    desk.pages.add(page)
    tasks = [asyncio.create_task(each) for each in (_read(socket, page), page.work(), page.work_aside())]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        wrong = next((error for task in done if isinstance(error := task.exception(), InvalidMessage)), None)
        if wrong is not None:
            await socket.close(WRONG, str(wrong)[:120])
    finally:
        page.gone = True
        desk.pages.discard(page)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        with suppress(RuntimeError, WebSocketDisconnect):
            await socket.close()


async def _read(socket: WebSocket, page: Page) -> None:
    pace = RateLimit()
    with suppress(WebSocketDisconnect):
        while True:
            try:
                text = await socket.receive_text()
            except KeyError:
                raise InvalidMessage("a message is not text") from None
            page.take(text)
            if wait := pace.wait():
                await asyncio.sleep(wait)


async def _file_response(desk: ServerState, request: Request) -> Response:
    """Return a file made from settings: a report's page, or the complete scene."""
    kind = request.path_params["kind"]
    if kind not in FILE_TYPES:
        return PlainTextResponse("there is no such file\n", 404, HEADERS)
    try:
        settings = (await request.body()).decode()
        if request.headers.get("content-type", "").startswith("text/plain"):  # a form: settings={…}
            settings = settings.partition("=")[2].strip()
        changes = json.loads(settings)
    except (ValueError, RecursionError):
        return PlainTextResponse("the settings are not JSON\n", 400, HEADERS)
    except ClientDisconnect:
        return PlainTextResponse("the body is too large\n", 413, HEADERS)
    async with desk.files:
        worker = await desk.crew.lend()
        found = await desk.crew.solve(worker, Job(kind, changes, {}), lambda: False, lambda text: None)
    head, _ = unpack_message(found)
    if head["kind"] != FILE:
        return PlainTextResponse(f"{head['message']}\n", 422, HEADERS)
    return Response(head["text"], media_type=FILE_TYPES[kind], headers=HEADERS)
