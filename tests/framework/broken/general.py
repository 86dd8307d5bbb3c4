"""Components that break a rule of all families, here indenters."""

import threading
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, SerializationInfo, model_serializer

from pellicle.units import Length
from tests.framework.broken.catalogue import Broken, Family, Taken
from tests.framework.broken.indenters import INDENTERS, Indenter


class Forgetful(Indenter):
    """Paraboloid that is written without what it was given."""

    @model_serializer
    def _wrong(self) -> dict[str, Any]:
        return {"type": "broken", "radius": 2 * self.radius}


class TwoFaced(Indenter):
    """Paraboloid that is another as a Python table than as JSON."""

    @model_serializer
    def _wrong(self, info: SerializationInfo) -> dict[str, Any]:
        factor = 2 if info.mode == "python" else 1
        return {"type": "broken", "radius": factor * self.radius}


class Thawed(Indenter):
    """Paraboloid whose fields can be set."""

    model_config = ConfigDict(frozen=False)

    def __hash__(self) -> int:
        return hash(self.radius)


def field(fault: str, kind: Any, default: Any, description: str | None) -> Broken:
    """Return a paraboloid with one more field."""
    annotation = Annotated[kind, Field(description=description)]
    return Broken(fault, KIT, fields={"more": (annotation, default)})


KIT = Taken("a run takes an object as it is; kit and registration look at its class")
PARABOLOID = {"type": (Literal["paraboloid"], "paraboloid")}
BROKEN: dict[str, Any] = {
    "class_can_be_registered": [
        Broken("no docstring", KIT, __doc__=None),
        field("no description", Length, 1.0, None),
    ],
    "numbers_have_units": field("no unit", float | None, None, "length [m]"),
    "is_frozen_and_closed": [
        Broken("not frozen", KIT, good=Thawed),
        Broken("unknown fields", KIT, model_config=ConfigDict(extra="ignore")),
    ],
    "pickles": Broken("no pickle", KIT, __getstate__=lambda f: threading.Lock()),
    "goes_through_files": [
        Broken("other JSON", KIT, good=Forgetful),
        field("no TOML", tuple[int | None, ...], (1, None), "marks"),
    ],
    "is_registered": Broken("type is taken", KIT, fields=PARABOLOID),
}
GENERAL = Family(Indenter, {"radius": 1e-3}, INDENTERS.uses, ("run",), BROKEN)
