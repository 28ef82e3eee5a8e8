"""What the comparisons share: tables, the name of the machine, one core."""

import os
import pathlib
import platform
import re


def table(header, rows):
    """A Markdown table."""
    for row in (header, ["---"] * len(header), *rows):
        print("| " + " | ".join(row) + " |")
    print()


def machine():
    """The processor's name."""
    try:
        names = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
        return names[1]
    except (OSError, TypeError):
        return platform.processor() or platform.machine()


def one_core():
    """This process and all it starts from now on: one thread, and on Linux one core."""
    pin(1)


def pin(cores):
    """This process and all it starts from now on: as many threads, and on Linux cores."""
    os.environ |= {"OMP_NUM_THREADS": str(cores), "RAYON_NUM_THREADS": str(cores)}
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-cores:])
