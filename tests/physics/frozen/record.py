"""Record the frozen values anew, and print what has changed.

    python tests/physics/frozen/record.py                    # all
    python tests/physics/frozen/record.py applications

What has changed by no more than rounding is left as it stands.
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

TESTS = Path(__file__).parents[2]
sys.path[:0] = [str(TESTS.parent), str(TESTS / "benchmarks")]

from tests.physics.frozen import reader  # noqa: E402
from tests.physics.frozen.benchmarks import CASES  # noqa: E402
from tests.physics.frozen.comparison import COUNT_TOLERANCE, changes, compact  # noqa: E402
from tests.physics.frozen.configurations import CONFIGURATIONS  # noqa: E402
from tests.physics.frozen.fit_layers import LAYERS, differences, rounded  # noqa: E402
from tests.physics.frozen.store import store, stored  # noqa: E402

ALLOWED = 100
"""Change of a run's numbers over its tolerance."""


def runs() -> None:
    """Record every variable of the runs."""
    old, new = stored("runs"), {}
    _tell_names("runs", old, CONFIGURATIONS)
    for name, configuration in CONFIGURATIONS.items():
        tolerance = ALLOWED * reader.solver_tolerance(configuration)
        values = compact(reader.run_values(configuration))
        kept = old.get(name, {"values": {}})["values"]
        changed = changes(kept, values, tolerance)
        if name in old:
            _tell({f"{name}: {variable}": text for variable, text in changed.items()})
        new[name] = {
            "tolerance": tolerance,
            "values": {v: values[v] if v in changed else kept[v] for v in values},
        }
    store("runs", new)


def applications() -> None:
    """Record the operator applications of the benchmarks."""
    old, new = stored("applications"), {}
    _tell_names("applications", old, [case.name for case in CASES])
    for case in CASES:
        count, kept = case.applications(), old.get(case.name)
        same = kept is not None and abs(count - kept) <= COUNT_TOLERANCE * kept
        if kept is not None and not same:
            _tell({case.name: f"{kept} → {count} ({count / kept - 1:+.0%})"})
        new[case.name] = kept if same else count
    store("applications", new)


def fits() -> None:
    """Record the layers of the answers of fits."""
    old, new = stored("fits"), {}
    for layer, (entries, changed) in LAYERS.items():
        before = old.get(layer, {})
        values = {name: rounded(value) for name, value in entries()}
        _tell({f"{layer}: {text}": "" for text in differences(layer, before, values)})
        new[layer] = {
            name: before[name] if name in before and not [*changed(before[name], value)] else value
            for name, value in values.items()
        }
    store("fits", new)


RECORDS: dict[str, Callable[[], None]] = {
    "runs": runs,
    "applications": applications,
    "fits": fits,
}


def _tell_names(file: str, old: Any, new: Any) -> None:
    _tell({f"{file}: {name}": "is gone" for name in old if name not in new})
    _tell({f"{file}: {name}": "is new" for name in new if name not in old})


def _tell(changed: dict[str, str]) -> None:
    for name, text in changed.items():
        sys.stdout.write(f"{name}: {text}\n" if text else f"{name}\n")


def main() -> None:
    """Record what is named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("records", nargs="*", metavar="RECORD", help=", ".join(RECORDS))
    for name in parser.parse_args().records or RECORDS:
        RECORDS[name]()


if __name__ == "__main__":
    main()
