"""The tables of implicit steps and their linear systems, of scripts/tables."""
import math
import re
import statistics
import sys

from greville import Run, how_to_install, read_table
from tables_common import (COLOURS, ROOT, argument, folder_of, print_head, print_row, pyplot, read_csv, run, run_to_end, save,
                           section, shipped, table, write_csv)

try:
    import numpy as np
except ImportError:
    np = None


def need_numpy():
    if np is None:
        sys.exit("scripts/tables: " + how_to_install("numpy"))


@table("stiffness_iterations", argument("--quick", action="store_true", help="only small meshes, and orders 1 and 2"),
       argument("bodies", nargs="*", metavar="BODY", default=["column_2d", "dome_2d", "beam_2d", "column_3d", "dome_3d"]))
def stiffness_iterations(given):
    """linear systems of quasi-static steps, as CSV

    Iterations and times over meshes, orders and solvers, for bodies of prm/stiffness (all of them).
    """
    columns = ["cells", "p", "solver", "points_per_direction", "unknowns", "iterations", "converged", "assembly_s", "setup_s",
               "solve_s", "unknowns_per_s", "operator_bytes", "preconditioner_bytes"]
    print(",".join(["body"] + columns), flush=True)
    for body in given.bodies:
        in_3d = body.endswith("_3d")
        if given.quick:
            runs = [("8", "1, 2", 2)] if in_3d else [("16, 32", "1, 2", 3)]
        else:
            runs = [("8, 12, 16", "1, 2", 2), ("8, 12, 16", "3", 3)] if in_3d else [("16, 32, 64, 128", "1, 2, 3, 4", 3)]
        for cells, orders, points in runs:
            folder = folder_of("run")
            run_to_end(ROOT / f"prm/stiffness/{body}.prm", folder,
                       {"Benchmark/Cells": cells, "Benchmark/Orders": orders, "Benchmark/Output directory": folder,
                        "Problem/Points per direction": points}, program="greville_benchmark")
            for row in read_csv(folder / "solves.csv"):
                print(",".join([body] + [row[name] for name in columns]), flush=True)


SOLVERS = {"cg-p-multigrid": ("p-multigrid", "#0072B2", "o-"), "cg-gamg": ("GAMG", "#D55E00", "s--"),
           "cg-boomeramg": ("BoomerAMG", "#009E73", "^:")}


