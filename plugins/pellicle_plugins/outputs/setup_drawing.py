"""A drawing of the set-up of a run: indenter, surface, layers, tension and what is prescribed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from html import escape
from typing import Any

from pellicle import Run
from pellicle.config.describe import inputs
from pellicle.files import for_document

_SURFACE, _BOTTOM, _LEFT, _RIGHT, _CENTRE, _TIP = 120, 215, 20, 500, 260, 142
_ROUND = f"M 190 50 C 195 110 225 {_TIP} {_CENTRE} {_TIP} S 325 110 330 50 Z"
_ROUGH = (
    "M 90 50 L 90 112 L 110 122 L 128 104 L 150 126 L 172 108 L 196 130 L 220 112 L 244 138 "
    f"L {_CENTRE} {_TIP} L 284 114 L 306 128 L 330 106 L 352 124 L 376 104 L 398 122 L 430 108 "
    "L 430 50 Z"
)
_SHAPES = {
    "sphere": _ROUND,
    "paraboloid": _ROUND,
    "quadric": _ROUND,
    "axisymmetric": _ROUND,
    "cone": f"M 170 50 L {_CENTRE} {_TIP} L 350 50 Z",
    "flat_punch": f"M 210 50 L 210 {_TIP} L 310 {_TIP} L 310 50 Z",
    "self_affine": _ROUGH,
    "heights": _ROUGH,
    "topography": _ROUGH,
}
"""Outlines by the type of the indenter, not to scale."""
_UNKNOWN = f"M 170 50 L 170 90 Q 170 {_TIP} {_CENTRE} {_TIP} Q 350 {_TIP} 350 90 L 350 50 Z"


def setup_drawing(
    configuration: Mapping[str, Any], prescribed: str, varied: tuple[str, ...] = ()
) -> bytes:
    """Return the set-up of a run as SVG, not to scale.

    The load steps give ``prescribed``. Values at the dotted paths ``varied`` differ between the
    runs of a study and have no number.
    """
    known = {i.name: i for i in inputs(configuration, Run)}

    def named(name: str) -> str:
        """Return words and value of an input, "(varied)" if it differs; empty if not there."""
        if name not in known:
            return ""
        words = known[name].words.partition(" of ")[0]
        return f"{words} {'(varied)' if name in varied else known[name].value}"

    kernel, indenter = configuration["kernel"], configuration["indenter"]
    while isinstance(part := indenter.get("part"), Mapping):
        indenter = part
    body = [*_solid(kernel, named), _text(_LEFT + 8, _BOTTOM - 6, known["kernel"].value, "start")]
    body += _surface(kernel, named, varied)
    outline = _SHAPES.get(indenter["type"], _UNKNOWN)
    body.append(f'<path class="indenter" d="{outline}" fill="#d9dee3" stroke="#222"/>')
    name = known["indenter"].value if "indenter" in known else indenter["type"]
    radius = named("indenter.radius")
    body.append(_text(_CENTRE, 40, f"{name}{f', {radius}' if radius else ''}"))
    load = prescribed.replace("_", " ")
    body += [_arrow(_RIGHT - 40, 50, _RIGHT - 40, 100), _text(_RIGHT - 40, 40, load)]
    if configuration.get("interaction"):
        adhesion = f"adhesion: {known['interaction'].value}"
        body.append(_text(_LEFT + 8, _TIP + 40, adhesion, "start"))
    lines = "\n".join(body)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 520 250" '
        f'font-family="sans-serif" font-size="13" fill="#222">\n{lines}\n</svg>\n'
    ).encode()


def description(configuration: Mapping[str, Any]) -> str:
    """Return the set-up in words, for readers who cannot see the drawing."""
    values = {i.name: i.value for i in inputs(configuration, Run)}
    return f"Set-up, not to scale: {values['indenter']} on {values['kernel']}."


def _solids(
    kernel: Mapping[str, Any], path: str = "kernel"
) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the path and the configuration of a solid, and of those that it is made of."""
    yield path, kernel
    for name in ("substrate", "solid"):
        if isinstance(inner := kernel.get(name), Mapping):
            yield from _solids(inner, f"{path}.{name}")


