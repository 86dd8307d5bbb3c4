"""What tests see of a picture: its pixels, and where they have a colour."""

from pathlib import Path
from typing import BinaryIO

import matplotlib.image
import numpy as np

from pellicle.arrays import Array


def pixels(picture: Path | BinaryIO) -> Array:
    """Return red, green and blue of each pixel of a PNG, from 0 to 1."""
    image: Array = matplotlib.image.imread(picture)[..., :3].astype(np.float64)
    return image


def colourfulness(picture: Path | BinaryIO) -> Array:
    """Return how far each pixel is from grey: axes, their grid and text are 0."""
    chroma: Array = np.ptp(pixels(picture), axis=-1)
    return chroma


def drawn_width(
    picture: Path | BinaryIO,
    columns: tuple[float, float] = (0.0, 1.0),
    rows: tuple[float, float] = (0.0, 1.0),
) -> float:
    """Return the share of the columns in a part of a picture that have a colour; 0 of empty axes.

    Columns and rows are fractions of the picture's width and height, rows counted from the top.
    """
    colour = colourfulness(picture) > 0.2
    height, width = colour.shape
    first, last = (round(width * edge) for edge in columns)
    top, bottom = (round(height * edge) for edge in rows)
    return float(colour[top:bottom, first:last].any(axis=0).mean())
