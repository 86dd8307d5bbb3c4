"""What a wrong unit or a wrong radius would give."""

from __future__ import annotations

from typing import Any

from pellicle.components import Component
from pellicle.errors import ConfigError

from .models.force_model import tension_model
from .models.solid import lengths
from .posed import Posed

_PLAUSIBLE_DEPTH = (1e-3, 1.0)
_PLAUSIBLE_MODULUS = (1.0, 1e12)
_PLAUSIBLE_TENSION = 10.0


def plausible(posed: Posed, point: float, modulus: float, tension: float) -> list[str]:
    """Refuse or warn of what a wrong unit or radius would give.

    Raises
    ------
    ConfigError
        The depth is beyond that of the indenter's force curve.
    """
    messages = []
    model: Any = tension_model(posed.asked.indenter)
    depth = float(posed.curve.position[-1]) - point
    shape = model.indenter
    radius = next(iter(lengths(shape)), None) if isinstance(shape, Component) else None
    if depth > model.depth_limit:
        raise ConfigError(
            f"the depth reaches {depth:.3g} m, and the curve of this indenter ends at "
            f"{model.depth_limit:.3g} m; is the radius right? If so, leave out the deepest part",
            "indenter",
        )
    if radius is not None and not _PLAUSIBLE_DEPTH[0] <= depth / radius <= _PLAUSIBLE_DEPTH[1]:
        messages.append(
            f"the depth of {depth:.3g} m is {depth / radius:.3g} times the radius of "
            f"{radius:.3g} m: are radius and units right?"
        )
    if not _PLAUSIBLE_MODULUS[0] <= modulus <= _PLAUSIBLE_MODULUS[1]:
        messages.append(f"a modulus of {modulus:.3g} Pa is not plausible: are the units right?")
    if tension > _PLAUSIBLE_TENSION:
        messages.append(f"a tension of {tension:.3g} N/m is not plausible: are the units right?")
    return messages
