"""Messages of steps that have several statuses."""

import re
from itertools import permutations

import pytest

from pellicle import Status
from pellicle.results.status import statuses_of, with_caveats

CAVEATS = [status for status in Status if status.converged and status is not Status.CONVERGED]


def _filled(status: Status) -> str:
    return re.sub(r"{[^}]*}", "7", status.value)


@pytest.mark.parametrize(("one", "other"), [*permutations(CAVEATS, 2)])
def test_each_caveat_of_a_step_is_told_apart(one: Status, other: Status) -> None:
    """A message of two caveats gives both of them back, whole and in their order."""
    messages = [_filled(one), _filled(other)]
    message = with_caveats(messages)
    assert message.count("converged") == 1
    assert statuses_of(one.name, message) == [(one, messages[0]), (other, messages[1])]


def test_the_reason_of_a_failure_is_not_split() -> None:
    """A failure has one status, whatever its reason says."""
    text = "failed: converged, but odd; moreover, something else"
    assert statuses_of("FAILED", text) == [(Status.FAILED, text)]
