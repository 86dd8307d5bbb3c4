"""Names of the top level that applications bring."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

import pellicle as pl
from pellicle.plugins import applications

GROUP = "pellicle.applications"


def test_a_name_is_that_of_the_application() -> None:
    """The name at the top level and that of the package are one object."""
    import pellicle_fit

    assert pl.fit is pellicle_fit.fit
    assert "fit" in dir(pl)


def test_what_is_not_installed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part of the wheel that is missing costs its own names, and no others."""
    unknown = "simulate_gel"
    entries = [
        EntryPoint("absent", "no_such_package", GROUP),
        EntryPoint("fit", "pellicle_fit", GROUP),
    ]
    monkeypatch.setattr(applications, "entry_points", lambda group: entries)
    assert applications.fit is pl.fit
    with pytest.raises(pl.PluginError, match=r"brings pellicle\.simulate_gel; that of no_such_pa"):
        getattr(applications, unknown)
    monkeypatch.setattr(applications, "entry_points", lambda group: [])
    with pytest.raises(AttributeError, match="'fit'"):
        _ = applications.fit
