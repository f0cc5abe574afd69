"""Chromium driven through its DevTools protocol: load a page, press what is on it, read it, photograph it.

No browser driver is needed: the protocol is JSON over a websocket, and tornado, on which Bokeh's server stands, has a
client for that. The browser talks to this machine alone.
"""

from __future__ import annotations

import asyncio
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

NAMES = ("chromium", "chromium-browser", "google-chrome")
LIMIT = 120.0
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1 , EXCLUDE localhost",
    "--remote-debugging-address=127.0.0.1",
    "--remote-debugging-port=0",
)
DEEP = """
function deep(root, found = []) {
  for (const element of root.querySelectorAll("*")) {
    found.push(element);
    if (element.shadowRoot) deep(element.shadowRoot, found);
  }
  return found;
}
function named(text) {
  return deep(document).find(e => e.tagName === "BUTTON" && e.textContent.trim() === text);
}
function words() {
  return deep(document).filter(e => !["SCRIPT", "STYLE"].includes(e.tagName)).flatMap(e => [...e.childNodes])
    .filter(n => n.nodeType === 3).map(n => n.textContent.trim()).filter(t => t).join("\\n");
}
function model(name) {
  return Bokeh.documents[0].get_model_by_name(name);
}
function field(label) {
  const group = deep(document).find(e => e.tagName === "LABEL" && e.textContent.trim() === label && e.offsetParent);
  return group.parentElement.querySelector("input, select");
}
"""
"""What the page is read and pressed with; parts of Bokeh's page live in shadow roots."""