@table("stiffness_growth", argument("files", nargs="*", metavar="FILE", help="solves.csv of earlier runs, instead of new runs"))
def stiffness_growth(given):
    """time, memory and iterations of linear systems over the number of unknowns

    Runs prm/stiffness/throughput_p2.prm and throughput_p3.prm five times each, and writes and draws the medians. Takes ten
    minutes, and needs an idle machine.
    """
    plt, files = pyplot(), list(given.files)
    for k in range(0 if files else 5):
        for p in (2, 3):
            folder = folder_of(p, k)
            run_to_end(ROOT / f"prm/stiffness/throughput_p{p}.prm", folder, {"Benchmark/Output directory": folder},
                       program="greville_benchmark")
            files.append(folder / "solves.csv")
    groups = {}
    for row in (row for file in files for row in read_table(file).rows()):
        groups.setdefault((int(row["p"]), int(row["cells"]), row["solver"]), []).append(row)
    rows = []
    for (p, cells, solver), group in sorted(groups.items(), key=lambda item: item[0][:2]):
        def median(name):
            return statistics.median(float(row[name]) for row in group)
        rates = [float(row["unknowns_per_s"]) for row in group]
        unknowns = int(group[0]["unknowns"])
        rows.append({
            "p": p, "cells": cells, "unknowns": unknowns, "solver": solver, "runs": len(group),
            "iterations": int(median("iterations")), "assembly_s": f"{median('assembly_s'):.3g}",
            "setup_s": f"{median('setup_s'):.3g}", "solve_s": f"{median('solve_s'):.3g}",
            "unknowns_per_s": f"{statistics.median(rates):.0f}", "fewest_per_s": f"{min(rates):.0f}",
            "most_per_s": f"{max(rates):.0f}",
            "bytes_per_unknown": f"{(median('operator_bytes') + median('preconditioner_bytes')) / unknowns:.0f}"})
    write_csv(rows)
    print_head("p", "unknowns", "iterations", "thousand unknowns per second", "over the better AMG", "kB per unknown")
    for p, unknowns in dict.fromkeys((row["p"], row["unknowns"]) for row in rows):
        mine = [next(row for row in rows if (row["p"], row["unknowns"], row["solver"]) == (p, unknowns, solver)) for solver in SOLVERS]
        rates = [float(row["unknowns_per_s"]) for row in mine]
        print_row(p, unknowns, ", ".join(str(row["iterations"]) for row in mine), ", ".join(f"{rate / 1e3:.1f}" for rate in rates),
                  f"{rates[0] / max(rates[1:]):.1f}", ", ".join(f"{float(row['bytes_per_unknown']) / 1e3:.1f}" for row in mine))

    figure, axes = plt.subplots(2, 2, figsize=(8, 5.6), dpi=150, sharex="col", sharey="row")
    for column, p in enumerate((2, 3)):
        for solver, (label, colour, line) in SOLVERS.items():
            mine = [row for row in rows if (row["p"], row["solver"]) == (p, solver)]
            unknowns = [row["unknowns"] for row in mine]
            seconds = [float(row["setup_s"]) + float(row["solve_s"]) for row in mine]
            axes[0][column].loglog(unknowns, [row["iterations"] for row in mine], line, color=colour, label=label)
            axes[1][column].loglog(unknowns, seconds, line, color=colour)
            if solver == "cg-p-multigrid":
                axes[1][column].loglog(unknowns, [seconds[-1] * n / unknowns[-1] for n in unknowns], color="0.5",
                                       linewidth=0.8, label="linear")
        axes[0][column].set_title(f"p = {p}")
        axes[1][column].set_xlabel("unknowns")
        for axis in axes[:, column]:
            axis.grid(True, which="both", color="0.92", linewidth=0.5)
            axis.set_xticks(unknowns, [f"{n}" for n in unknowns])
            axis.set_xticks([], minor=True)
    axes[0][0].set(ylabel="iterations to 1e-6", ylim=(3, 900))
    axes[1][0].set_ylabel("set-up and solve, s")
    axes[0][0].legend(frameon=False, fontsize=8, ncol=3, loc="upper center")
    axes[1][0].legend(frameon=False, fontsize=8)
    save(figure)


# The exact force, N / m; the displacement at the end, m; its description; the body.
LIMITS = {"footing": (-25.70797e3, -6e-5, "strip on clay", "soil"), "notched_plate": (1.48425e6, 3e-4, "notched plate", "plate")}
# File, cells, cells in half of the strip or ligament, order, projection, points per direction.
LIMIT_RUNS = [("footing", "30, 15", 7.5, 1, "order p-1", 2),
              ("footing", "62, 31", 15.5, 1, "order p-1", 2),
              ("footing", "126, 63", 31.5, 1, "order p-1", 2),
              ("footing", "32, 16", 8, 2, "order p-1", 3),
              ("footing", "64, 32", 16, 2, "order p-1", 3),
              ("footing", "62, 31", 15.5, 1, "none", 2),
              ("footing", "64, 32", 16, 2, "none", 3),
              ("notched_plate", "25, 14", 2.5, 1, "order p-1", 2),
              ("notched_plate", "55, 28", 5.5, 1, "order p-1", 2),
              ("notched_plate", "105, 52", 10.5, 1, "order p-1", 2),
              ("notched_plate", "55, 28", 5.5, 1, "none", 2)]


