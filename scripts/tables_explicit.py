"""The tables of explicit steps, of scripts/tables."""
import json
import math
import os
import re
import statistics
import subprocess
import time
from pathlib import Path

from greville import ResultsError, Run
from tables_common import (OPTIONS, ROOT, argument, folder_of, print_head, print_row, pyplot, read_csv, run, run_to_end, save,
                           section, shipped, table, write_csv)

KINDS = [("updated", mass) for mass in ("lumped", "fmpm-2", "fmpm-4", "consistent")] \
    + [("total", mass) for mass in ("lumped", "consistent")]
COLOURS = dict(zip(KINDS, ["#0072B2", "#56B4E9", "#E69F00", "#D55E00", "#009E73", "#000000"]))
LINES = {1: ":", 2: "--", 3: "-"}
# A problem, the cells of a mesh, meshes, the end in s, and its body, whose points are Gauss points in total Lagrangian
# steps.
STUDIES = [("vibrating_bar", "{n}, 1", [8, 16, 32, 64], 6.25, "bar"),
           ("axis_aligned_mms_2d", "{n}, {n}", [8, 16, 32], 0.02, "cube"),
           ("twisting_disk", "{n}, {n}", [12, 24, 48], 0.5, None)]


def error_and_cost(study, kind, p, n, safety):
    """Return a row; None if the run has failed."""
    problem, cells, _, end, body = study
    formulation, mass = kind
    settings = {"Sweep/Cells": "", "Sweep/Orders": "", "Sweep/Masses": "", "Sweep/Formulations": "",
                "Output/Fields every": 0, "Output/Statistics every": end, "Grid/Cells": cells.format(n=n), "Grid/Order": p,
                "Time/End": end, "Time/Step": "", "Time/CFL number": 100, "Time/Safety": safety,
                "Scheme/Formulation": f"{formulation} Lagrangian", "Scheme/Mass": mass, "Solver/Tolerance": 1e-10}
    if body and formulation == "total":
        settings |= {f"Body {body}/Placement": "Gauss", f"Body {body}/Points per direction": p + 1}
    start, whole = (run(shipped(problem), folder_of("run"), {**settings, "Time/Maximum steps": steps}) for steps in (1, 0))
    if start.has_failed or whole.has_failed:
        return None
    # The start time of a program varies by 0.05 s.
    return {"problem": problem, "formulation": formulation, "mass": mass, "p": p, "cells": n, "safety": safety,
            "steps": re.search(r"(\d+) steps to", whole.out).group(1),
            "seconds": f"{max(whole.cpu - start.cpu, 0.05):.3f}",
            "error_l2": re.search(r"error of displacement: L2 (\S+),", whole.out).group(1)}


def front_of(rows, *wanted):
    """Return seconds and errors of the runs of a problem, formulation, mass and order without a cheaper run of smaller error."""
    runs = sorted((float(row["seconds"]), float(row["error_l2"])) for row in rows
                  if (row["problem"], row["formulation"], row["mass"], int(row["p"])) == wanted)
    front, best = [], float("inf")
    for seconds, error in runs:
        if error < best:
            front.append((seconds, error))
            best = error
    return front


