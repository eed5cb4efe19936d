"""Draw the results of a run.

The pictures depend on the contents of FOLDER:

fields.pvd        a simulation: files/frames/frame_NNNN.png, one for each time of output,
                  animation.gif, also .mp4 if ffmpeg is installed, and
                  picture.png with four times, and below them the measured
                  series of section Reference or, without it, the energies. The
                  last time shows a measured surface and failure line.
                  For results of --check --draw: picture.png with the names of
                  all parts.
failure/          of a ramp: failure.png, the increment of displacement at failure, and
                  the displacement of probes over the factor.
convergence.csv   a sweep: convergence.png, errors over the number of cells.
solves.csv        of greville_benchmark: solves.png, iterations and time per unknown
                  (assembly and set-up included) over the order.
element_test.csv  of greville --element-test: element_test.png with q over p, q over the
                  strain, the change of volume, and the void ratio over p.
*/statistics.csv  a sweep without errors: energies.png, one line per folder.

Several folders of simulations: energies.png in the folder that contains them.

Needs Debian's python3-matplotlib and, for simulations, python3-vtk9.
"""
import io
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from .charts import draw_all_energies, draw_convergence, draw_element_test, draw_solves
from .command import parser_of, run_command
from .drawing import (BODY_COLOURS, COLOURS, STYLE, EllipseCollection, Image, Triangulation, add_legend, draw_spheres, label_energy,
                      matplotlib, need_libraries, np, patheffects, plt)
from .results import ResultsError, Run, has_points, pretty, runs_in
from .scene import Simulation, add_axes, add_colour_bar, axes_order, draw_points, frame, panel_ratio, read_reference
from .set_up import draw_set_up


class Picture:
    """A figure of matplotlib that notebooks show as it is; save(file) writes it."""

    def __init__(self, figure):
        self.figure = figure

    def save(self, file):
        self.figure.savefig(file)

    def _repr_png_(self):
        file = io.BytesIO()
        self.figure.savefig(file, format="png")
        return file.getvalue()


def picture_of(run, k, mesh=False, **options):
    """Return the Picture of the kth time of a run; options are the options of Simulation."""
    need_libraries()
    with plt.rc_context(STYLE):
        simulation = Simulation(run.folder, **options)
        return Picture(frame(simulation, k, mesh))


def draw_frames(simulation, mesh):
    folder = simulation.folder / "files/frames"
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("frame_*.png"):
        old.unlink()
    pictures = []
    for k in range(len(simulation.times)):
        pictures.append(folder / f"frame_{k:04d}.png")
        frame(simulation, k, mesh).savefig(pictures[-1])
    print(f"{folder}/frame_0000.png to {pictures[-1].name}")
    # Durations of a frame; the last one stays longer.
    duration, end = int(np.clip(6000 / len(pictures), 40, 400)), 1500
    write_gif(simulation, pictures, duration, end)
    write_mp4(simulation.folder, duration, end)


def write_gif(simulation, pictures, duration, end):
    # One palette for all frames: the colours of points, in 3D in four shades, of bodies, and grey.
    shades = np.array([1., 0.87, 0.74, 0.6] if simulation.dim == 3 else [1.])
    colours = plt.get_cmap(simulation.colours)(np.linspace(0, 1, 224 // len(shades)))[:, :3]
    colours = np.r_[(shades[:, None, None] * colours).reshape(-1, 3), matplotlib.colors.to_rgba_array(BODY_COLOURS)[:, :3], np.linspace([0.] * 3, [1.] * 3, 24)]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.rint(255 * colours).astype(int).ravel().tolist())
    images = [Image.open(name).convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE)
              for name in pictures]
    images[0].save(simulation.folder / "animation.gif", save_all=True, append_images=images[1:], loop=0,
                   duration=[duration] * (len(images) - 1) + [end])
    print(simulation.folder / "animation.gif")


