#!/usr/bin/env python3
"""AUTO-07p and tangency on periodic orbits of a ring of coupled oscillators with 20, 40 and 80 states, by
collocation on 100 intervals with 4 points each: elapsed time for a step of the branch, on one core or on several.

Prints Markdown. What it needs and what it measures is in README.md beside it.
"""

import argparse
import datetime
import pathlib
import statistics
import sys
import tempfile

from auto import AUTO, CONSTANTS, FORMULATIONS, Auto, build, call, tangency
from common import machine, pin, table

SIZES = (20, 40, 80)
STEPS = 10
# Neither stability nor special points; one Newton matrix a point; steps of equal length.
RING = CONSTANTS | {
    "IPS": 2, "NBC": 0, "ICP": [1, 11], "NTST": 100, "ISP": 0, "ILP": 0, "NWTN": 1,
    "DS": 0.01, "DSMAX": 0.01, "IADS": 0, "IPLT": 0, "A0": -1e9, "A1": 1e9, "RL1": 100.0,
}  # fmt: skip


def step(auto, states, runs):
    """The elapsed time of AUTO for a step, in ms: the median difference of two runs of different lengths."""
    times = []
    for _ in range(runs):
        both = []
        for points in (2, 2 + STEPS):
            auto.run("measured", NDIM=states, NMX=points)
            both.append(auto.elapsed)
        times.append((both[1] - both[0]) / STEPS)
    return statistics.median(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1, help="runs of AUTO-07p (1)")
    parser.add_argument("--cores", type=int, default=1, help="cores; with several, AUTO-07p also uses OpenMP (1)")
    parser.add_argument("--tangency", default="cargo run --release --locked --quiet --example ring_speed",
                        help="command that prints tangency's rows")  # fmt: skip
    arguments = parser.parse_args()
    if arguments.tangency.startswith("cargo run"):  # compile on all cores, before the pinning
        call(*arguments.tangency.replace("cargo run", "cargo build", 1).split(), cwd=pathlib.Path(__file__).parents[2])

    rows = []
    with tempfile.TemporaryDirectory() as directory:
        directory = pathlib.Path(directory)
        call(sys.executable, "-m", "pip", "download", "--no-deps", "--no-binary", "bifpy", "-d", directory, AUTO)
        (sources,) = directory.glob("*.tar.gz")
        FORMULATIONS["ring"] = ("ring.F90", RING)
        builds = [["-O2"], ["-O3"]] + [["-O3", "-fopenmp"]] * (arguments.cores > 1)
        for options in builds:
            auto = Auto("ring", directory / "".join(options), build(sources, directory / f"objects{''.join(options)}", options), options)
            pin(arguments.cores)
            rows.append([f"AUTO-07p, {' '.join(options)}", *(step(auto, states, arguments.runs) for states in SIZES)])
        rows += [[name, *map(float, times)] for name, *times in tangency(arguments.tangency)]

    versions = [call("gfortran", "--version").splitlines()[0], call("rustc", "--version").strip()]
    print(f"{machine()}, {arguments.cores} core(s); {'; '.join(versions)}; {AUTO}; {datetime.date.today()}.\n")
    table(["ms for a step", *(f"{states} states" for states in SIZES)],
          [[row[0], *(f"{time:.1f}" for time in row[1:])] for row in rows])  # fmt: skip
    fastest = [min(times) for times in zip(*(row[1:] for row in rows if row[0].startswith("AUTO")))]
    own = [row for row in rows if not row[0].startswith("AUTO")]
    table(["time of the fastest AUTO-07p divided by the time of", *(f"{states} states" for states in SIZES)],
          [[row[0], *(f"{auto / time:.1f}" for auto, time in zip(fastest, row[1:]))] for row in own])  # fmt: skip


if __name__ == "__main__":
    main()