@table("work_precision", argument("--draw", action="store_true", help="run nothing, draw doc/data/work_precision.csv"))
def work_precision(given):
    """error against CPU time, for each formulation and mass

    Runs the vibrating bar, the axis-aligned manufactured solution and the twisting disk in updated Lagrangian steps with
    lumped mass, FMPM(2), FMPM(4) and the consistent mass, and in total Lagrangian steps with lumped and consistent mass,
    orders 1 to 3, on several meshes, each with 0.9 of its own critical step and with a quarter of that. Times are CPU times
    on one core, without the time of a run of one step, and at least 0.05 s. Draws work_precision.png and a short form of it,
    order_pays.png, and prints the cheapest run below some errors.
    """
    plt = pyplot()
    if given.draw:
        rows = read_csv(ROOT / "doc/data/work_precision.csv")
    else:
        rows = []
        for study in STUDIES:
            for kind in KINDS:
                for case in [(p, n, safety) for p in LINES for n in study[2] for safety in (0.9, 0.225)]:
                    row = error_and_cost(study, kind, *case)
                    if row:
                        rows.append(row)
                    else:
                        print(f"{study[0]}, {kind}, p, cells and safety {case} failed", flush=True)
                print(study[0], *kind, "done", flush=True)
        write_csv(rows)
    figure, axes = plt.subplots(1, len(STUDIES), figsize=(14, 4.5))
    for axis, (problem, *_) in zip(axes, STUDIES):
        for kind, p in [(kind, p) for kind in KINDS for p in LINES]:
            front = front_of(rows, problem, *kind, p)
            if front:
                axis.loglog(*zip(*front), LINES[p], color=COLOURS[kind], marker="o", markersize=3, label=f"{' '.join(kind)}, p = {p}")
        axis.set(title=problem.replace("_", " "), xlabel="CPU time, s", ylabel="relative error of displacement, L2")
        axis.grid(alpha=0.3)
    axes[-1].legend(fontsize=7, frameon=False, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, dpi=110)

    # Total Lagrangian steps with the consistent mass beside lumped updated Lagrangian ones.
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), dpi=130, sharey=True)
    problems = {"axis_aligned_mms_2d": "Large strains, exact solution", "twisting_disk": "Twisting disk, free curved surface"}
    for axis, (problem, title) in zip(axes, problems.items()):
        axis.loglog(*zip(*front_of(rows, problem, "updated", "lumped", 2)), "s-", color="#D55E00", linewidth=2,
                    label="points move through the grid,\nlumped mass, p = 2")
        for p, colour in zip(LINES, ("#9ecae1", "#4292c6", "#08306b")):
            axis.loglog(*zip(*front_of(rows, problem, "total", "consistent", p)), "o-", color=colour, linewidth=2,
                        label=f"total Lagrangian,\nconsistent mass, p = {p}" if p == 1 else f"the same, p = {p}")
        axis.set_title(title, fontsize=11)
        axis.set_xlabel("CPU time, s")
        axis.grid(True, color="0.92")
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("relative error of displacement")
    axes[1].legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, "order_pays")

    for problem in ("vibrating_bar", *problems):
        for level in (1e-2, 1e-3, 1e-4):
            found = []
            for formulation in ("updated", "total"):
                good = [row for row in rows if (row["problem"], row["formulation"]) == (problem, formulation)
                        and float(row["error_l2"]) < level]
                best = min(good, key=lambda row: float(row["seconds"]), default=None)
                found.append(f"{formulation} {best['seconds']} s ({best['mass']}, p = {best['p']}, "
                             f"{best['cells']} cells)" if best else f"{formulation} none")
            print(f"{problem}, error below {level:g}:", "; ".join(found))


@table("load_balance",
       argument("files", nargs="*", default=["prm/simulation/dam_break.prm", "prm/simulation/granular_collapse.prm"]),
       argument("--processes", default="2,4"), argument("--rounds", type=int, default=1),
       argument("--steps", type=int, default=0, help="number of steps (0: all)"), argument("--cells", help="'Grid/Cells'"))
