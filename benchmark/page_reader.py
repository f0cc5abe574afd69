"""Is a page of the dashboard without painting it: takes every message that a browser takes and answers at once.

    python benchmark/page_reader.py http://127.0.0.1:PORT/ SECONDS

Speaks the protocol of Bokeh's websocket (Bokeh's own client isn't made for a stream without end: it calls itself for
each message). Prints how many updates came, and how many bytes.
"""

from __future__ import annotations

import asyncio
import json
import re
import sys
import time
from typing import Any

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

LARGEST = 2**28
PATIENCE = 300.0


class Reader:
    """One page.

    Args:
        connection: Bokeh's websocket.
    """

    def __init__(self, connection: WebSocketClientConnection) -> None:
        self._connection = connection
        self._number = 0
        self.bytes = self.binary = 0

    async def message(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Header and content of the next message; its buffers are taken in and counted."""
        parts = [await self._part() for _ in range(3)]
        header, content = json.loads(parts[0]), json.loads(parts[2])
        for _ in range(header.get("num_buffers", 0)):
            await self._part()
            self.binary += len(await self._part())
        return header, content

    async def _part(self) -> str | bytes:
        part = await self._connection.read_message()
        if part is None:
            raise ConnectionError("the server closed the page")
        self.bytes += len(part)
        return part

    async def send(self, kind: str, content: dict[str, Any]) -> None:
        """Send a message without buffers."""
        self._number += 1
        for part in ({"msgid": f"reader{self._number}", "msgtype": kind}, {}, content):
            await self._connection.write_message(json.dumps(part))

    async def document(self) -> dict[str, Any]:
        """Ask for the page's models."""
        await self.send("PULL-DOC-REQ", {})
        while True:
            header, content = await self.message()
            if header["msgtype"] == "PULL-DOC-REPLY":
                return content

    async def answer(self, model: str, number: int) -> None:
        """Say that an update has arrived."""
        new = {"type": "map", "entries": [["n", [number]]]}
        event = {"kind": "ModelChanged", "model": {"id": model}, "attr": "data", "new": new}
        await self.send("PATCH-DOC", {"events": [event]})


async def connect(url: str) -> Reader:
    """Open a page as a browser does: the document first, then the websocket with the session's token."""
    response = await AsyncHTTPClient().fetch(url, connect_timeout=PATIENCE, request_timeout=PATIENCE)
    found = re.search(r'"token":"([^"]+)"', response.body.decode())
    if found is None:
        raise ConnectionError("no session in the page")
    request = HTTPRequest(url.replace("http", "ws", 1) + "ws", connect_timeout=PATIENCE, request_timeout=PATIENCE)
    connection = await websocket_connect(request, subprotocols=["bokeh", found[1]], max_message_size=LARGEST)
    reader = Reader(connection)
    await reader.message()
    return reader


def parts_of_pulse(document: Any) -> tuple[str, str]:
    """Ids of the source whose number has to be answered, and of the one that takes the answer."""
    divs = [model["attributes"] for model in objects(document) if model.get("name") == "Div"]
    pulse = next(attributes for attributes in divs if attributes.get("name") == "banner")["tags"][0]
    callbacks = dict(pulse["attributes"]["js_property_callbacks"]["entries"])["change:data"]
    arguments = dict(callbacks[0]["attributes"]["args"]["entries"])
    return pulse["id"], arguments["answer"]["id"]


def objects(value: Any) -> list[dict[str, Any]]:
    """All serialized models below a value."""
    found = []
    if isinstance(value, dict):
        if value.get("type") == "object":
            found.append(value)
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            found += objects(item)
    return found


def number_in(event: dict[str, Any], pulse: str) -> int | None:
    """Number of the update where an event is one."""
    if event.get("model", {}).get("id") != pulse:
        return None
    data: Any = event.get("new", event.get("data"))
    return int(dict(data["entries"])["n"][0])


async def read(url: str, seconds: float) -> dict[str, float]:
    """Be a page for some seconds."""
    reader = await connect(url)
    pulse, answer = parts_of_pulse(await reader.document())
    began, count, size = time.monotonic(), 0, reader.bytes
    while time.monotonic() < began + seconds:
        header, content = await reader.message()
        if header["msgtype"] != "PATCH-DOC":
            continue
        for event in content["events"]:
            number = number_in(event, pulse)
            if number is not None:
                count += 1
                await reader.answer(answer, number)
    spent = time.monotonic() - began
    return {"updates": count, "updates_per_second": count / spent, "bytes_per_second": (reader.bytes - size) / spent}


if __name__ == "__main__":
    print(json.dumps(asyncio.run(read(sys.argv[1], float(sys.argv[2])))))
