"""Chooses the display of a run in pictures and reports: main field, colour ranges, upright axis, room for rigid bodies."""
import re

from .results import AXES, ResultsError, np

# The smallest upper end of the scale of a field. A plastic strain below 0.01 does not
# change the shape of a body visibly; on a fitted scale, a stable body would look as if
# it failed.
LEAST_UPPER_ENDS = {"plastic_strain": 0.01}
# Fields to show if points have no velocity; the first existing one is used.
MAIN_FIELDS = ("displacement", "pressure", "von_mises", "pore_pressure")
# Fields that only identify points.
IDENTIFIERS = ("body", "id", "process", "size", "reference")


def parts_in_range(field):
    """Return the percentiles of values that bound a colour scale. The plastic strain of a thin sheared layer is many times
    larger than in the body above it."""
    return (0., 97.) if field == "plastic_strain" else (0.2, 99.8)


def range_of_colours(field, low, high):
    """Return the range of a scale that fits the values from low to high."""
    return low, max(high, LEAST_UPPER_ENDS.get(field, high))


def main_field(run):
    """Return the most informative field of a run; None if points have only positions.

    This is the plastic strain of soil, if there is any, else the speed. For points that are written without their
    velocity, it is the pore pressure, or the first existing field of MAIN_FIELDS and others.
    """
    available = run.point_fields
    models = {run.parameters.get(f"Material {run.parameters.get(f'Body {name}/Material')}/Model") for name in run.bodies}
    if models & {"drucker-prager", "mohr-coulomb"} and "plastic_strain" in available \
            and run.points(-1, ["plastic_strain"])["plastic_strain"].max() > 0:
        return "plastic_strain"
    if "velocity" in available:
        return "speed"
    if "pore_pressure" in available and run.parameters.get("Simulation/Pore water") == "true":
        return "pore_pressure"
    others = [name for name in available if name not in IDENTIFIERS]
    return next((name for name in (*MAIN_FIELDS, *others, "body") if name in available), None)


def check_field(run, name):
    """Refuse a field that is neither 'speed', nor an array of the points, nor a component such as velocity_x."""
    available = run.point_fields
    if name == "speed" and "velocity" in available or name in available \
            or isinstance(name, str) and name[:-2] in available and name[-2:] in ("_x", "_y", "_z"):
        return
    names = (["speed"] if "velocity" in available else []) + available
    raise ResultsError(f"{run.folder} has no field {name}. There are: {', '.join(names) or 'none'}.")


def array_of(run, name):
    """Return the array that contains a field: 'velocity' for 'speed' and for 'velocity_x'."""
    return "velocity" if name == "speed" else name if name in run.point_fields else name[:-2]


def up_axis(run, up=None):
    """Return the number of the upright axis in 3D: the named axis, or the axis closest to gravity.

    The first numbers in the formulas of gravity decide, including stages. Without gravity, it is the axis along which
    bodies are flat, less than half as long as along the others, or y.
    """
    if up:
        if up not in AXES:
            raise ResultsError(f"the upright axis is x, y or z, not <{up}>.")
        return AXES.index(up)
    sizes = np.zeros(3)
    for name, text in run.parameters.items():
        if name == "Loads/Gravity" or name.endswith("/Loads/Gravity"):
            for d, formula in enumerate(text.split(";")[:3]):
                number = re.search(r"\d+\.?\d*([eE][-+]?\d+)?", formula)
                sizes[d] = max(sizes[d], float(number.group()) if number else float(bool(formula.strip())))
    if sizes.any():
        return int(np.flatnonzero(sizes == sizes.max())[-1])
    if run.has_points:
        extents = np.ptp(run.points(0, []).x, axis=0)
        flat = int(np.argmin(extents))
        if extents[flat] < 0.5 * np.delete(extents, flat).min():
            return flat
    return 1


def room_for_rigid_bodies(run, lower, upper, facets_of):
    """Return limits of bodies with room for rigid bodies. facets_of[name] has an array of facets for each time.

    Unbounded bodies, which are cut beyond the grid, and bodies that do not fit have little room.
    """
    room, (low, high) = (upper - lower).max(), (lower, upper)
    n = len(lower)
    ends = [np.r_[end, [0.] * (n - run.dim)] for end in run.grid_box or (lower[:run.dim], upper[:run.dim])]
    for name, times in facets_of.items():
        endless = bool(re.search("half_space|level_set|[<>]", run.parameters.get(f"Rigid body {name}/Shape", "")))
        for facets in times:
            if not len(facets):
                continue
            least, most = facets[:, :, :n].min(axis=(0, 1)), facets[:, :, :n].max(axis=(0, 1))
            least = np.where((least < lower - room) | endless & (least < ends[0]), lower - 0.1 * room, least)
            most = np.where((most > upper + room) | endless & (most > ends[1]), upper + 0.1 * room, most)
            low, high = np.minimum(low, least), np.maximum(high, most)
    return low, high
