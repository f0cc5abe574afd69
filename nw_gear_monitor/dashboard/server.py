"""Serves the page: Bokeh's server behind the gate, in a thread of its own with its own loop."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import socket
import threading

from bokeh.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.document import Document
from bokeh.server.server import BaseServer
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop, PeriodicCallback

from nw_gear_common.errors import InputError
from nw_gear_monitor.dashboard.application import GatedTornado
from nw_gear_monitor.dashboard.digest import Digest, digest
from nw_gear_monitor.dashboard.gate import Gate
from nw_gear_monitor.dashboard.page import Page, Show

DIGEST_MS = 1000
START_WITHIN = 10.0
STOP_WITHIN = 3.0


class Server:
    """The page's server.

    Args:
        show: what pages show; its `digest` is this server's.
        address, port: to listen on; port 0 takes any free one.
        token: that requests have to carry, "" for none.

    Raises:
        InputError: the address can't be listened on.
    """

    def __init__(self, address: str, port: int, token: str) -> None:
        self._digest = Digest()
        self._computing = False
        self._token, self._address = token, address
        try:
            self._socket = socket.create_server((address, port), family=_family(address))
        except OSError as error:
            reason = errno.errorcode.get(error.errno or 0, "") if error.strerror is None else error.strerror
            raise InputError("parameter port", f"a free port of {address}", f"{port} ({reason})") from None
        self._socket.setblocking(False)
        self.port: int = self._socket.getsockname()[1]
        host = f"[{address}]" if ":" in address else address
        self.url = f"http://{host}:{self.port}/"
        self._loop: IOLoop | None = None
        self._ready = threading.Event()
        self._thread: threading.Thread | None = None
        self.error = ""

    def digest(self) -> Digest:
        """The newest pictures that took computing."""
        return self._digest

    def start(self, show: Show) -> None:
        """Begin to serve."""
        logging.getLogger("bokeh").setLevel(logging.WARNING)
        logging.getLogger("bokeh.server.views.ws").setLevel(logging.ERROR)  # a browser that has gone is no trouble
        logging.getLogger("tornado.access").setLevel(logging.ERROR)
        self._thread = threading.Thread(target=self._work, args=(show,), name="server", daemon=True)
        self._thread.start()
        self._ready.wait(START_WITHIN)

    def stop(self) -> None:
        """Close all connections and the port."""
        loop = self._loop
        if loop is not None:
            loop.add_callback(loop.stop)
        if self._thread is not None:
            self._thread.join(STOP_WITHIN)
        self._socket.close()

    @property
    def sessions(self) -> int:
        """Pages that are open."""
        return self._count

    _count = 0

    # --- the server's thread ------------------------------------------------------------------------------------------

    def _work(self, show: Show) -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        loop = self._loop = IOLoop.current()
        application = Application(FunctionHandler(lambda document: _build(document, show)))
        tornado = GatedTornado(application, Gate(self._address, self.port, self._token))
        http = HTTPServer(tornado)
        http.add_socket(self._socket)
        server = BaseServer(loop, tornado, http)
        server.start()
        refresh = PeriodicCallback(lambda: self._refresh(server, show), DIGEST_MS)
        refresh.start()
        self._ready.set()
        try:
            loop.start()
        finally:
            refresh.stop()
            server.stop(wait=False)
            with contextlib.suppress(TimeoutError):
                loop.run_sync(http.close_all_connections, timeout=STOP_WITHIN)
            loop.close(all_fds=True)

    def _refresh(self, server: BaseServer, show: Show) -> None:
        """Let the pictures be computed anew by another thread, where anybody looks and they aren't being computed."""
        self._count = len(server.get_sessions("/"))
        if not self._count or self._computing:
            return
        self._computing = True
        threading.Thread(target=self._compute, args=(show,), name="digest", daemon=True).start()

    def _compute(self, show: Show) -> None:
        try:
            self._digest = digest(show.feed, self._digest)
        except Exception as error:  # a page with some pictures missing is better than none; the node tells
            self.error = f"{type(error).__name__}: {error}"
        finally:
            self._computing = False


def _build(document: Document, show: Show) -> None:
    Page(document, show)


def _family(address: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in address else socket.AF_INET
