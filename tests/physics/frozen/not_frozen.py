"""Not frozen, will change: what the stored values leave out, and the reason of each."""

from typing import Final

VARIABLES: Final = {
    "wall_time": "it is the machine's",
    "status": "a sentence; its code is frozen here, its words are in the snapshot of sentences",
    "caveats": "a text of numbers to all digits; its gravest code is frozen here",
}
"""Variables of a run."""

CASES: Final = {
    "line contacts that stick": "they stall, and are mended with the adhesive solver",
    "the major axis of a round contact": "any direction is one",
    "explanations far behind the best": "they are not sought to the end",
    "quantities of explanations that were not chosen": (
        "some lie at a limit, from which ends differ between processors; their χ² and what they "
        "lend to the interval over all that is tied are frozen"
    ),
    "tension beside relaxation on unloading rows": (
        "its force is not known, and fits do not try it; the formula was off by 8 to 37 %"
    ),
}
"""What no configuration and no curve contains."""
