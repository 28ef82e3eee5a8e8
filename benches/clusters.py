#!/usr/bin/env python3
"""The scripts of docs/how-to/clusters on the real programs: Slurm and GNU parallel, on one machine, with tasks that are killed.

    apt-get install slurm-wlm parallel
    python3 benches/clusters.py [--tangency target/release/tangency]

A small sweep is done as a whole. Then each script does it in parts, of which one is killed (SIGKILL) and, with Slurm, another
one cancelled (SIGTERM) after their first results. `tangency merge` has to refuse what is unfinished. The same command again
has to go on from these results, and the merged files have to have the bytes of the whole. Slurm runs as one node, with
munged, slurmctld and slurmd started here, in a temporary folder that holds all their files. Linux only; a program that is
not installed is skipped.
"""

import argparse
import contextlib
import getpass
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCRIPTS = ROOT / "docs" / "how-to" / "clusters"
PARTS = 8
PATIENCE = 300  # seconds for anything

# Runs that follow each other in eight strands, and independent ones.
SCENE = """Scene(
    title: "Chaos", problem: Mita(), parameters: [("frequency", 0.5)],
    plot: (y: "displacement_range", swept: [("voltage", "exponent")]),
    sweeps: [
        (name: "up", order: up, strands: 8, over: [(name: "voltage", low: 0.3, high: 0.7, count: 96)],
         search: (transient: 1500, recorded_periods: 20, lyapunov_periods: 2000), measures: ["displacement_range"]),
        (name: "starts", over: [(name: "displacement", low: -0.3, high: 0.3, count: 5), (name: "velocity", low: 0, high: 0.2, count: 5)],
         set: [("voltage", "0.2")], search: (transient: 200, recorded_periods: 40, lyapunov_periods: 0)),
    ],
)"""
SWEEP = ["chaos.ron", "--save-every", "0.01"]
RUNS = 96

SLURM = """ClusterName=sweep
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthInfo=socket={folder}/munge.socket
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs=8
PartitionName=all Nodes={host} Default=YES
"""


