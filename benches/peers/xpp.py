#!/usr/bin/env python3
"""XPPAUT and tangency on the example files of Debian's package xppaut: the same trajectory of every model that tangency
reads, and the reason why it refuses the others.

    apt-get install xppaut
    python3 benches/peers/xpp.py [--tangency COMMAND] [FILE.ode ...]

Prints Markdown. xppaut runs without a window on a copy of each file (`xppaut FILE -silent`), whose last options ask for
tight tolerances, output at equal times and no bounds. It runs twice, the second time with looser tolerances: where the
two runs differ by more than 1e-7, the motion magnifies errors (or xppaut cannot resolve it), and the comparison ends.
A model that stays where it begins is compared from other initial values.
"""

import argparse
import csv
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from common import table

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = pathlib.Path("/usr/share/doc/xppaut")
AGREEMENT = 1e-6  # of |a - b| / (1 + |b|), with b from xppaut
SENSITIVE = 1e-7  # where xppaut's two runs differ by more, the comparison ends
# xppaut writes single precision. For each of these scales s a further column holds x - floor(s x) / s, which has more
# and more of the last digits of x; together the columns give it in double precision (while |x| is below some 1e4).
SCALES = (2**10, 2**30)


class Unread(Exception):
    """A program did not follow the model: its words."""


def tangency(command, path, time, count):
    """Rows (t, states, auxiliary quantities) of tangency at count + 1 equal times."""
    arguments = [path, "--time", repr(time), "--count", str(count)]
    done = subprocess.run([*shlex.split(command), *arguments], cwd=ROOT, text=True, capture_output=True)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"tangency ends with {done.returncode}"]
        raise Unread(lines[0].replace(f"{path}, ", "").strip())
    _, *rows = csv.reader(done.stdout.splitlines())
    return [[float(cell) for cell in row] for row in rows]


class Model:
    """An .ode file as xppaut runs it: joined lines up to `done`, the options that matter here, and whether it is a map
    or has events."""

    def __init__(self, text):
        text = re.sub(r"\\[^\n]*\n", "", text)  # continued lines
        text = re.split(r"^\s*d(?:one)?\s*$", text, maxsplit=1, flags=re.I | re.M)[0]
        # Sets would be run instead of the file itself, `only` leaves columns out, folding takes variables modulo 2π.
        text = re.sub(r"^\s*(?:set|only)\s.*$", "# left out", text, flags=re.I | re.M)
        self.text = re.sub(r"\b(?:fold|tor_per)=[^\s,]*", "", text, flags=re.I)
        words = (word for line in re.findall(r"^@(.*)$", self.text, re.M) for word in re.split(r"[\s,]+", line))
        options = {name.upper(): value for name, given, value in (word.partition("=") for word in words) if given}
        method = next((value for name, value in options.items() if name.startswith("METH")), "rungekutta")
        self.map = method[0] in "dD" or bool(re.search(r"^\s*\w+\s*\(\s*t\s*\+\s*1\s*\)\s*=", self.text, re.I | re.M))
        self.events = bool(re.search(r"^\s*g\w*\s+[-+]?\d", self.text, re.I | re.M))
        self.start, total = float(options.get("T0", 0)), float(options.get("TOTAL", 20))
        self.total = math.floor(total) if self.map else total

    def moved(self, states):
        """The text with other initial values, all different."""
        values = [f"init {name}={0.1 + 0.1 * k / len(states)!r}" for k, name in enumerate(states)]
        return "\n".join([self.text, *values, "done\n"])

    def copy(self, states, options, initial):
        """The text for xppaut, with the columns of further digits after all others."""
        own = re.findall(r"^\s*au\w*\s+[^\[=\n]*(\[[^\]=\n]*\])?[^=\n]*=(.*)$", self.text, re.I | re.M)
        formulas = [("", name) for name in states] + own  # with the range of indices of an array
        digits = [f"aux q{k}d{n}_{indices}=({formula.strip()})-flr(({formula.strip()})*{scale})/{scale}"
                  for n, scale in enumerate(SCALES) for k, (indices, formula) in enumerate(formulas)]  # fmt: skip
        values = [f"init {name}={value!r}" for name, value in initial]
        return "\n".join([self.text, *digits, *values, f"@ {options}", "done\n"])


