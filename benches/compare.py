#!/usr/bin/env python3
"""Is one commit slower than another? CPU times of the program at both, in pairs that take turns.

    python3 benches/compare.py                      # the commit before the last one, and the last one
    python3 benches/compare.py main .               # a branch, and the files as they are now
    python3 benches/compare.py --programs A B       # two programs that are there already
    python3 benches/compare.py v1 v2 --run 'trace mita-type-1' --rounds 20 --fail-above 1.05

Whatever else a machine does makes times longer, by a factor that changes within seconds. So both programs run one right
after the other, in the order old, new, new, old, and only the ratio of the two times of a pair counts. Of all ratios the
median is printed, with the interval in which the true median is with 95 % confidence: the order statistics of a
sign test, which assume nothing about how times scatter. Where valgrind is installed, the instructions of the
shortest command are counted as well, on which other work has no influence.
"""

import argparse
import math
import os
import pathlib
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile

from peers import common

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = ROOT / "target" / "compare"

RUNS = [
    f"trace {scene}"
    for scene in [
        "belt", "brusselator", "fitzhugh-nagumo", "impact-oscillator", "lure", "mita-nonimpacting", "mita-type-1",
        "plate-supported",
    ]
]

CONFIDENCE = 0.95


class Refused(Exception):
    """What cannot be compared, in words."""


def main():
    options = arguments()
    try:
        programs = options.programs or [build(commit, options.profile) for commit in options.commits]
        sys.exit(compare([pathlib.Path(program).resolve() for program in programs], options))
    except (Refused, OSError) as cause:
        sys.exit(f"error: {cause}")


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("commits", nargs="*", default=["HEAD~1", "HEAD"], metavar="COMMIT",
                        help="the old and the new commit; `.` are the files as they are now")
    parser.add_argument("--programs", nargs=2, metavar=("OLD", "NEW"), help="finished programs")
    parser.add_argument("--run", action="append", metavar="ARGUMENTS",
                        help=f"a command to measure; may be repeated (default: {', '.join(RUNS)})")
    parser.add_argument("--rounds", type=int, default=10, metavar="N",
                        help="rounds of old, new, new, old: two pairs each (default: 10)")
    parser.add_argument("--profile", default="release", help="cargo's profile (default: release)")
    parser.add_argument("--fail-above", type=float, metavar="RATIO",
                        help="exit with 1 if a whole interval is above this ratio")
    options = parser.parse_args()
    if len(options.commits) != 2:
        parser.error("two commits are compared: the old one and the new one")
    if options.rounds < 3:
        parser.error("fewer than 3 rounds have no interval of 95 %")
    return options


def build(commit, profile):
    """The program at a commit, built in a work tree of its own. It is kept, and built once."""
    here = commit == "."
    name = "now" if here else output("git", "rev-parse", "--verify", f"{commit}^{{commit}}")[:12]
    program = FOLDER / f"tangency-{name}-{profile}"
    if program.exists() and not here:
        return program
    tree = ROOT if here else FOLDER / name
    if not here and not tree.exists():
        output("git", "worktree", "add", "--detach", tree, name)
    print(f"building {commit} ({name}), {profile} …", file=sys.stderr, flush=True)
    # Dependencies are the same in most pairs: one target folder builds them once.
    target = FOLDER / "target"
    try:
        output("cargo", "build", "--locked", "--quiet", "--profile", profile, "--bin", "tangency",
               "--target-dir", target, at=tree)
    finally:
        if not here:
            output("git", "worktree", "remove", "--force", tree)
    shutil.copy2(target / profile / "tangency", program)
    return program


def output(*command, at=ROOT):
    """What a command prints."""
    done = subprocess.run([str(word) for word in command], cwd=at, capture_output=True, text=True)
    if done.returncode != 0:
        raise Refused(f"`{shlex.join(done.args)}` fails: {done.stderr.strip()}")
    return done.stdout.strip()


def compare(programs, options):
    """Measures all commands and prints the table; the exit code."""
    common.pin(1)
    runs, rows, medians, slower = options.run or RUNS, [], {}, False
    middle = []
    with tempfile.TemporaryDirectory() as folder:
        for run in runs:
            times = paired(programs, run, options.rounds, folder)
            ratios = sorted(new / old for old, new in times)
            low, high = interval(ratios)
            middle.append(statistics.median(ratios))
            slower |= options.fail_above is not None and low > options.fail_above
            medians[run] = statistics.median(old for old, _ in times)
            new = statistics.median(new for _, new in times)
            rows.append([f"`{run}`", f"{1e3 * medians[run]:.0f}", f"{1e3 * new:.0f}",
                         f"{middle[-1]:.3f}", f"{low:.3f} to {high:.3f}", str(len(ratios))])
        print(common.machine() + "\n")
        common.table(["command", "old, CPU time in ms", "new", "new / old", "95 %", "pairs"], rows)
        print(f"Geometric mean of new / old: {statistics.geometric_mean(middle):.3f}.\n")
        if shutil.which("valgrind"):
            cheapest = min(runs, key=medians.get)
            old, new = (instructions(program, cheapest, folder) for program in programs)
            print(f"Instructions of `{cheapest}`: {old} and {new}, ratio {new / old:.4f}.")
    if slower:
        print(f"A command is slower by more than {options.fail_above}.", file=sys.stderr)
    return 1 if slower else 0


def paired(programs, run, rounds, folder):
    """Times of both programs, in pairs; the first run of each, which fills caches, does not count."""
    old, new = programs
    for program in programs:
        seconds(program, run, folder)
    pairs = []
    for _ in range(rounds):
        first = (seconds(old, run, folder), seconds(new, run, folder))
        second = (seconds(new, run, folder), seconds(old, run, folder))
        pairs += [first, second[::-1]]
    return pairs


def command(program, run, folder):
    """The words of a command that writes into a folder."""
    return [str(program), *shlex.split(run), "--out", folder]


def seconds(program, run, folder):
    """The CPU time of one run: how the kernel divides it into user and system time is not exact, their sum is."""
    with tempfile.TemporaryFile("w+") as messages:
        process = subprocess.Popen(command(program, run, folder), stdout=subprocess.DEVNULL,
                                   stderr=messages, cwd=folder)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            messages.seek(0)
            raise Refused(f"`{program} {run}` fails: {messages.read().strip()}")
    return usage.ru_utime + usage.ru_stime


def interval(ratios):
    """The interval of the median: the narrowest pair of order statistics with at least 95 % between them.

    >>> interval([1.0, 1.1, 1.2, 1.3, 1.4, 1.5])
    (1.0, 1.5)
    >>> interval(list(range(1, 21)))
    (6, 15)
    """
    n = len(ratios)
    outside, k = 0.0, 0
    # So many of n signs are on one side with the probability of a fair coin.
    while 2 * (outside + math.comb(n, k) / 2**n) <= 1 - CONFIDENCE:
        outside += math.comb(n, k) / 2**n
        k += 1
    return ratios[k - 1], ratios[n - k]


def instructions(program, run, folder):
    """The instructions that a run executes."""
    valgrind = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
    done = subprocess.run(valgrind + command(program, run, folder), cwd=folder, capture_output=True,
                          text=True)
    counted = re.search(r"I\s+refs:\s+([\d,]+)", done.stderr)
    if done.returncode != 0 or counted is None:
        raise Refused(f"valgrind does not count `{run}`: {done.stderr.strip()}")
    return int(counted[1].replace(",", ""))


if __name__ == "__main__":
    main()
