"""Run a parameter file once for each combination of the entries of its section Sweep.

    scripts/sweep prm/simulation/vibrating_bar.prm
    scripts/sweep -np 2 --set "Sweep/Processes per run=1" prm/simulation/vibrating_bar.prm
    scripts/sweep --resume output/vibrating_bar

scripts/run does the same, and also draws and reports the results.
"""
import argparse
import contextlib
import fcntl
import itertools
import math
import os
import re
import signal
import socket
import sys
import tempfile
import time
from pathlib import Path
from threading import current_thread, main_thread
from types import SimpleNamespace

from . import measured
from .case import Case, Progress, RunFailed, as_prm, as_text, call, check_number, folder_of, interrupt, message_of, start, values_of
from .results import Error, Run, names_in, path_of, read_table

# In the order of the runs: the last one varies fastest.
LISTS = ("Formulations", "Masses", "Orders", "Values", "Cells")


class Sweep:
    """The results of a sweep: its table (sweep.csv), and for each run its value and its Run, or None if it has failed.

    message has the program's messages on failed runs.
    """

    def __init__(self, folder, message=""):
        self.folder, self.message = path_of(folder), message
        self.table = read_table(self.folder / "sweep.csv")
        self.values, self.runs = self.table["value"], []
        for name, failed in zip(self.table["run"], self.table["failed"]):
            self.runs.append(None if failed else Run(self.folder / name))

    def report(self, **options):
        """Write report.html about the runs side by side, and return its path; options are the options of Run.report()."""
        from . import report
        return report.write([self.folder], **options)

    def __iter__(self):
        return iter(zip(self.values, self.runs))

    def __len__(self):
        return len(self.runs)


def sweep(case, parameter=None, values=(), processes=1, processes_per_run=1, progress=None):
    """Run a case with each of these values of a parameter, or with its section Sweep, in groups of processes. Returns the Sweep."""
    check_number("processes", processes)
    check_number("processes_per_run", processes_per_run)
    if not isinstance(case, Case):
        raise RunFailed(f"A sweep needs a Case, not {case!r}.")
    if isinstance(values, (str, bytes, dict)) or not hasattr(values, "__iter__"):
        raise RunFailed(f"The values of a sweep are a list, not {values!r}.")
    case = case.copy().set("Sweep/Processes per run", processes_per_run)
    if parameter is not None:
        case.set("Sweep/Parameter", parameter).set("Sweep/Values", " | ".join(map(as_text, values)))
    runs = Runs(case, case.parameters)
    return Sweep(runs.folder, runs.run(processes, progress or Progress()))