def write_mp4(folder, duration, end):
    """Write the frames as a film in all colours if ffmpeg is installed. Removes an earlier film, which would show another run."""
    file = folder / "animation.mp4"
    file.unlink(missing_ok=True)
    if not shutil.which("ffmpeg"):
        return
    # Players need even numbers of pixels, and this colour format.
    filters = f"tpad=stop_mode=clone:stop_duration={end / 1000},pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,format=yuv420p"
    done = subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-framerate", f"1000/{duration}", "-i", folder / "files/frames/frame_%04d.png",
                           "-vf", filters, "-r", "25", "-movflags", "+faststart", file], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        file.unlink(missing_ok=True)
        print(f"{folder}: no animation.mp4: ffmpeg says: {(done.stderr.strip().splitlines() or ['nothing'])[-1]}", file=sys.stderr)
    else:
        print(file)


# Lines.

def draw_failure_lines(axes, simulation, k):
    """Draw the measured failure line, and the line where points have moved by Reference/Failure displacement."""
    # White lines with dark edges are visible on all colours and beside them.
    style = {"color": "white", "linewidth": 1.3,
             "path_effects": [patheffects.Stroke(linewidth=2.2, foreground="0.2"), patheffects.Normal()]}
    axes.plot(*simulation.failure_line[:2], linestyle=(0, (3, 2)), label="its failure line", **style)
    if "displacement" in simulation.needed:
        x, _, diameter, _ = simulation.load(k)
        moved = np.linalg.norm(simulation.run.points(k, ["displacement"])["displacement"], axis=1)
        triangles = Triangulation(*x[:, :2].T)
        corners = x[triangles.triangles, :2]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        triangles.set_mask(edges > 4. * np.median(diameter))   # Segments across air and along walls.
        level = float(simulation.parameters["Reference/Failure displacement"])
        if not moved.min() < level < moved.max():   # Nothing has failed yet.
            return
        contour = axes.tricontour(triangles, moved, colors="white", linewidths=style["linewidth"], levels=[level])
        for lines in getattr(contour, "collections", [contour]):   # One collection since matplotlib 3.8.
            lines.set_path_effects(style["path_effects"])
        axes.plot([], [], label="failure line of the run", **style)


def draw_series(axes, simulation, series):
    """Draw a column of statistics.csv and its measured values."""
    quantity = simulation.parameters["Reference/Series quantity"]
    labels = [f"{label}, {pretty(simulation.run.unit('statistics.csv', column))}"
              for label, column in (("time", "time"), (quantity.replace("_", " "), quantity))]
    axes.plot(simulation.statistics["time"], simulation.statistics[quantity], color=COLOURS[0], label="simulation")
    axes.plot(*series[:2], "o", color="black", markerfacecolor="white", markersize=5, label=series[2])
    axes.set(xlabel=labels[0], ylabel=labels[1])


def draw_energies(axes, simulation):
    """Draw energies, and the columns of work."""
    statistics = simulation.statistics
    time, lowest = statistics["time"], statistics["gravitational"].min()
    for k, name in enumerate(("kinetic", "strain", "gravitational", "dissipation", "total")):
        value = statistics[name] - (lowest if name in ("gravitational", "total") else 0.)
        if np.any(value != 0):
            label = name + (" (above its minimum)" if name == "gravitational" and lowest != 0 else "")
            axes.plot(time, value, color="black" if name == "total" else COLOURS[k],
                      linestyle="--" if name == "total" else "-", label=label)
    works = [name for name in simulation.run.work if name != "work_gravity"]
    if works:
        label = works[0].replace("_", " ").replace("work ", "work of ") if len(works) == 1 else "work of loads, walls, damping"
        axes.plot(time, sum(statistics[name] for name in works), color=COLOURS[4], linestyle="-.", label=label)
    axes.set(xlabel="time, s")
    label_energy(axes, "energy", simulation.run)


