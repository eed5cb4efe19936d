"""Draw what a run has left.

What is drawn, and where to, depends on what FOLDER holds:

points.pvd        a simulation: frames/frame_NNNN.png, one for each time of output,
                  animation.gif, and picture.png, which has four times and below
                  them the measured series of the parameters' section Reference or,
                  where there is none, the energies. A measured surface and
                  failure line, with that of the run, are drawn over the last of
                  the four times.
failure/          of a ramp: failure.png, the increment of displacement at failure, and
                  the displacement of probes over the factor.
convergence.csv   a sweep: convergence.png, errors over the number of cells.
solves.csv        of greville_benchmark: solves.png. Left: iterations over the order, one
                  line per solver and mesh. Right: time per unknown, assembly and
                  set-up included.
element_test.csv  of greville --element-test: element_test.png with q over p, q over the
                  strain, the change of volume, and the void ratio over p.
*/statistics.csv  a sweep without errors: energies.png, one line per folder.

Several folders of simulations: energies.png in the folder that holds them all.

Needs Debian's python3-matplotlib and, for simulations, python3-vtk9.
"""
import io
import math
import os
import re
import sys
from pathlib import Path

from .command import parser_of, run_command
from .results import (PACKAGES, ResultsError, Run, how_to_install, main_field, parts_in_range, pretty, range_of_colours,
                      read_table, runs_in)

# Help is there without the libraries, too.
try:
    import matplotlib
    import matplotlib.pyplot as plt
    import numpy as np
    from matplotlib import patheffects
    from matplotlib.collections import EllipseCollection
    from matplotlib.path import Path as Outline
    from matplotlib.ticker import FormatStrFormatter
    from matplotlib.tri import Triangulation
    from PIL import Image
    MISSING = ""
except ImportError as error:
    MISSING = (error.name or "").split(".")[0]

