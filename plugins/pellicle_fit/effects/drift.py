"""A force of the instrument that drifts."""

from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Array, Contact, Curve, Fitted, Records, fitted


class Drift(Records, title="drift in time"):
    """Force of the instrument that grows with time."""

    type: Literal["drift"] = "drift"
    examples = ({}, {"drift": "10 pN/s"})
    rank: ClassVar[int] = 1
    drift: Annotated[float, Fitted("N/s", scope="curve")] = fitted(
        "rate of the force without a load [N/s]"
    )

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse curves of one pass, on which it is a sloping baseline."""
        return "" if len(curve.passes) > 1 else "on one pass it is a sloping baseline"

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return F + rate × time since the first row [N]."""
        return force + self.drift * (curve.clock - float(curve.clock[0]))
