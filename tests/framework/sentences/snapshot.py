"""One snapshot of the sentences of the program: messages, verdicts, statuses, help.

    python tests/framework/sentences/snapshot.py

writes it anew; what has changed is read in its difference, as prose.
"""

import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from typer.main import get_command
from typer.testing import CliRunner

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[2])]

from pellicle.cli.app import app  # noqa: E402
from pellicle.contact import Status  # noqa: E402
from pellicle.plugins.commands import typer_command  # noqa: E402
from tests.framework.sentences import bad_files  # noqa: E402
from tests.physics.frozen.fit_curves import CASES  # noqa: E402

FILE, TABLE = HERE / "sentences.txt", HERE / "commands.txt"
_VARYING = {
    # The words of numpy, h5py and the system.
    r"(cannot be read as [\w ]+ )\(.*?\)(;|$)": r"\1(…)\2",
    r"\(Unable to .*\); give": "(…); give",
    r"[\d.e+-]+ GB are available": "… GB are available",
}
"""What differs between machines, and what stands for it."""
_NUMBER = re.compile(r"(?<![\w.])[-−]?\d[\d.]*(e[-+]\d+)?")


class Row(NamedTuple):
    """A command, its exit code, and the field or file that its message names first."""

    code: int
    named: str
    """Empty if it names none."""
    command: str

    @property
    def arguments(self) -> list[str]:
        """The arguments; a command that begins with an option runs the start file."""
        words = shlex.split(self.command)
        return ["run", "start.toml", "-o", "out", *words] if words[0] == "--set" else words


class Answer(NamedTuple):
    """What the command line did."""

    code: int
    stdout: str
    stderr: str

    @property
    def sentences(self) -> str:
        """All that was said, with … or # for what may vary."""
        text = self.stderr.replace(f"{Path.cwd()}{os.sep}", "")
        for pattern, instead in _VARYING.items():
            text = re.sub(pattern, instead, text, flags=re.MULTILINE)
        if self.code < 2:
            # Numbers that are computed.
            shown = re.sub(
                r"\b[0-9a-f]{8,}(…|(?=\.h5))|^date: .*\n", "", self.stdout, flags=re.MULTILINE
            )
            shown = re.sub(r" {2,}|-{3,}", " ", _NUMBER.sub("#", shown))
            text = _NUMBER.sub("#", text) + shown
        return "\n".join(line.rstrip() for line in text.splitlines() if line.strip())


def rows() -> list[Row]:
    """Return the table of commands."""
    lines = TABLE.read_text(encoding="utf-8").splitlines()
    parts = [line.split(maxsplit=2) for line in lines if line and not line.startswith("#")]
    return [Row(int(code), "" if name == "-" else name, command) for code, name, command in parts]


def prepare(folder: Path) -> None:
    """Write the files that commands name: bad ones, and measured curves."""
    bad_files.make(folder)
    for name, case in CASES.items():
        (curve, *_), lines = case.curves, ["position [m],force [N],time [s]"]
        lines += [f"{z},{f},{t}" for z, f, t in np.transpose(curve).tolist()]
        name = name.replace("/", "_")
        (folder / f"{name}.csv").write_text("\n".join(lines), encoding="utf-8")


def answer(row: Row) -> Answer:
    """Return what a command answers in the working folder."""
    result = CliRunner().invoke(app, row.arguments, prog_name="pellicle")
    # Anything but an exit would be a traceback on the user's screen.
    assert result.exception is None or isinstance(result.exception, SystemExit), row
    return Answer(result.exit_code, result.stdout, result.stderr)


def fixed() -> Iterator[tuple[str, str]]:
    """Yield sentences that no command need say: statuses of steps, and help."""
    yield "statuses", "\n".join(f"{name}: {s.value}" for name, s in Status.__members__.items())
    group: Any = get_command(app)
    for name in group.commands:
        command = typer_command(name)
        context = command.context_class(command, info_name=name)
        options = [_help(p, context) for p in command.params]
        yield f"{name} --help", "\n".join([" ".join((command.help or "").split()), *options])


def _help(parameter: Any, context: Any) -> str:
    record = parameter.get_help_record(context)
    words = " ".join(record or (parameter.human_readable_name, parameter.help or ""))
    # The types of click, which the terminal does not show.
    return f"  {' '.join(re.sub(r' <.*?>', '', words).split())}"


def stored() -> dict[str, str]:
    """Return the snapshot: what was said by what was asked."""
    blocks = FILE.read_text(encoding="utf-8").split("\n$ ")[1:]
    asked = (block.partition("\n") for block in blocks)
    return {command: text.strip("\n") for command, _, text in asked}


def main() -> None:
    """Write the snapshot."""
    parts = ["All sentences of the program.  snapshot.py writes this file.\n"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        prepare(Path(folder))
        said = {row.command: answer(row).sentences for row in rows()} | dict(fixed())
    parts += [f"\n$ {command}\n{text}\n" for command, text in said.items()]
    FILE.write_text("".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