# Okabe and Ito's colours, which the colour-blind can tell apart.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
LINES = ["-", "--", "-."]
BODY_COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5CC0", "#8C8C8C"]
STYLE = {"font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9, "legend.fontsize": 8,
         "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7, "lines.linewidth": 1.4,
         "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "legend.handlelength": 2.6}


def need_libraries():
    if MISSING:
        raise ResultsError(how_to_install(MISSING if MISSING in PACKAGES else "matplotlib"))


def read_reference(run, name):
    """Measured data of a run; a word where they are not to be found."""
    found = run.reference(name)
    if not found and run.parameters.get("Reference/" + name):
        print(f"{run.folder}: no measured data: there is no {run.parameters['Reference/' + name]}.", file=sys.stderr)
    return found


class Simulation:
    """A run with the colours and limits of its pictures."""

    def __init__(self, folder, field=None, magnify=1., rigid_bodies=True):
        self.run, self.magnify, self.has_rigid_bodies = Run(folder), magnify, rigid_bodies
        self.folder, self.title_of_run = folder, self.run.title
        self.times, self.dim, self.parameters = np.asarray(self.run.times), self.run.dim, self.run.parameters
        self.decimals = max(0, 2 - int(np.floor(np.log10(self.times[-1] or 1.))))
        self.statistics = self.run.statistics if (folder / "statistics.csv").exists() else None

        available = self.run.point_fields
        field = field or main_field(self.run)
        self.array, self.component = ("velocity" if field == "speed" else field), field
        if field not in available and field[-2:] in ("_x", "_y", "_z") and field[:-2] in available:
            self.array = field[:-2]
        if self.array not in available:
            speed = ["speed"] if "velocity" in available else []
            raise ResultsError(f"{folder} has no field {field}. There are: {', '.join(speed + available)}.")
        self.needed = {name for name in (self.array, "velocity", "size", "J", "body", "displacement") if name in available}
        if self.magnify != 1. and "displacement" not in available:
            raise ResultsError(f"--magnify needs the field displacement, which {folder}/points.pvd lacks.")
        self.is_body = field == "body"
        self.unit = pretty(self.run.unit("points.pvd", self.array))
        self.label = field.replace("_", " ").replace("von mises", "von Mises stress")
        self.find_ranges()

    def load(self, k):
        """Positions, values and diameters at the kth time; the mean speed as well."""
        points = self.run.points(k, self.needed)
        if not len(points.x):
            raise ResultsError(f"{points.path} has no points.")
        x = points.x
        if self.magnify != 1.:
            x = x + (self.magnify - 1.) * points["displacement"]
        speed = np.linalg.norm(points["velocity"], axis=1).mean() if "velocity" in points else 0.
        value = points.component(self.component)
        if self.is_body:
            value = value % len(BODY_COLOURS)
        self.body = points["body"].astype(int) if "body" in points else np.zeros(len(x), int)
        return x, value, self.run.sizes(k, points), speed

    def rigid_facets(self, k):
        """Corners of the facets of each rigid body at the kth time."""
        result = []
        for name in self.run.rigid_bodies if self.has_rigid_bodies else []:
            facets, fields = self.run.rigid(name, self.times[k])
            result.append(facets + (self.magnify - 1.) * fields["displacement"].reshape(facets.shape))
        return result

    def with_rigid_bodies(self, lower, upper):
        """Limits of bodies with room for rigid ones. Those without an end, which are cut beyond the grid, have little."""
        room, (low, high) = (upper - lower).max(), (lower, upper)
        ends = [np.r_[end, [0.] * (3 - self.dim)] for end in self.run.grid_box or (lower[:self.dim], upper[:self.dim])]
        for k in range(len(self.times)):
            for name, facets in zip(self.run.rigid_bodies, self.rigid_facets(k)):
                if not len(facets):
                    continue
                least, most = facets.min(axis=(0, 1)), facets.max(axis=(0, 1))
                if re.search("half_space|level_set|[<>]", self.parameters.get(f"Rigid body {name}/Shape", "")):
                    least = np.where(least < ends[0], lower - 0.1 * room, least)
                    most = np.where(most > ends[1], upper + 0.1 * room, most)
                low, high = np.minimum(low, np.maximum(least, lower - room)), np.maximum(high, np.minimum(most, upper + room))
        return low, high

    def find_ranges(self):
        """Limits and range of colours, which are the same at all times, and mean speeds."""
        lower, upper, ranges, self.mean_speed = [], [], [], []
        for k in range(len(self.times)):
            x, value, diameter, speed = self.load(k)
            lower.append((x - diameter[:, None] / 2).min(axis=0))
            upper.append((x + diameter[:, None] / 2).max(axis=0))
            ranges.append((*np.percentile(value, parts_in_range(self.component)), value.min(), value.max()))
            if k == 0:
                # In 2D lines around all bodies but the largest tell them from it, whatever the colours of points are.
                counts = np.bincount(self.body)
                several = self.dim == 2 and not self.is_body and np.count_nonzero(counts) > 1
                self.outlined = [b for b in np.flatnonzero(counts) if b != counts.argmax()] if several else []
            self.mean_speed.append(speed)
        lower, upper = np.min(lower, axis=0), np.max(upper, axis=0)
        self.surface = read_reference(self.run, "Surface file") if self.dim == 2 else None
        self.failure_line = read_reference(self.run, "Failure line file") if self.dim == 2 else None
        if self.surface:
            upper[:2] = np.maximum(upper[:2], [self.surface[0].max(), self.surface[1].max()])
        lower, upper = self.with_rigid_bodies(lower, upper)
        margin = 0.04 * (upper - lower).max()
        lower, upper = lower - margin, upper + margin
        self.domain = np.array(self.run.grid_box) if self.run.grid_box else None
        # In total Lagrangian steps bodies may leave the grid.
        self.is_bounded = self.domain is not None and self.parameters.get("Scheme/Formulation") != "total Lagrangian" \
            and self.magnify == 1.
        if self.is_bounded:
            d = self.dim
            lower[:d] = np.maximum(lower[:d], self.domain[0] - 0.45 * margin)
            upper[:d] = np.minimum(upper[:d], self.domain[1] + 0.45 * margin)
        self.lower, self.upper, self.clip = lower, upper, None
        if self.is_bounded and self.dim == 2:
            # Nothing is drawn beyond a wall.
            held = [kind not in ("free", "periodic") for kind in self.run.walls.values()]
            self.clip = np.array([np.where(held[0::2], self.domain[0], lower[:2]), np.where(held[1::2], self.domain[1], upper[:2])])

        ranges = np.array(ranges)
        low, high, self.colours = ranges[:, 0].min(), ranges[:, 1].max(), "viridis"
        if self.is_body:
            n = len(BODY_COLOURS)
            low, high, self.colours = -0.5, n - 0.5, matplotlib.colors.ListedColormap(BODY_COLOURS)
        elif self.component in ("speed", "velocity", "displacement"):
            low = 0.
        elif low < 0 < high and min(-low, high) > 0.1 * max(-low, high):
            low, high, self.colours = -max(-low, high), max(-low, high), "RdBu_r"
        low, high = range_of_colours(self.component, low, high)
        if high - low <= 1e-9 * max(abs(high), abs(low), 1e-300):
            low, high = low - 0.1 * abs(low), high + (0.1 * abs(high) or 1.)
        self.extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[
            bool(ranges[:, 2].min() < low - 0.01 * (high - low)), bool(ranges[:, 3].max() > high + 0.01 * (high - low))]
        power = next((n for n in (3, 2, 1) if max(-low, high) >= 10**(3 * n)), 0) if self.unit == "Pa" else 0
        self.scale, self.unit = 10.**(-3 * power), ["", "k", "M", "G"][power] + self.unit
        self.limits_of_colours = low * self.scale, high * self.scale

    @property
    def norm(self):
        """A new one for each artist: figures that are gone leave nothing behind."""
        return plt.Normalize(*self.limits_of_colours)

    def title(self, k):
        return f"$t$ = {self.times[k]:.{self.decimals}f} s"

    def four_times(self):
        """Beginning, end, and two between at equal parts of the way that points have gone."""
        n, speed = len(self.times), np.array(self.mean_speed)
        way = np.concatenate([[0.], np.cumsum((speed[1:] + speed[:-1]) * np.diff(self.times))])
        if n <= 4 or way[-1] == 0:
            return sorted({round(part * (n - 1) / 3) for part in range(4)})
        return sorted({0, n - 1} | {int(np.argmin(abs(way - part * way[-1] / 3))) for part in (1, 2)})


# Points.

def add_axes(figure, position, simulation, mesh=False, labels="xy"):
    """Axes at a position in inches, with limits and labels of the simulation."""
    box = np.array(position) / np.tile(figure.get_size_inches(), 2)
    lower, upper = simulation.lower, simulation.upper
    if simulation.dim == 3:
        axes = figure.add_axes(box, projection="3d", proj_type="ortho")
        order = axes_order(simulation)
        for k, name in enumerate("xyz"):
            limits = (lower[order[k]], upper[order[k]])
            axes.set(**{name + "lim": limits[::-1] if order == [0, 2, 1] and k == 1 else limits})
            axis = getattr(axes, name + "axis")
            axis.set_label_text(f"${'xyz'[order[k]]}$, m")
            axis.labelpad = (0, 0, -5)[k]
            axis.set_tick_params(pad=-2)
            # Short axes have room for few labels, or for one.
            part = (upper - lower)[order[k]] / (upper - lower).max()
            locator = plt.MaxNLocator(int(np.clip(round(4 * part), 1, 4 if k == 0 else 3)), steps=[1, 2, 5, 10])
            if part < 0.3:
                places = locator.tick_values(*sorted(limits))
                locator = plt.FixedLocator(places[places <= max(limits)][-1:])
            axis.set_major_locator(locator)
            axis.set_pane_color((0.96, 0.96, 0.96, 1.))
            axis._axinfo["grid"].update(color="0.85", linewidth=0.5)
        axes.view_init(elev=22, azim=-62)
        fit_box(axes, (upper - lower)[order], position[2:])
        return axes
    axes = figure.add_axes(box, xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), aspect="equal",
                           xlabel="$x$, m" if "x" in labels else "", ylabel="$y$, m" if "y" in labels else "")
    width = min(position[2], position[3] * (upper[0] - lower[0]) / (upper[1] - lower[1]))
    axes.xaxis.set_major_locator(plt.MaxNLocator(int(np.clip(width / 0.3, 1, 6)), steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(plt.MaxNLocator(int(np.clip(position[3] / 0.2, 1, 4)), steps=[1, 2, 5, 10],
                                             min_n_ticks=2))
    axes.tick_params(labelbottom="x" in labels, labelleft="y" in labels)
    for axis, is_shown in ((axes.xaxis, "x" in labels), (axes.yaxis, False)):
        if is_shown:
            keep_apart(axis)
    draw_walls(axes, simulation)
    if mesh and simulation.domain is not None:
        for d, draw in enumerate((axes.axvline, axes.axhline)):
            cells = int(simulation.parameters["Grid/Cells"].split(",")[d])
            for x in np.linspace(*simulation.domain[:, d], cells + 1):
                draw(x, color="0.85", linewidth=0.4, zorder=0)
    return axes


def fit_box(axes, size, inches):
    """The largest box of this shape that fits into so many inches with its labels."""
    axes.set_box_aspect(size)
    axes.figure.canvas.draw()
    corners = np.array([[limits[(k >> d) & 1] for d, limits in enumerate((axes.get_xlim(), axes.get_ylim(), axes.get_zlim()))]
                        for k in range(8)])
    projected = np.c_[corners, np.ones(8)] @ axes.get_proj().T
    pixels = axes.transData.transform(projected[:, :2] / projected[:, 3:])
    room = (np.array(inches) - [0.5, 0.65]) * axes.figure.dpi
    axes.set_box_aspect(size, zoom=float((room / np.ptp(pixels, axis=0)).min()))


def keep_apart(axis):
    """The last label of an x axis ends within it, away from the first one of the next panel."""
    low, high = sorted(axis.get_view_interval())
    places = [place for place in axis.get_majorticklocs() if low <= place <= high]
    axis.set_ticks(places)
    for tick, place in zip(axis.get_major_ticks(), places):
        part = (place - low) / (high - low)
        if part > 0.92:
            tick.label1.set_horizontalalignment("right")


def draw_walls(axes, simulation):
    """A line along each side of the grid where there is a wall, and hatching behind it."""
    if simulation.domain is None or simulation.magnify != 1.:
        return
    (x0, y0), (x1, y1) = simulation.domain
    lower, upper = simulation.lower, simulation.upper
    sides = {"Left": (lower[0], y0, x0, y1), "Right": (x1, y0, upper[0], y1),
             "Bottom": (x0, lower[1], x1, y0), "Top": (x0, y1, x1, upper[1])}
    for name, kind in simulation.run.walls.items():
        left, low, right, high = sides[name]
        if kind in ("free", "periodic") or right <= left or high <= low:
            continue
        axes.add_patch(plt.Rectangle((left, low), right - left, high - low, facecolor="none", edgecolor="0.6",
                                     hatch="//////", linewidth=0., zorder=0))
        line = {"Left": ((x0, x0), (y0, y1)), "Right": ((x1, x1), (y0, y1)),
                "Bottom": ((x0, x1), (y0, y0)), "Top": ((x0, x1), (y1, y1))}[name]
        axes.plot(*line, color="0.3", linewidth=1.4, zorder=3, solid_capstyle="butt")


def axes_order(simulation):
    """The axes of a view from above: that which gravity follows most, by the first numbers in its formulas, is the last."""
    gravity = simulation.parameters.get("Loads/Gravity", "").split(";")
    found = [re.search(r"\d+\.?\d*", text) for text in gravity]
    sizes = [float(number.group()) if number else 1. if text.strip() else 0. for number, text in zip(found, gravity)]
    up = max(range(len(sizes)), key=lambda d: (sizes[d], d)) if any(sizes) else 1
    return [[1, 2, 0], [0, 2, 1], [0, 1, 2]][up]


def draw_points(axes, simulation, k):
    x, value, diameter, _ = simulation.load(k)
    value = value * simulation.scale
    if simulation.dim == 3:
        colours = plt.get_cmap(simulation.colours)(simulation.norm(value))[:, :3]
        order = axes_order(simulation)
        facets = np.concatenate([np.zeros((0, 3, 3))] + simulation.rigid_facets(k))
        draw_spheres(axes, x[:, order], diameter, colours, facets[:, :, order], (simulation.lower[order], simulation.upper[order]))
        return
    # Circles of the volume would leave gaps, and where bodies are sheared larger ones as well.
    inner = is_inside(simulation, x, diameter)
    for mine, factor in ((inner, 3.4), (slice(None), 1.7)):
        size = factor * diameter[mine]
        circles = EllipseCollection(size, size, np.zeros(len(size)), units="xy", offsets=x[mine, :2], array=value[mine],
                                    cmap=simulation.colours, norm=simulation.norm, linewidths=0)
        circles.set_offset_transform(axes.transData)
        axes.add_collection(circles)
        if simulation.clip is not None:
            circles.set_clip_path(plt.Rectangle(simulation.clip[0], *(simulation.clip[1] - simulation.clip[0]),
                                                transform=axes.transData))
    draw_outlines(axes, simulation, x, diameter)
    for segments in simulation.rigid_facets(k):
        if len(segments):
            axes.add_patch(plt.matplotlib.patches.PathPatch(loops_of(segments), facecolor="0.78", edgecolor="0.35", linewidth=0.8, zorder=2.2))


def loops_of(segments):
    """The closed lines that segments, which have the inside on their left, make of one after the other."""
    ends = [tuple(map(tuple, segment[:, :2])) for segment in segments]
    following, corners, codes = dict(ends), [], []
    while following:
        start, place = following.popitem()
        loop = [start]
        while place != start and place in following:
            loop.append(place)
            place = following.pop(place)
        corners += loop + [start]
        codes += [Outline.MOVETO] + [Outline.LINETO] * (len(loop) - 1) + [Outline.CLOSEPOLY]
    return Outline(corners, codes)


def draw_outlines(axes, simulation, x, diameter):
    """Lines around bodies, where the part of squares that their points fill is a half."""
    for b in simulation.outlined:
        mine = simulation.body == b
        if not mine.any():
            continue
        width = np.median(diameter[mine])
        edges = [np.arange(low - 4 * width, high + 5 * width, width) for low, high in
                 zip(x[mine, :2].min(axis=0), x[mine, :2].max(axis=0))]
        area = np.histogram2d(*x[mine, :2].T, bins=edges, weights=diameter[mine]**2)[0] / width**2
        smooth = sum(np.roll(area, (i - 2, j - 2), axis=(0, 1)) for i, j in np.ndindex(5, 5)) / 25
        centers = [(edge[1:] + edge[:-1]) / 2 for edge in edges]
        axes.contour(*centers, smooth.T, levels=[0.5], colors="white", linewidths=2.2, zorder=2.4)
        axes.contour(*centers, smooth.T, levels=[0.5], colors=[BODY_COLOURS[(b + 1) % len(BODY_COLOURS)]], linewidths=1.1, zorder=2.5)


def is_inside(simulation, x, diameter):
    """Points that have others, or walls, around them in all squares of three and a half of the usual diameters."""
    width = 3.5 * np.median(diameter)
    origin = simulation.domain[0] if simulation.domain is not None else x[:, :2].min(axis=0)
    place = np.maximum(np.floor((x[:, :2] - origin) / width).astype(int) + 1, 1)
    filled = np.zeros(place.max(axis=0) + 2, bool)
    filled[tuple(place.T)] = True
    if simulation.domain is not None:
        beyond = np.floor((simulation.domain[1] - origin) / width).astype(int) + 2
        for name, squares in {"Left": np.s_[0], "Right": np.s_[beyond[0]:], "Bottom": np.s_[:, 0], "Top": np.s_[:, beyond[1]:]}.items():
            if simulation.run.walls[name] not in ("free", "periodic"):
                filled[squares] = True
    result = np.ones(len(x), bool)
    for i, j in np.ndindex(3, 3):
        result &= filled[place[:, 0] + i - 1, place[:, 1] + j - 1]
    return result


def places_in(triangles, spacing):
    """Weights of corners at places in triangles that are no further apart, with the triangles, of which there are few at a time."""
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1, initial=0.)
    numbers = np.ceil(longest / spacing).astype(int) + 1
    for n in np.unique(numbers):
        i, j = np.nonzero(np.add.outer(range(n + 1), range(n + 1)) <= n)
        mine = np.flatnonzero(numbers == n)
        for part in np.array_split(mine, -(-len(mine) * len(i) // 300000)):
            yield np.c_[i, j, n - i - j] / n, part


def draw_spheres(axes, x, diameter, colours, facets, limits, sampling=2):
    """Spheres, and grey triangles within limits, with a depth buffer, which matplotlib lacks, as an image over the axes."""
    axes.figure.canvas.draw()
    matrix = axes.get_proj()
    scale = sampling * (axes.transData.transform([1., 0.]) - axes.transData.transform([0., 0.]))[0]

    def view(x):
        """Pixels and, towards the eye, depth in pixels."""
        projected = np.c_[x, np.ones(len(x))] @ matrix.T / matrix[3, 3]   # Without perspective.
        return np.c_[sampling * axes.transData.transform(projected[:, :2]), -scale * projected[:, 2]]

    points = view(x)
    radius = np.maximum(0.65 * diameter * scale * np.linalg.norm(matrix[:3, 0]) / matrix[3, 3], 1.)
    order = np.argsort(points[:, 2])   # The nearest is written last.
    pixel, depth, radius, colours = points[order, :2], points[order, 2], radius[order], colours[order]
    seen = view(facets.reshape(-1, 3)).reshape(-1, 3, 3)
    box = view(np.array([[limits[(k >> d) & 1][d] for d in range(3)] for k in range(8 * bool(len(facets)))]).reshape(-1, 3))
    toward = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    toward *= np.where(toward[:, 2:] < 0, -1., 1.) / np.maximum(np.linalg.norm(toward, axis=1, keepdims=True), 1e-300)

    # Pixels that points and triangles cover, and the nearest of these.
    reach = int(np.ceil(radius.max()))
    every = np.r_[pixel, box[:, :2]]
    origin = (every.min(axis=0) // sampling).astype(int) - reach - 10
    pixel = pixel - sampling * origin
    corner = pixel.astype(int)
    width, height = sampling * (((every.max(axis=0) - sampling * origin).astype(int) + reach + 20) // sampling)
    nearest, owner = np.full(width * height, -np.inf), np.full(width * height, -1)
    for weights, part in places_in(seen, 0.8):
        places, sample = weights @ facets[part], weights @ seen[part]
        inside = ((places >= limits[0]) & (places <= limits[1])).all(axis=2)
        sample, mine = sample[inside], np.broadcast_to(part[:, None], inside.shape)[inside]
        order = np.argsort(sample[:, 2])
        place, z = (sample[order, :2] - sampling * origin).astype(int) @ [1, width], sample[order, 2]
        wins = z > nearest[place]
        nearest[place[wins]], owner[place[wins]] = z[wins], len(x) + mine[order][wins]
    for i, j in np.ndindex(2 * reach + 1, 2 * reach + 1):
        place = corner + [i - reach, j - reach]
        z = radius**2 - ((place + 0.5 - pixel)**2).sum(axis=1)
        inside = np.flatnonzero(z > 0)
        place, z = place[inside] @ [1, width], depth[inside] + np.sqrt(z[inside])
        wins = z > nearest[place]
        nearest[place[wins]], owner[place[wins]] = z[wins], inside[wins]

    # Light from the upper left; darker where something near stands in front.
    place = np.flatnonzero(owner >= 0)
    mine = owner[place]
    normal, is_point = np.zeros((len(place), 3)), mine < len(x)
    points = mine[is_point]
    offsets = np.c_[place % width, place // width][is_point] + 0.5 - pixel[points]
    normal[is_point] = np.c_[offsets, nearest[place[is_point]] - depth[points]] / radius[points, None]
    normal[~is_point] = toward[mine[~is_point] - len(x)]
    colours = np.r_[colours, np.full((len(facets), 3), 0.78)]
    light = 0.72 + 0.28 * np.clip(normal @ [-0.4, 0.6, 0.7], 0., 1.)
    nearest = nearest.reshape(height, width)
    hidden, own = np.zeros_like(nearest), np.where(np.isinf(nearest), np.inf, nearest)
    for step in (2, 5, 10):
        for shift in ((step, 0), (-step, 0), (0, step), (0, -step)):
            rise = np.roll(nearest, shift, axis=(0, 1)) - own
            hidden += np.clip(rise / np.median(radius) - 0.5, 0., 3.) / 12
    image = np.zeros((height * width, 4))
    image[place, :3] = colours[mine] * (light * np.exp(-0.7 * hidden.ravel()[place]))[:, None]
    image[place, 3] = 1.
    image = image.reshape(height // sampling, sampling, width // sampling, sampling, 4).mean(axis=(1, 3))
    image[..., :3] /= np.maximum(image[..., 3:], 1e-9)
    axes.figure.figimage(np.clip(image, 0., 1.), *origin, origin="lower", zorder=5)


def add_colour_bar(figure, position, simulation):
    """Or a legend of the bodies."""
    if simulation.is_body:
        handles = [plt.Line2D([], [], marker="o", linestyle="", markersize=6, color=BODY_COLOURS[k % len(BODY_COLOURS)],
                              label=name.replace("_", " ")) for k, name in enumerate(simulation.run.bodies)]
        width, height = figure.get_size_inches()
        figure.legend(handles=handles, loc="upper left", bbox_to_anchor=((position[0] - 0.15) / width, (position[1] + position[3]) / height),
                      handletextpad=0.1, borderaxespad=0.)
        return
    axes = figure.add_axes(np.array(position) / np.tile(figure.get_size_inches(), 2))
    bar = figure.colorbar(plt.cm.ScalarMappable(simulation.norm, simulation.colours), cax=axes,
                          extend=simulation.extend)
    bar.set_label(simulation.label + (f", {simulation.unit}" if simulation.unit else ""))
    bar.locator = plt.MaxNLocator(5)
    bar.formatter.set_powerlimits((-2, 4))
    bar.outline.set_linewidth(0.5)
    bar.update_ticks()
    if simulation.outlined:
        handles = [plt.Line2D([], [], color=BODY_COLOURS[(b + 1) % len(BODY_COLOURS)], label=simulation.run.bodies[b].replace("_", " "))
                   for b in simulation.outlined]
        width, height = figure.get_size_inches()
        figure.legend(handles=handles, loc="upper left", handlelength=1., handletextpad=0.4, borderaxespad=0.,
                      bbox_to_anchor=((position[0] - 0.1) / width, (position[1] - 0.15) / height))


def panel_ratio(simulation):
    size = simulation.upper - simulation.lower
    return 0.78 if simulation.dim == 3 else min(max(size[1] / size[0], 0.1), 3.)


def frame(simulation, k, mesh=False):
    """The figure of the kth time."""
    ratio = panel_ratio(simulation)
    width = min(5.6, 6. / ratio)
    height = max(width * ratio, 1.2)
    figure = plt.figure(figsize=(width + 1.8, height + 0.9), dpi=120)
    axes = add_axes(figure, (0.65, 0.5, width, height), simulation, mesh)
    draw_points(axes, simulation, k)
    figure.text(0.65 / (width + 1.8), 1 - 0.22 / (height + 0.9),
                f"{simulation.title_of_run},  {simulation.title(k)}", va="center")
    inset = 0.5 * (height - min(height, 3.))
    add_colour_bar(figure, (width + (1.05 if simulation.dim == 3 else 0.8), 0.5 + inset, 0.13, height - 2 * inset),
                   simulation)
    plt.close(figure)   # Figures that are kept open would be shown by notebooks, too.
    return figure


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
    """The Picture of the kth time of a run; options are those of Simulation."""
    need_libraries()
    with plt.rc_context(STYLE):
        simulation = Simulation(run.folder, **options)
        return Picture(frame(simulation, k, mesh))


def draw_frames(simulation, mesh):
    folder = simulation.folder / "frames"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("frame_*.png"):
        old.unlink()
    pictures = []
    for k in range(len(simulation.times)):
        pictures.append(folder / f"frame_{k:04d}.png")
        frame(simulation, k, mesh).savefig(pictures[-1])
    print(f"{folder}/frame_0000.png to {pictures[-1].name}")

    # One palette for all: the colours of points, in 3D in four shades, those of bodies, and grey.
    shades = np.array([1., 0.87, 0.74, 0.6] if simulation.dim == 3 else [1.])
    colours = plt.get_cmap(simulation.colours)(np.linspace(0, 1, 224 // len(shades)))[:, :3]
    colours = np.r_[(shades[:, None, None] * colours).reshape(-1, 3), matplotlib.colors.to_rgba_array(BODY_COLOURS)[:, :3], np.linspace([0.] * 3, [1.] * 3, 24)]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.rint(255 * colours).astype(int).ravel().tolist())
    images = [Image.open(name).convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE)
              for name in pictures]
    duration = int(np.clip(6000 / len(images), 40, 400))
    images[0].save(simulation.folder / "animation.gif", save_all=True, append_images=images[1:], loop=0,
                   duration=[duration] * (len(images) - 1) + [1500])
    print(simulation.folder / "animation.gif")


# Lines.

def draw_failure_lines(axes, simulation, k):
    """The measured one, and where points of the run have moved by Reference/Failure displacement."""
    # White lines with dark edges can be seen on all colours and beside them.
    style = {"color": "white", "linewidth": 1.3,
             "path_effects": [patheffects.Stroke(linewidth=2.2, foreground="0.2"), patheffects.Normal()]}
    axes.plot(*simulation.failure_line[:2], linestyle=(0, (3, 2)), label="its failure line", **style)
    if "displacement" in simulation.needed:
        x, _, diameter, _ = simulation.load(k)
        moved = np.linalg.norm(simulation.run.points(k, ["displacement"])["displacement"], axis=1)
        triangles = Triangulation(*x[:, :2].T)
        corners = x[triangles.triangles, :2]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        triangles.set_mask(edges > 4. * np.median(diameter))   # Those across the air and along walls.
        contour = axes.tricontour(triangles, moved, colors="white", linewidths=style["linewidth"],
                                  levels=[float(simulation.parameters["Reference/Failure displacement"])])
        for lines in contour.collections:
            lines.set_path_effects(style["path_effects"])
        axes.plot([], [], label="that of the run", **style)


def draw_series(axes, simulation, series):
    """A column of statistics.csv and its measured values."""
    quantity = simulation.parameters["Reference/Series quantity"]
    labels = [f"{label}, {pretty(simulation.run.unit('statistics.csv', column))}"
              for label, column in (("time", "time"), (quantity.replace("_", " "), quantity))]
    axes.plot(simulation.statistics["time"], simulation.statistics[quantity], color=COLOURS[0], label="simulation")
    axes.plot(*series[:2], "o", color="black", markerfacecolor="white", markersize=5, label=series[2])
    axes.set(xlabel=labels[0], ylabel=labels[1])


def draw_energies(axes, simulation):
    """Energies, and the work of all that is none of them."""
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


def label_energy(axes, name, run):
    """Ticks of at most four digits, and the unit that fits them."""
    largest = max(map(abs, axes.get_ylim()))
    power = min(3, max(-3, math.floor(math.log10(largest) / 3))) if largest > 0 else 0
    prefix = {-3: "n", -2: "\u00b5", -1: "m", 0: "", 1: "k", 2: "M", 3: "G"}[power]
    axes.yaxis.set_major_formatter(lambda value, _: f"{value / 1000.**power:g}")
    unit = pretty(run.unit("statistics.csv", "kinetic")) or ("J" if "center_z" in run.statistics else "J/m")
    axes.set_ylabel(f"{name}, {prefix}{unit}")


def add_legend(axes):
    """Above the axes, where there are no lines; of so many columns that it fits."""
    handles, labels = axes.get_legend_handles_labels()
    columns = len(labels)
    while columns > 1 and sum(sorted(map(len, labels))[-columns:]) + 8 * columns > 110:
        columns -= 1
    axes.legend(handles, labels, loc="lower left", bbox_to_anchor=(0., 1.), ncol=columns, borderaxespad=0.2, columnspacing=1.4)


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
        axes = add_axes(figure, (left, low, width, height), simulation, mesh,
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
    """Positions and increments of displacement of the points of the last two states of a ramp, m."""
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
    ratio = panel_ratio(simulation)
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


def draw_all_energies(folders, place):
    """Kinetic and total energy of several runs."""
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 2.9 + 0.17 * (len(folders) // 3)), dpi=200)
    for k, folder in enumerate(folders):
        run = Run(folder)
        statistics = run.statistics
        for axis, name in zip(axes, ("kinetic", "total")):
            axis.plot(statistics["time"], statistics[name], LINES[k // len(COLOURS) % len(LINES)],
                      color=COLOURS[k % len(COLOURS)], label=folder.resolve().name.replace("_", " "))
            axis.set(xlabel="time, s")
            label_energy(axis, f"{name} energy", run)
            axis.margins(x=0)
    columns = min(3, len(folders))
    room = 0.2 * -(-len(folders) // columns) + 0.1
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=columns)
    figure.tight_layout(rect=(0, room / figure.get_figheight(), 1, 1))
    figure.savefig(place / "energies.png")
    print(place / "energies.png")


def draw_convergence(folder):
    table = read_table(folder / "convergence.csv")
    p, cells, error = (table[name] for name in ("p", "cells", "error_l2"))
    kinds = list(zip(table["formulation"], table["mass"], table["quadrature"]))
    # What is the same for all rows needs no label.
    told = [k for k in range(3) if len({kind[k] for kind in kinds}) > 1] or [1]
    names, orders = list(dict.fromkeys(kinds)), sorted(set(p.astype(int)))
    figure, axes = plt.subplots(figsize=(5.4, 3.8), dpi=200)
    for m, order in enumerate(orders):
        colour = COLOURS[m % len(COLOURS)]
        best = []
        for n, name in enumerate(names):
            mine = [k for k in range(len(p)) if kinds[k] == name and p[k] == order and error[k] > 0]
            mine.sort(key=lambda k: cells[k])
            if mine:
                label = ", ".join([name[k] for k in told] + [f"$p$ = {order}"])
                axes.plot(cells[mine], error[mine], "os^Dv"[n % 5] + LINES[n % len(LINES)],
                          color=colour, markersize=4.5, markerfacecolor="white", label=label)
                best.append((error[mine[0]], cells[mine]))
        if best:
            first, x = min(best, key=lambda pair: pair[0])
            axes.plot(x, 0.6 * first * (x / x[0])**-(order + 1.), ":", color=colour, linewidth=0.9)
    axes.plot([], [], ":", color="0.4", linewidth=0.9, label="order $p$ + 1")
    axes.set(xscale="log", yscale="log", xlabel="cells", ylabel="relative $L_2$ error of the displacement")
    axes.set_xticks(sorted(set(cells)), [f"{int(n)}" for n in sorted(set(cells))])
    axes.minorticks_off()
    axes.grid(True, color="0.9", linewidth=0.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    figure.savefig(folder / "convergence.png")
    print(folder / "convergence.png")


def variant(row):
    parts = [row["solver"], row["cycle"], row["smoother"]]
    return ", ".join(part for part in parts if part)


def draw_solves(folder):
    rows = [row for row in read_table(folder / "solves.csv").rows() if row["converged"] == 1]
    if not rows:
        raise ResultsError(f"{folder}/solves.csv has no solve that converged.")

    # The finest mesh of the largest dimension.
    dim = max(int(row["dim"]) for row in rows)
    rows = [row for row in rows if int(row["dim"]) == dim]
    cells = max(int(row["cells"]) for row in rows)
    rows = [row for row in rows if int(row["cells"]) == cells]

    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    styles = ["o-", "s--", "^:", "D-.", "v-", "x--"]
    for k, name in enumerate(dict.fromkeys(variant(row) for row in rows)):
        style = styles[k % len(styles)]
        mine = sorted((r for r in rows if variant(r) == name), key=lambda r: int(r["p"]))
        orders = [int(row["p"]) for row in mine]
        if all(isinstance(row["iterations"], float) and row["iterations"] > 0 for row in mine):
            axes[0].plot(orders, [int(row["iterations"]) for row in mine], style, label=name)
        cost = [
            1e9 * (float(row["assembly_s"]) + float(row["setup_s"]) + float(row["solve_s"]))
            / int(row["unknowns"])
            for row in mine
        ]
        axes[1].plot(orders, cost, style, label=name)
    axes[0].set_ylabel("iterations")
    axes[1].set_ylabel("time per unknown, ns")
    for axis in axes:
        axis.set_yscale("log")
        axis.set_xlabel("order p")
        axis.xaxis.get_major_locator().set_params(integer=True)
        axis.grid(True, which="both", alpha=0.3)
    axes[1].legend(fontsize=8)
    figure.suptitle(f"{folder.name}: {dim}D, {cells} cells per direction, processes: {int(rows[0]['processes'])}")
    figure.tight_layout()
    figure.savefig(folder / "solves.png", dpi=110)
    print(folder / "solves.png")


def draw_element_test(folder):
    table = read_table(folder / "element_test.csv")
    # The strain that grows most is the one that the test controls.
    axial, shear = table["strain_axial"], table["strain_shear"]
    is_shear = np.ptp(shear) > 1.5 * np.ptp(axial)
    strain, label = (shear, "shear strain") if is_shear else (axial, "axial strain")
    p, q, u = table["p"] / 1e3, table["q"] / 1e3, table["pore_pressure"] / 1e3
    figure, axes = plt.subplots(2, 2, figsize=(8, 6.4))
    axes[0, 0].plot(p, q, color=COLOURS[0], label="effective")
    if np.ptp(u) > 0.:
        axes[0, 0].plot(p + u, q, LINES[1], color=COLOURS[1], label="total")
        axes[0, 0].legend()
    axes[0, 0].plot(p[:1], q[:1], "o", color=COLOURS[0], markersize=4)
    axes[0, 0].set(xlabel="p, kPa", ylabel="q, kPa")
    axes[0, 1].plot(strain, q, color=COLOURS[0])
    axes[0, 1].set(xlabel=label, ylabel="q, kPa")
    if np.ptp(u) > 0.:
        axes[1, 0].plot(strain, u, color=COLOURS[0])
        axes[1, 0].set(xlabel=label, ylabel="pore pressure, kPa")
    else:
        axes[1, 0].plot(strain, table["strain_volumetric"], color=COLOURS[0])
        axes[1, 0].set(xlabel=label, ylabel="volumetric strain (compression)")
    axes[1, 1].plot(p, table["void_ratio"], color=COLOURS[0])
    axes[1, 1].plot(p[:1], table["void_ratio"][:1], "o", color=COLOURS[0], markersize=4)
    axes[1, 1].set(xlabel="p, kPa", ylabel="void ratio e")
    if p.min() > 0.:
        axes[1, 1].set_xscale("log")
        plain = FormatStrFormatter("%g")
        axes[1, 1].xaxis.set_major_formatter(plain)
        axes[1, 1].xaxis.set_minor_formatter(plain)
    for axis in axes.flat:
        axis.grid(True, which="both", alpha=0.3)
    figure.suptitle(folder.name)
    figure.tight_layout()
    figure.savefig(folder / "element_test.png", dpi=110)
    print(folder / "element_test.png")


def main(program=None):
    parser = parser_of(program, __doc__)
    parser.add_argument("--field", metavar="NAME",
                        help="colour of points: speed, a field of points.pvd, such as pressure, von_mises, "
                             "plastic_strain or body, or a component of a vector, such as velocity_x. "
                             "Without it: plastic_strain of soil that yields, and else speed")
    parser.add_argument("--no-rigid-bodies", action="store_true",
                        help="leave rigid bodies out, which may hide the others (3D)")
    parser.add_argument("--magnify", type=float, default=1., metavar="FACTOR",
                        help="draw displacements this many times as large")
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
    elif (folder / "points.pvd").exists():
        simulation = Simulation(folder, arguments.field, arguments.magnify, not arguments.no_rigid_bodies)
        draw_picture(simulation, arguments.mesh)
        if (folder / "failure" / "points.pvd").exists() and "ramp" in simulation.run.summary:
            draw_failure(simulation)
        draw_frames(simulation, arguments.mesh)
    elif (folder / "convergence.csv").exists():
        draw_convergence(folder)
    else:
        runs = runs_in(folder)
        if not runs:
            raise ResultsError(f"{folder} has nothing to draw: no points.pvd, convergence.csv, solves.csv or */statistics.csv.")
        draw_all_energies(runs, folder)