def load_balance(given):
    """runs with and without load balance while running

    Runs the parameter files with 'Load balance/Threshold' = 0 and with the default, in turns, --rounds times on each
    number of processes, and prints a table: the imbalance (largest work of a process over the mean, from the rows of
    statistics.csv) at the worst and its mean over time, which is the time of a step in a model in which points and cells
    are all the work; how often cells were redistributed and the seconds for it; and the ratios of wall and CPU times with
    and without it, as medians over rounds. Times are meaningful only if each process has a core and nothing else runs.
    """
    print_head("file", "processes", "imbalance without: mean, largest", "with: mean, largest", "largest work without, with (points)",
               "partitions", "s for them, of all", "wall, with / without", "CPU, with / without")
    settings = {"Output/Load": "true", "Output/Fields every": 0, "Checkpoints/Every minutes": 0, "Time/Maximum steps": given.steps}
    if given.cells:
        settings["Grid/Cells"] = given.cells
    for file in given.files:
        for n_processes in map(int, given.processes.split(",")):
            walls, cpus, seconds = [], [], []
            for k in range(given.rounds):
                runs, tables = {}, {}
                for balanced in (False, True) if k % 2 == 0 else (True, False):
                    runs[balanced] = run_to_end(ROOT / file, folder_of("run"), {**settings, "Load balance/Threshold": 1.2 if balanced else 0},
                                                processes=n_processes)
                    tables[balanced] = Run(folder_of("run")).statistics
                    if balanced:
                        summary = Run(folder_of("run")).summary
                walls.append(runs[True].wall / runs[False].wall)
                cpus.append(runs[True].cpu / runs[False].cpu)
                seconds.append((summary["parts"].get("load balance", 0.0), summary["wall_time"]))

            def imbalance(balanced):
                values = tables[balanced]["imbalance"]
                return f"{statistics.mean(values):.2f}, {max(values):.2f}"
            print_row(Path(file).stem, n_processes, imbalance(False), imbalance(True),
                      ", ".join(f"{max(tables[balanced]['largest_load']):.0f}" for balanced in (False, True)),
                      f"{tables[True]['partitions'][-1]:.0f}",
                      f"{statistics.median(s[0] for s in seconds):.3f}, {statistics.median(s[1] for s in seconds):.1f}",
                      f"{statistics.median(walls):.2f} ({min(walls):.2f} to {max(walls):.2f})", f"{statistics.median(cpus):.2f}")


@table("cost_of_rows")
def cost_of_rows(_):
    """cost of a row of statistics in each step

    The ratio of CPU times of runs with and without rows, both less the time of a run of one step, which is the set-up
    time. Medians of five pairs, one process.
    """
    print_head("", "mass", "cost of a row / step")
    for name, mass, steps in (("elastic_block_2d", "lumped", 200), ("elastic_block_2d", "consistent", 60),
                              ("bouncing_ball_3d", "lumped", 150), ("bouncing_ball_3d", "consistent", 40),
                              ("granular_collapse", "lumped", 150)):
        def cpu(n_steps, every):
            settings = {"Scheme/Mass": mass, "Time/Maximum steps": n_steps, "Output/Statistics every": every,
                        "Output/Fields every": 0, "Output/Grid fields": "false"}
            return run_to_end(shipped(name), folder_of("run"), settings).cpu
        costs = []
        for _ in range(5):
            setup, none, rows = cpu(1, 1e9), cpu(steps, 1e9), cpu(steps, 0)
            costs.append((rows - none) / (none - setup))
        print_row(f"`{name}`", mass, f"{statistics.median(costs):.3f}")


# Problems of prm/mass/smoothers.prm, with their parameters in 2D and 3D.
MASSES = {"constant density": ({}, {}),
          "smooth density": ({"Problem/Density": "exp(2.302585*sin(2*pi*x)*cos(2*pi*y))"},) * 2,
          "jittered points, full box": ({"Problem/Points": "box"},) * 2,
          "jittered points, disk or ball": ({"Problem/Points": "disk"}, {"Problem/Points": "ball"})}
SMOOTHERS = {"ict": "ICT", "ict, 4 processes": "ICT, 4 processes", "ic0": "IC(0)", "ilut": "ILUT", "tensor-product": "lines",
             "petsc": "Schwarz", "jacobi": "Jacobi"}
SCHWARZ = "-pc_type asm -pc_asm_local_blocks 8 -pc_asm_overlap 1 -sub_pc_type icc"
# Steps of bodies that touch: a file, its cells, its order, and other sections.
TOUCHING = section("Body upper", Shape="ball(0.48, 0.48, 0.2)")
STEPS = {"disks, p = 2": ("colliding_disks", "60, 60", 2, TOUCHING), "disks, p = 3": ("colliding_disks", "60, 60", 3, TOUCHING),
         "ball, p = 2": ("bouncing_ball_3d", "20, 20, 20", 2, "")}