@table("limit_loads", argument("--draw", action="store_true", help="use the runs in output/limit_loads"))
def limit_loads(given):
    """limit loads of a footing and of a notched plate on several meshes

    Runs prm/simulation/footing.prm and notched_plate.prm, and draws forces over displacements beside the exact limits.
    Takes some minutes.
    """
    plt = pyplot()
    rows, curves = [], {name: [] for name in LIMITS}
    for case, cells, half, order, projection, points in LIMIT_RUNS:
        exact, end, _, body = LIMITS[case]
        folder = folder_of(case, cells.replace(", ", "x"), f"p{order}", "none" if projection == "none" else "projected")
        if not given.draw:
            result = run(shipped(case), folder, {"Grid/Cells": cells, "Grid/Order": order, "Scheme/Volumetric projection": projection,
                                                 f"Body {body}/Points per direction": points, "Output/Fields every": 0})
            if result.has_failed:
                print(result.error.strip(), file=sys.stderr)
        if not (folder / "statistics.csv").exists():
            continue
        results = Run(folder)
        forces, seconds = results.statistics["reaction_top_y"], results.summary.get("wall_time", "")
        rows.append({"case": case, "cells": cells.replace(", ", " x "), "cells_in_half": half, "p": order, "projection": projection,
                     "steps": len(forces) - 1, "seconds": f"{seconds:.3g}" if seconds else "", "force": f"{forces[-1]:.6g}",
                     "exact": exact, "ratio": f"{forces[-1] / exact:.4f}"})
        curves[case].append(([abs(end) * t * 1e3 for t in results.statistics["time"]], [force / exact for force in forces],
                             f"{half:g} cells, p = {order}" + ("" if projection != "none" else ", not projected")))
    write_csv(rows)
    print_head("case", "cells", "in half of the width", "p", "projection", "force over the exact limit")
    for row in rows:
        print_row(row["case"].replace("_", " "), *(row[name] for name in ("cells", "cells_in_half", "p", "projection", "ratio")))
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), dpi=150)
    for axis, (case, (_, _, title, _)) in zip(axes, LIMITS.items()):
        for colour, (x, y, label) in zip(COLOURS, curves[case]):
            axis.plot(x, y, "o-", color=colour, markersize=2.5, linewidth=1.1, label=label)
        axis.axhline(1, color="0", linewidth=0.8, linestyle="--", label="exact")
        axis.set(title=title, xlabel="displacement, mm", ylabel="force over the exact limit", ylim=(0, 1.45))
        axis.legend(fontsize=7, frameon=False, loc="lower right")
    save(figure)


LENGTH = 0.048   # m, the width of Cook's membrane


def tip(folder):
    """Return the upward displacement of the tip, mm."""
    table = Run(folder).probes
    count = sum(re.fullmatch(r"x\d+", name) is not None for name in table)
    x, y = ([np.array([table[f"{axis}{k}"][row] for k in range(count)]) * 1e3 for row in (0, -1)] for axis in "xy")
    # Probes share points.
    a, b, v = np.unique(np.array([x[0] - 48., y[0] - 52., y[1] - y[0]]).T, axis=0).T
    return np.linalg.lstsq(np.array([a**0, a, b, a * a, a * b, b * b]).T, v, rcond=None)[0][0]


