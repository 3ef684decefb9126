"""Access control of the server: only pages that it served itself, under the name by which it was called.

The program listens on the loopback address, so that no other machine reaches it; but every page in the user's browser
does. Such a page has another origin, or makes its own name point here (DNS rebinding), which the Host header reveals.
Under any other address a token is required too.
"""

import hmac
from dataclasses import dataclass
from urllib.parse import parse_qs

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LARGEST_BODY = 64_000  # [byte] of the body of a request
SAFE_FETCH_SITES = ("same-origin", "none")  # Sec-Fetch-Site of requests by the user or by our own page


@dataclass(frozen=True)
class AccessRules:
    """Where the server answers: the names by which it may be called (none: any), and the required token."""

    names: frozenset[str]
    token: str = ""

    def refuses(self, scope: Scope) -> tuple[int, str]:
        """Return the status and the reason for refusing a request; (0, '') if it is accepted."""
        # a header that occurs twice becomes a text that equals nothing
        headers: dict[str, str] = {}
        for raw_name, raw in scope["headers"]:
            name, value = raw_name.decode("latin-1").lower(), raw.decode("latin-1")
            headers[name] = f"{headers[name]}, {value}" if name in headers else value
        host, origin = headers.get("host", ""), headers.get("origin")
        if self.names and host not in self.names:
            return 403, "called under another host name (open the address that screwsim explore printed)"
        if origin is not None and origin not in (f"http://{host}", f"https://{host}"):
            return 403, "asked by another page"
        if headers.get("sec-fetch-site", "none") not in SAFE_FETCH_SITES and not _is_navigation(scope, headers):
            return 403, "asked by another page"
        if scope["type"] == "websocket" and origin is None and "sec-fetch-site" in headers:
            return 403, "requested by a page without an origin"
        token = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if self.token and not hmac.compare_digest(token.encode(), self.token.encode()):
            return 403, "the token is missing or wrong (open the full address that screwsim explore printed)"
        length = headers.get("content-length", "0")
        if not length.isdigit() or int(length) > LARGEST_BODY:
            return 413, f"the body is larger than {LARGEST_BODY} bytes"
        return 0, ""


def _is_navigation(scope: Scope, headers: dict[str, str]) -> bool:
    """Tell whether a user is following a link to the page."""
    return scope.get("method") == "GET" and headers.get("sec-fetch-mode") == "navigate"


class Guard:
    """Middleware that passes requests not refused by `AccessRules`, and no body beyond `LARGEST_BODY`."""

    def __init__(self, app: ASGIApp, rules: AccessRules) -> None:
        self._app, self._rules = app, rules

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        status, reason = self._rules.refuses(scope)
        if status:
            if scope["type"] == "websocket":
                await receive()  # the connect
            await PlainTextResponse(f"{reason}\n", status, {"connection": "close"})(scope, receive, send)
        else:
            await self._app(scope, _limited_receiver(receive) if scope["type"] == "http" else receive, send)


def _limited_receiver(receive: Receive) -> Receive:
    """Return a receiver that reports a disconnect once a body, sent in parts, exceeds `LARGEST_BODY`."""
    taken = 0

    async def bounded() -> Message:
        nonlocal taken
        message = await receive()
        taken += len(message.get("body", b""))
        return {"type": "http.disconnect"} if taken > LARGEST_BODY else message

    return bounded
