"""Shared by all pictures: libraries, colours, axes, and spheres with a depth buffer."""
import math

from .results import PACKAGES, ResultsError, how_to_install, pretty
from .rigid import cut, loops_of

# Help must work without the libraries.
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
    matplotlib = plt = np = patheffects = EllipseCollection = Outline = FormatStrFormatter = Triangulation = Image = None

# Okabe and Ito's colours, which colour-blind readers can distinguish.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
LINES = ["-", "--", "-."]
BODY_COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5CC0", "#8C8C8C"]
STYLE = {"font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9, "legend.fontsize": 8,
         "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7, "lines.linewidth": 1.4,
         "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "legend.handlelength": 2.6}


def need_libraries():
    if MISSING:
        raise ResultsError(how_to_install(MISSING if MISSING in PACKAGES else "matplotlib"))


# Room for labels beside and below the axes box in 3D, inches.
LABELS_3D = 0.5, 0.65


def fit_box(axes, size, inches):
    """Return the largest box of this shape that fits into this many inches with its labels."""
    axes.set_box_aspect(size)
    axes.figure.canvas.draw()
    corners = np.array([[limits[(k >> d) & 1] for d, limits in enumerate((axes.get_xlim(), axes.get_ylim(), axes.get_zlim()))]
                        for k in range(8)])
    projected = np.c_[corners, np.ones(8)] @ axes.get_proj().T
    pixels = axes.transData.transform(projected[:, :2] / projected[:, 3:])
    room = (np.array(inches) - LABELS_3D) * axes.figure.dpi
    axes.set_box_aspect(size, zoom=float((room / np.ptp(pixels, axis=0)).min()))


def keep_apart(axis):
    """Align the last label of an x axis to end within it, away from the first label of the next panel."""
    low, high = sorted(axis.get_view_interval())
    places = [place for place in axis.get_majorticklocs() if low <= place <= high]
    axis.set_ticks(places)
    for tick, place in zip(axis.get_major_ticks(), places):
        part = (place - low) / (high - low)
        if part > 0.92:
            tick.label1.set_horizontalalignment("right")


def outline_of(segments):
    """Return the path of the closed lines that the segments form."""
    corners, codes = [], []
    for loop in loops_of(segments):
        corners += loop + loop[:1]
        codes += [Outline.MOVETO] + [Outline.LINETO] * (len(loop) - 1) + [Outline.CLOSEPOLY]
    return Outline(corners, codes)


def places_in(triangles, spacing):
    """Yield corner weights of positions in triangles, no further apart than the spacing, with the triangles, a few at a time."""
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1, initial=0.)
    numbers = np.ceil(longest / spacing).astype(int) + 1
    for n in np.unique(numbers):
        i, j = np.nonzero(np.add.outer(range(n + 1), range(n + 1)) <= n)
        mine = np.flatnonzero(numbers == n)
        for part in np.array_split(mine, -(-len(mine) * len(i) // 300000)):
            yield np.c_[i, j, n - i - j] / n, part


def draw_spheres(axes, x, diameter, colours, facets, limits, sampling=2):
    """Draw spheres, and grey triangles within limits, as an image over the axes, with a depth buffer, which matplotlib lacks."""
    axes.figure.canvas.draw()
    # The parts of long triangles outside the picture would take most of the time.
    facets = cut(facets, np.linalg.norm(np.subtract(*limits)) / 8, limits, np.inf)
    matrix = axes.get_proj()
    scale = sampling * (axes.transData.transform([1., 0.]) - axes.transData.transform([0., 0.]))[0]

    def view(x):
        """Return pixels, and the depth towards the eye in pixels."""
        projected = np.c_[x, np.ones(len(x))] @ matrix.T / matrix[3, 3]   # There is no perspective.
        return np.c_[sampling * axes.transData.transform(projected[:, :2]), -scale * projected[:, 2]]

    points = view(x)
    radius = np.maximum(0.65 * diameter * scale * np.linalg.norm(matrix[:3, 0]) / matrix[3, 3], 1.)
    order = np.argsort(points[:, 2])   # Write the nearest last.
    pixel, depth, radius, colours = points[order, :2], points[order, 2], radius[order], colours[order]
    seen = view(facets.reshape(-1, 3)).reshape(-1, 3, 3)
    box = view(np.array([[limits[(k >> d) & 1][d] for d in range(3)] for k in range(8 * bool(len(facets)))]).reshape(-1, 3))
    toward = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    toward *= np.where(toward[:, 2:] < 0, -1., 1.) / np.maximum(np.linalg.norm(toward, axis=1, keepdims=True), 1e-300)

    # The pixels that points and triangles cover, and the nearest of these.
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
    if len(x) < (2 * reach + 1)**2:
        # The few large ones, one after the other.
        rows, owners = nearest.reshape(height, width), owner.reshape(height, width)
        for m in range(len(x)):
            (left, right), (low, high) = ((max(c - reach, 0), c + reach + 1) for c in corner[m])
            z = (radius[m]**2 - (np.arange(left, right) + 0.5 - pixel[m, 0])[None, :]**2
                 - (np.arange(low, high) + 0.5 - pixel[m, 1])[:, None]**2)
            place = np.s_[low:high, left:right]
            z = np.where(z > 0, depth[m] + np.sqrt(np.maximum(z, 0.)), -np.inf)
            wins = z > rows[place]
            rows[place][wins], owners[place][wins] = z[wins], m
    else:
        for i, j in np.ndindex(2 * reach + 1, 2 * reach + 1):
            place = corner + [i - reach, j - reach]
            z = radius**2 - ((place + 0.5 - pixel)**2).sum(axis=1)
            inside = np.flatnonzero(z > 0)
            place, z = place[inside] @ [1, width], depth[inside] + np.sqrt(z[inside])
            wins = z > nearest[place]
            nearest[place[wins]], owner[place[wins]] = z[wins], inside[wins]

    # Light from the upper left; darker behind near objects.
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


def label_energy(axes, name, run):
    """Set ticks of at most four digits, and the unit that fits them."""
    largest = max(map(abs, axes.get_ylim()))
    power = min(3, max(-3, math.floor(math.log10(largest) / 3))) if largest > 0 else 0
    prefix = {-3: "n", -2: "\u00b5", -1: "m", 0: "", 1: "k", 2: "M", 3: "G"}[power]
    axes.yaxis.set_major_formatter(lambda value, _: f"{value / 1000.**power:g}")
    unit = pretty(run.unit("statistics.csv", "kinetic")) or ("J" if "center_z" in run.statistics else "J/m")
    axes.set_ylabel(f"{name}, {prefix}{unit}")


def add_legend(axes):
    """Add a legend above the axes, with as many columns as fit."""
    handles, labels = axes.get_legend_handles_labels()
    columns = len(labels)
    while columns > 1 and sum(sorted(map(len, labels))[-columns:]) + 8 * columns > 110:
        columns -= 1
    axes.legend(handles, labels, loc="lower left", bbox_to_anchor=(0., 1.), ncol=columns, borderaxespad=0.2, columnspacing=1.4)
