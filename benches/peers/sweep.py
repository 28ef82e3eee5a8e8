#!/usr/bin/env python3
"""heyoka, SciPy's DOP853 and tangency on the impacting motion of Mita's actuator at ω = 0.5: periods simulated a
second on one core, on P(1,1) (V = 0.52) and in chaos (V = 0.65), at equal error of the state after one period.

Prints Markdown. What it needs and what it measures is in README.md beside it.
"""

import argparse
import datetime
import math
import os
import pathlib
import re
import shlex
import statistics
import subprocess
import tempfile
import time

import heyoka as hy
import numpy as np
import scipy
from common import machine, pin, table
from scipy.integrate import solve_ivp

ROOT = pathlib.Path(__file__).resolve().parents[2]
OMEGA, CLEARANCE, RESTITUTION, DAMPING = 0.5, 0.5, 0.8, 0.04
FRICTION, FRAME, GRAVITY = 0.27, 5.0, 9.81
PERIOD = math.pi / OMEGA
DRAG = FRICTION * (FRAME + 1) * GRAVITY  # the friction of a frame that moves
KICK = (1 + RESTITUTION) / (FRAME + 1)
ERROR = 1e-10
# From the loosest on, in steps of about a third of a decade: at looser ones all three err by more.
TOLERANCES = [1e-8, *(float(f"{m}e-{k}") for k in range(9, 14) for m in (5, 2, 1))]


def passed(guard, q, u, v, slip):
    """Motion and direction of slip after an event: the stoppers are guards 0 and 1, rest is 2."""
    if guard == 2:
        return q, u, 0.0, 0
    v += KICK * u
    return q, -RESTITUTION * u, v, (1 if v > 0 else -1)


class Heyoka:
    """Taylor's method, compiled once for each mode; terminal events."""

    name = f"heyoka {hy.__version__}"

    def __init__(self, voltage, tolerance):
        q, u, v = hy.make_vars("q", "u", "v")
        force = hy.par[0] ** 2 * hy.sin(OMEGA * hy.time) ** 2 / (1 - q) ** 2 - q - DAMPING * u
        frame = (-force - hy.par[1] * DRAG) / FRAME
        falls = {"direction": hy.event_direction.negative}
        stoppers = [hy.t_event(CLEARANCE - q, **falls), hy.t_event(CLEARANCE + q, **falls)]
        rest = hy.t_event(hy.par[1] * v, **falls)
        make = lambda system, events, pars: hy.taylor_adaptive(  # noqa: E731
            system, [0.0] * len(system), tol=tolerance, t_events=events, pars=pars, compact_mode=False)  # fmt: skip
        self.stick = make([(q, u), (u, force)], stoppers, [voltage])
        self.slip = make([(q, u), (u, force - frame), (v, frame)], [*stoppers, rest], [voltage, 1.0])

    def period(self, q, u, v, slip):
        """The motion after one period."""
        t, limit = 0.0, hy.taylor_outcome.time_limit
        while True:
            flow = self.slip if slip else self.stick
            flow.time = t
            if slip:
                flow.state[:] = (q, u, v)
                flow.pars[1] = slip
            else:
                flow.state[:] = (q, u)
            flow.reset_cooldowns()
            outcome = flow.propagate_until(PERIOD)[0]
            state, t = flow.state, flow.time
            q, u, v = state[0], state[1], state[2] if slip else 0.0
            if outcome == limit:
                return q, u, v, slip
            q, u, v, slip = passed(-int(outcome) - 1, q, u, v, slip)


class SciPy:
    """DOP853 with events, begun again at each of them."""

    name = f"SciPy {scipy.__version__} DOP853"

    def __init__(self, voltage, tolerance):
        self.options = {"method": "DOP853", "rtol": tolerance, "atol": tolerance}

        def force(t, q, u):
            return (voltage * math.sin(OMEGA * t) / (1 - q)) ** 2 - q - DAMPING * u

        def stick(t, x, slip):
            return x[1], force(t, x[0], x[1])

        def slide(t, x, slip):
            r = force(t, x[0], x[1])
            frame = (-r - slip * DRAG) / FRAME
            return x[1], r - frame, frame

        guards = [lambda t, x, slip: CLEARANCE - x[0], lambda t, x, slip: CLEARANCE + x[0],
                  lambda t, x, slip: slip * x[2]]  # fmt: skip
        for guard in guards:
            guard.terminal, guard.direction = True, -1.0
        self.stick, self.slide, self.guards = stick, slide, guards

    def period(self, q, u, v, slip):
        """The motion after one period."""
        t = 0.0
        while True:
            field, x = (self.slide, (q, u, v)) if slip else (self.stick, (q, u))
            guards = self.guards if slip else self.guards[:2]
            found = solve_ivp(field, (t, PERIOD), x, events=guards, args=(slip,), **self.options)
            state, t = found.y[:, -1], found.t[-1]
            q, u, v = state[0], state[1], state[2] if slip else 0.0
            if found.status == 0:
                return q, u, v, slip
            hit = next(k for k, times in enumerate(found.t_events) if len(times))
            q, u, v, slip = passed(hit, q, u, v, slip)


def error(found, exact):
    """The median over the states of the largest error of a component."""
    return statistics.median(max(abs(a - b) for a, b in zip(x[:3], y[:3])) for x, y in zip(found, exact))


