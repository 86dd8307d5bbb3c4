"""Files in the XML formats of VTK, which ParaView opens."""

from __future__ import annotations

import base64
import struct
import sys
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.sax.saxutils import XMLGenerator
from xml.sax.xmlreader import AttributesImpl

import numpy as np

from pellicle.files import atomic_write

BLOCK = 1 << 22
"""Size of the blocks that are compressed one by one [bytes]."""
_TYPES = {"f8": "Float64", "i8": "Int64", "b1": "UInt8"}


@contextmanager
def writer(path: Path, kind: str, **attributes: str) -> Iterator[XMLGenerator]:
    """Yield a writer of the elements inside those of a VTK file of a ``kind``."""
    outer = {
        "type": kind,
        "version": "1.0",
        "byte_order": "LittleEndian" if sys.byteorder == "little" else "BigEndian",
        "header_type": "UInt64",
        "compressor": "vtkZLibDataCompressor",
    }
    with atomic_write(path) as part, part.open("wb") as file:
        xml = XMLGenerator(file, "utf-8", short_empty_elements=True)
        xml.startDocument()
        with element(xml, "VTKFile", **outer), element(xml, kind, **attributes):
            yield xml
        xml.endDocument()


@contextmanager
def element(xml: XMLGenerator, name: str, **attributes: str) -> Iterator[None]:
    """Write an element; its content is written inside the context."""
    xml.startElement(name, AttributesImpl(attributes))
    yield
    xml.endElement(name)


def array(
    xml: XMLGenerator, name: str, dtype: np.dtype[Any], blocks: Iterable[bytes], **attributes: str
) -> None:
    """Write numbers, given as `base64_of` takes them."""
    kind = _TYPES[dtype.str[1:]]
    with element(xml, "DataArray", **attributes, type=kind, Name=name, format="binary"):
        for text in base64_of(blocks):
            xml.characters(text)


def rows_of(number: int, size: int) -> list[slice]:
    """Return slices of rows of ``size`` bytes that make blocks of about 4 MB."""
    many = max(1, BLOCK // size)
    return [slice(start, start + many) for start in range(0, number, many)]


def base64_of(blocks: Iterable[bytes]) -> Iterator[str]:
    """Yield blocks of bytes, all of one size but the last, in base64, each compressed.

    The header holds the number of blocks, their size, that of the last block if it is smaller, else
    0, and the compressed size of each block. The parts are yielded one by one, since all in base64
    would take several times the memory of the field.
    """
    packed, sizes = [], []
    for block in blocks:
        packed.append(zlib.compress(block, 1))
        sizes.append(len(block))
    head = [len(packed), sizes[0], sizes[-1] % sizes[0], *map(len, packed)]
    yield base64.b64encode(struct.pack(f"={len(head)}Q", *head)).decode("ascii")
    rest = b""
    for part in packed:
        # Three bytes are four letters, across the ends of blocks.
        data = rest + part
        whole = len(data) - len(data) % 3
        yield base64.b64encode(data[:whole]).decode("ascii")
        rest = data[whole:]
    yield base64.b64encode(rest).decode("ascii")