METHODS = [("ICT alone", {"Method": "cg-ic0"}, {}), ("cycle, ICT", {"Method": "cg-p-multigrid"}, {"Smoother": "ict"}),
           ("cycle, IC(0)", {"Method": "cg-p-multigrid"}, {"Smoother": "ic0"}), ("Jacobi", {"Method": "cg-jacobi"}, {})]


@table("mass_smoothers", argument("--draw", action="store_true", help="only print the tables of doc/data/mass_smoothers.csv"))
def mass_smoothers(given):
    """smoothers of p-multigrid for the mass, with and without coarse levels

    Iterations and CPU times per unknown of the systems of prm/mass/smoothers.prm, and the CPU time of steps. Medians of
    three, one process unless another number is named.
    """
    rows = [] if not given.draw else read_csv(ROOT / "doc/data/mass_smoothers.csv")
    for problem, settings in MASSES.items() if not rows else []:
        for k, dim in enumerate((2, 3)):
            for processes in (1, 4):
                folder = folder_of(problem, dim, processes)
                smoothers = "ict, ic0, ilut, tensor-product, petsc, jacobi" if processes == 1 else "ict"
                run_to_end(ROOT / "prm/mass/smoothers.prm", folder,
                           {"Benchmark/Dimensions": dim, "Benchmark/Cells": (64, 12)[k], "Benchmark/Output directory": folder,
                            "Benchmark/Smoothers": smoothers, "Smoother/PETSc options": SCHWARZ, **settings[k]}, program="greville_benchmark", processes=processes)
                for row in read_csv(folder / "solves.csv"):
                    n = int(row["stable"] or row["unknowns"]) + int(row["lumped"] or 0)
                    rows.append({"problem": problem, "dim": dim, "p": row["p"], "unknowns": n, "processes": processes,
                                 "smoother": row["smoother"], "levels": "cycle" if "multigrid" in row["solver"] else "alone",
                                 "iterations": row["iterations"] if row["converged"] == "1" else f"> {row['iterations']}",
                                 **{f"{part}_us": f"{1e6 * float(row[f'{part}_s']) / n:.3g}"
                                    for part in ("assembly", "setup", "solve")}})
    if not given.draw:
        write_csv(rows)

    def of(problem, smoother, dim, entry):
        name, _, several = smoother.partition(", ")
        mine = [row for row in rows if (row["problem"], row["smoother"], str(row["dim"])) == (problem, name, str(dim))
                and (str(row["processes"]) == "4") == bool(several)]
        return "; ".join(" ".join(entry(row) for row in mine if row["levels"] == levels and (row["p"], levels) != ("1", "cycle"))
                         for levels in ("cycle", "alone"))
    def microseconds(row):
        value = float(row["setup_us"]) + float(row["solve_us"])
        return f"{value:.0f}" if value >= 10 else f"{value:.2g}"
    columns = [(problem, dim) for problem in (list(MASSES)[0], list(MASSES)[-1]) for dim in (2, 3)]
    for title, entry in (("iterations", lambda row: row["iterations"]), ("set-up and solve, us per unknown", microseconds)):
        print(f"\n{title}: cycle, p = 2 to 5; alone, p = 1 to 5\n")
        print_head("smoother", *(f"{problem}, {dim}D" for problem, dim in columns))
        for smoother, name in SMOOTHERS.items():
            print_row(name, *(of(problem, smoother, dim, entry) for problem, dim in columns))
    if given.draw:
        return
    print()
    print_head("file", *(f"{name}: iterations, ms per step, over ICT alone" for name, _, _ in METHODS))
    for name, (file, cells, order, others) in STEPS.items():
        entries = []
        for k, (_, solver, cycle) in enumerate(METHODS):
            path = folder_of("steps", name, k).with_suffix(".prm")
            path.write_text(f"include {shipped(file)}\n" + section("Grid", Cells=cells, Order=order) + section("Solver", **solver)
                            + section("p-multigrid", **cycle) + others)
            found = [json.loads(subprocess.run([OPTIONS.build / "step_benchmark", path, "consistent", "40", "60"], check=True,
                                               capture_output=True, text=True).stdout) for _ in range(3)]
            ms = statistics.median(1e3 * one["cpu"] / one["steps"] for one in found)
            entries.append((found[0]["iterations"], ms))
        print_row(name, *(f"{iterations:.1f}, {ms:.3g}, {ms / entries[0][1]:.2f}" for iterations, ms in entries))


