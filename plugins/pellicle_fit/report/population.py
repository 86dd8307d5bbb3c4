"""Files of a population beside its tables: contact sheet, distributions, and force maps."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from pellicle.show import save_figure
from pellicle_fit.many import ManyFits

from . import distributions
from .contact_sheet import save_sheets
from .map_files import save_map


def save_population(fits: ManyFits, directory: Path) -> tuple[Path, ...]:
    """Write ``fits-curves.pdf``, ``fits.png`` and the images in ``maps``, and return the files.

    Raises
    ------
    StorageError
        A file cannot be written.
    """
    files = [save_sheets(fits.rows, directory / "fits-curves.pdf")]
    if distributions.drawable(fits.rows):
        draw = partial(distributions.distributions, fits.rows)
        files += save_figure(draw, directory / "fits", ["png"], distributions.SIZE)
    for stem, (name, images) in zip(_stems(list(fits.maps)), fits.maps.items(), strict=True):
        files += save_map(images, directory / "maps" / stem, Path(name).name)
    return tuple(files)


def _stems(names: list[str]) -> list[str]:
    """Return a file name for each map, numbered where two files have the same name."""
    stems = [Path(name).stem for name in names]
    return [
        stem if stems.count(stem) == 1 else f"{stem}-{stems[:number].count(stem) + 1}"
        for number, stem in enumerate(stems)
    ]
