"""A stranger's prescription: the mean gap, within the middle of the domain if that is wanted."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

import pellicle as pl
from pellicle.components import Variable
from pellicle.units import Quantity


class MeanGap(pl.Prescription):
    """Mean gap between surface and indenter in the middle of the domain."""

    type: Literal["mean_gap"] = "mean_gap"
    unit: ClassVar = "m"
    at_least: ClassVar = 0
    variables: ClassVar = (Variable("mean_gap", "m", "mean gap in the middle of the domain"),)

    share: Annotated[
        float,
        Quantity("1", above=0, at_most=1),
        Field(description="share of the edge of the domain that counts"),
    ] = 1.0

    def target(self, setting, value):
        """Return the search for the depth, by which the mean gap falls."""
        return pl.Search(
            value,
            self.of,
            control=pl.Depth,
            increasing=False,
            resolution=1e-7 * (value or 1e-9),
        )

    def report(self, setting, step):
        """Return the mean gap of a solved step."""
        return {"mean_gap": self.of(step)}

    def of(self, step):
        """Return the mean gap [m] of a step."""
        nx, ny = step.gap.shape
        kept = [
            slice(round(n * (1 - self.share) / 2), n - round(n * (1 - self.share) / 2))
            for n in (nx, ny)
        ]
        return float(step.gap[kept[0], kept[1]].mean())


@pl.hookimpl
def register_components(register):
    """Register the prescription."""
    register(MeanGap)
