"""``pellicle new``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pellicle.errors import ConfigError, StorageError

from .printing import echo

_EXAMPLES = "rough", "gel", "layer", "fit"


def new(
    path: Annotated[
        Path | None,
        typer.Argument(
            metavar="PATH",
            help="File to write (default: indent.toml, or EXAMPLE.toml); with --plugin, the "
            "component's name.",
        ),
    ] = None,
    example: Annotated[
        str | None,
        typer.Option(
            "--example",
            metavar="EXAMPLE",
            help="Write an example that runs as it is: rough, gel, layer, or fit, with a curve.",
        ),
    ] = None,
    plugin: Annotated[
        str | None,
        typer.Option(
            "--plugin",
            metavar="FAMILY",
            help="Write the package of a kernel, indenter, interaction, solver, correction, "
            "output, executor or prescription.",
        ),
    ] = None,
) -> None:
    """Write a commented starter file, an example, or the package of a plugin."""
    if path is not None and plugin is None and not path.suffix:
        # The folder of results is named after the file without its suffix.
        path = path.with_suffix(".toml")
    if example is not None:
        if plugin is not None:
            raise ConfigError("and --plugin exclude each other; give one of them", "--example")
        _write_example(example, path)
        return
    if plugin is None:
        _write_starter(path or Path("indent.toml"))
        return
    from .scaffold import write_plugin

    if path is None:
        raise ConfigError(f"is missing; for example: pellicle new --plugin {plugin} mine", "NAME")
    folder = write_plugin(plugin, str(path), Path())
    echo(f"wrote {folder}; next: cd {folder}, pip install -e '.[test]', python -m pytest")


def _write_starter(path: Path) -> None:
    from importlib.resources import files

    _write_new(path, files("pellicle.cli").joinpath("starter.toml").read_text(encoding="utf-8"))
    echo(f"wrote {path}; next: pellicle run {path}")


def _write_example(name: str, path: Path | None) -> None:
    from importlib.resources import files
    from string import Template

    if name not in _EXAMPLES:
        raise ConfigError(
            f"{name!r} is not an example; give one of {', '.join(_EXAMPLES)}", "--example"
        )
    path = path or Path(f"{name}.toml")
    source = files("pellicle.cli") / "examples" / f"{name}.toml"
    curve = path.with_name(f"{path.stem}-curve.csv")
    text = Template(source.read_text(encoding="utf-8")).substitute(curve=curve.name)
    if name == "fit":
        _write_new(curve, _curve())
    _write_new(path, text)
    echo(f"wrote {path}; next: pellicle {'fit' if name == 'fit' else 'run'} {path}")


def _curve() -> str:
    """Return a made-up force curve of a bead on a gel, with noise, as the text of a table."""
    import numpy as np

    from pellicle.components import HasForceCurve, Indenter
    from pellicle.plugins import registry

    bead = registry().make(Indenter, {"type": "sphere", "radius": 5e-6})
    assert isinstance(bead, HasForceCurve)
    depth = np.linspace(-0.5e-6, 1.5e-6, 400)
    # E* = 2 kPa, and a tension of 5 mN/m over it: 2τ₀/E* = 5 µm.
    force = 2e3 * bead.force_curve(depth, 5e-6).force
    force += 0.003 * force.max() * np.random.default_rng(1).standard_normal(depth.size)
    rows = [f"{(z + 3e-6) * 1e6:.5f},{f * 1e9:.5f}" for z, f in zip(depth, force, strict=True)]
    return "\n".join(["position [um],force [nN]", *rows, ""])


def _write_new(path: Path, text: str) -> None:
    """Write a file that must not exist.

    Raises
    ------
    StorageError
        It exists, or cannot be written.
    """
    from pellicle.files import storage_errors

    with storage_errors(path):
        try:
            with path.open("x", encoding="utf-8") as file:
                file.write(text)
        except FileExistsError:
            raise StorageError(f"{path} exists already; give another name") from None
