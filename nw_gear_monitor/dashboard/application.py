"""Bokeh's web application with a gate in front, and with one message for all that an update changes."""

from __future__ import annotations

from collections.abc import Awaitable
from typing import Any

from bokeh.application import Application
from bokeh.document.events import DocumentPatchedEvent
from bokeh.server.connection import ServerConnection
from bokeh.server.contexts import ApplicationContext
from bokeh.server.session import ServerSession
from bokeh.server.tornado import BokehTornado
from bokeh.server.views.ws import WSHandler
from tornado.httputil import HTTPServerRequest
from tornado.web import RequestHandler

from nw_gear_monitor.dashboard.gate import ALLOWED, HAND_OVER, Gate, Verdict

UNUSED_MS = 5000
"""How long a page that nobody looks at any more is kept (ms)."""


class Gathering(ServerConnection):
    """Sends the changes of an update as one message.

    Bokeh looks through all models of the page for each message that it makes; with a message for each change that was
    most of the server's work.
    """

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._events: list[DocumentPatchedEvent] = []

    def send_patch_document(self, event: DocumentPatchedEvent) -> Awaitable[None]:
        """Keep a change; the first of what this returns that is awaited sends all that were kept."""
        self._events.append(event)
        return self._send()

    async def _send(self) -> None:
        events, self._events = self._events, []
        if events:
            await self._socket.send_message(self.protocol.create("PATCH-DOC", events))


class Alive(RequestHandler):
    """Says that the server is there."""

    def get(self) -> None:
        """Answer."""
        self.set_header("Cache-Control", "no-store")
        self.write("alive")


class Refusal(RequestHandler):
    """Answers what the gate didn't let through."""

    def initialize(self, verdict: Verdict, cookie: str) -> None:
        """Take the verdict."""
        self._verdict, self._cookie_name = verdict, cookie

    def prepare(self) -> None:
        """Refuse, or hand the token over to a cookie."""
        if self._verdict.what == HAND_OVER and self.request.method == "GET":
            token = self.get_query_argument("token")
            self.set_cookie(self._cookie_name, token, httponly=True, samesite="Strict")
            self.redirect("/")
            return
        self.set_status(403)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"refused: {self._verdict.reason or 'the token belongs into the cookie'}\n")


class GatedTornado(BokehTornado):
    """Bokeh's application with the gate in front of every request: pages, files and websockets alike."""

    def __init__(self, application: Application, gate: Gate) -> None:
        self._gate = gate
        super().__init__(
            {"/": application},
            extra_patterns=[(r"/alive", Alive)],
            extra_websocket_origins=["*"],  # the gate has compared the origin with the host
            use_index=False,
            unused_session_lifetime_milliseconds=UNUSED_MS,
            check_unused_sessions_milliseconds=UNUSED_MS,
            include_headers=[],
            include_cookies=[],
        )

    def new_connection(
        self, protocol: Any, socket: WSHandler, application_context: ApplicationContext, session: ServerSession
    ) -> ServerConnection:
        """Make the connection of a page that has been opened."""
        connection = Gathering(protocol, socket, application_context, session)
        self._clients.add(connection)
        return connection

    def find_handler(self, request: HTTPServerRequest, **kwargs: Any) -> Any:
        """Let the gate judge first."""
        query = request.query_arguments.get("token", [b""])[-1].decode("ascii", "replace")
        cookie = request.cookies.get(self._gate.cookie)
        verdict = self._gate.judge(request.headers, query, cookie.value if cookie else "")
        if verdict.what == ALLOWED:
            return super().find_handler(request, **kwargs)
        return self.get_handler_delegate(request, Refusal, {"verdict": verdict, "cookie": self._gate.cookie})
