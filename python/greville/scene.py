"""Draws the points of a simulation at a time in axes of matplotlib, and the frame of an animation."""
import sys
from numbers import Real

from .drawing import (BODY_COLOURS, LABELS_3D, EllipseCollection, draw_spheres, fit_box, keep_apart, matplotlib, np, outline_of, plt)
from .display import (array_of, check_field, main_field, parts_in_range, range_of_colours, room_for_rigid_bodies, up_axis)
from .results import ResultsError, Run, pretty


def read_reference(run, name):
    """Return measured data of a run; print a note if they are missing."""
    found = run.reference(name)
    if not found and run.parameters.get("Reference/" + name):
        print(f"{run.folder}: no measured data: there is no {run.parameters['Reference/' + name]}.", file=sys.stderr)
    return found


class Simulation:
    """A run with the colours and limits of its pictures."""

    def __init__(self, folder, field=None, magnify=1., rigid_bodies=True, up=None):
        if not isinstance(magnify, Real) or not np.isfinite(magnify):
            raise ResultsError(f"magnify has to be a finite number, not {magnify!r}.")
        self.run, self.magnify, self.has_rigid_bodies = Run(folder), magnify, rigid_bodies
        self.folder, self.title_of_run = folder, self.run.title
        self.times, self.dim, self.parameters = np.asarray(self.run.times), self.run.dim, self.run.parameters
        span = np.ptp(self.times) or abs(self.times[-1]) or 1.
        self.decimals = max(0, 2 - int(np.floor(np.log10(span))))
        self.statistics = self.run.statistics if (folder / "statistics.csv").exists() else None

        available = self.run.point_fields
        field = field or main_field(self.run)
        self.array, self.component = None, field
        if field:
            check_field(self.run, field)
            self.array = array_of(self.run, field)
        self.needed = {name for name in (self.array, "velocity", "size", "J", "body", "displacement") if name in available}
        if self.magnify != 1. and "displacement" not in available:
            raise ResultsError(f"--magnify needs the field displacement, which the points in {folder} lack.")
        self.is_body = field == "body"
        self.unit = pretty(self.run.unit("points", self.array))
        self.label = (field or "").replace("_", " ").replace("von mises", "von Mises stress")
        self.up = up_axis(self.run, up) if self.dim == 3 else 1
        self.find_ranges()

    def load(self, k):
        """Return positions, values and diameters at the kth time, and the mean speed."""
        points = self.run.points(k, self.needed)
        if not len(points.x):
            raise ResultsError(f"{points.path} has no points.")
        x = points.x
        if self.magnify != 1.:
            x = x + (self.magnify - 1.) * points["displacement"]
        speed = np.linalg.norm(points["velocity"], axis=1).mean() if "velocity" in points else 0.
        # A field that does not exist yet has no values.
        value = np.nan_to_num(points.component(self.component)) if self.component else np.zeros(len(x))
        if self.is_body:
            value = value % len(BODY_COLOURS)
        self.body = points["body"].astype(int) if "body" in points else np.zeros(len(x), int)
        return x, value, self.run.sizes(k, points), speed

    def rigid_facets(self, k):
        """Return the facet corners of each rigid body that is drawn at the kth time, by name."""
        return {name: self.facets_of(name, k) for name in (self.run.rigid_bodies if self.has_rigid_bodies else [])}

    def facets_of(self, name, k):
        facets, fields = self.run.rigid(name, self.times[k])
        return facets + (self.magnify - 1.) * fields["displacement"].reshape(facets.shape)

    def find_ranges(self):
        """Find mean speeds, and the limits and colour range for all times."""
        lower, upper, ranges, self.mean_speed = [], [], [], []
        for k in range(len(self.times)):
            x, value, diameter, speed = self.load(k)
            lower.append((x - diameter[:, None] / 2).min(axis=0))
            upper.append((x + diameter[:, None] / 2).max(axis=0))
            ranges.append((*np.percentile(value, parts_in_range(self.component)), value.min(), value.max()))
            if k == 0:
                # In 2D, outlines distinguish all bodies from the largest, for any colours of points.
                counts = np.bincount(self.body)
                several = self.dim == 2 and not self.is_body and np.count_nonzero(counts) > 1
                self.outlined = [b for b in np.flatnonzero(counts) if b != counts.argmax()] if several else []
            self.mean_speed.append(speed)
        lower, upper = np.min(lower, axis=0), np.max(upper, axis=0)
        self.surface = read_reference(self.run, "Surface file") if self.dim == 2 else None
        self.failure_line = read_reference(self.run, "Failure line file") if self.dim == 2 else None
        if self.surface:
            upper[:2] = np.maximum(upper[:2], [self.surface[0].max(), self.surface[1].max()])
        lower, upper = room_for_rigid_bodies(self.run, lower, upper, {
            name: (self.facets_of(name, k) for k in range(len(self.times)))
            for name in (self.run.rigid_bodies if self.has_rigid_bodies else [])})
        margin = 0.04 * (upper - lower).max()
        lower, upper = lower - margin, upper + margin
        self.domain = np.array(self.run.grid_box) if self.run.grid_box else None
        # In total Lagrangian steps, bodies may leave the grid.
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
        """Return a new one for each artist, so that closed figures leave nothing behind."""
        return plt.Normalize(*self.limits_of_colours)

    def title(self, k):
        return f"$t$ = {self.times[k]:.{self.decimals}f} s"

    def four_times(self):
        """Return the first and last time, and two times at equal parts of the path of the points."""
        n, speed = len(self.times), np.array(self.mean_speed)
        way = np.concatenate([[0.], np.cumsum((speed[1:] + speed[:-1]) * np.diff(self.times))])
        if n <= 4 or way[-1] == 0:
            return sorted({round(part * (n - 1) / 3) for part in range(4)})
        return sorted({0, n - 1} | {int(np.argmin(abs(way - part * way[-1] / 3))) for part in (1, 2)})