class Xppaut:
    """xppaut on one model, in a directory."""

    def __init__(self, model, directory):
        self.model, self.directory, self.states = model, directory, []
        log, _ = self.run("total=1,dt=1,nout=1")
        self.states = re.findall(r"^\s*\d+:d(.+)/dt=", log, re.M) or re.findall(r"^\s*(.+?)\(t\+1\)=", log, re.M)
        if not self.states:
            raise Unread(f"xppaut: {log.strip().splitlines()[-1].strip()}")

    def run(self, options, initial=()):
        """What xppaut printed, and the rows that it wrote."""
        (self.directory / "model.ode").write_text(self.model.copy(self.states, options, initial))
        output = self.directory / "output.dat"
        output.unlink(missing_ok=True)
        # A home of its own, lest ~/.xpprc set options.
        done = subprocess.run(["xppaut", "model.ode", "-silent"], cwd=self.directory, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                              env=os.environ | {"HOME": str(self.directory)})  # fmt: skip
        lines = output.read_text().splitlines() if output.exists() else []
        return done.stdout, [[float(word) for word in line.split()] for line in lines]

    def rows(self, options, many=1, initial=()):
        """One row in so many, in double precision, up to the first that is not finite."""
        options = f"total={self.model.total!r},trans=0,nout=1,bound=1e12,{options}"
        rows = []
        for row in self.run(options, initial)[1][::many]:
            if not all(map(math.isfinite, row)):
                break
            rows.append(self.restored(row))
        return rows

    @staticmethod
    def restored(row):
        """t and the columns in double precision."""
        t, *columns = row
        size = len(columns) // (1 + len(SCALES))
        values = columns[:size]
        for n, scale in enumerate(SCALES, start=1):
            parts = columns[n * size : (n + 1) * size]
            values = [part + round((value - part) * scale) / scale for value, part in zip(values, parts)]
        return [t, *values]

    def twice(self, count):
        """The trajectory at tight and at loose tolerances."""
        step = self.model.total / count
        if self.model.map:  # nothing to choose: the second run begins elsewhere, at a distance of 1e-13
            options = f"meth=discrete,maxstor={count + 100}"
            tight = self.rows(options)
            near = [(name, x + 1e-13 * (1 + abs(x))) for name, x in zip(self.states, *(row[1:] for row in tight[:1]))]
            return tight, self.rows(options, initial=near)
        if self.model.events:  # found by linear interpolation over a step, whatever the method: hence short ones
            parts = (math.ceil(step / longest) for longest in (1e-4, 2e-4))
            return [self.rows(f"meth=rungekutta,dt={step / k!r},nout={k},maxstor={count + 100}") for k in parts]
        # CVODE, for stiff models, takes at most 500 steps between two outputs: hence more of them than are wanted.
        methods = (("8", 1), ("cvode", 50))
        runs = []
        for method, many in methods:
            options = f"meth={method},dt={step / many!r},maxstor={many * count + 100}"
            found = [self.rows(f"{options},tol={each},atol={each}", many) for each in (1e-13, 1e-12)]
            runs.append(found)
            if min(map(len, found)) > count:
                break
        return max(runs, key=lambda pair: min(map(len, pair)))


def difference(row, other):
    """The largest relative difference of two rows, times left out."""
    return max(abs(a - b) / (1 + abs(b)) for a, b in zip(row[1:], other[1:]))


def verdict(own, tight, loose, end):
    """Whether the trajectory of tangency agrees with xppaut's, and how far, in words."""
    if not tight or not loose:
        return False, "xppaut writes nothing"
    if len(own[0]) != len(tight[0]):
        return False, f"{len(own[0]) - 1} columns, xppaut has {len(tight[0]) - 1}"
    worst, sure = 0.0, 0
    for row, other, check in zip(own, tight, loose):
        if not difference(other, check) <= SENSITIVE:
            break
        if abs(row[0] - other[0]) > 1e-6 * (1 + abs(other[0])):
            return False, f"at t = {row[0]:g} xppaut is at t = {other[0]:g}"
        found = difference(row, other)
        if not found <= AGREEMENT:
            return False, f"**differs by {found:.0e} at t = {row[0]:g}**"
        worst, sure = max(worst, found), sure + 1
    if sure == len(own):
        return True, f"agrees to {worst:.0e} until t = {end:g}"
    reason = "sensitive from there on" if sure < min(len(tight), len(loose)) else "where a program stops"
    last = tight[max(sure, 1) - 1][0]
    return sure > 1, f"agrees to {worst:.0e} until t = {last:g} of {end:g}, {reason}"


def followed(command, path, model, count, directory):
    """Whether the programs agree, in words, and the states if none of them moves."""
    own = tangency(command, path, model.total, count)
    xppaut = Xppaut(model, directory)
    tight, loose = xppaut.twice(count)
    size = len(xppaut.states)
    rests = tight and all(difference(row[: 1 + size], tight[0][: 1 + size]) < 1e-12 for row in tight)
    return *verdict(own, tight, loose, model.start + model.total), xppaut.states if rests else []


def compared(command, path, count):
    """The result of a file: a kind, and what it is in words."""
    with tempfile.TemporaryDirectory() as name:
        directory = pathlib.Path(name)
        model = Model(path.read_text(errors="replace"))
        count = model.total if model.map else count
        try:
            agrees, words, resting = followed(command, path, model, count, directory)
            if agrees and resting:
                elsewhere = directory / path.name
                elsewhere.write_text(model.moved(resting))
                model = Model(elsewhere.read_text())
                agrees, words, _ = followed(command, elsewhere, model, count, directory)
                words = f"at rest; from elsewhere {words}"
        except Unread as error:
            place = re.search(r"^line \d+, column \d+", str(error))
            return ("refused", f"refused: {error}") if place else ("differs", f"**{error}**")
        return ("agrees" if agrees else "differs"), words


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tangency", default="cargo run --release --locked --quiet --example trajectory --",
                        help="command that writes trajectories")  # fmt: skip
    parser.add_argument("--count", type=int, default=500, help="output times, other than of maps (500)")
    parser.add_argument("files", nargs="*", type=pathlib.Path, help=f"models (all below {EXAMPLES})")
    arguments = parser.parse_args()
    files = [path.resolve() for path in arguments.files] or sorted(EXAMPLES.glob("**/*.ode"))
    if not files:
        raise SystemExit(f"no .ode file below {EXAMPLES}: apt-get install xppaut, or apt-get download and dpkg -x")
    rows, kinds = [], []
    for path in files:
        kind, words = compared(arguments.tangency, path, arguments.count)
        shown = path.relative_to(EXAMPLES) if path.is_relative_to(EXAMPLES) else path
        rows.append([str(shown), words.replace("|", "\\|")])
        kinds.append(kind)
    table(["file", "result"], rows)
    counts = (("agree", "agrees"), ("are refused", "refused"), ("differ", "differs"))
    print(f"Of {len(kinds)} files {', '.join(f'{kinds.count(kind)} {words}' for words, kind in counts)}.")
    sys.exit("differs" in kinds)


if __name__ == "__main__":
    main()
