"""The page: text stays text, nothing is loaded, maps hold their values."""

import base64
import re
import zlib
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

from pellicle import Grid
from pellicle.components import Column, Table
from pellicle.show.html import Block, Code, Notice, Picture, Section, Text, page
from pellicle.show.maps import Field, Maps, frame, side

EVIL = "</script><script>alert(1)</script> \"quoted\" 'so' <!-- & µ 接触 {{ 7 * 7 }}"
GRID = Grid(points=(10, 7), size=("1 mm", "0.7 mm"))


class Parsed(HTMLParser):
    """All tags of a page with their attributes, and the text in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.text: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))

    def handle_data(self, data: str) -> None:
        self.text.append(data)

    def values(self, name: str) -> list[str]:
        """Return the values of an attribute wherever it stands."""
        return [attributes[name] for _, attributes in self.tags if name in attributes]


def maps(label: str = "first") -> Maps:
    """Return two frames of two fields."""
    fields = [np.arange(70.0).reshape(10, 7), np.ones((10, 7))]
    frames = [frame(label, GRID, fields, 512), frame("second", GRID, fields[::-1], 4)]
    return Maps("Both.", "load step", [Field("pressure", "Pa"), Field("gap", "m")], frames)


def full(text: str) -> Parsed:
    """Return a page with ``text`` wherever text goes."""
    blocks: list[Block] = [
        Text(text),
        Notice(text, False, [text]),
        Table([Column(text, [text], "", text, frames=[0]), Column("n", [1.0], text)], text),
        Picture(b"<svg xmlns='http://www.w3.org/2000/svg'/>", text, text),
        Code(text, text, text),
        maps(text),
        maps(),
    ]
    return Parsed(page(text, [Section(text, blocks), Section("left out", [])], text))


def test_text_stays_text() -> None:
    """Markup, quotes and template syntax in any text are shown, not obeyed."""
    evil, plain = full(EVIL), full("plain")
    assert [tag for tag, _ in evil.tags] == [tag for tag, _ in plain.tags]
    assert [sorted(attributes) for _, attributes in evil.tags] == [
        sorted(attributes) for _, attributes in plain.tags
    ]
    # The label of a frame is in the data of the script too, where JSON escapes it.
    assert sum(EVIL in text for text in evil.text) == 16
    assert sum("plain" in text for text in plain.text) == 18
    assert EVIL in evil.values("alt")
    assert EVIL in evil.values("download")


def test_tables_show_what_columns_say() -> None:
    """Cells are as people read them; those that are bad, linked or shortened are marked."""
    numbers = Column("depth", [1e-6, np.nan], "m", bad=[False, True], frames=[None, 1])
    table = Table([numbers, Column("hash", ["0123456789abcdef" * 4, "none"])], "Both.")
    text = page("", [Section("", [table])])
    cells = re.findall(r"<td data-label=\"(.*?)\" class=\"(.*?)\"(.*?)>(.*?)</td>", text)
    assert cells == [
        ("depth [µm]", "", "", "1"),
        ("hash", "words", f' title="{"0123456789abcdef" * 4}"', "01234567…"),
        ("depth [µm]", " bad", "", '<a href="#maps" data-frame="1">–</a>'),
        ("hash", "words", "", "none"),
    ]


def test_nothing_is_loaded() -> None:
    """Addresses lead into the page or hold what they name; everything else is forbidden."""
    parsed = full("plain")
    addresses = [
        address for name in ("href", "src", "srcset", "action") for address in parsed.values(name)
    ]
    assert addresses
    assert all(address.startswith(("#", "data:")) for address in addresses)
    assert not re.search(r"url\(|@import|https?:|fetch\(|import\(", "".join(parsed.text))
    (policy,) = [p for p in parsed.values("content") if "default-src" in p]
    assert "default-src 'none'" in policy


def test_ids_are_unique_and_links_lead_to_them() -> None:
    """Also where there are several maps."""
    parsed = full("plain")
    ids = parsed.values("id")
    assert len(set(ids)) == len(ids)
    assert {href[1:] for href in parsed.values("href") if href.startswith("#")} == set(ids)
    assert "left out" not in parsed.text


def unpacked(packed: dict[str, Any], shape: tuple[int, int]) -> np.ndarray[Any, Any]:
    """Return the values of a map as the script of the page unpacks them."""
    high, low = np.frombuffer(zlib.decompress(base64.b64decode(packed["data"])), np.uint8).reshape(
        2, -1
    )
    codes = np.cumsum(256 * high.astype(int) + low) & 0xFFFF
    values = packed["low"] + codes / 65534 * (packed["high"] - packed["low"])
    return np.where(codes == 65535, np.nan, values).reshape(shape)


def test_maps_hold_the_values() -> None:
    """To one part in 131068 of the range; zero stays zero, and what is not finite stays empty."""
    values = np.random.default_rng(1).uniform(0, 5e3, (10, 7)) ** 2
    values[2, 3] = 0.0
    values[4, 5], values[6, 0] = np.inf, np.nan
    panel = Maps("", "", [Field("p", "Pa")], [frame("", GRID, [values], 512)]).data
    assert panel["fields"][0]["unit"] == "MPa"
    values_read = unpacked(panel["frames"][0]["fields"][0], (10, 7))
    expected = np.where(np.isfinite(values), values, np.nan) * 1e-6
    np.testing.assert_allclose(values_read, expected, rtol=0, atol=np.nanmax(expected) / 131067)
    assert values_read[2, 3] == 0
    assert panel["frames"][0]["size"] == pytest.approx([1000, 700])
    assert panel["unit"] == "µm"


def test_field_without_a_value() -> None:
    """A map of nothing is packed too."""
    panel = Maps("", "", [Field("gap", "m")], [frame("", GRID, [np.full((10, 7), np.inf)], 512)])
    packed = panel.data["frames"][0]["fields"][0]
    assert (packed["low"], packed["high"]) == (0, 0)
    assert np.isnan(unpacked(packed, (10, 7))).all()


def test_pixels_are_means_over_blocks() -> None:
    """Also where the last block is cut; of values that are not finite nothing counts."""
    field = np.arange(70.0).reshape(10, 7)
    field[9, 6] = np.inf
    data = frame("", GRID, [field], 4)
    assert (data.factors, data.shape) == ((3, 2), (4, 4))
    values_read = unpacked(data.packed[0]._asdict(), (4, 4))
    expected = [
        [
            np.nanmean(np.where(np.isinf(b := field[i : i + 3, j : j + 2]), np.nan, b))
            for j in (0, 6)
        ]
        for i in (0, 3)
    ]
    np.testing.assert_allclose(values_read[:2, [0, 3]], expected, atol=1e-3)
    assert np.isnan(values_read[3, 3])
    assert maps().remark == "Each pixel is the mean over up to 3 × 2 cells."


def test_many_maps_are_coarser() -> None:
    """A page stays small: together its maps have three million pixels at most."""
    assert side(512, 10) == 512
    assert 200 * side(512, 200) ** 2 <= 3_000_000
    assert side(512, 10**6) == 32
    assert side(16, 10**6) == 16
