#!/usr/bin/env python3
"""AUTO-07p and tangency on periodic orbits of a ring of coupled oscillators with 20, 40 and 80 states, by
collocation on 100 intervals with 4 points each: CPU time for a step of the branch, on one core.

Prints Markdown. What it needs and what it measures is in README.md beside it.
"""

import argparse
import datetime
import pathlib
import statistics
import sys
import tempfile

from auto import AUTO, CONSTANTS, FORMULATIONS, Auto, build, call, tangency
from common import machine, one_core, table

SIZES = (20, 40, 80)
STEPS = 10
# Neither stability nor special points; one Newton matrix a point; steps of equal length.
RING = CONSTANTS | {
    "IPS": 2, "NBC": 0, "ICP": [1, 11], "NTST": 100, "ISP": 0, "ILP": 0, "NWTN": 1,
    "DS": 0.01, "DSMAX": 0.01, "IADS": 0, "IPLT": 0, "A0": -1e9, "A1": 1e9, "RL1": 100.0,
}  # fmt: skip


def step(auto, states, runs):
    """The CPU time of AUTO for a step, in ms: the median difference of two runs of different lengths."""
    times = []
    for _ in range(runs):
        short, long = (auto.run("measured", NDIM=states, NMX=points)[0] for points in (2, 2 + STEPS))
        times.append((long - short) / STEPS)
    return statistics.median(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1, help="runs of AUTO-07p (1)")
    parser.add_argument("--tangency", default="cargo run --release --locked --quiet --example ring_speed",
                        help="command that prints tangency's rows")  # fmt: skip
    arguments = parser.parse_args()
    if arguments.tangency.startswith("cargo run"):  # compile on all cores, before the pinning to one
        call(*arguments.tangency.replace("cargo run", "cargo build", 1).split(), cwd=pathlib.Path(__file__).parents[2])

    rows = []
    with tempfile.TemporaryDirectory() as directory:
        directory = pathlib.Path(directory)
        call(sys.executable, "-m", "pip", "download", "--no-deps", "--no-binary", "bifpy", "-d", directory, AUTO)
        (sources,) = directory.glob("*.tar.gz")
        FORMULATIONS["ring"] = ("ring.F90", RING)
        for options in (["-O2"], ["-O3"]):
            auto = Auto("ring", directory / options[0], build(sources, directory / f"objects{options[0]}", options), options)
            one_core()
            rows.append([f"AUTO-07p, {options[0]}", *(step(auto, states, arguments.runs) for states in SIZES)])
        rows += [[name, *map(float, times)] for name, *times in tangency(arguments.tangency)]

    versions = [call("gfortran", "--version").splitlines()[0], call("rustc", "--version").strip()]
    print(f"{machine()}, one core; {'; '.join(versions)}; {AUTO}; {datetime.date.today()}.\n")
    table(["CPU ms for a step", *(f"{states} states" for states in SIZES)],
          [[row[0], *(f"{time:.1f}" for time in row[1:])] for row in rows])  # fmt: skip
    fastest = [min(times) for times in zip(*(row[1:] for row in rows if row[0].startswith("AUTO")))]
    own = [row for row in rows if not row[0].startswith("AUTO")]
    table(["CPU time of the fastest AUTO-07p divided by the CPU time of", *(f"{states} states" for states in SIZES)],
          [[row[0], *(f"{auto / time:.1f}" for auto, time in zip(fastest, row[1:]))] for row in own])  # fmt: skip


if __name__ == "__main__":
    main()
