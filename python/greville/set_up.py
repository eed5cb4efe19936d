"""Draws the output of --check --draw: bodies, walls, surfaces with loads and contacts, and probes, with their names."""
import re

from .drawing import COLOURS, np, plt
from .results import numbers_in
from .scene import frame


def probes_of(text, dim):
    """Return the positions of point probes and the corners of box probes, each by its number."""
    points, boxes = {}, {}
    # Nested shapes have no semicolons.
    for number, part in enumerate(part.strip() for part in (text or "").split(";")):
        box = re.fullmatch(r"box\(([^()]*)\)", part)
        try:
            values = numbers_in(box.group(1) if box else part)
        except ValueError:
            continue
        if box and len(values) == 2 * dim:
            boxes[number] = np.array(values).reshape(2, dim)
        elif len(values) == dim:
            points[number] = np.array(values)
    return points, boxes


def edges_of(corners):
    """Return the edges of a box, from its two corners."""
    dim = corners.shape[1]
    places = [np.array([corners[(k >> d) & 1][d] for d in range(dim)]) for k in range(2**dim)]
    return [(places[k], places[k | 1 << d]) for k in range(2**dim) for d in range(dim) if not k >> d & 1]


class Overlay:
    """Axes over the whole figure, to draw at positions of the simulation above the points, also in 3D."""

    def __init__(self, figure, simulation, order):
        figure.canvas.draw()   # This sets the final limits of the axes.
        self.figure, self.below, self.order, self.dim = figure, figure.axes[0], order, simulation.dim
        self.axes = figure.add_axes([0., 0., 1., 1.], xlim=(0., 1.), ylim=(0., 1.), zorder=10, facecolor="none")
        self.axes.axis("off")

    def __call__(self, x):
        """Return positions as fractions of the figure's width and height."""
        x = np.atleast_2d(np.asarray(x, float))
        if self.dim == 3:
            seen = np.c_[x[:, self.order], np.ones(len(x))] @ self.below.get_proj().T
            x = seen[:, :2] / seen[:, 3:]
        return self.below.transData.transform(x[:, :2]) / self.figure.bbox.size


def names_of_surfaces(run):
    names = [name.strip() for kind in ("Surface loads", "Contacts") for name in run.parameters.get(f"Simulation/{kind}", "").split(",")]
    return [name for name in names if name]


def draw_surfaces(overlay, run):
    """Draw points of surfaces, and arrows of loads that are not zero at the start."""
    names, shown = names_of_surfaces(run), {}
    for name in run.surfaces:
        fields = run.series(name)(0)
        numbers = fields["surface_load"].astype(int) if len(fields.x) else np.zeros(0, int)
        for number in np.unique(numbers):
            mine = numbers == number
            label = names[number].replace("_", " ") if number < len(names) else f"surface {number}"
            colour = shown.setdefault(label, COLOURS[1 + len(shown) % (len(COLOURS) - 1)])
            places = overlay(fields.x[mine, :])
            overlay.axes.scatter(*places.T, s=5, color=colour, linewidths=0)
            load = fields["load"][mine]
            size = np.linalg.norm(load, axis=1)
            if size.max() > 0:
                length = 0.12 * (np.ptp(run.grid_box, axis=0).max() if run.grid_box else np.ptp(fields.x, axis=0).max()) / size.max()
                chosen = np.flatnonzero(size > 0)
                chosen = chosen[::-(-len(chosen) // 24)]
                # Arrows end at their points of action.
                tails = overlay(fields.x[mine][chosen] - length * load[chosen])
                for tail, head in zip(tails, places[chosen]):
                    overlay.axes.annotate("", head, tail, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 0.9,
                                                                      "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7})
    return shown


def draw_probes(overlay, run):
    points, boxes = probes_of(run.parameters.get("Output/Probes"), run.dim)
    style = {"fontsize": 7, "color": "black", "bbox": {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.8}}
    for number, x in points.items():
        place = overlay(x)[0]
        overlay.axes.plot(*place, "P", color="black", markeredgecolor="white", markersize=6)
        overlay.axes.annotate(str(number), place, xytext=(5, 4), textcoords="offset points", **style)
    for number, corners in boxes.items():
        for edge in edges_of(corners):
            overlay.axes.plot(*overlay(edge).T, color="black", linewidth=0.9, linestyle=(0, (3, 2)))
        overlay.axes.annotate(str(number), overlay(corners.mean(axis=0))[0], ha="center", va="center", **style)
    return bool(points or boxes)


def draw_rigid_names(overlay, run):
    for name in run.rigid_bodies:
        facets, _ = run.rigid(name, run.times[0])
        if len(facets) and run.grid_box:
            # Half spaces reach beyond the grid.
            lower, upper = (np.r_[corner, [0.] * (3 - run.dim)] for corner in run.grid_box)
            middle = np.clip(facets.reshape(-1, 3), lower, upper)
            middle = (middle.min(axis=0) + middle.max(axis=0)) / 2
            overlay.axes.annotate(name.replace("_", " "), overlay(middle)[0], ha="center", va="center", fontsize=8,
                                  bbox={"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 1.})


def wall_text(run):
    walls = [f"{name.lower()} {kind}" for name, kind in run.walls.items() if kind != "free"]
    return "walls: " + (", ".join(walls) if walls else "none")


def show_grid(simulation):
    """Set limits of the picture that contain the grid and its walls."""
    if simulation.domain is None:
        return
    d, margin = simulation.dim, 0.02 * np.ptp(simulation.domain, axis=0).max()
    simulation.lower[:d] = np.minimum(simulation.lower[:d], simulation.domain[0] - margin)
    simulation.upper[:d] = np.maximum(simulation.upper[:d], simulation.domain[1] + margin)


def draw_set_up(simulation, order, mesh=False):
    run = simulation.run
    show_grid(simulation)
    figure = frame(simulation, 0, mesh)
    width, height = figure.get_size_inches()
    overlay = Overlay(figure, simulation, order)
    shown = draw_surfaces(overlay, run)
    draw_rigid_names(overlay, run)
    handles = [plt.Line2D([], [], color=colour, label=name) for name, colour in shown.items()]
    if draw_probes(overlay, run):
        handles.append(plt.Line2D([], [], color="black", marker="P", markeredgecolor="white", linestyle="", label="probes"))
    if handles:
        overlay.axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1. - 0.05 / width, 0.1 / height), handlelength=1.,
                            handletextpad=0.5, borderaxespad=0.)
    figure.text(0.65 / width, 0.06 / height, wall_text(run), fontsize=7.5, color="0.25")
    figure.savefig(simulation.folder / "picture.png")
    plt.close(figure)
    print(simulation.folder / "picture.png")
