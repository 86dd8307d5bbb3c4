"""A solid that relaxes once, as the standard linear solid does."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Literal

import numpy as np

from pellicle_fit.effect import Array, Fitted, Sizes, Values, fitted

from .relaxing import Relaxing


class StandardLinear(Relaxing, title="standard linear relaxation"):
    """Standard linear solid, E(t) = E* (1 − g + g e^(−t/T)), with E* that of fast loading."""

    type: Literal["standard_linear"] = "standard_linear"
    examples = ({}, {"relaxed_share": 0.3, "relaxation_time": "1 s"})
    relaxed_share: Annotated[float, Fitted("1", at_least=0, at_most=0.99)] = fitted(
        "share g that relaxes"
    )
    relaxation_time: Annotated[float, Fitted("s", above=0, log=True)] = fitted(
        "time T in which it relaxes [s]"
    )

    def relaxed(self, time: float) -> float:
        """Return 1 − g + g e^(−t/T)."""
        left: float = 1 + self.relaxed_share * np.expm1(-time / self.relaxation_time)
        return left

    def limits(self, sizes: Sizes) -> Mapping[str, tuple[float, float]]:
        """Return times of more than a few rows and of less than many curves."""
        return {"relaxation_time": (5 * sizes.time / sizes.rows, 100 * sizes.time)}

    def primitive(self, time: Array) -> Array:
        """Return (1 − g) t + g T (1 − e^(−t/T)) [s]."""
        share, constant = self.relaxed_share, self.relaxation_time
        return (1 - share) * time - share * constant * np.expm1(-time / constant)

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield relaxation within a small part of the path, a third of it and all of it."""
        least, _ = self.limits(sizes)["relaxation_time"]
        for share in (0.05, 0.3, 2.0):
            yield {"relaxed_share": 0.3, "relaxation_time": max(share * sizes.time, least)}