@table("cooks_membrane")
def cooks_membrane(_):
    """Cook's membrane at finite strain on grids that are shifted, and on finer ones, as CSV

    Ten shifts of the grid of prm/simulation/cooks_membrane.prm for p = 2 and 3, then three grids with 2, 3 and 4 points
    per cell and direction. Takes some minutes.

    In x, a shift must keep the wall at x = 0, so it changes the size of the cells: n + shift of them are 48 mm wide. In
    y it moves the lines of the grid. The displacement of the tip (48, 52) mm comes from a quadratic polynomial through
    points within 2.5 mm of it (three spacings of points, if that is more). Needs python3-numpy.
    """
    need_numpy()
    print("cells,p,points,shift_x,shift_y,tip_mm,steps,newton_iterations,linear_iterations,", flush=True)
    runs = [(32, order, 3 if order == 2 else 4, k * 3 % 10 / 10, k / 10) for order in (2, 3) for k in range(10)]
    runs += [(cells, order, per_cell, 0, 0) for cells in (16, 32, 64) for order in (2, 3) for per_cell in (2, 3, 4)]
    for cells, order, per_cell, shift_x, shift_y in runs:
        h = LENGTH / cells
        n = (cells + 2, round(0.081 / h) + 3)
        lower, reach = (shift_y - 2) * h, max(2.5, 3 * 48 / (cells * per_cell))
        steps = [k * reach / 5 for k in range(-5, 6)]
        probes = "; ".join(f"{(48 + a) / 1e3:.6f}, {(52 + b) / 1e3:.6f}" for a in steps for b in steps
                           if a <= 0 and a * a + b * b < reach * reach)
        result = run(shipped("cooks_membrane"), folder_of("run"),
                     {"Grid/Lower corner": f"0, {lower:.10g}", "Grid/Cells": f"{n[0]}, {n[1]}", "Grid/Order": order,
                      "Grid/Upper corner": f"{LENGTH / (cells + shift_x) * n[0]:.10g}, {lower + n[1] * h:.10g}",
                      "Body membrane/Points per direction": per_cell, "Output/Fields every": 0,
                      "Output/Probes": probes})
        row = f"{cells},{order},{per_cell},{shift_x:.1f},{shift_y:.1f},"
        if result.has_failed:
            # The time that the run has reached.
            times = re.findall(r"^step \d+, t = (\S+)", result.out, re.MULTILINE)
            print(row + f",,,,stopped at t = {times[-1] if times else 0}", flush=True)
            continue
        made = Run(result.folder)
        linear = [int(k) for n, k in zip(made.newton["iteration"], made.newton["linear_iterations"]) if n > 0]
        print(row + f"{tip(result.folder):.3f},{made.statistics.n_rows - 1},{len(linear)},"
              f"{sum(linear) / len(linear):.1f},", flush=True)


# Width, box of the grid for a size h of cells, shape, body force (m / s^2), walls, places where stresses are singular.
LOCKING = {
    "cook": (48., lambda h: (0., -h, 48. + h, 60. + 2. * h),
             "intersection(box(0, -1, 48, 61), half_space(11, -12, 0), half_space(-1, 3, 132))", "0; (X / 48)^4",
             {"Left": "fixed"}, [(0., 0.), (0., 44.)]),
    "strip": (2., lambda h: (0., 0., 2., 1. + h), "box(0, 0, 2, 0.9375)", "0; -100 * exp(-(X / 0.3)^4) * max(0, Y - 0.6)",
              {"Left": "sliding", "Right": "sliding", "Bottom": "fixed"}, []),
}


def run_locking(case, cells, order, projection, placement="equidistant", jitter=0.5):
    """Return the folder of a run, and run it if the folder is missing."""
    length, box, shape, force, walls, _ = LOCKING[case]
    h = length / cells
    x0, y0, x1, y1 = box(h)
    n = [round((x1 - x0) / h), round((y1 - y0) / h)]
    folder = folder_of(case, cells, order, projection, *(["reference"] if jitter == 0 else []))
    if not (folder / "summary.json").exists():
        result = run(
            section("Simulation", Bodies="body", Materials="rubber")
            + section("Grid", Lower_corner=f"{x0}, {y0}", Upper_corner=f"{x0 + n[0] * h}, {y0 + n[1] * h}",
                      Cells=f"{n[0]}, {n[1]}", Order=order)
            + section("Time", End=1, Step=1)
            + section("Scheme", Formulation="total Lagrangian", Stress_update="quasi-static", Volumetric_projection=projection,
                      Filling_threshold=0 if order == 1 and projection != "none" else 0.1)
            + section("Newton", Tolerance=1e-7)
            + section("Body body", Material="rubber", Shape=shape, Points_per_direction=4, Placement=placement, Jitter=jitter)
            + section("Material rubber", Model="linear-elastic", Density=1, Young_modulus=1e6, Poisson_ratio=0.4999)
            + section("Loads", Body_force=force) + section("Walls", **walls) + section("Output", Fields_every=1), folder)
        folder.with_suffix(".txt").write_text(result.out + result.error)
    return folder


def pressures(folder):
    points = Run(folder).points(-1)
    return points.x[:, :2], points["pressure"]


