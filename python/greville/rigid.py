"""Prepares the rigid bodies of a run for the report: few facets, and the motion at each time."""
import base64
import zlib

from .display import room_for_rigid_bodies
from .results import np

# Facets of a body in 3D, at most, and the longest edge over the size of the view: facets are drawn from the back to the
# front, which long ones would disturb.
MOST_FACETS, LONGEST_EDGE = 3000, 0.08


def loops_of(segments):
    """Return the closed lines, each a list of positions, that segments form: the inside is on their left."""
    following, loops = {tuple(start): tuple(end) for start, end in segments[:, :, :2]}, []
    while following:
        start, place = following.popitem()
        loop = [start]
        while place != start and place in following:
            loop.append(place)
            place = following.pop(place)
        loops.append(loop)
    return loops


def motion_between(before, after):
    """Return the rotation and the shift between two sets of positions, or None if no rigid motion maps them."""
    centers = before.mean(axis=0), after.mean(axis=0)
    left, _, right = np.linalg.svd((before - centers[0]).T @ (after - centers[1]))
    sign = np.ones(len(left))
    sign[-1] = np.sign(np.linalg.det(left @ right))
    rotation = (left * sign @ right).T
    shift = centers[1] - rotation @ centers[0]
    error = np.abs(before @ rotation.T + shift - after).max()
    return (rotation, shift) if error < 1e-3 * np.ptp(before, axis=0).max() else None


def cut(facets, longest, limits=None, most=MOST_FACETS):
    """Return triangles without longer edges, unless there would be too many, and without triangles beyond limits."""
    while True:
        if limits is not None:
            facets = facets[~((facets < limits[0]).all(axis=1) | (facets > limits[1]).all(axis=1)).any(axis=1)]
        edges = np.linalg.norm(np.roll(facets, -1, axis=1) - facets, axis=2)
        long = edges.max(axis=1, initial=0.) > longest
        if not long.any() or len(facets) + long.sum() > most:
            return facets
        # The longest edge becomes the first one, and is cut in two.
        turn = (edges[long].argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(facets[long], turn[:, :, None], axis=1), 1, 0)
        middle = (a + b) / 2
        facets = np.concatenate([facets[~long], np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def simplified(facets, size):
    """Return at most MOST_FACETS triangles, with no edge much longer than LONGEST_EDGE times the size of the view."""
    width = np.ptp(facets, axis=(0, 1)).max() / 100
    original, origin = facets, facets.min(axis=(0, 1))
    while len(facets) > MOST_FACETS:
        # Merge the corners in a small cube.
        _, cube = np.unique(np.floor((original - origin) / width).astype(int).reshape(-1, 3), axis=0, return_inverse=True)
        cube = cube.ravel()
        sums = np.stack([np.bincount(cube, column) for column in original.reshape(-1, 3).T], axis=1)
        corners = cube.reshape(-1, 3)
        corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]
        _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
        facets = (sums / np.bincount(cube)[:, None])[corners[first]]
        width *= 1.5
    return cut(facets, LONGEST_EDGE * size)


class Shapes:
    """The shapes of a body: one, unless the view cuts it differently at different times."""

    def __init__(self, dim, size):
        self.dim, self.size, self.shapes, self.bytes, self.last = dim, size, [], [], None

    def add(self, facets):
        """Return the number of the shape of these facets, and its motion to them."""
        motion = None
        if self.last is not None and self.last.shape == facets.shape and len(facets):
            motion = motion_between(self.last.reshape(-1, self.dim), facets.reshape(-1, self.dim))
        if motion is None:
            self.last, motion = facets, (np.eye(self.dim), np.zeros(self.dim))
            self.append(facets)
        return [len(self.shapes) - 1, *(float(f"{value:.7g}") for value in (*motion[0].ravel(), *motion[1]))]

    def append(self, facets):
        if self.dim == 2:
            loops = loops_of(facets)
            lengths, places = [len(loop) for loop in loops], np.array([place for loop in loops for place in loop]).reshape(-1, 2)
        else:
            facets = simplified(facets, self.size)
            lengths, places = len(facets), facets.reshape(-1, 3)
        low, high = (places.min(axis=0), places.max(axis=0)) if len(places) else np.zeros((2, self.dim))
        width = np.where(high > low, high - low, 1.)
        self.shapes.append({"low": low.tolist(), "width": width.tolist(), "n": len(places), "loops" if self.dim == 2 else "facets": lengths})
        self.bytes.append(np.rint((places - low) / width * 65535).astype("<u2").tobytes())

    def packed(self):
        return base64.b64encode(zlib.compress(b"".join(self.bytes), 9)).decode()


def rigid_data(run, times, lower, upper):
    """Return the data of each rigid body for the report, and the limits of the points with room for these bodies."""
    names, dim = run.rigid_bodies, run.dim

    def facets_at(name):
        return (run.rigid(name, time)[0][:, :, :dim] for time in times)
    view = room_for_rigid_bodies(run, lower, upper, {name: facets_at(name) for name in names})
    result = []
    for name in names:
        shapes = Shapes(dim, np.linalg.norm(view[1] - view[0]))
        frames = [shapes.add(facets) for facets in facets_at(name)]
        result.append({"name": name, "frames": frames, "shapes": shapes.shapes, "data": shapes.packed()})
    return result, view


def rigid_rows(run):
    """Return names of rigid bodies, and the extents of bounded ones."""
    rows = []
    for name in run.rigid_bodies:
        facets, _ = run.rigid(name, run.times[0])
        row = {"name": name, "model": "rigid"}
        box = run.grid_box
        if len(facets):
            corners = facets.reshape(-1, 3)[:, :run.dim]
            inside = box is None or (corners >= box[0]).all() and (corners <= box[1]).all()
            if inside:
                row["extent"] = [float(f"{size:.4g}") for size in np.ptp(corners, axis=0)]
        rows.append(row)
    return rows
