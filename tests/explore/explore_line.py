"""A server of the live page in a thread of the test, and a page that is none: it asks and reads answers."""

import json
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import uvicorn
from websockets.sync.client import connect

from screwsim.explore.answer import unpack_message
from screwsim.explore.changes import open_base
from screwsim.explore.serve import configured, listen, prepared_server
from screwsim.explore.worker_pool import Timeouts

PAPER = str(Path(__file__).parents[2] / "configs" / "paper" / "point.yaml")


class Served:
    """A server that runs: its address, its scene."""

    def __init__(self, file, address, base):
        self.file, self.url, self.base, self.rules = file, address.url, base, address.rules

    @property
    def host(self):
        return self.url.split("/")[2]


@contextmanager
def served(file=PAPER, overrides=(), host="127.0.0.1", workers=1, patience=Timeouts()):  # noqa: B008
    """Serve a scene for as long as the block lasts."""
    base = open_base(file, overrides)
    address = listen(host, 0)
    server = uvicorn.Server(configured(prepared_server(base, address.rules, workers, patience)))
    thread = threading.Thread(target=server.run, args=([address.socket],), daemon=True)
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.01)
    try:
        yield Served(file, address, base)
    finally:
        server.should_exit = True
        thread.join(20.0)
        assert not thread.is_alive()


class Line:
    """What the page's script does at its line: numbered settings go out, heads and traces come back."""

    def __init__(self, server, **more):
        self.line = connect(f"ws://{server.host}/line{server.url.partition(server.host)[2][1:]}", **more)
        self.number, self.notes = 0, []

    def __enter__(self):
        self.socket = self.line.__enter__()
        return self

    def __exit__(self, *raised):
        self.line.__exit__(*raised)

    def ask(self, values=(), **effects):
        """Send settings; return their number."""
        self.number += 1
        changes = {"set": dict(values), "effects": effects}
        self.socket.send(json.dumps({"kind": "point", "number": self.number, "changes": changes}))
        return self.number

    def send(self, message):
        self.socket.send(message if isinstance(message, str | bytes) else json.dumps(message))

    def next(self, timeout=60.0):
        """Return head and numbers of the next message that is no note."""
        while True:
            head, numbers = unpack_message(self.socket.recv(timeout))
            if head["kind"] != "note":
                return head, numbers
            self.notes.append(head["text"])

    def answer(self, values=(), **effects):
        """Send settings; return the head of the answer to them."""
        number = self.ask(values, **effects)
        while True:
            head, _ = self.next()
            if head.get("number") == number:
                return head
