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


def pin(cores):
    """Limits this process, and all processes that it starts from now on, to a number of threads, on Linux also of cores."""
    os.environ |= {"OMP_NUM_THREADS": str(cores), "RAYON_NUM_THREADS": str(cores)}
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-cores:])
