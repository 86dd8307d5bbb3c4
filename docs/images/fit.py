"""Draws ``fit.png``: the fit of docs/first-fit.md, and the likelihood of its parameters.

Run it as ``python docs/images/fit.py``.
"""

from __future__ import annotations

from pathlib import Path

import pellicle as pl
import pellicle_fit
from pellicle_fit.report.figures import save_figure

EXAMPLE = Path(pellicle_fit.__file__).parent / "examples" / "fit" / "fit.toml"


def main() -> None:
    """Fit, draw and write the picture next to this file."""
    fit = pl.fit(config=pl.FitConfig.from_toml(EXAMPLE))
    save_figure(fit, Path(__file__).with_name("fit"))


if __name__ == "__main__":
    main()
