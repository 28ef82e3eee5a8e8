#!/usr/bin/env python3
"""AUTO-07p and tangency on the nonimpacting periodic orbits of Mita's actuator at ω = 0.45, from V = 0.01
through the fold to max q₂ = 0.9: number of points, error of the fold, CPU time on one core.

Prints Markdown. What it needs and what it measures is in README.md beside it.
"""

import argparse
import datetime
import os
import pathlib
import re
import shlex
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time

from common import machine, pin, table

HERE = pathlib.Path(__file__).resolve().parent
AUTO = "bifpy==0.3.0"  # the source package that carries AUTO-07p
FOLD = 0.2355654335833884  # by fold.py
COLUMNS = ("method", "points", "mesh", "fold V", "fold error", "CPU ms")

CONSTANTS = {
    # Derivatives are those of the equations file.
    "NINT": 0, "NPAR": 11, "JAC": 1,
    # The mesh, adapted after every third point.
    "NTST": 20, "NCOL": 4, "IAD": 3,
    # Folds, branch points and bifurcations of the multipliers are detected and located.
    "ILP": 1, "ISP": 2, "MXBF": 0,
    # Newton's matrix is formed in the first NWTN iterations of a point; tolerances as in AUTO's demos.
    "ITMX": 9, "ITNW": 5, "NWTN": 3, "EPSL": 1e-7, "EPSU": 1e-7, "EPSS": 1e-5,
    # Steps adapted after every point.
    "DS": 0.01, "DSMIN": 1e-5, "IADS": 1,
    # Until max q = 0.9, which is the measure that IPLT = 1 selects.
    "IPLT": 1, "A0": -1.0, "A1": 0.9, "RL0": 0.0, "RL1": 1.0, "NMX": 400,
    # As little output as possible: solutions at the ends and the fold only, no diagnostics.
    "NPR": 100000, "IID": 0,
}  # fmt: skip
# Each formulation's equations and constants; DSMAX decides that there are 47 points.
PERIODIC = {"IPS": 2, "NDIM": 4, "NBC": 0, "ICP": [1, 11], "DSMAX": 0.034}  # V and the period are free
BOUNDARY = {"IPS": 7, "NDIM": 3, "NBC": 3, "ICP": [1], "DSMAX": 0.039}  # multipliers too; V is free
FORMULATIONS = {
    "IPS = 2": ("periodic.F90", CONSTANTS | PERIODIC),
    "IPS = 7": ("boundary.F90", CONSTANTS | BOUNDARY),
    "IPS = 7, NWTN = 1": ("boundary.F90", CONSTANTS | BOUNDARY | {"NWTN": 1}),
}