def draw_picture(simulation, mesh):
    series = read_reference(simulation.run, "Series file")
    chosen, ratio = simulation.four_times(), panel_ratio(simulation)
    columns = min(len(chosen), 4 if ratio > 1.3 else 3 if len(chosen) == 3 and ratio > 0.6 else 2 if ratio > 0.12 else 1)
    rows = -(-len(chosen) // columns)
    between, length = (0.45, 5.35) if simulation.dim == 3 else (0.2, 5.7)
    width = (length - between * (columns - 1)) / columns
    height, gap = width * ratio, 0.3
    bottom = (0.5 if simulation.statistics is None else 3.25) - (0.25 if simulation.dim == 3 else 0.)
    total = bottom + rows * (height + gap) + 0.05
    figure = plt.figure(figsize=(7.2, total), dpi=200)
    for n, k in enumerate(chosen):
        row, column = divmod(n, columns)
        left, low = 0.65 + column * (width + between), bottom + (rows - 1 - row) * (height + gap)
        axes = add_axes(figure, (left, low, width, height), simulation, k if mesh else None,
                        ("x" if row == rows - 1 else "") + ("y" if column == 0 else ""))
        draw_points(axes, simulation, k)
        figure.text(left / 7.2, (low + height + 0.1) / total, f"({'abcd'[n]})  {simulation.title(k)}")
        if simulation.surface and n == len(chosen) - 1:
            axes.plot(*simulation.surface[:2], "o", color="black", markerfacecolor="white", markersize=4,
                      label=simulation.surface[2], clip_on=False)
        if simulation.failure_line and n == len(chosen) - 1:
            draw_failure_lines(axes, simulation, k)
        if axes.get_legend_handles_labels()[1]:
            axes.legend(loc="upper right", borderpad=0, handletextpad=0.4, handlelength=1.6)
    middle, size = bottom + (rows * (height + gap) - gap) / 2, min(rows * (height + gap) - gap, 3.)
    add_colour_bar(figure, (6.5, middle - size / 2, 0.12, size), simulation)
    if simulation.statistics is not None:
        axes = figure.add_axes([0.65 / 7.2, 0.5 / total, 5.7 / 7.2, 1.9 / total])
        if series:
            draw_series(axes, simulation, series)
        else:
            draw_energies(axes, simulation)
            axes.margins(x=0)
        axes.set_xlim(simulation.statistics["time"][0])
        add_legend(axes)
    figure.savefig(simulation.folder / "picture.png")
    plt.close(figure)
    print(simulation.folder / "picture.png")


def increments(run):
    """Return positions and displacement increments of points between the last two states of a ramp, m."""
    first, last = (run.points(k, ["id", "body"]) for k in (0, -1))
    places = {key: x for key, x in zip(zip(first["body"], first["id"]), first.x)}
    here = [key in places for key in zip(last["body"], last["id"])]
    before = np.array([places[key] for key, is_here in zip(zip(last["body"], last["id"]), here) if is_here])
    return before, last.x[here] - before


def draw_failure(simulation):
    run = Run(simulation.folder / "failure")
    if not {"id", "body"} <= set(run.point_fields):
        raise ResultsError(f"{run.folder} lacks the fields id or body ('Output/Fields'), which tell points of two states apart.")
    x, increment = increments(run)
    size = np.linalg.norm(increment, axis=1)
    size /= size.max() or 1.
    ratio = panel_ratio(simulation, 5.7)
    height, bottom = 5.7 * ratio, 3.
    total = bottom + height + 0.4
    figure = plt.figure(figsize=(7.2, total), dpi=200)
    factors = simulation.run.summary["ramp"]
    if simulation.dim == 2:
        axes = add_axes(figure, (0.65, bottom, 5.7, height), simulation)
        diameter = simulation.run.sizes(-1)[0] * 1.7
        circles = EllipseCollection(np.full(len(x), diameter), np.full(len(x), diameter), np.zeros(len(x)), units="xy",
                                    offsets=x[:, :2], array=size, cmap="viridis", norm=plt.Normalize(0., 1.), linewidths=0)
        circles.set_offset_transform(axes.transData)
        axes.add_collection(circles)
        chosen = np.flatnonzero(size > 0.1)
        chosen = chosen[::max(1, len(chosen) // 60)]
        axes.quiver(x[chosen, 0], x[chosen, 1], increment[chosen, 0], increment[chosen, 1], color="white", width=0.0022)
    else:
        axes = add_axes(figure, (0.65, bottom, 5.7, height), simulation)
        order = axes_order(simulation)
        draw_spheres(axes, x[:, order], simulation.run.sizes(-1)[:len(x)], plt.get_cmap("viridis")(size)[:, :3],
                     np.zeros((0, 3, 3)), (simulation.lower[order], simulation.upper[order]))
        circles = plt.cm.ScalarMappable(plt.Normalize(0., 1.), "viridis")
    figure.text(0.65 / 7.2, (bottom + height + 0.12) / total, "increment of displacement at failure over the largest one")
    bar = figure.add_axes([6.5 / 7.2, bottom / total, 0.12 / 7.2, height / total])
    figure.colorbar(circles, cax=bar)
    axes = figure.add_axes([0.65 / 7.2, 0.5 / total, 5.7 / 7.2, 1.75 / total])
    factor, probes = simulation.run.statistics["factor"], simulation.run.probes
    names = [] if probes is None else [name for name in probes if re.fullmatch(r"displacement_x\d+", name)]
    last = simulation.run.statistics.get("stage", np.zeros(len(factor)))
    mine = last == last[-1]
    for n, name in enumerate(names):
        way = np.linalg.norm([probes[name.replace("_x", "_" + axis)] for axis in "xyz"[:simulation.dim]], axis=0)
        axes.plot(factor[mine], way[mine], "o-", markersize=3, color=COLOURS[n % len(COLOURS)], label=f"probe {n}")
    if "to" in factors:
        axes.axvspan(factors["from"], factors["to"], color="0.8", linewidth=0)
        axes.axvline(factors["factor"], color="0.2", linewidth=1, label=f"failure at {factors['factor']:.3f}")
    axes.set(xlabel="factor", ylabel="displacement, m")
    if names:
        axes.set_yscale("log")
    add_legend(axes)
    figure.savefig(simulation.folder / "failure.png")
    plt.close(figure)
    print(simulation.folder / "failure.png")


def main(program=None):
    parser = parser_of(program, __doc__)
    parser.add_argument("--field", metavar="NAME",
                        help="colour of points: speed, a field of points, such as pressure or body, or a component such as "
                             "velocity_x. Default: a field that suits the run")
    parser.add_argument("--no-rigid-bodies", action="store_true",
                        help="leave rigid bodies out, which may hide the others (3D)")
    parser.add_argument("--magnify", type=float, default=1., metavar="FACTOR",
                        help="draw displacements this many times as large")
    parser.add_argument("--up", choices=["x", "y", "z"], help="vertical axis in 3D (default: the direction of gravity)")
    parser.add_argument("--mesh", action="store_true", help="draw the mesh behind the points (2D)")
    run_command(parser, draw)


def draw(arguments):
    need_libraries()
    plt.switch_backend("Agg")
    folders = arguments.folders
    for folder in folders:
        if not folder.is_dir():
            raise ResultsError(f"{folder} is not a folder.")
    folder = folders[0]
    if len(folders) == 1 and (folder / "solves.csv").exists():
        draw_solves(folder)
        return
    plt.rcParams.update(STYLE)
    if len(folders) == 1 and (folder / "element_test.csv").exists():
        draw_element_test(folder)
    elif len(folders) > 1:
        for folder in folders:
            if not (folder / "statistics.csv").exists():
                raise ResultsError(f"{folder} has no statistics.csv, so its energies cannot be compared.")
        draw_all_energies(folders, Path(os.path.commonpath([folder.resolve().parent for folder in folders])))
    elif has_points(folder):
        is_set_up = not (folder / "statistics.csv").exists() and not (folder / "messages.log").exists()
        field = arguments.field or ("body" if is_set_up and "body" in Run(folder).point_fields else None)
        simulation = Simulation(folder, field, arguments.magnify, not arguments.no_rigid_bodies, arguments.up)
        if is_set_up:
            draw_set_up(simulation, axes_order(simulation), arguments.mesh)
            return
        draw_picture(simulation, arguments.mesh)
        if has_points(folder / "failure") and "ramp" in simulation.run.summary:
            draw_failure(simulation)
        draw_frames(simulation, arguments.mesh)
    elif (folder / "convergence.csv").exists():
        draw_convergence(folder)
    else:
        runs = runs_in(folder)
        if not runs:
            raise ResultsError(f"{folder} has nothing to draw: no fields.pvd, convergence.csv, solves.csv or */statistics.csv.")
        draw_all_energies(runs, folder)