def _solid(kernel: Mapping[str, Any], named: Callable[[str], str]) -> Iterator[str]:
    layers, on_rigid = list[str](), True
    for path, solid in _solids(kernel):
        layers += [path] * ("thickness" in solid)
        layers += [f"{path}.layers.{index}" for index in range(len(solid.get("layers") or ()))]
        # Layers on a half-space have a solid below them; a single layer lies on a rigid base.
        on_rigid &= not ("layers" in solid and isinstance(solid.get("substrate"), Mapping))
    on_rigid &= bool(layers)
    bands = len(layers) + (not on_rigid)
    height = (_BOTTOM - _SURFACE) / bands
    for band in range(bands):
        top, shade = _SURFACE + band * height, "#f3dfc8" if band % 2 == 0 else "#e6c9a8"
        yield (
            f'<rect class="{"layer" if band < len(layers) else "half-space"}" x="{_LEFT}" '
            f'y="{top:.1f}" width="{_RIGHT - _LEFT}" height="{height:.1f}" fill="{shade}"/>'
        )
        if band < len(layers):
            label = named(f"{layers[band]}.thickness")
            yield _text(_RIGHT - 8, top + height - 6, label, "end")
    if on_rigid:
        yield (
            f'<rect class="base" x="{_LEFT}" y="{_BOTTOM}" width="{_RIGHT - _LEFT}" height="8" '
            'fill="#777"/>'
        )
        yield _text(_CENTRE, _BOTTOM + 24, "rigid base")


def _surface(
    kernel: Mapping[str, Any], named: Callable[[str], str], varied: tuple[str, ...]
) -> Iterator[str]:
    names = ("tension", "bending", "surface_stiffness")
    for path, solid in _solids(kernel):
        skin = [name for name in names if solid.get(name) or f"{path}.{name}" in varied]
        if skin:
            break
    # The surface is pressed down where the indenter, drawn later, hides its bottom.
    yield (
        f'<path class="surface" d="M {_LEFT} {_SURFACE} L 120 {_SURFACE} Q 215 {_SURFACE} '
        f'{_CENTRE} {_TIP} Q 305 {_SURFACE} 400 {_SURFACE} L {_RIGHT} {_SURFACE}" fill="none" '
        f'stroke="#14557b" stroke-width="{4 if skin else 1.5}"/>'
    )
    if "tension" in skin:
        yield _arrow(_LEFT + 45, _SURFACE, _LEFT - 14, _SURFACE, "tension")
        yield _arrow(_RIGHT - 45, _SURFACE, _RIGHT + 14, _SURFACE, "tension")
    labels = [named(f"{path}.{name}") for name in skin]
    if labels:
        yield _text(_LEFT + 8, _TIP + 22, ", ".join(labels), "start")


def _text(x: float, y: float, text: str, anchor: str = "middle") -> str:
    markup = escape(for_document(text))
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}">{markup}</text>'


def _arrow(x0: float, y0: float, x1: float, y1: float, kind: str = "load") -> str:
    """Return an arrow along x or y as SVG."""
    dx, dy = (x1 > x0) - (x1 < x0), (y1 > y0) - (y1 < y0)
    left = f"{x1 - 9 * dx - 5 * dy} {y1 - 9 * dy - 5 * dx}"
    right = f"{x1 - 9 * dx + 5 * dy} {y1 - 9 * dy + 5 * dx}"
    return (
        f'<path class="{kind}" d="M {x0} {y0} L {x1} {y1} M {left} L {x1} {y1} L {right}" '
        'fill="none" stroke="#b3261e" stroke-width="2.5"/>'
    )