def at_points(x, fine, values, h):
    """Return, for each x, the value of a plane through the values of the nearest fine points. Cells of size h sort the fine points."""
    cells = {}
    for k, cell in enumerate(map(tuple, np.floor(fine / h).astype(int))):
        cells.setdefault(cell, []).append(k)
    result = np.empty(len(x))
    for k, (point, (i, j)) in enumerate(zip(x, np.floor(x / h).astype(int))):
        near = np.array([q for a in (-1, 0, 1) for b in (-1, 0, 1) for q in cells.get((i + a, j + b), [])])
        d = fine[near] - point
        best = np.argsort((d**2).sum(axis=1))[:9]
        A = np.column_stack([np.ones(len(best)), d[best]])
        result[k] = np.linalg.lstsq(A, values[near[best]], rcond=None)[0][0]
    return result


@table("projection_tables")
def projection_tables(_):
    """spaces of Scheme/Volumetric projection at a Poisson's ratio of 0.4999, as CSV

    Cook's membrane and a soil below a strip, with jittered points. Takes some minutes; existing runs are kept.

    Body forces are smooth. The displacement is the work relative to a fine run, i.e. the mean displacement, weighted by
    the force. The pressure is compared with the fine run at points that are farther than an eighth of the
    width from the ends of the clamped side: the root of the mean square of the error, and the largest error, over the same
    of the pressure. The fine run has order 2, 64 cells, the coarse mesh and points at Gauss positions. Needs python3-numpy
    and python3-vtk9.
    """
    need_numpy()
    print("case,cells,p,projection,displacement,pressure_l2,pressure_max,linear_iterations", flush=True)
    for case, (width, *_, singular) in LOCKING.items():
        reference = run_locking(case, 64, 2, "coarse mesh", "Gauss", 0)
        fine, fine_pressure = pressures(reference)
        for cells, order, projection in [(cells, order, projection) for cells in (8, 16, 32) for order in (1, 2, 3)
                                         for projection in ("none", "order p-1", "coarse mesh")]:
            folder = run_locking(case, cells, order, projection)
            start = f"{case},{cells},{order},{projection},"
            if not (folder / "summary.json").exists() or Run(folder).statistics.n_rows < 2:
                print(start + "no solution,,,", flush=True)
                continue
            iterations = folder.with_suffix(".txt").read_text().split("linear systems of Newton's method: ")[1].split(" ")[0]
            x, p = pressures(folder)
            exact = at_points(x, fine, fine_pressure, width / 48.)
            inner = np.full(len(x), True)
            for place in singular:
                inner &= ((x - place)**2).sum(axis=1) > (width / 8.)**2
            error, exact = (p - exact)[inner], exact[inner]
            work, fine_work = (Run(one).statistics["work_loads"][-1] for one in (folder, reference))
            print(start + f"{work / fine_work:.4f},{np.sqrt((error**2).mean() / (exact**2).mean()):.3f},"
                  f"{np.abs(error).max() / np.abs(exact).max():.2f},{iterations}", flush=True)


SOLID = (section("Simulation", Bodies="body", Materials="solid")
         + section("Material solid", Density=1, Young_modulus=100, Poisson_ratio=0.3))
WAVE_SPEED = math.sqrt(100 * 0.7 / (1.3 * 0.4))   # m/s, of SOLID
MIDPOINT = section("Scheme", Stress_update="implicit-midpoint", Mass="consistent", Energy_gain="warn")


def rows_of(text, file="statistics.csv"):
    """Return the rows of a table of a run, and the end of the run."""
    (folder_of("run") / file).unlink(missing_ok=True)
    result = run(text + section("Output", Fields_every=0), folder_of("run"), program="sweep" if file == "convergence.csv" else "greville")
    if result.has_failed and not (result.folder / file).exists():
        sys.exit(result.error)
    return read_table(result.folder / file).rows(), result.error.strip()


def print_energy(name, rows, message):
    start = rows[0]["total"]
    largest = max(abs(row["total"] / start - 1) for row in rows)
    print(f"{name}: energy {largest:.1e}, kinetic at the end {rows[-1]['kinetic'] / start:.3f}, "
          f"fragments {max(row['fragments'] for row in rows):.0f}, t = {rows[-1]['time']:g} s {message}", flush=True)


