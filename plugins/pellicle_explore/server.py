"""A server for whoever knows a token, on this machine."""

from __future__ import annotations

import asyncio
import re
import secrets
import socket
from collections.abc import Callable
from typing import Final

from bokeh.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.document import Document
from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop
from tornado.routing import HostMatches, Rule, RuleRouter

ADDRESS: Final = "127.0.0.1"


async def serve(fill: Callable[[Document], None], tell: Callable[[str], None]) -> None:
    """Serve a page to this machine until the task is cancelled; ``tell`` is given its address.

    Everything is below an address with a token, without which the answer is 404.
    """
    listener = socket.create_server((ADDRESS, 0))
    listener.setblocking(False)
    host, token = f"{ADDRESS}:{listener.getsockname()[1]}", secrets.token_urlsafe(32)
    application = BokehTornado(
        {"/": Application(FunctionHandler(fill))},
        prefix=token,
        extra_websocket_origins=[host],
        ico_path="none",
    )
    # By another name of this machine, a page of a stranger could read this one (DNS rebinding).
    http = HTTPServer(RuleRouter([Rule(HostMatches(re.escape(ADDRESS)), application)]))
    http.add_socket(listener)
    server = BaseServer(IOLoop.current(), application, http)
    server.start()
    try:
        tell(f"http://{host}/{token}")
        await asyncio.Event().wait()
    finally:
        server.stop()
        server.unlisten()
