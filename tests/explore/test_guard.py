"""Only a page that the server itself gave is answered, under its name and with its token; nothing large is read."""

import http.client
import json
import logging

import pytest
from each_row import each_row
from explore_line import Line, served
from websockets.exceptions import ConnectionClosed, InvalidStatus

from screwsim.explore.guard import LARGEST_BODY, AccessRules, Guard
from screwsim.explore.pages import BURST, RATE, RateLimit
from screwsim.explore.serve import configured, is_loopback

HOST = "127.0.0.1:8421"
OWN = AccessRules(frozenset({HOST, "localhost:8421"}))
ELSEWHERE = AccessRules(frozenset(), "secret")


def asked(rules, headers, query="", kind="http", method="GET"):
    """Return the status with which a request is refused, 0 where it is not."""
    raw = [(name.encode(), value.encode()) for name, value in headers]
    scope = {"type": kind, "method": method, "headers": raw, "query_string": query.encode()}
    return rules.refuses(scope)[0]


@each_row("host", ["evil.example", "127.0.0.1:80", "127.0.0.1", "", "localhost:8421.evil.example"])
def test_another_name_is_refused(host):
    assert asked(OWN, [("host", host)]) == 403


def test_two_names_are_refused():
    assert asked(OWN, [("host", HOST), ("host", "evil.example")]) == 403


@each_row("origin", ["http://evil.example", "null", "http://127.0.0.1:80", "file://", f"ftp://{HOST}"])
@each_row("kind", ["http", "websocket"])
def test_another_origin_is_refused(origin, kind):
    assert asked(OWN, [("host", HOST), ("origin", origin)], kind=kind, method="POST") == 403


def test_its_own_page_is_answered():
    for name in OWN.names:
        headers = [("host", name), ("origin", f"http://{name}"), ("sec-fetch-site", "same-origin")]
        assert asked(OWN, headers, kind="websocket") == 0
        assert asked(OWN, headers, method="POST") == 0


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_what_a_browser_calls_foreign_is_refused(site):
    headers = [("host", HOST), ("sec-fetch-site", site)]
    assert asked(OWN, [*headers, ("sec-fetch-mode", "no-cors")]) == 403
    assert asked(OWN, [*headers, ("sec-fetch-mode", "navigate")], method="POST") == 403
    assert asked(OWN, headers, kind="websocket") == 403
    assert asked(OWN, [*headers, ("sec-fetch-mode", "navigate")]) == 0  # a link on another page, which sees nothing


@each_row("query", ["", "token=", "token=secre", "token=secrets", "other=secret", "token=wrong&token=secret"])
def test_without_its_token_another_address_answers_nobody(query):
    for kind in ("http", "websocket"):
        assert asked(ELSEWHERE, [("host", "machine:8421")], query, kind) == 403


def test_with_the_token_it_answers():
    assert asked(ELSEWHERE, [("host", "machine:8421"), ("origin", "http://machine:8421")], "token=secret") == 0
    assert asked(ELSEWHERE, [("host", "machine:8421"), ("origin", "http://evil.example")], "token=secret") == 403


@each_row("length", [str(LARGEST_BODY + 1), "-1", "x", "1e3", ""])
def test_a_body_of_another_size_is_refused(length):
    assert asked(OWN, [("host", HOST), ("content-length", length)], method="POST") == 413