def add_axes(figure, position, simulation, mesh=None, labels="xy"):
    """Add axes at a position in inches, with limits and labels of the simulation, and the mesh of a time."""
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
            axis.labelpad = (0, 0, 1)[k]
            axis.set_tick_params(pad=-2)
            # Short axes have room for only one or a few labels.
            part = (upper - lower)[order[k]] / (upper - lower).max()
            most = int(np.clip(round(4 * part), 1, 4 if k == 0 else 3))
            places = plt.MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(*sorted(limits))
            places = places[(places >= min(limits)) & (places <= max(limits))]
            axis.set_major_locator(plt.FixedLocator(places[-1:] if part < 0.3 else places[::2] if len(places) > most else places))
            axis.set_pane_color((0.96, 0.96, 0.96, 1.))
            axis._axinfo["grid"].update(color="0.85", linewidth=0.5)
        axes.view_init(elev=ELEVATION, azim=AZIMUTH)
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
    if mesh is not None and simulation.domain is not None:
        draw_cells(axes, simulation.run, mesh)
    return axes


def draw_cells(axes, run, k):
    """Draw the cells of level 0, and all cells with points at the kth time of a refined grid."""
    for d, draw in enumerate((axes.axvline, axes.axhline)):
        for x in run.grid_edges(d):
            draw(x, color="0.85", linewidth=0.4, zorder=0)
    for (x0, y0), (x1, y1) in run.cell_boxes(k):
        axes.add_patch(plt.Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor="0.7", linewidth=0.4, zorder=0))


def draw_walls(axes, simulation):
    """Draw a line along each side of the grid with a wall, and hatching behind it."""
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
    """Return the order of axes with the upright axis last."""
    return [[1, 2, 0], [0, 2, 1], [0, 1, 2]][simulation.up]