@table("cost_of_domains")
def cost_of_domains(_):
    """cost of B-splines averaged over domains

    The ratio of CPU times of steps with 'Scheme/Functions' = domains and of as many equal steps with points, both
    less the time of a run of one step, which is the set-up time. Medians of five pairs, one process.
    """
    print_head("", "mass", "step with domains / with points")
    for name, settings, steps in (("colliding_disks", {"Grid/Cells": "60, 60", "Time/Step": 5e-4, "Sweep/Masses": ""}, 400),
                                  ("bouncing_ball_3d", {"Time/Step": 1e-4}, 60)):
        for mass in ("lumped", "consistent"):
            def cpu(functions, n_steps):
                own = {**settings, "Scheme/Mass": mass, "Scheme/Functions": functions, "Time/Maximum steps": n_steps,
                       "Output/Statistics every": 1e9, "Output/Fields every": 0, "Output/Grid fields": "false"}
                return run_to_end(shipped(name), folder_of("run"), own).cpu
            costs = []
            for _ in range(5):
                times = [cpu(functions, steps) - cpu(functions, 1) for functions in ("points", "domains")]
                costs.append(times[1] / times[0])
            print_row(f"`{name}`", mass, f"{statistics.median(costs):.2f}")


def without_contacts(text):
    """Return the text of a parameter file without its contacts and rigid bodies."""
    text = re.sub(r"subsection (Contact|Rigid body) .*?\nend\n", "", text, flags=re.DOTALL)
    return re.sub(r"\n *set (Contacts|Rigid bodies) .*", "", text)


CONTACTS = {
    "colliding_bars, consistent": ("colliding_bars", {"Grid/Cells": "192, 8", "Time/Step": 1e-4}, 4000, True),
    "colliding_bars, lumped": ("colliding_bars", {"Grid/Cells": "192, 8", "Time/Step": 1e-4, "Scheme/Mass": "lumped"}, 4000,
                               True),
    "block_on_incline, rigid body": ("block_on_incline", {"Time/Step": 1e-4}, 4000, False),
    "landslide_terrain_3d, material points": ("landslide_terrain_3d", {"Time/Step": 5e-3}, 150, False)}


@table("cost_of_contact", argument("cases", nargs="*", metavar="CASE", default=list(CONTACTS)))
def cost_of_contact(given):
    """cost of contact in explicit steps

    The ratio of CPU times of the same steps with and without contacts, both less the time of a run of one step, which is
    the set-up time; and the fraction of material points that are contactors or on surfaces. Medians of five pairs,
    one process.
    """
    print_head("", "points", "points in contacts", "step with contact / without")
    for name in given.cases:
        file, settings, steps, per_body = CONTACTS[name]
        text = shipped(file).read_text()
        texts = [re.sub(r"= *reference/", f"= {ROOT / 'prm' / 'simulation' / 'reference'}/", some)
                 for some in (text, without_contacts(text))]

        def result(kind, n_steps):
            own = {**settings, "Time/Maximum steps": n_steps, "Output/Statistics every": 1e9, "Output/Fields every": 0,
                   "Output/Grid fields": "false", **({"Grid/Per body": "true"} if kind == 1 and per_body else {})}
            return run_to_end(texts[kind], folder_of(f"run_{kind}"), own)
        costs = []
        for _ in range(5):
            times = [result(kind, steps).cpu - result(kind, 1).cpu for kind in (1, 0)]
            costs.append(times[1] / times[0])
        last = Run(folder_of("run_0"))
        in_contacts = sum(len(last.series(name)(-1).x) for name in last.surfaces)
        n_points = last.summary["points"]
        print_row(f"`{file}`, {name.split(', ')[1]}", n_points, f"{in_contacts / n_points:.1%}",
                  f"{statistics.median(costs):.3f}")


