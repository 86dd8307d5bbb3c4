"""Whether the frozen runs are bit by bit those of another commit, on this machine.

Installs that commit and this checkout, as it lies on the disk, in folders of their own and solves
the runs of `tests.physics.frozen.configurations` with each, some interrupted and resumed. Prints
which variables differ; variables of only one of the two are listed, and count as no difference.
The exit code is 1 if anything differs.

    python tests/benchmarks/same_as.py main
    python tests/benchmarks/same_as.py HEAD~3 --only jkr "gap volume" --without status
"""

import argparse
import io
import json
import os
import subprocess
import sys
import tarfile
import threading
import time
import warnings
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
# Products of matrices on several threads would add up in another order each time.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
INTERRUPTED = "interrupted"
Values = dict[str, Any]


def main() -> int:
    """Compare and print; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("commit", help="what git calls it: a hash, a branch, HEAD~1")
    parser.add_argument("--only", nargs="+", default=[""], help="parts of the names of runs")
    parser.add_argument("--without", nargs="+", default=[], help="variables to leave out")
    options = parser.parse_args()
    sys.path.insert(0, str(ROOT))
    from tests.physics.frozen.configurations import CONFIGURATIONS, RESUMED

    runs = {n: c for n, c in CONFIGURATIONS.items() if any(part in n for part in options.only)}
    resumed = [name for name in RESUMED if name in runs]
    if not runs:
        parser.error(f"no run has such a name; there are: {', '.join(CONFIGURATIONS)}")
    with TemporaryDirectory() as scratch:
        here, there = Path(scratch, "here"), Path(scratch, "there")
        checkout(options.commit, there / "source")
        install(ROOT, here / "site")
        install(there / "source", there / "site")
        ours, theirs = (solved(folder, runs, resumed) for folder in (here, there))
    differing = 0
    for name in ours:
        told = list(differences(theirs[name], ours[name], {"wall_time", *options.without}))
        added, gone = (
            sorted({*ours[name]} - {*theirs[name]}),
            sorted({*theirs[name]} - {*ours[name]}),
        )
        if told or added or gone:
            notes = [f"new: {', '.join(added)}"] * bool(added) + [
                f"gone: {', '.join(gone)}"
            ] * bool(gone)
            print(name, *told, *notes, sep="\n    ")
        differing += bool(told)
    print(f"{differing} of {len(ours)} runs differ from {options.commit}")
    return int(differing > 0)


def checkout(commit: str, folder: Path) -> None:
    """Write the files of a commit."""
    command = ["git", "-C", str(ROOT), "archive", "--format=tar", commit]
    archive = subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        tar.extractall(folder, filter="data")


def install(source: Path, site: Path) -> None:
    """Install what lies in a folder, with the libraries that are here."""
    options = ("--quiet", "--no-deps", "--no-build-isolation", "--disable-pip-version-check")
    command = [sys.executable, "-m", "pip", "install", *options, "--target", str(site), str(source)]
    subprocess.run(command, check=True)


def solved(folder: Path, runs: Mapping[str, Any], resumed: Collection[str]) -> dict[str, Values]:
    """Return the variables of all runs by the version whose ``site`` is in a folder."""
    files = [folder / f"{number}.npz" for number in range(len(runs) + len(resumed))]
    jobs = [(configuration, "") for configuration in runs.values()]
    jobs += [(runs[name], str(folder / f"run {number}")) for number, name in enumerate(resumed)]
    for job in jobs[len(runs) :]:
        child(folder / "site", [job], [INTERRUPTED])
    child(folder / "site", jobs, [str(file) for file in files])
    names = [*runs, *(f"{name}, resumed" for name in resumed)]
    return {n: dict(np.load(file)) for n, file in zip(names, files, strict=True)}


def child(site: Path, jobs: list[tuple[Any, str]], files: list[str]) -> None:
    """Let a process of its own solve runs and save them."""
    # Nothing of this checkout may be importable there: -P leaves the folder of the script out.
    command = [sys.executable, "-P", __file__, "--child"]
    environment = os.environ | ONE_THREAD | {"PYTHONPATH": str(site)}
    text = json.dumps([str(site), jobs, files])
    subprocess.run(command, input=text, text=True, env=environment, cwd=site, check=True)


def solve() -> None:
    """Solve and save the runs on standard input: all that is done with either version."""
    import pellicle as pl

    site, jobs, files = json.load(sys.stdin)
    if not Path(str(pl.__file__)).is_relative_to(site):
        raise SystemExit(f"{pl.__file__} is not in {site}")
    warnings.simplefilter("ignore")
    for (configuration, folder), file in zip(jobs, files, strict=True):
        if file == INTERRUPTED:
            threading.Thread(target=end_at_first_file, args=[Path(folder)], daemon=True).start()
        try:
            run = pl.Run(**configuration, outputs=[])
            steps = pl.run(run, directory=folder or None, progress=False).dataset
            values = {str(name): array.values for name, array in steps.variables.items()}
        except pl.PellicleError as error:
            values = {"error": np.array(str(error))}
        texts = {name: array.astype(str) for name, array in values.items() if array.dtype == object}
        if file != INTERRUPTED:
            np.savez(file, allow_pickle=False, **values | texts)


def end_at_first_file(folder: Path) -> None:
    """End this process without a word once a step has been written."""
    while not (folder.is_dir() and any(path.suffix == ".h5" for path in folder.iterdir())):
        time.sleep(1e-3)
    os._exit(0)


def differences(old: Values, new: Values, without: Collection[str]) -> Iterator[str]:
    """Tell which variables that are in both differ in any bit."""
    for name in [name for name in old if name in new and name not in without]:
        a, b = old[name], new[name]
        if a.dtype.kind == b.dtype.kind == "U":
            if a.shape != b.shape or (a != b).any():
                yield f"{name}: {a.tolist()} → {b.tolist()}"
        elif a.dtype != b.dtype or a.shape != b.shape:
            yield f"{name}: {a.dtype} {a.shape} → {b.dtype} {b.shape}"
        elif a.tobytes() != b.tobytes():
            unlike = (a != b) & ~(np.isnan(a) & np.isnan(b))
            with np.errstate(all="ignore"):
                most = np.nanmax(np.abs(a.astype(float) - b), initial=0.0)
                share = most / np.nanmax(np.abs(a.astype(float)), initial=0.0)
            yield f"{name}: {unlike.sum()} of {a.size} values, by up to {share:.1e} of the largest"


if __name__ == "__main__":
    if sys.argv[1:] == ["--child"]:
        solve()
    else:
        sys.exit(main())