def call(*command, cwd=None):
    """Runs a command and gives what it printed; on failure its whole output is the error."""
    done = subprocess.run(command, cwd=cwd, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0:
        raise SystemExit(f"{shlex.join(map(str, command))} failed:\n{done.stdout}")
    return done.stdout


def build(sources, directory, options):
    """The objects of AUTO, compiled with the given gfortran options by the makefile of the package."""
    with tarfile.open(sources) as archive:
        archive.extractall(directory, filter="data")
    (auto,) = directory.glob("*/auto")
    compiler = shlex.join(["gfortran", *options])
    call("make", "native", f"F77={compiler}", f"F90={compiler}", cwd=auto)
    return [auto / "native" / "main.o", auto / "lib" / "libbifpy.a"]


class Auto:
    """AUTO linked with a formulation: one program to measure, one that writes V with all digits."""

    def __init__(self, name, directory, objects, options):
        equations, self.constants = FORMULATIONS[name]
        self.directory = directory / name
        self.directory.mkdir(parents=True)
        for program, define in (("measured", []), ("digits", ["-DFULL_DIGITS"])):
            call("gfortran", *options, *define, HERE / equations, *objects, "-o", self.directory / program)

    def run(self, program, **constants):
        """One run in the program's directory: its CPU time (user and system) in ms, and what it printed; the elapsed
        time in ms is kept."""
        lines = (f"{name} = {value!r}\n" for name, value in (self.constants | constants).items())
        (self.directory / "fort.2").write_text("".join(lines))
        begin = time.perf_counter()
        with open(self.directory / "log", "w") as log:
            process = subprocess.Popen([self.directory / program], cwd=self.directory, stdout=log,
                                       stderr=subprocess.STDOUT)  # fmt: skip
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.elapsed = 1e3 * (time.perf_counter() - begin)
        if process.returncode != 0:
            raise SystemExit(f"AUTO ended with exit code {process.returncode} in {self.directory}")
        return 1e3 * (usage.ru_utime + usage.ru_stime), (self.directory / "log").read_text()

    def fold(self):
        """V at the fold with all digits: the last V written that agrees with AUTO's own 11 digits."""
        (self.directory / "fort.55").unlink(missing_ok=True)
        self.run("digits")
        (printed,) = (float(row[4]) for row in self.rows() if row[2] == "5")  # type 5 is LP
        voltages = map(float, (self.directory / "fort.55").read_text().split())
        return [v for v in voltages if abs(v - printed) < 1e-10][-1]

    def rows(self):
        """The points in fort.7: branch, point, type, label, V, max q, …; header lines have branch 0."""
        lines = (self.directory / "fort.7").read_text().splitlines()
        return [line.split() for line in lines if line.split()[0] != "0"]

    def row(self, name, runs):
        """The row of the table, and a remark on start-up and on the time AUTO reports itself."""
        branch, first, reported = [], [], []
        for _ in range(runs):
            first.append(self.run("measured", NMX=1)[0])
            time, output = self.run("measured")
            branch.append(time)
            reported.append(1e3 * float(re.search(r"Total Time\s+(\S+)", output)[1]))
        points = len(self.rows())
        maximum = float(self.rows()[-1][5])
        if maximum < CONSTANTS["A1"]:
            raise SystemExit(f"{name}: the branch ended at max q = {maximum}, before {CONSTANTS['A1']}")
        median = statistics.median(branch) - statistics.median(first)
        least = min(branch) - statistics.median(first)
        fold = self.fold()
        mesh = f"{CONSTANTS['NTST']} × {CONSTANTS['NCOL']}"
        remark = (f"{name}: process {statistics.median(branch):.2f} ms; one point alone, subtracted, "
                  f"{statistics.median(first):.2f} ms; AUTO's clock {statistics.median(reported):.2f} ms.")
        return [name, str(points), mesh, f"{fold:.14f}", f"{abs(fold - FOLD):.1e}",
                f"{median:.2f} (min {least:.2f})"], remark  # fmt: skip


def tangency(command):
    """The rows that tangency's own benchmark prints: lines that begin with `| tangency`."""
    output = call(*shlex.split(command), cwd=HERE.parents[1])
    lines = [line for line in output.splitlines() if line.startswith("| tangency")]
    if not lines:
        raise SystemExit(f"{command} printed no line that begins with '| tangency':\n{output}")
    rows = (line.strip().strip("|").split("|") for line in lines)
    return [[cell.strip() for cell in row] for row in rows]


def milliseconds(row):
    """The number in the last of the common columns."""
    return float(re.match(r"[\d.eE+-]+", row[len(COLUMNS) - 1])[0])


def together(rounds):
    """One row for each of tangency's methods out of several rounds: the median of CPU times, and the least."""
    for rows in zip(*rounds):
        row = sorted(rows, key=milliseconds)[len(rows) // 2]
        least = min(float(re.search(r"least ([\d.eE+-]+)", row[-1])[1]) for row in rows)
        yield [*row[:-1], f"{milliseconds(row):.3f} (least {least:.3f})"]


def measure(arguments, directory):
    """The rows of AUTO in its several builds, with remarks, and tangency's: both take turns, since machines have slow
    minutes."""
    call(sys.executable, "-m", "pip", "download", "--no-deps", "--no-binary", "bifpy", "-d", directory, AUTO)
    (sources,) = directory.glob("*.tar.gz")
    builds = {"as bifpy builds it": ([], build(sources, directory / "0", [])),
              "-O2": (["-O2"], build(sources, directory / "2", ["-O2"]))}  # fmt: skip
    if arguments.objects:
        builds["native"] = (["-O2", "-fopenmp"], sorted(pathlib.Path(arguments.objects).glob("*.o")))
    programs = {f"AUTO-07p, {build_name}, {name}": Auto(name, directory / build_name, objects, options)
                for build_name, (options, objects) in builds.items() for name in FORMULATIONS}  # fmt: skip
    pin(1)
    rows, remarks, rounds = [], [], []
    for name, auto in programs.items():
        row, remark = auto.row(name, arguments.runs)
        rows.append(row)
        remarks.append(remark)
        if arguments.tangency:
            rounds.append(tangency(arguments.tangency))
    return rows, remarks, list(together(rounds))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=40, help="runs of each program (40)")
    parser.add_argument("--objects", help="directory with the objects of a native AUTO, measured as well")
    parser.add_argument("--tangency", default="cargo run --profile fastest --locked --quiet --example orbit_speed",
                        help="command that prints tangency's rows; empty: AUTO alone")  # fmt: skip
    arguments = parser.parse_args()
    if arguments.tangency.startswith("cargo run"):  # compile on all cores, before the pinning to one
        call(*shlex.split(arguments.tangency.replace("cargo run", "cargo build", 1)), cwd=HERE.parents[1])

    with tempfile.TemporaryDirectory() as directory:
        rows, remarks, own = measure(arguments, pathlib.Path(directory))

    versions = [call("gfortran", "--version").splitlines()[0]]
    versions += [call("rustc", "--version").strip()] if own else []
    print(f"{machine()}, one core; {'; '.join(versions)}; {AUTO}; {datetime.date.today()}.\n")
    table(COLUMNS, [*rows, *own])
    if own:
        ratios = ([row[0], *(f"{milliseconds(row) / milliseconds(other):.1f}" for other in own)]
                  for row in rows)
        table(["CPU time divided by that of", *(other[0] for other in own)], ratios)
    print("\n".join(remarks))


if __name__ == "__main__":
    main()
