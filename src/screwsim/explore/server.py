"""The server of the page: the page itself, its line for settings and answers, and what it makes files of."""

import asyncio
import json
import secrets
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from screwsim.explore.answer import FILE, unpacked
from screwsim.explore.crew import Crew
from screwsim.explore.guard import App, Guard, Rules
from screwsim.explore.pages import Pace, Page, Wrong
from screwsim.explore.worker import Job

MOST_PAGES = 32  # open at once
WRONG, FULL = 1008, 1013  # codes of closing a line
SENDING = 30.0  # [s] in which a page has to take an answer
FILES = {"report": "text/html; charset=utf-8", "scene": "application/yaml; charset=utf-8"}
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


@dataclass
class Desk:
    """What the server has: the page's text, the workers, the pages that are open."""

    text: str  # with @NONCE@ where its policy's nonce goes
    crew: Crew
    pages: set[Page] = field(default_factory=set)
    files: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(2))


def application(desk: Desk, rules: Rules) -> App:
    """Return the server as an ASGI application."""

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        await desk.crew.start()
        try:
            yield
        finally:
            await desk.crew.stop()

    async def page(request: Request) -> Response:
        return _page(desk, request)

    async def line(socket: WebSocket) -> None:
        await _line(desk, socket)

    async def made(request: Request) -> Response:
        return await _made(desk, request)

    routes = [
        Route("/", page, methods=["GET"]),
        Route("/make/{kind}", made, methods=["POST"]),
        WebSocketRoute("/line", line),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), rules)


def _page(desk: Desk, request: Request) -> Response:
    """Return the page; its policy lets it load nothing, and speak to this server alone."""
    nonce, host = secrets.token_urlsafe(16), request.headers.get("host", "")
    policy = (
        f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data: blob:; "
        f"connect-src 'self' ws://{host} wss://{host}; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
    )
    return HTMLResponse(desk.text.replace("@NONCE@", nonce), headers={**HEADERS, "Content-Security-Policy": policy})


async def _line(desk: Desk, socket: WebSocket) -> None:
    """Answer a page for as long as it is open."""
    await socket.accept()
    if len(desk.pages) >= MOST_PAGES:
        await socket.close(FULL, f"{MOST_PAGES} pages are open")
        return
    sending = asyncio.Lock()

    async def send(message: bytes) -> None:
        async with sending, asyncio.timeout(SENDING):
            await socket.send_bytes(message)

    page = Page(desk.crew, send)
    desk.pages.add(page)
    tasks = [asyncio.create_task(each) for each in (_read(socket, page), page.work(), page.work_aside())]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        wrong = next((error for task in done if isinstance(error := task.exception(), Wrong)), None)
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
    pace = Pace()
    with suppress(WebSocketDisconnect):
        while True:
            try:
                text = await socket.receive_text()
            except KeyError:
                raise Wrong("a message is no text") from None
            page.take(text)
            if wait := pace.wait():
                await asyncio.sleep(wait)


async def _made(desk: Desk, request: Request) -> Response:
    """Return what is made of settings: a report's page, or the whole scene."""
    kind = request.path_params["kind"]
    if kind not in FILES:
        return PlainTextResponse("there is no such file\n", 404, HEADERS)
    try:
        changes = _changes((await request.body()).decode(), request.headers.get("content-type", ""))
    except (ValueError, RecursionError):
        return PlainTextResponse("the settings are no JSON\n", 400, HEADERS)
    except ClientDisconnect:
        return PlainTextResponse("the body is too large\n", 413, HEADERS)
    async with desk.files:
        worker = await desk.crew.lend()
        found = await desk.crew.solve(worker, Job(kind, changes, {}), lambda: False, lambda text: None)
    return _file(kind, found)


def _changes(body: str, kind: str) -> Any:
    """Return the settings that a form or a script sent."""
    if kind.startswith("text/plain"):  # a form: settings={…}
        body = body.partition("=")[2].strip()
    return json.loads(body)


def _file(kind: str, found: bytes) -> Response:
    head, _ = unpacked(found)
    if head["kind"] != FILE:
        return PlainTextResponse(f"{head['message']}\n", 422, HEADERS)
    return Response(head["text"], media_type=FILES[kind], headers=HEADERS)
