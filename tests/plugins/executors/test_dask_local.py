"""Workers of a dask scheduler that is started here: they do not start, or all die."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import distributed
import pytest

import pellicle as pl
from pellicle_plugins.executors import submission


class Deserted:
    """A client of a cluster without workers, which none comes to."""

    def __init__(self) -> None:
        self.scaled: list[int] = []
        self.cluster = SimpleNamespace(
            scheduler_info={"workers": {}}, worker_spec={0: {}, 1: {}}, scale=self.scaled.append
        )

    def wait_for_workers(self, number: int, timeout: float) -> None:
        """Wait in vain."""
        raise TimeoutError


def test_workers_that_never_come_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as at first are started, a few times; then every task says that there are none."""
    monkeypatch.setattr(submission, "_LOOK_EVERY", 0.001)
    client: Any = Deserted()
    tasks: Any = [SimpleNamespace(name=f"job {i}") for i in range(3)]
    given = submission.Submission(client, lambda task, say: None, tasks)
    given._futures = dict.fromkeys(range(3), Any)  # type: ignore[arg-type]
    outcomes = list(given._finished(lambda task, said: None))
    assert client.scaled == [0, 2] * submission._RESTARTS
    assert [index for index, _ in outcomes] == [0, 1, 2]
    for _, outcome in outcomes:
        assert isinstance(outcome, pl.PellicleError)
        assert str(outcome) == "all workers that were started for it died"


def test_workers_that_do_not_start(monkeypatch: pytest.MonkeyPatch) -> None:
    """What dask says of a script without a guard is followed by what to do."""

    def fail(**options: object) -> None:
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(submission, "_Local", fail)
    with (
        pytest.raises(pl.ConfigError, match=r'if __name__ == "__main__":, or take the executor'),
        submission.cluster(None, 1, 1),
    ):
        raise AssertionError("has a client")


def test_worker_that_died_before_it_was_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its end is no error to the cluster, which must hear of the next one."""
    ours = submission._Local.__new__(submission._Local)
    ours.scheduler_info = {"workers": {}}
    with pytest.raises(KeyError):
        distributed.LocalCluster._update_worker_status(ours, "remove", "tcp://gone")
    ours._update_worker_status("remove", "tcp://gone")
    ours.status = distributed.Status.closed
