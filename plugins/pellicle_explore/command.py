"""``pellicle explore``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pellicle.cli import echo
from pellicle.errors import ConfigError


def explore(
    file: Annotated[
        Path | None, typer.Argument(help="Run file to start from; a bead on a layer if not given.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the file."),
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
) -> None:
    """Open a page with sliders for a run: pressure, profile and force curve follow them.

    The page is served to this machine only, at an address with a token, until Ctrl-C.
    """
    import asyncio
    import logging
    import webbrowser

    try:
        from bokeh.document import Document
    except ImportError:
        raise ConfigError(
            "needs bokeh, which is not installed; install it by: pip install 'pellicle[explore]'",
            "explore",
        ) from None
    import pellicle as pl
    from pellicle_explore.page import Explorer
    from pellicle_explore.server import serve

    # It warns of each message to a page that has just been closed or reloaded.
    logging.getLogger("bokeh.server.views.ws").setLevel(logging.ERROR)
    run = pl.Run.from_toml(file or Path(__file__).with_name("start.toml"), set_ or [])
    # A run with a load is refused before a page is served.
    _ = run.indentation

    def tell(address: str) -> None:
        echo(f"{address}\nopen it in a browser on this machine; Ctrl-C ends it")
        if browser:
            webbrowser.open(address)

    def fill(document: Document) -> None:
        Explorer(run, document)

    try:
        asyncio.run(serve(fill, tell))
    except KeyboardInterrupt:
        echo("ended")