def draw_points(axes, simulation, k):
    x, value, diameter, _ = simulation.load(k)
    value = value * simulation.scale
    if simulation.dim == 3:
        colours = plt.get_cmap(simulation.colours)(simulation.norm(value))[:, :3]
        order = axes_order(simulation)
        facets = np.concatenate([np.zeros((0, 3, 3)), *simulation.rigid_facets(k).values()])
        draw_spheres(axes, x[:, order], diameter, colours, facets[:, :, order], (simulation.lower[order], simulation.upper[order]))
        return
    # Circles of equal volume would leave gaps; in sheared bodies, larger circles would, too.
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
    for segments in simulation.rigid_facets(k).values():
        if len(segments):
            axes.add_patch(plt.matplotlib.patches.PathPatch(outline_of(segments), facecolor="0.78", edgecolor="0.35", linewidth=0.8, zorder=2.2))


def draw_outlines(axes, simulation, x, diameter):
    """Draw outlines of bodies, at which their points fill half of the squares."""
    for b in simulation.outlined:
        mine = simulation.body == b
        if not mine.any():
            continue
        width = np.median(diameter[mine])
        edges = [np.arange(low - 4 * width, high + 5 * width, width) for low, high in
                 zip(x[mine, :2].min(axis=0), x[mine, :2].max(axis=0))]
        area = np.histogram2d(*x[mine, :2].T, bins=edges, weights=diameter[mine]**2)[0] / width**2
        smooth = sum(np.roll(area, (i - 2, j - 2), axis=(0, 1)) for i, j in np.ndindex(5, 5)) / 25
        if smooth.max() <= 0.5:   # The body is too thin for an outline.
            continue
        centers = [(edge[1:] + edge[:-1]) / 2 for edge in edges]
        axes.contour(*centers, smooth.T, levels=[0.5], colors="white", linewidths=2.2, zorder=2.4)
        axes.contour(*centers, smooth.T, levels=[0.5], colors=[BODY_COLOURS[(b + 1) % len(BODY_COLOURS)]], linewidths=1.1, zorder=2.5)


def is_inside(simulation, x, diameter):
    """Return whether points are inside: points or walls fill all squares of three and a half usual diameters around them."""
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


def add_colour_bar(figure, position, simulation):
    """Add a colour bar, or a legend of the bodies; nothing if points have no field."""
    if not simulation.component:
        return
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


# The direction of the view in 3D, degrees.
ELEVATION, AZIMUTH = 22, -62


def panel_ratio(simulation, width=2.45):
    """Return height over width of axes of this width in inches: of the box in 2D, of its view with labels in 3D."""
    size = simulation.upper - simulation.lower
    if simulation.dim == 2:
        return min(max(size[1] / size[0], 0.1), 3.)
    a, b, c = size[axes_order(simulation)]
    sine, cosine = np.abs(np.sin(np.deg2rad([AZIMUTH, ELEVATION]))), np.abs(np.cos(np.deg2rad([AZIMUTH, ELEVATION])))
    seen = (sine[1] * (cosine[0] * a + sine[0] * b) + cosine[1] * c) / (sine[0] * a + cosine[0] * b)
    return float(np.clip((seen * (width - LABELS_3D[0]) + LABELS_3D[1]) / width, 0.4, 1.2))


def frame(simulation, k, mesh=False):
    """Return the figure of the kth time."""
    ratio = panel_ratio(simulation, 5.6)
    width = min(5.6, 6. / ratio)
    height = max(width * ratio, 1.2)
    figure = plt.figure(figsize=(width + 1.8, height + 0.9), dpi=120)
    axes = add_axes(figure, (0.65, 0.5, width, height), simulation, k if mesh else None)
    draw_points(axes, simulation, k)
    figure.text(0.65 / (width + 1.8), 1 - 0.22 / (height + 0.9),
                f"{simulation.title_of_run},  {simulation.title(k)}", va="center")
    inset = 0.5 * (height - min(height, 3.))
    add_colour_bar(figure, (width + (1.05 if simulation.dim == 3 else 0.8), 0.5 + inset, 0.13, height - 2 * inset),
                   simulation)
    plt.close(figure)   # Notebooks would also show open figures.
    return figure