SCHEMES = {"consistent": {"Mass": "consistent"},
           "consistent, Filter 0": {"Mass": "consistent", "Filter": 0},
           "consistent, Filter 1": {"Mass": "consistent", "Filter": 1},
           "consistent, Safety 0.35": {"Mass": "consistent", "Time/Safety": 0.35},
           "fmpm-2": {"Mass": "fmpm-2"},
           "lumped": {"Mass": "lumped", "Stress update": "MUSL"},
           "lumped USL": {"Mass": "lumped", "Stress update": "USL"},
           "lumped, FLIP share 1": {"Mass": "lumped", "Stress update": "MUSL", "FLIP share": 1}}
LONG_RUNS = {f"beam, {formulation}, {scheme}": ("beam", {"Formulation": f"{formulation} Lagrangian", **SCHEMES[scheme]})
             for formulation, scheme in [("total", "consistent"), ("total", "lumped USL")]
             + [("updated", scheme) for scheme in ("consistent", "consistent, Filter 0", "consistent, Filter 1",
                                                   "consistent, Safety 0.35", "fmpm-2", "lumped USL", "lumped")]}
LONG_RUNS |= {f"pile, {scheme}": ("pile", {"Stress update": "USL", **SCHEMES[scheme]})
              for scheme in ("lumped", "lumped, FLIP share 1", "lumped USL", "consistent")}
FREE_FALL = math.sqrt(2 * 9.81 * 1.0)  # m / s, from the height of the pile


