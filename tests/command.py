"""The command line, called in this process."""

from collections.abc import Callable

from typer.testing import CliRunner, Result

from pellicle.cli.app import app
from pellicle.cli.printing import CRASHED

Cli = Callable[..., Result]


def call(*words: object, code: int = 0, **environment: str) -> Result:
    """Return what a command has done; its exit code has to be ``code``."""
    done = CliRunner().invoke(app, [*map(str, words)], prog_name="pellicle", env=environment)
    # Anything but an exit would be a traceback on the user's screen.
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == code, done.output
    assert code == CRASHED or "Traceback" not in done.output
    return done