def find_chromium() -> str | None:
    """Path of the browser, None where there is none."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Chromium:
    """One browser with one page; use it in a `with` block.

    Args:
        size: of the window, pixels.
    """

    def __init__(self, size: tuple[int, int] = (1400, 1000)) -> None:
        self._size = size
        self.complaints: list[str] = []
        self.requested: list[str] = []
        self._number = 0

    def __enter__(self) -> Chromium:
        path = find_chromium()
        if path is None:
            raise FileNotFoundError("chromium (Debian's package)")
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        window = f"--window-size={self._size[0]},{self._size[1]}"
        command = [path, *FLAGS, window, f"--user-data-dir={self._folder.name}", "about:blank"]
        self._process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        self._loop = asyncio.new_event_loop()
        try:
            self._socket = self._loop.run_until_complete(_connect(self._address()))
            self._attach()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_exception: object) -> None:
        if hasattr(self, "_socket"):
            self._socket.close()
            self._loop.run_until_complete(asyncio.sleep(0.1))
        self._process.terminate()
        try:
            self._process.wait(LIMIT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait(LIMIT)
        self._loop.close()
        self._folder.cleanup()

    def _address(self) -> str:
        """Address of the browser's websocket, from the file that it writes when it listens."""
        file = Path(self._folder.name) / "DevToolsActivePort"
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            lines = file.read_text().split() if file.exists() else []
            if len(lines) == 2:
                return f"ws://127.0.0.1:{lines[0]}{lines[1]}"
            if self._process.poll() is not None:
                raise AssertionError(f"chromium ended with {self._process.returncode}")
            time.sleep(0.02)
        raise AssertionError(f"chromium didn't listen within {LIMIT:g} s")

    def _attach(self) -> None:
        self._session = ""
        targets = self.send("Target.getTargets")["targetInfos"]
        page = next(t["targetId"] for t in targets if t["type"] == "page")
        self._session = self.send("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    # --- the protocol -------------------------------------------------------------------------------------------------

    def send(self, method: str, **parameters: Any) -> Any:
        """Send a command and return its result; events that come meanwhile are noted."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        return self._loop.run_until_complete(asyncio.wait_for(self._exchange(self._socket, message), LIMIT))

    async def _exchange(self, socket: WebSocketClientConnection, message: dict[str, Any]) -> Any:
        await socket.write_message(json.dumps(message))
        while (text := await socket.read_message()) is not None:
            answer = json.loads(text)
            if answer.get("id") == message["id"]:
                if "error" in answer:
                    raise AssertionError(f"{message['method']}: {answer['error']['message']}")
                return answer["result"]
            self._note(answer.get("method", ""), answer.get("params", {}))
        raise AssertionError("chromium closed the connection")

    def _note(self, event: str, what: dict[str, Any]) -> None:
        if event == "Runtime.consoleAPICalled" and what["type"] in ("error", "assert", "warning"):
            said = " ".join(str(part.get("value", part.get("description", ""))) for part in what["args"])
            self.complaints.append(f"console {what['type']}: {said}")
        elif event == "Runtime.exceptionThrown":
            details = what["exceptionDetails"]
            self.complaints.append(f"exception: {details.get('exception', {}).get('description', details['text'])}")
        elif event == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.complaints.append(f"log: {what['entry']['text']} {what['entry'].get('url', '')}")
        elif event == "Network.requestWillBeSent":
            self.requested.append(what["request"]["url"])
        elif event == "Network.webSocketCreated":
            self.requested.append(what["url"])

    # --- the page -----------------------------------------------------------------------------------------------------

    def open(self, url: str) -> None:
        """Go to an address and wait until Bokeh has built the page."""
        self.send("Page.navigate", url=url)
        self.wait_for("document.readyState === 'complete' && window.Bokeh && Bokeh.documents.length > 0", LIMIT)

    def read(self, expression: str) -> Any:
        """Value of an expression in the page; `deep`, `words`, `named`, `model` and `field` are there."""
        # an arrow function leaves nothing behind in the page
        code = f"(() => {{ {DEEP}; return ({expression}); }})()"
        result = self.send("Runtime.evaluate", expression=code, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise AssertionError(f"{expression}: {result['exceptionDetails']['exception'].get('description')}")
        return result["result"].get("value")

    def wait_for(self, expression: str, limit: float = LIMIT, also: Callable[[], str] = str) -> Any:
        """Wait until an expression in the page is true and return it; fails with what the page says."""
        end = time.monotonic() + limit
        while time.monotonic() < end:
            value = self.read(expression)
            if value:
                return value
            time.sleep(0.1)
        raise AssertionError(f"not within {limit:g} s: {expression}\n{self.read('words()')[:6000]}\n{also()}")

    def press(self, label: str) -> None:
        """Press a button with the mouse; once more where the page moved away from under it."""
        button = f"named({label!r})"
        self.wait_for(f"{button} && !{button}.disabled")
        self.read(f"({button}.addEventListener('click', () => {{ window.pressed = true; }}, {{once: true}}), 0)")
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            self.read(f"(window.pressed = false, {button}.scrollIntoView({{block: 'center', behavior: 'instant'}}))")
            box = self.read(f"{button}.getBoundingClientRect().toJSON()")
            at = {
                "x": box["x"] + box["width"] / 2,
                "y": box["y"] + box["height"] / 2,
                "button": "left",
                "clickCount": 1,
            }
            for kind in ("mousePressed", "mouseReleased"):
                self.send("Input.dispatchMouseEvent", type=kind, **at)
            if self.read("window.pressed"):
                return
        raise AssertionError(f"the mouse never met the button {label}")

    def enter(self, label: str, value: object) -> None:
        """Type a value into the field with a label, or choose it there."""
        self.read(
            f"(e => {{ e.value = {json.dumps(str(value))}; e.dispatchEvent(new Event('change', {{bubbles: true}})); }})"
            f"(field({label!r}))"
        )

    def photograph(self, path: Path, height: int | None = None) -> None:
        """Picture of the page, down to a height (pixels), or of the window."""
        options: dict[str, Any] = {"format": "png"}
        self.read("window.scrollTo({top: 0, behavior: 'instant'})")
        if height is not None:
            clip = {"x": 0, "y": 0, "width": self._size[0], "height": height, "scale": 1}
            options |= {"captureBeyondViewport": True, "clip": clip}
        path.write_bytes(base64.b64decode(self.send("Page.captureScreenshot", **options)["data"]))


async def _connect(url: str) -> WebSocketClientConnection:
    return await websocket_connect(url, max_message_size=2**28)


def chromium_or_reason() -> str:
    """Why there can be no test with a browser here, "" where there can."""
    if find_chromium() is None and os.environ.get("CI") != "true":
        return "chromium isn't installed (Debian's package)"
    return ""
