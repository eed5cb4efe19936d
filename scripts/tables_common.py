"""Shared by the tables of scripts/tables."""
import argparse
import csv
import os
import subprocess
import sys
import time
from pathlib import Path

from greville import ResultsError, how_to_install

ROOT = Path(__file__).resolve().parent.parent
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
# From the command line: the folder of the programs, and the name of the table.
OPTIONS = argparse.Namespace(build=ROOT / "build", name="")
# For each name: its function of the command-line arguments, and its arguments for argparse.
TABLES = {}


def table(name, *arguments):
    """Add a function to the list; the first line of its docstring says what it makes."""
    def add(function):
        TABLES[name] = (function, arguments)
        return function
    return add


def argument(*words, **options):
    return words, options


def shipped(name):
    return ROOT / "prm" / "simulation" / f"{name}.prm"


def section(name, **values):
    """Return the text of a section; underscores become blanks."""
    return f"subsection {name}\n" + "".join(f"  set {key.replace('_', ' ')} = {value}\n" for key, value in values.items()) + "end\n"


class Result:
    """The output of a run, its folder, and its CPU and wall time in s."""

    def __init__(self, folder, process, cpu, wall):
        self.folder, self.cpu, self.wall = folder, cpu, wall
        self.has_failed, self.out, self.error = process.returncode != 0, process.stdout, process.stderr


def folder_of(*words):
    return ROOT / "output" / OPTIONS.name / "_".join(str(word).replace(" ", "_").replace("/", "_") for word in words)


def run(file, folder, settings={}, program="greville", processes=0):
    """Run a parameter file, or the text of one, with results in a folder and {"SECTION/PARAMETER": value} set."""
    path = ROOT / "scripts/sweep" if program == "sweep" else OPTIONS.build / program
    if not path.exists():
        raise ResultsError(f"there is no program {path}: --build FOLDER has the programs.")
    folder.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(file, str):
        text, file = file, folder.with_suffix(".prm")
        file.write_text(text)
    if program != "greville_benchmark":
        settings = {"Output/Directory": folder, "Output/Earlier results": "remove", **settings}
    command = (["mpirun", "-np", str(processes)] if processes else []) + [path, file]
    for parameter, value in settings.items():
        command += ["--set", f"{parameter}={value}"]
    environment = dict(os.environ, OMP_NUM_THREADS="1", DEAL_II_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1", GREVILLE=str(OPTIONS.build / "greville"),
                       PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe")
    before, begin = os.times(), time.monotonic()
    process = subprocess.run(command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                             errors="replace")
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return Result(folder, process, cpu, time.monotonic() - begin)


def run_to_end(*arguments, **options):
    """Run a file as run() does. The run must succeed."""
    result = run(*arguments, **options)
    if result.has_failed:
        raise ResultsError(f"{result.folder} has failed: {result.error.strip() or result.out[-2000:]}")
    return result


def write_csv(rows, columns=None, name=None):
    """Write rows, which are dicts, to doc/data."""
    with open(ROOT / "doc" / "data" / f"{name or OPTIONS.name}.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns or list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read_csv(file):
    """Return the rows of a table as dicts of words."""
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))


def print_head(*columns):
    print("| " + " | ".join(columns) + " |\n|" + " --- |" * len(columns), flush=True)


def print_row(*entries):
    print("| " + " | ".join(map(str, entries)) + " |", flush=True)


def pyplot():
    try:
        import matplotlib
    except ImportError:
        sys.exit("scripts/tables: " + how_to_install("matplotlib"))
    matplotlib.use("Agg")
    import matplotlib.pyplot
    return matplotlib.pyplot


def save(figure, name=None, **options):
    figure.tight_layout()
    figure.savefig(ROOT / "doc" / "pictures" / f"{name or OPTIONS.name}.png", **options)
