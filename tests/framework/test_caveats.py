"""Caveats of steps: their order, what hides what, their sentences and their text in files."""

import math
import re

import pytest

from pellicle.contact.caveats import (
    Caveat,
    Status,
    by_phrase,
    from_text,
    ranked,
    sentence_of,
    status_of,
    to_text,
)

VALUES: dict[str, float | str] = {
    "quantity": "contact area",
    "unit": "m**2",
    "below": 1e-12,
    "above": 2e-12,
    "end": "jump",
    "remedy": "larger domain",
    "loss": "known",
    "off": "known error",
    "error": 0.1,
    "stop": "ITERATION_LIMIT",
    "prescribed": "depth",
    "reason": "no memory",
}
NUMBERS = re.compile(r"{(\w+):(?:[mNJ]|count|g|\.\d[ef])}")


def _filled(status: Status) -> Caveat:
    numbers = dict.fromkeys(NUMBERS.findall(status.value), 3)
    return Caveat(status, {**VALUES, "value": 1e-6, "least_size": 1e-3, "lost": 1e-9, **numbers})


@pytest.mark.parametrize("status", Status)
def test_a_caveat_in_a_file_says_the_same(status: Status) -> None:
    """Every template can be filled from what a file holds."""
    caveat = _filled(status)
    assert "{" not in caveat.sentence
    (read,) = from_text(to_text([caveat]))
    assert read == caveat
    assert read.sentence == caveat.sentence


def test_numbers_that_are_not_finite_are_read_again() -> None:
    """An infinite length is one in a file too, and JSON stays JSON."""
    text = to_text([Caveat(Status.JUMPED, {"lost": math.nan, "until": math.inf})])
    ((_, values),) = from_text(text)
    assert "Infinity" not in text
    assert values["until"] == math.inf
    assert math.isnan(float(values["lost"]))


def test_a_failure_hides_the_rest_and_the_gravest_comes_first() -> None:
    """The numbers of a failed step mean nothing; coarse cells are coarse in the zone, too."""
    jumped, zone, coarse = map(_filled, (Status.JUMPED, Status.COARSE_ZONE, Status.COARSE))
    load, nan = _filled(Status.LOAD), _filled(Status.NOT_FINITE)
    assert ranked([jumped, load, nan, coarse]) == (nan,)
    assert ranked([jumped, zone, coarse]) == (coarse, jumped)
    assert ranked([jumped, zone]) == (zone, jumped)
    assert ranked([]) == ()
    assert status_of(ranked([jumped, load])) is Status.LOAD
    assert status_of(()) is Status.CONVERGED


def test_a_message_of_two_caveats_says_once_that_the_step_converged() -> None:
    """The sentences follow each other, the gravest first."""
    coarse, jumped = _filled(Status.COARSE), _filled(Status.JUMPED)
    message = sentence_of([coarse, jumped])
    assert message.startswith(coarse.sentence)
    assert message.count("converged") == 1
    assert message.endswith(jumped.sentence.partition("; ")[2])


def test_caveats_are_grouped_by_phrase() -> None:
    """The gravest first, within a phrase in the order of the steps."""
    several = [_filled(s) for s in (Status.JUMPED, Status.COARSE, Status.JUMPED)]
    groups = by_phrase(enumerate([*several, _filled(Status.COARSE_ZONE)]))
    assert [[place for place, _ in group] for group in groups.values()] == [[1, 3], [0, 2]]
