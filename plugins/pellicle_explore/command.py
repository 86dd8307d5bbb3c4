"""``pellicle explore``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pellicle.cli import echo
from pellicle.errors import ConfigError, PellicleError

if TYPE_CHECKING:
    from pellicle.config.run import Run
    from pellicle_explore.measured import Measured


def explore(
    file: Annotated[
        Path | None, typer.Argument(help="Run file to start from; a bead on a layer if not given.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the file."),
    ] = None,
    curve: Annotated[
        Path | None,
        typer.Option(help="Measured force curve to lay over, as for pellicle fit."),
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0 for a free one.")] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
) -> None:
    """Open a page with sliders for a run: pressure, profile and force curve follow them.

    The page is served to this machine only, at an address with a token, until Ctrl-C.
    """
    import logging
    import webbrowser
    from importlib.util import find_spec

    if find_spec("bokeh") is None:
        raise ConfigError(
            "needs bokeh, which is not installed; install it by: pip install 'pellicle[explore]'",
            "explore",
        )
    from pellicle_explore.page import Explorer
    from pellicle_explore.server import Server

    # It warns of each message to a page that has just been closed or reloaded.
    logging.getLogger("bokeh.server.views.ws").setLevel(logging.ERROR)
    run = _run(file, set_ or [])
    measured = _measured(curve) if curve else None
    server = Server(lambda document: Explorer(run, measured, document).show(), port)
    echo(f"{server.address}\nopen it in a browser on this machine; Ctrl-C ends it")
    if browser:
        webbrowser.open(server.ticket_address)
    try:
        server.run()
    except KeyboardInterrupt:
        echo("ended")


def _run(file: Path | None, overrides: list[str]) -> Run:
    from importlib.resources import as_file, files

    from pellicle.config.run import Run

    if file is not None:
        return Run.from_toml(file, overrides)
    with as_file(files("pellicle_explore").joinpath("start.toml")) as start:
        return Run.from_toml(start, overrides)


def _measured(path: Path) -> Measured:
    from pellicle_explore.measured import Measured
    from pellicle_fit.curves.cleaning import clean
    from pellicle_fit.curves.columns import Calibration
    from pellicle_fit.curves.sources import SourceStream, gather

    source, *others = SourceStream(gather(path, "approach", Calibration(), {}))
    if others:
        raise ConfigError(f"holds {1 + len(others)} curves; give a file with one", "--curve")
    if isinstance(source.curve, PellicleError):
        raise source.curve
    curve = clean(source.curve)
    return Measured(curve.position, curve.force)