@each_row(
    ("host", "is_own"),
    [("127.0.0.1", True), ("127.1.2.3", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("box", False)],
)
def test_loopback_is_known(host, is_own):
    assert is_loopback(host) == is_own


def test_who_sends_more_than_the_rate_waits():
    pace = RateLimit()
    waits = [pace.wait() for _ in range(int(BURST + RATE))]
    assert waits[0] == 0.0
    assert waits[-1] == pytest.approx(1.0, abs=0.2)  # as many beyond the burst as pass in a second


@pytest.fixture(scope="module")
def server():
    with served() as found:
        yield found


def fetched(server, method="GET", path="/", body=None, **headers):
    line = http.client.HTTPConnection(server.host, timeout=30)
    line.request(method, path, body, headers)
    response = line.getresponse()
    text = response.read().decode()
    line.close()
    return response, text


def test_the_page_loads_nothing_and_speaks_to_its_server_alone(server):
    response, text = fetched(server)
    assert response.status == 200
    policy = response.headers["Content-Security-Policy"]
    nonce = policy.partition("'nonce-")[2].partition("'")[0]
    assert "default-src 'none'" in policy and "unsafe" not in policy and f'nonce="{nonce}"' in text
    assert f"connect-src 'self' ws://{server.host} wss://{server.host};" in policy
    for word in ("http://", "https://", "@NONCE@", "src="):
        assert word not in text
    assert nonce not in fetched(server)[1]


@pytest.mark.parametrize("headers", [{"Host": "evil.example"}, {"Origin": "http://evil.example"}])
def test_the_server_refuses_foreigners(server, headers):
    for method, path in (("GET", "/"), ("POST", "/make/scene")):
        response, text = fetched(server, method, path, "{}" if method == "POST" else None, **headers)
        assert response.status == 403 and len(text.splitlines()) == 1
    with pytest.raises(InvalidStatus) as refusal, Line(server, additional_headers=headers):
        pass
    assert refusal.value.response.status_code in (400, 403)  # 400: two Host headers


def test_large_bodies_are_refused_whole_and_in_parts(server):
    assert fetched(server, "POST", "/make/scene", "x" * (LARGEST_BODY + 1))[0].status == 413
    parts = (b"x" * 10_000 for _ in range(20))
    line = http.client.HTTPConnection(server.host, timeout=30)
    try:
        line.request("POST", "/make/scene", parts, encode_chunked=True, headers={"Transfer-Encoding": "chunked"})
        assert line.getresponse().status == 413
    except ConnectionError:  # closed while it was still sent
        pass
    finally:
        line.close()


@pytest.mark.parametrize("path", ["/make/other", "/../etc/passwd", "/static/x", "/docs", "/make/scene/x"])
def test_there_is_nothing_else(server, path):
    assert fetched(server, path=path)[0].status in (404, 405)


@pytest.mark.parametrize("body", ["", "no json", "[" * 60_000, "\udcff".encode("utf-8", "surrogateescape")])
def test_a_body_that_is_no_json_is_refused(server, body):
    assert fetched(server, "POST", "/make/scene", body)[0].status == 400


def test_a_scene_is_made_of_settings(server):
    body = json.dumps({"set": {"operation.speed": "1500 rpm"}})
    response, text = fetched(server, "POST", "/make/scene", f"settings={body}\r\n", **{"Content-Type": "text/plain"})
    assert response.status == 200 and "speed: 1500 rpm" in text
    response, text = fetched(server, "POST", "/make/scene", json.dumps({"set": {"title": "x"}}))
    assert response.status == 422 and text.startswith("title: ")


@pytest.mark.parametrize(
    "message",
    [
        "no json",
        "[]",
        '{"kind": "other"}',
        '{"kind": "point", "number": 2}',
        '{"kind": "point", "number": true}',
        '{"kind": "point", "number": "1"}',
        '{"kind": "curve", "id": 1, "points": [["a"]], "changes": {}}',
        '{"kind": "curve", "id": 1, "points": 3, "changes": {}}',
        json.dumps({"kind": "around", "id": 1, "points": [["a", 1]] * 201, "changes": {}}),
        "[" * 50_000,
        b"\x00\x01",
    ],
)
def test_a_line_that_speaks_otherwise_is_closed(server, message):
    with Line(server) as line:
        line.send(message)
        with pytest.raises(ConnectionClosed) as closed:
            line.next(10.0)
        assert closed.value.rcvd.code == 1008 and closed.value.rcvd.reason


def test_a_message_that_is_too_large_closes_its_line(server):
    with Line(server) as line:
        line.send("x" * 70_000)
        with pytest.raises(ConnectionClosed) as closed:
            line.next(10.0)
        assert closed.value.rcvd.code == 1009


def test_another_address_asks_for_the_token(tmp_path):
    with served(host="0.0.0.0") as found:
        found.url = found.url.replace(found.host.partition(":")[0], "127.0.0.1")  # as a client may call it
        assert fetched(found)[0].status == 403
        assert fetched(found, path=f"/?token={found.rules.token}")[0].status == 200
        with Line(found) as line:
            assert line.answer()["status"] == "ok"
        found.url = found.url.partition("?")[0]
        with pytest.raises(InvalidStatus), Line(found):
            pass


def test_a_request_that_is_no_http_is_not_told_in_the_terminal():
    configured(Guard(lambda scope, receive, send: None, AccessRules(frozenset())))
    logger = logging.getLogger("uvicorn.error")
    assert not logger.isEnabledFor(logging.WARNING) and logger.isEnabledFor(logging.ERROR)
