"""A server for one user on this machine, who is known by a token."""

from __future__ import annotations

import re
import secrets
import socket
from collections.abc import Callable
from typing import Any, Final
from urllib.parse import urlencode

from bokeh.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.document import Document
from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.views.doc_handler import DocHandler
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.ioloop import IOLoop
from tornado.web import RequestHandler

from pellicle.errors import ConfigError

ADDRESS = "127.0.0.1"
# bokeh would also serve a script by which other pages embed this one.
_SERVED: Final = re.compile(r"/(ws|favicon\.ico|static/.*)?$")


class _Refused(RequestHandler):
    """Answers whoever does not know the token."""

    def prepare(self) -> None:
        self.set_status(403)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish("Open the address that pellicle explore printed, with its token.\n")


class _Entrance(RequestHandler):
    """Moves the token from the address to a cookie."""

    def initialize(self, cookie: str, token: str) -> None:
        self.cookie, self.token = cookie, token

    def prepare(self) -> None:
        self.set_cookie(self.cookie, self.token, httponly=True, samesite="Strict", path="/")
        self.set_header("Referrer-Policy", "no-referrer")
        self.redirect("/")


class _Page(DocHandler):
    """The page, which browsers must not keep.

    One that is kept for the back button would hold its session here for ten minutes.
    """

    def set_default_headers(self) -> None:
        self.set_header("Cache-Control", "no-store")


class _Guarded(BokehTornado):
    """Passes on requests, also for files and of websockets, only to this host and with the token.

    Another name of this machine in the header Host would let a page of a stranger read this one
    (DNS rebinding), so only the address itself is allowed.
    """

    def __init__(self, applications: dict[str, Any], host: str, token: str, ticket: str) -> None:
        self._host, self._token, self._ticket = host, token, ticket
        self._cookie = f"pellicle-{host.rpartition(':')[2]}"
        super().__init__(applications, extra_websocket_origins=[host])

    def find_handler(self, request: HTTPServerRequest, **options: Any) -> Any:
        if request.host != self._host or not _SERVED.match(request.path):
            return self.get_handler_delegate(request, _Refused)
        if request.path == "/" and self._enters(request.query_arguments):
            credentials = {"cookie": self._cookie, "token": self._token}
            return self.get_handler_delegate(request, _Entrance, credentials)
        cookie = request.cookies.get(self._cookie)
        if cookie is None or not self._knows(cookie.value):
            return self.get_handler_delegate(request, _Refused)
        return super().find_handler(request, **options)

    def get_handler_delegate(
        self,
        request: HTTPServerRequest,
        target_class: type[RequestHandler],
        *rest: Any,
        **more: Any,
    ) -> Any:
        own = _Page if target_class is DocHandler else target_class
        return super().get_handler_delegate(request, own, *rest, **more)

    def _enters(self, arguments: dict[str, list[bytes]]) -> bool:
        """Return whether the address has the token, or the ticket, which it uses up."""
        tokens, tickets = arguments.get("token", []), arguments.get("ticket", [])
        if any(secrets.compare_digest(ticket, self._ticket.encode()) for ticket in tickets):
            self._ticket = secrets.token_urlsafe(32)
            return True
        return any(self._knows(token.decode("latin-1")) for token in tokens)

    def _knows(self, token: str) -> bool:
        return secrets.compare_digest(token.encode(), self._token.encode())


class Server:
    """Serves a page to this machine until it is stopped.

    Parameters
    ----------
    fill
        Adds the content to the document of a visitor.
    port
        Port to listen on; 0 for a free one.

    Raises
    ------
    ConfigError
        The port is taken, or not allowed.
    """

    def __init__(self, fill: Callable[[Document], None], port: int = 0) -> None:
        self.loop = IOLoop(make_current=False)
        try:
            listener = socket.create_server((ADDRESS, port))
        except OSError as error:
            raise ConfigError(
                f"port {port} of {ADDRESS} cannot be used ({error.strerror}); give another, or 0 "
                "for any",
                "--port",
            ) from None
        listener.setblocking(False)
        host = f"{ADDRESS}:{listener.getsockname()[1]}"
        token, ticket = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        self.address = f"http://{host}/?{urlencode({'token': token})}"
        """The address to be opened by hand, as often as one likes."""
        self.ticket_address = f"http://{host}/?{urlencode({'ticket': ticket})}"
        """An address that serves once: other users of a machine see the commands that run on it."""
        application = _Guarded({"/": Application(FunctionHandler(fill))}, host, token, ticket)
        self._http, self._listener = HTTPServer(application), listener
        self._server = BaseServer(self.loop, application, self._http)

    def run(self) -> None:
        """Serve until `stop` is called from another thread, or the process is interrupted."""
        # Socket and timers go to the loop that is current, which is this one once it runs.
        self.loop.add_callback(self._http.add_socket, self._listener)
        self.loop.add_callback(self._server.start)
        try:
            self.loop.start()
        finally:
            self._server.stop()
            self._server.unlisten()

    def stop(self) -> None:
        """Make `run` return."""
        self.loop.add_callback(self.loop.stop)