def last_time(file):
    """Return the time in the last complete line of a table."""
    try:
        with open(file, "rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - 4000))
            lines = stream.read().decode().split("\n")[:-1]
            return float(lines[-1].split(",")[0]) if len(lines) > 1 else None
    except (OSError, ValueError):
        return None


def run_long(name):
    """Run to the end. Writes the resident memory over the time of the run to memory.csv."""
    kind, settings = LONG_RUNS[name]
    folder = folder_of(re.sub(r"\W+", "_", name))
    folder.mkdir(parents=True, exist_ok=True)
    command = [OPTIONS.build / "greville", ROOT / "benchmarks" / "long_runs" / f"{kind}.prm"]
    for key, value in {**settings, "Output/Directory": folder / "run", "Output/Earlier results": "remove"}.items():
        command += ["--set", f"{key if '/' in key else 'Scheme/' + key}={value}"]
    environment = dict(os.environ, OMP_NUM_THREADS="1", DEAL_II_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    samples = []
    with open(folder / "log.txt", "w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=environment)
        while True:
            pid, _, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                break
            status = Path(f"/proc/{process.pid}/status").read_text()
            memory, t = re.search(r"VmRSS:\s+(\d+) kB", status), last_time(folder / "run" / "statistics.csv")
            if memory and t is not None:
                samples.append((t, memory.group(1)))
            time.sleep(0.2)
    (folder / "memory.csv").write_text("time,resident_kb\n" + "".join(f"{t},{memory}\n" for t, memory in samples))
    (folder / "seconds.txt").write_text(f"{usage.ru_utime:.1f}\n")


def results_of(name):
    folder = folder_of(re.sub(r"\W+", "_", name))
    rows, memory = ([{key: float(value) for key, value in row.items()} for row in read_csv(file)]
                    for file in (folder / "run" / "statistics.csv", folder / "memory.csv"))
    return folder, rows, memory


def measure(name):
    folder, rows, memory = results_of(name)
    log = (folder / "log.txt").read_text()
    # The energy balance may have stopped the run.
    steps = re.search(r"(\d+) steps to", log) or re.search(r"The state of step (\d+)", log)
    if steps is None:
        raise ResultsError(f"{name} failed:\n{log}")
    energies = [row["total"] / rows[0]["total"] for row in rows]
    speeds = [row["largest_speed"] for row in rows if row.get("stage") == 3]
    is_beam = name.startswith("beam")
    late = [row for row in memory if row["time"] >= 0.2 * rows[-1]["time"]]
    return {"run": name, "steps": steps.group(1), "seconds": (folder / "seconds.txt").read_text().strip(),
            "end": f"{rows[-1]['time']:.4g}",
            "mass_change": f"{max(abs(row['mass'] / rows[0]['mass'] - 1) for row in rows):.1e}",
            "least_energy": f"{min(energies):.4f}" if is_beam else "", "largest_energy": f"{max(energies):.4f}" if is_beam else "",
            "largest_speed": "" if is_beam else f"{max(speeds) / FREE_FALL:.1e}" if speeds else "none",
            "memory_fifth_kb": int(late[0]["resident_kb"]), "memory_end_kb": int(late[-1]["resident_kb"]),
            "memory_largest_kb": int(max(row["resident_kb"] for row in memory))}


@table("long_runs", argument("runs", nargs="*", metavar="RUN", help="first column of the table (default: all runs)"))
def long_runs(given):
    """100000 steps and more of a beam and of a pile: energy, mass, memory

    A beam that swings without damping, in total and updated Lagrangian steps with several masses, and a pile of soil at
    rest (benchmarks/long_runs/beam.prm, pile.prm). For each run: the largest change of the mass, and the smallest and
    largest energy (kinetic and strain energy over the initial sum), of the beam; the largest speed of the pile in its
    last stage, over the speed of a free fall from its height; the resident memory of the program after a fifth of the run
    and at its end, and the largest in between; the CPU time. Rows of other runs stay as they are in the table.
    """
    for name in given.runs:
        if name not in LONG_RUNS:
            raise ResultsError(f"there is no run <{name}>; there are: " + "; ".join(LONG_RUNS))
    plt = pyplot()
    for name in given.runs or LONG_RUNS:
        run_long(name)
        print(measure(name), flush=True)
    done = [name for name in LONG_RUNS if (folder_of(re.sub(r"\W+", "_", name)) / "seconds.txt").exists()]
    rows = {row["run"]: row for row in read_csv(ROOT / "doc/data/long_runs.csv")} | {name: measure(name) for name in done}
    write_csv([rows[name] for name in LONG_RUNS if name in rows])
    figure, axes = plt.subplots(1, 3, figsize=(15, 4))
    for name in done:
        _, rows, memory = results_of(name)
        label, some = name.split(", ", 1)[1], rows[::max(1, len(rows) // 400)]
        if name.startswith("beam"):
            axes[0].plot([row["time"] for row in some], [row["total"] / rows[0]["total"] for row in some], label=label, linewidth=1)
        else:
            axes[1].semilogy([row["time"] for row in some[1:]], [row["largest_speed"] / FREE_FALL for row in some[1:]], label=label,
                             linewidth=1)
        axes[2].plot([row["time"] / rows[-1]["time"] for row in memory], [row["resident_kb"] / 1024 for row in memory],
                     label=name, linewidth=1)
    axes[0].set(title="Swinging beam", xlabel="time, s", ylabel="kinetic and strain energy over the initial one")
    axes[1].set(title="Pile of soil", xlabel="time, s", ylabel="largest speed over that of a free fall")
    axes[1].axhline(1e-6, color="grey", linestyle=":")
    axes[2].set(title="Memory", xlabel="part of the run", ylabel="resident memory, MB")
    axes[2].set_ylim(bottom=0)
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.legend(fontsize=7, frameon=False)
    save(figure, dpi=80)
