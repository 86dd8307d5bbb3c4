"""What became of a run, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from pellicle.contact.caveats import Caveat, Status, by_phrase
from pellicle.errors import first_of

if TYPE_CHECKING:
    from .result import Result


def first_message(steps: Sequence[tuple[int, Caveat]]) -> str:
    """Return number and message of the first step with a caveat, and the number of further ones."""
    return f"{first_of([f'step {number}' for number, _ in steps])}: {steps[0][1].sentence}"


def failed_steps(result: Result) -> Iterator[str]:
    """Yield for each way to fail which steps of a run did not converge, and why the first."""
    failed: dict[Status, list[tuple[int, str]]] = {}
    for number, caveat in result.caveats():
        if not caveat.status.converged:
            failed.setdefault(caveat.status, []).append((number, caveat.sentence))
    for group in failed.values():
        numbers = dict.fromkeys(number for number, _ in group)
        ends = ([n for n in numbers if n + by not in numbers] for by in (-1, 1))
        spans = [str(a) if a == b else f"{a} to {b}" for a, b in zip(*ends, strict=True)]
        listed = " and ".join(map(str, numbers)) if len(group) == 2 else ", ".join(spans)
        several = len({message for _, message in group}) > 1
        first = f"step {group[0][0]}: " if several else ""
        steps = f"step{'s' * (len(group) > 1)} {listed}"
        yield f"{steps} did not converge: {first}{group[0][1]}"


def status_of_run(result: Result) -> tuple[str, bool | None, list[str]]:
    """Return what became of a run, whether all is well, None with reservations, and details."""
    total = result.planned_steps
    done, failed = result.dataset.sizes["step"], result.failures()
    sentences = []
    if done < total:
        sentences.append(f"The run ended early: {done} of {total} load steps are finished.")
    count = "The load step" if done == 1 else f"All {done} load steps"
    bad = f"{len(failed)} of {done} load steps did not converge: do not rely on them."
    sentences.append(bad if failed else f"{count} converged.")
    groups = by_phrase(result.caveats())
    sentences += [f"In {len(steps)} of {done} {phrase}." for phrase, steps in groups.items()]
    lines = *failed_steps(result), *map(first_message, groups.values())
    details = [f"{line[0].upper()}{line[1:]}" for line in lines]
    is_good = None if details else True
    return " ".join(sentences), is_good if done == total and not failed else False, details


def interruption_note(result: Result) -> str:
    """Return how far an interrupted run came; empty if it is whole."""
    done, planned = result.dataset.sizes["step"], result.planned_steps
    return f"interrupted: {done} of {planned} steps are finished; run it again" * (done < planned)