@table("flight")
def flight(_):
    """strain over kinetic energy of a block after 40 of its lengths, implicit-midpoint"""
    for order, ratio, jitter in [(order, ratio, jitter) for order in (2, 3) for ratio in (0.3, 1, 2) for jitter in (0, 0.5)]:
        speed = ratio * WAVE_SPEED
        rows, message = rows_of(
            SOLID + MIDPOINT + section("Material solid", Model="linear-elastic")
            + section("Grid", Lower_corner="0, 0", Upper_corner="337, 13", Cells="337, 13", Order=order)
            + section("Body body", Material="solid", Shape="box(4.3, 2.4, 12.3, 10.4)", Points_per_direction=3, Jitter=jitter,
                      Velocity=f"{speed}; 0")
            + section("Newton", Absolute_tolerance=1e-8)
            + section("Time", End=320 / speed, Step=0.5 / (WAVE_SPEED + speed)) + section("Output", Statistics_every=40 / speed))
        print(f"p = {order}, speed {ratio}, jitter {jitter}: {rows[-1]['strain'] / rows[0]['kinetic']:.1e} {message}", flush=True)


@table("disk")
def disk(_):
    """change of energy of a disk that spins and bounces, 10^4 steps, implicit-midpoint"""
    w = 0.05 * WAVE_SPEED / 3.3
    for courant in (0.5, 5):
        step = courant / WAVE_SPEED
        print_energy(f"dt c / h = {courant}", *rows_of(
            SOLID + MIDPOINT + section("Material solid", Model="neo-hookean")
            + section("Grid", Lower_corner="0, 0", Upper_corner="10, 10", Cells="10, 10", Order=2)
            + section("Walls", Left="sliding", Right="sliding", Bottom="sliding", Top="sliding")
            + section("Body body", Material="solid", Shape="ball(5.03, 4.89, 3.3)", Points_per_direction=3,
                      Velocity=f"{0.03 * WAVE_SPEED} - {w} * (y - 4.89); {0.0185 * WAVE_SPEED} + {w} * (x - 5.03)")
            + section("Newton", Tolerance=1e-11, Absolute_tolerance=1e-9)
            + section("Time", End=10000 * step, Step=step) + section("Output", Statistics_every=500 * step)))


@table("collision")
def collision(_):
    """change of energy of colliding disks, implicit-midpoint"""
    for step, order, threshold in [(step, order, threshold) for step in (0.01696, 0.0848, 0.1696) for order in (2, 3)
                                   for threshold in (0.55, 0.1)]:
        print_energy(f"step {step} s, p = {order}, threshold {threshold}", *rows_of(
            shipped("colliding_disks").read_text() + section("Sweep", Masses="") + MIDPOINT + section("Grid", Order=order)
            + section("Time", Step=step) + section("Scheme", Filling_threshold=threshold)
            + section("Newton", Absolute_tolerance=1e-8) + section("Output", Statistics_every=0)))


def print_convergence(name, space_step, time_steps, orders_in_time, **newton):
    for scheme in ("newmark", "implicit-midpoint"):
        common = (shipped(name).read_text() + section("Scheme", Stress_update=scheme)
                  + section("Sweep", Cells="8, 16, 32", Orders="1, 2, 3", Masses="consistent"))
        for step in (space_step, *time_steps):
            text = common + section("Newton", **newton) + section("Time", Step=step)
            if step != space_step:
                text += section("Sweep", Cells=32, Orders=3) + orders_in_time
            rows, message = rows_of(text, "convergence.csv")
            for row in rows:
                print(f"{scheme}, step {step}, p = {row['p']:.0f}, {row['cells']:.0f} cells: {row['error_l2']:.2e} {message}",
                      flush=True)


@table("bar")
def bar(_):
    """errors of prm/simulation/vibrating_bar.prm in implicit steps"""
    print_convergence("vibrating_bar", "0.016 * (h / 3)^2", (0.1, 0.05, 0.025, 0.0125), section("Time", End=2), Tolerance=1e-7,
                      Absolute_tolerance=1e-10)


@table("mms")
def mms(_):
    """errors of prm/simulation/axis_aligned_mms_2d.prm in implicit steps"""
    print_convergence("axis_aligned_mms_2d", "0.4 * h / 116", (0.002, 0.001, 0.0005, 0.00025), "")