def images(program, states):
    return [program.period(*state) for state in states]


def rate(program, states, periods):
    """Periods a second of CPU time, each state followed for so many."""
    start = time.process_time()
    for state in states:
        for _ in range(periods):
            state = program.period(*state)
    return len(states) * periods / (time.process_time() - start)


class Tangency:
    """The example sweep_speed, which reads states, writes what they become, and prints its rates."""

    def __init__(self, command, voltage, directory):
        self.command, self.voltage = shlex.split(command), voltage
        self.states, self.images = directory / f"states-{voltage}", directory / f"images-{voltage}"

    def run(self, tolerance, periods):
        """Rates by the way of following."""
        command = [*self.command, str(self.voltage), str(tolerance), str(periods), self.states, self.images]
        output = subprocess.run(command, cwd=ROOT, check=True, text=True, stdout=subprocess.PIPE).stdout
        rows = re.findall(r"^\| tangency, ([^|]*) \|.*\| (\S+) \|$", output, re.M)
        return {name: float(number) for name, number in rows}

    @staticmethod
    def read(path):
        """States with the direction of slip: the modes are sticking, slipping forward, slipping backward."""
        lines = (line.split() for line in path.read_text().splitlines())
        return [(*map(float, numbers), (0, 1, -1)[int(mode)]) for mode, *numbers in lines]


def tried(error_of):
    """Tolerances with their errors, from the loosest on, until the error is far below what is wanted."""
    for tolerance in TOLERANCES:
        found = error_of(tolerance)
        yield tolerance, found
        if found < 0.3 * ERROR:
            return


def nearest(error_of):
    """The tolerance with the error nearest to what is wanted, and its error."""
    return min(tried(error_of), key=lambda pair: abs(math.log(pair[1] / ERROR)))


def loosest(error_of, most):
    """The loosest tolerance with no more than this error, and its error."""
    return next(pair for pair in tried(error_of) if pair[1] <= most)


def measure(arguments, voltage, directory):
    """Rows of one voltage: program, tolerance, error, periods a second."""
    tangency = Tangency(arguments.tangency, voltage, directory)
    tangency.run(1e-14, 1)
    states, converged = (tangency.read(path) for path in (tangency.states, tangency.images))
    exact = images(Heyoka(voltage, 1e-16), states)
    few = states[:: len(states) // 25]  # for SciPy
    few_exact = exact[:: len(states) // 25]

    def error_of_tangency(tolerance):
        tangency.run(tolerance, 1)
        return error(tangency.read(tangency.images), exact)

    of_heyoka = nearest(lambda tolerance: error(images(Heyoka(voltage, tolerance), states), exact))
    of_scipy = nearest(lambda tolerance: error(images(SciPy(voltage, tolerance), few), few_exact))
    of_tangency = loosest(error_of_tangency, of_heyoka[1])
    heyoka, scipys = Heyoka(voltage, of_heyoka[0]), SciPy(voltage, of_scipy[0])
    rates = {}
    for _ in range(arguments.rounds):  # alternately: the speed of a machine changes
        found = tangency.run(of_tangency[0], arguments.periods)
        for name, number in found.items():
            rates.setdefault((f"tangency, {name}", *of_tangency), []).append(number)
        rates.setdefault((Heyoka.name, *of_heyoka), []).append(rate(heyoka, states, arguments.periods))
        rates.setdefault((SciPy.name, *of_scipy), []).append(rate(scipys, few, 1))
    remark = f"V = {voltage}: heyoka at 1e-16 and tangency at 1e-14 differ by {error(converged, exact):.1e}."
    return [[f"{voltage}", *key, statistics.median(numbers)] for key, numbers in rates.items()], remark


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7, help="runs of each program (7)")
    parser.add_argument("--periods", type=int, default=20, help="periods from each state (20)")
    parser.add_argument("--tangency", default="cargo run --profile fastest --locked --quiet --example sweep_speed --",
                        help="command that runs the example sweep_speed")  # fmt: skip
    arguments = parser.parse_args()
    if arguments.tangency.startswith("cargo run"):  # compile on all cores, before the pinning to one
        build = arguments.tangency.replace("cargo run", "cargo build", 1).removesuffix("--")
        subprocess.run(shlex.split(build), cwd=ROOT, check=True)
    pin(1)
    with tempfile.TemporaryDirectory() as directory:
        measured = [measure(arguments, voltage, pathlib.Path(directory)) for voltage in (0.52, 0.65)]
    flags = os.environ.get("RUSTFLAGS", "")
    print(f"{machine()}, one core; NumPy {np.__version__}; RUSTFLAGS '{flags}'; {datetime.date.today()}.\n")
    rows = []
    for found, _ in measured:
        best = max(row[4] for row in found if row[1].startswith("tangency"))
        rows += [[voltage, name, f"{tolerance:.0e}", f"{wrong:.1e}", f"{number:.0f}", f"{best / number:.1f}"]
                 for voltage, name, tolerance, wrong, number in found]  # fmt: skip
    table(["V", "program", "tolerance", "error", "periods a second", "tangency's rate divided by it"], rows)
    print("\n".join(remark for _, remark in measured))


if __name__ == "__main__":
    main()
