"""``pellicle schema``."""

from __future__ import annotations

from .printing import print_json


def schema() -> None:
    """Print the JSON schema of a run or study file, with all installed components, for editors."""
    from pellicle.config.json_schema import schema as make_schema

    print_json(make_schema())