def scaled(parameters, grid, n, most):
    """Return the cell numbers of a grid scaled so that the largest is n."""
    cells = [int(word) for word in names_in(parameters[f"{grid}/Cells"])]
    if any(number > 1 and (number * n % most or number * n // most >= 2**31) for number in cells):
        raise RunFailed(f"The parameter 'Sweep/Cells' has the entry {n}, with which '{grid}/Cells' cannot keep their ratio, or are "
                        "too many.")
    return ", ".join(str(number if number == 1 else number * n // most) for number in cells)


def rows_of(parameters):
    """Return the runs of a sweep: the entries of each, and the parameters that it changes."""
    lists = {name: names_in(parameters[f"Sweep/{name}"]) for name in LISTS}
    lists["Values"] = [word.strip() for word in parameters["Sweep/Values"].split("|")] if parameters["Sweep/Values"] else []
    varied, stages = parameters["Sweep/Parameter"], names_in(parameters["Simulation/Stages"])
    most = max(int(word) for word in names_in(parameters["Grid/Cells"]))
    grids = ["Grid", *(f"Body {name}/Grid" for name in names_in(parameters["Simulation/Bodies"]))]
    rows = []
    for formulation, mass, p, value, n in itertools.product(*(lists[name] or [None] for name in LISTS)):
        changes = {"Grid/Order": p or parameters["Grid/Order"], **{f"Sweep/{name}": "" for name in (*LISTS, "Parameter")}}
        for name, word in (("Scheme/Formulation", formulation), ("Scheme/Mass", mass)):
            if word:
                changes.update({name: word, **{f"Stage {stage}/{name}": word for stage in stages}})
        if n:
            changes.update((f"{grid}/Cells", scaled(parameters, grid, int(n), most)) for grid in grids)
        if value is not None:
            # Stages with the value of the outer section inherit it.
            own = [name for name in (f"Stage {stage}/{varied}" for stage in stages) if name in parameters]
            changes.update({varied: value, **{name: value for name in own if parameters[name] == parameters.get(varied)}})
        rows.append(SimpleNamespace(value=value or "", p=int(changes["Grid/Order"]), cells=int(n or most), changes=changes,
                                    failure="not at its end", results={}, error=None, order=None))
    return rows


def name_folders(rows, parameters):
    """Name the run folders by the varied parameters."""
    names, word = {}, parameters["Sweep/Parameter"].rsplit("/", 1)[-1]
    is_alone = word and not any(parameters[f"Sweep/{name}"] for name in LISTS if name != "Values")
    for row in rows:
        name = re.sub(r"[^A-Za-z0-9.+-]", "_", f"{word}_{row.value[:60]}")
        candidates = itertools.chain([name], (f"{name}_{k}" for k in itertools.count(2)))
        name = next(one for one in candidates if names.setdefault(one, row.value) == row.value)
        formulation = f"{row.formulation.split()[0]}_" if parameters["Sweep/Formulations"] else ""
        row.name = name if is_alone else f"{formulation}{row.mass}_p{row.p}_{row.cells}" + (f"_{name}" if word else "")


def write(file, lines):
    """Write a table. An earlier one stays until the new one is complete."""
    new = file.with_name(f"{file.name}.tmp")
    new.write_text("".join(",".join(map(str, line)) + "\n" for line in lines), encoding="utf-8")
    os.replace(new, file)


@contextlib.contextmanager
def locked(folder):
    """Hold the lock of a folder, as the program does."""
    with open(folder / "lock", "w") as lock:
        with contextlib.suppress(OSError):   # The file system has no locks.
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        print(f"process {os.getpid()} on {socket.gethostname()}", file=lock, flush=True)
        try:
            yield
        finally:
            os.unlink(lock.name)


class Runs:
    """The runs of a Case with these parameters; resumed is the folder of a resumed sweep."""

    def __init__(self, case, parameters, options=(), resumed=None):
        if not any(parameters[f"Sweep/{name}"] for name in LISTS):
            raise RunFailed(f"{case.name} has no 'Sweep': scripts/run or the program greville runs it.")
        self.case, self.parameters, self.options = case, parameters, [*options, *(["--resume"] if resumed else [])]
        self.folder, self.is_resumed, self.rows = resumed or folder_of(parameters), bool(resumed), rows_of(parameters)
        self.running, self.stopped = {}, ""

    def prepare(self, place, *options):
        """Write the files of the runs, let the program check them and make room for results, and name their folders."""
        (place / "runs").mkdir()
        for k, row in enumerate(self.rows):
            row.file = place / f"runs/{k:06d}.prm"
            row.file.write_text(as_prm({**self.parameters, **row.changes}), encoding="utf-8")
        try:
            output = self.case._call("--runs", place / "runs", *self.options, *options)
        except RunFailed as error:
            found = re.fullmatch(r"Run (\d+): (.*)", str(error), re.DOTALL)
            if not found:
                raise
            message, name = re.sub(r"Line \d+ of <[^>]*>", "A run of the sweep", found[2]), self.parameters["Sweep/Parameter"]
            raise RunFailed((f"The parameter 'Sweep/Parameter' is <{name}>, with the value <{self.rows[int(found[1])].value}>. "
                             if name else "") + message) from None
        for row, (formulation, mass) in zip(self.rows, re.findall(r"^Run \d+: (.*), (.*)$", output, re.MULTILINE)):
            row.formulation, row.mass, row.kind = formulation, mass, (formulation, mass, row.p, row.value)
        name_folders(self.rows, self.parameters)
        for note in re.findall("^Note: .*", output, re.MULTILINE):
            print(note, flush=True)

    def arguments_of(self, row, *options):
        folder = self.folder / row.name
        own = [word for word in self.options if word != "--resume" or any(folder.glob("checkpoint_*.h5"))]
        return [row.file, "--set", f"Output/Directory={folder}", *own, *options]

    def check(self, processes, drawing):
        """Print the estimated cost of each run."""
        seconds, total = {"s": 1, "min": 60, "h": 3600, "days": 86400}, 0.
        with tempfile.TemporaryDirectory() as place:
            self.prepare(Path(place), "--check")
            for k, row in enumerate(self.rows, 1):
                text = call(self.arguments_of(row, "--check", *(["--draw", f"{drawing}/{row.name}"] if drawing else [])), processes)
                print(f"Run {k} of {len(self.rows)} of the sweep: {row.name}\n\n{text.replace(str(row.file), row.name)}\n", flush=True)
                times = re.findall(r"estimated time(?: of all stages)?: (\S+) (\w+)", text)
                total += sum(float(number) * seconds[unit] for number, unit in times[-1:])
        unit = next(unit for unit, least in (("days", 172800), ("h", 7200), ("min", 120), ("s", 0)) if total >= least)
        print(f"  estimated time of the sweep: {total / seconds[unit]:.2g} {unit}")

    def run(self, processes, progress=None):
        """Run all, and show their output or else progress. Returns messages on failed runs."""
        with tempfile.TemporaryDirectory() as place:
            self.prepare(Path(place))
            with locked(self.folder):
                if not self.is_resumed:
                    self.write_results()
                # Only the main thread receives signals.
                numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP) if current_thread() is main_thread() else ()
                handlers = [signal.signal(number, self.stop) for number in numbers]
                try:
                    self.run_all(Path(place), processes, progress)
                finally:
                    for process in self.running.values():
                        interrupt(process, self.each)
                    for number, handler in zip(numbers, handlers):
                        signal.signal(number, handler)
        if self.stopped:
            raise RunFailed(f"{self.stopped} scripts/sweep --resume {self.folder} resumes all runs.")
        for last, row in zip(self.rows, self.rows[1:]):
            if last.error and row.error and row.kind == last.kind and row.cells != last.cells:
                row.order = math.log(last.error["l2"] / row.error["l2"]) / math.log(row.cells / last.cells)
        self.write_results()
        if self.parameters["Exact solution/Displacement"]:
            self.write_errors()
        if not progress:
            print(self.text())
        failures = [f"\n  {row.formulation}, {row.mass}, order {row.p}, {row.cells} cells"
                    + (f", {row.value}" if row.value else "") + f": {row.failure}" for row in self.rows if row.failure]
        return "Runs of 'Sweep' failed:" + "".join(failures) if failures else ""

    def stop(self, number, _):
        """Let runs write checkpoints and end."""
        self.stopped = f"Stopped by {signal.Signals(number).name}."
        for process in self.running.values():
            interrupt(process, self.each)

    def run_all(self, place, processes, progress):
        """Run one after the other, or side by side. A signal ends the sequence."""
        given, waiting = int(self.parameters["Sweep/Processes per run"]), list(range(len(self.rows)))
        self.each = min(processes, given) or processes
        is_shown = not progress and not given
        if not progress and given:
            print(f"{len(waiting)} runs, {min(processes // self.each, len(waiting))} side by side on {self.each} process(es) each; the "
                  "output of each run is in its folder, output.txt\n", flush=True)
        while waiting and not self.stopped or self.running:
            while waiting and not self.stopped and len(self.running) < processes // self.each:
                k = waiting.pop(0)
                with open(place / f"{k}.txt", "wb") as output, open(place / f"{k}.message", "wb") as message:
                    self.running[k] = start(self.arguments_of(self.rows[k]), self.each, is_shown and sys.stdout.isatty(),
                                            stdout=None if is_shown else output, stderr=message)
            time.sleep(0.01)
            for k in [k for k, process in self.running.items() if process.poll() is not None]:
                row, process = self.rows[k], self.running.pop(k)
                text = self.take(row, process.returncode and message_of((place / f"{k}.message").read_text(errors="replace")))
                if is_shown:
                    print(text, flush=True)
                else:
                    (self.folder / row.name).mkdir(exist_ok=True)
                    (self.folder / row.name / "output.txt").write_text((place / f"{k}.txt").read_text(errors="replace") + text)
                if progress:
                    done = len(self.rows) - len(waiting) - len(self.running)
                    progress(done / len(self.rows), f"{done} of {len(self.rows)} runs: {row.name}")

    def take(self, row, message):
        """Take the results of a run, or its message. Returns the text to print."""
        if message:
            row.failure = message
            if message.startswith("Stopped by "):
                self.stopped = message
            return f"  failed: {message}\n"
        run = Run(self.folder / row.name)
        summary, row.failure = run.summary, ""
        row.results, row.error = {"wall_time": summary["wall_time"]}, summary["errors"].get("displacement")
        if "ramp" in summary:
            ramp = summary["ramp"]
            row.results.update(failure_factor=ramp["factor"], failure_from=ramp["from"], failure_to=ramp.get("to", math.inf))
        row.results.update((name, values[-1]) for name, values in run.statistics.items())
        return measured.add_to_summary(run)

    def write_results(self):
        """Write sweep.csv: the entries of each run, and the last row of its statistics."""
        names = list(dict.fromkeys(name for row in self.rows for name in row.results))
        write(self.folder / "sweep.csv", [["run", "value", "formulation", "mass", "p", "cells", "failed", *names]] + [
            [row.name, row.value.replace(",", " "), row.formulation, row.mass, row.p, row.cells, int(bool(row.failure)),
             *(f"{row.results[name]:.10g}" if name in row.results else "" for name in names)] for row in self.rows])

    def write_errors(self):
        """Write convergence.csv."""
        write(self.folder / "convergence.csv", [("formulation", "mass", "p", "cells", "error_l2", "error_max", "order")] + [
            (row.formulation, row.mass, row.p, row.cells, f"{row.error['l2']:.10g}", f"{row.error['max']:.10g}",
             "" if row.order is None else f"{row.order:.10g}") for row in self.rows if row.error])

    def text(self):
        """Return a line for each run: errors, or the factor of a ramp and the last time."""
        text = "  " * 21 + "relative error: L2    largest  order\n" if any(row.error for row in self.rows) else ""
        for row in self.rows:
            text += f"  {row.name:40}" + "  failed" * bool(row.failure)
            if row.error:
                text += f"{row.error['l2']:18.3e}{row.error['max']:11.3e}" + ("" if row.order is None else f"{row.order:7.2f}")
            else:
                text += "".join(f"  {label} = {row.results[name]:.5g}" for name, label in
                                (("failure_factor", "factor"), ("time", "t")) if name in row.results)
            text += "\n"
        return f"{text}  results: {self.folder}"


def main(program=None):
    parser = argparse.ArgumentParser(prog=program, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="?", metavar="FILE", help="a parameter file: .prm, .json or .yaml")
    parser.add_argument("-np", type=int, default=1, metavar="N", dest="processes", help="processes of all runs (1)")
    parser.add_argument("--set", action="append", default=[], metavar="SECTION/PARAMETER=VALUE", help="replace the value of a parameter; may be repeated")
    parser.add_argument("--from", dest="other", metavar="FOLDER", help="begin each run with the last checkpoint of another one")
    parser.add_argument("--resume", type=Path, metavar="FOLDER", help="resume the sweep with results in this folder")
    parser.add_argument("--check", action="store_true", help="run nothing, and show the estimated cost of each run")
    parser.add_argument("--draw", metavar="FOLDER", help="with --check: write the initial points of each run to a folder in this one")
    parser.add_argument("--printed", action="store_true", help="read the output of greville FILE --print-parameters from standard input")
    given = parser.parse_args()
    if (given.file is None) == (given.resume is None):
        parser.error("takes a parameter file, or --resume and the folder of a sweep.")
    try:
        check_number("-np", given.processes)
        case = Case(given.file or given.resume / "parameters.prm")
        for setting in given.set:
            case.set(*setting.partition("=")[::2])
        parameters = values_of(sys.stdin.read()) if given.printed else case.parameters
        runs = Runs(case, parameters, ["--from", given.other] if given.other else [], given.resume)
        if given.check:
            runs.check(given.processes, given.draw)
        elif failures := runs.run(given.processes):
            sys.exit(f"{parser.prog}: {failures}")
    except Error as error:
        sys.exit(f"{parser.prog}: {error}")