class Wrong(Exception):
    """What is not as docs/how-to/clusters.md says, in words."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tangency", type=pathlib.Path, default=ROOT / "target" / "release" / "tangency")
    program = parser.parse_args().tangency.resolve()
    if not program.exists():
        sys.exit(f"error: there is no {program}: build it, or say --tangency PROGRAM")
    with tempfile.TemporaryDirectory(prefix="sweep-") as folder:
        folder = pathlib.Path(folder)
        # The scripts call `tangency` by its name.
        (folder / "bin").mkdir()
        (folder / "bin" / "tangency").symlink_to(program)
        os.environ["PATH"] = os.pathsep.join([str(folder / "bin"), os.environ["PATH"], "/usr/sbin"])
        try:
            whole = Folder(folder / "whole")
            begin = time.monotonic()
            whole.run("tangency", "sweep", *SWEEP)
            print(f"the whole: {time.monotonic() - begin:.1f} s")
            for name, needed, check in [
                ("Slurm", ["munged", "slurmctld", "slurmd", "sbatch"], slurm),
                ("GNU parallel", ["parallel"], parallel),
            ]:
                missing = [program for program in needed if shutil.which(program) is None]
                if missing:
                    print(f"{name}: skipped, since not installed: {', '.join(missing)}")
                    continue
                begin = time.monotonic()
                parts = Folder(folder / name.split()[-1].lower())
                check(parts)
                parts.merge_equals(whole)
                print(f"{name}: the merged files have the bytes of the whole; {time.monotonic() - begin:.1f} s")
        except Wrong as cause:
            sys.exit(f"error: {cause}")


class Folder:
    """A folder in which the sweep is done."""

    def __init__(self, path):
        self.path, self.out = path, path / "out"
        path.mkdir()
        (path / "chaos.ron").write_text(SCENE)

    def run(self, *command, fails=None):
        """The standard output of a command; it may fail if it says so with certain words."""
        done = subprocess.run(command, cwd=self.path, text=True, capture_output=True)
        said = done.stdout + done.stderr
        if (done.returncode != 0) != (fails is not None) or (fails or "") not in said:
            raise Wrong(f"`{' '.join(map(str, command))}` ended with {done.returncode}: {said.strip()}")
        return done.stdout

    def part(self, number):
        return self.out / f"chaos.part-{number}-of-{PARTS}.npz"

    def runs(self, number):
        """How many runs of the first sweep a part has done: the length of a column of its file."""
        try:
            with zipfile.ZipFile(self.part(number)) as archive, archive.open("up/runs/run.npy") as column:
                return int(re.search(rb"'shape': \((\d+),", column.read(128))[1])
        except FileNotFoundError:
            return 0

    def process(self, number):
        """The process that does a part here, after its first results."""
        wait(lambda: self.runs(number) > 0, f"first results of part {number}")
        for entry in pathlib.Path("/proc").iterdir():
            with contextlib.suppress(OSError):
                if f"{number}/{PARTS}" in (entry / "cmdline").read_text().split("\0") and self.path.samefile(entry / "cwd"):
                    if (entry / "exe").resolve().name == "tangency":
                        return int(entry.name)
        raise Wrong(f"part {number} ended before it could be killed")

    def unfinished(self, *numbers):
        """Says how far parts are, which have to be unfinished and known as such."""
        for number in numbers:
            done = self.runs(number)
            if not 0 < done < RUNS // PARTS:
                raise Wrong(f"part {number} has {done} runs of {RUNS // PARTS}, so it was not ended in the middle")
            print(f"  part {number}: ended after {done} of {RUNS // PARTS} runs")
        self.run("tangency", "merge", "--out", "early", *self.all_parts(), fails="are missing in all parts")

    def all_parts(self):
        return sorted(self.out.glob("*.part-*.npz"))

    def merge_equals(self, whole):
        self.run("tangency", "merge", "--out", "merged", *self.all_parts())
        for name in ["chaos.npz", "chaos.svg"]:
            if (self.path / "merged" / name).read_bytes() != (whole.out / name).read_bytes():
                raise Wrong(f"{name}, merged in {self.path.name}, differs from the whole's")


def wait(until, what):
    begin = time.monotonic()
    while not until():
        if time.monotonic() - begin > PATIENCE:
            raise Wrong(f"waited {PATIENCE} s for {what}")
        time.sleep(0.02)


def parallel(parts):
    """Part 1 is killed; the same command does it again, and only it."""
    command = ["sh", SCRIPTS / "parallel.sh", *SWEEP]
    first = subprocess.Popen(command, cwd=parts.path, stdout=subprocess.DEVNULL)
    try:
        os.kill(parts.process(1), signal.SIGKILL)
    finally:
        status = first.wait()
    if status == 0:
        raise Wrong("parallel does not say that a part failed")
    parts.unfinished(1)
    parts.run(*command)
    done = len((parts.path / "parts.log").read_text().splitlines()) - 1
    if done != PARTS + 1:
        raise Wrong(f"{done} tasks were started for {PARTS} parts of which one was killed")


def slurm(parts):
    """The first part is killed, the last one cancelled; the same command does both again."""
    with cluster(parts):
        command = ["sbatch", "--parsable", SCRIPTS / "slurm.sh", *SWEEP]
        job = parts.run(*command).strip()
        os.kill(parts.process(1), signal.SIGKILL)
        # Stopped, lest it end before Slurm's signals to continue and to terminate.
        os.kill(parts.process(PARTS), signal.SIGSTOP)
        parts.run("scancel", f"{job}_{PARTS}")
        wait(lambda: ended(parts), "the job array")
        parts.unfinished(1, PARTS)
        again = parts.run(*command).strip()
        wait(lambda: ended(parts), "the job array")
        for number in range(1, PARTS + 1):
            shown = parts.run("scontrol", "show", "job", f"{again}_{number}")
            if "JobState=COMPLETED" not in shown:
                raise Wrong(f"task {number} is not completed: {shown}")


def ended(parts):
    return not parts.run("squeue", "--noheader").strip()


@contextlib.contextmanager
def cluster(parts):
    """Slurm with one node, this machine."""
    folder = parts.path / "slurm"
    for name in ["state", "spool"]:
        (folder / name).mkdir(parents=True)
    (folder / "key").write_bytes(os.urandom(128))
    (folder / "key").chmod(0o400)
    host = socket.gethostname().split(".")[0]
    with socket.create_server(("", 0)) as one, socket.create_server(("", 0)) as two:
        ports = [one.getsockname()[1], two.getsockname()[1]]
    text = SLURM.format(host=host, user=getpass.getuser(), folder=folder, ports=ports)
    (folder / "slurm.conf").write_text(text)
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    munge = {"key-file": "key", "socket": "munge.socket", "pid-file": "munge.pid", "log-file": "munge.log", "seed-file": "seed"}
    # `--force`: a temporary folder is not as private as munged wants it.
    files = [f"--{option}={folder / name}" for option, name in munge.items()]
    daemons = []
    try:
        daemons.append(start(folder, "munged", "--foreground", "--force", *files))
        wait((folder / "munge.socket").exists, "munged")
        daemons += [start(folder, "slurmctld", "-D"), start(folder, "slurmd", "-D")]
        wait(lambda: idle(folder, daemons), "an idle node")
        yield
    finally:
        subprocess.run(["scancel", "--user", getpass.getuser()], capture_output=True)
        with contextlib.suppress(Wrong):
            wait(lambda: ended(parts), "the end of all jobs")
        for daemon in reversed(daemons):
            daemon.terminate()
            daemon.wait()


def start(folder, *command):
    with open(folder / f"{command[0]}.out", "w") as output:
        return subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT)


def idle(folder, daemons):
    for daemon in daemons:
        if daemon.poll() is not None:
            name = daemon.args[0]
            raise Wrong(f"{name} ended with {daemon.returncode}: {(folder / f'{name}.out').read_text()}")
    shown = subprocess.run(["sinfo", "--noheader", "--format=%T"], text=True, capture_output=True)
    return shown.stdout.strip() == "idle"


if __name__ == "__main__":
    main()
