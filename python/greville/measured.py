"""Distances of a run to the measured data that its section Reference names.

scripts/run, scripts/sweep and Case.run() print them and add them to summary.json.
"""
import json

from .command import parser_of, run_command
from .results import ResultsError, Run, how_to_install, np

FILES = ("Surface file", "Failure line file", "Series file")


def statistics_of(distance, value):
    """Return the mean and the largest distance (in the unit of the values), and the mean relative to the mean value."""
    return {"mean": distance.mean(), "largest": distance.max(), "relative": distance.mean() / abs(value).mean(), "values": len(distance)}


def surface_distance(run, x, y):
    """Compare the measured surface with the highest point within half a cell of x, plus half of its size: vertical distances.

    Beyond the body, its surface is the floor. front is the run-out beyond the last x, m.
    """
    points, edges = run.points(-1, ["size"]), run.grid_edges(0)
    half_cells = np.diff(edges)[np.clip(np.searchsorted(edges, x, "right") - 1, 0, len(edges) - 2)] / 2
    top = points.x[:, 1] + points["size"] / 2
    height = np.array([top[abs(points.x[:, 0] - place) <= half].max(initial=run.grid_box[0][1])
                       for place, half in zip(x, half_cells)])
    return {**statistics_of(abs(height - y), y), "front": run.statistics["front_99"][-1] - x.max()}


def failure_line_distance(run, x, y):
    """Return the area between the failure lines of measurement and run, over the length of the measured line, m.

    The area belongs to points that were above the line and have not failed, or below it and have failed.
    """
    if len(x) < 2 or (np.diff(x) <= 0).any():
        raise ResultsError(f"<{run.parameters['Reference/Failure line file']}> of the parameter 'Reference/Failure line file' "
                           "needs two or more rows with growing x.")
    points = run.points(-1, ["displacement", "size", "J"])
    initial = points.x - points["displacement"]
    has_failed = np.linalg.norm(points["displacement"], axis=1) > float(run.parameters["Reference/Failure displacement"])
    is_wrong = (x[0] <= initial[:, 0]) & (initial[:, 0] < x[-1]) & ((initial[:, 1] > np.interp(initial[:, 0], x, y)) != has_failed)
    area = points["size"].astype(float)**2 / points["J"]
    if run.parameters["Grid/Geometry"] == "axisymmetric":
        area *= points.x[:, 0] / initial[:, 0]
    return {"mean": area[is_wrong].sum() / np.hypot(np.diff(x), np.diff(y)).sum()}


def series_distance(run, x, y):
    """Compare a column of statistics.csv with the measured values at the times that the run has reached."""
    table = run.statistics
    time, value = table["time"], table[run.parameters["Reference/Series quantity"]]
    reached = (time[0] <= x) & (x <= time[-1])
    if not reached.any():
        return {"mean": 0., "largest": 0., "relative": 0., "values": 0}
    distance, y = abs(np.interp(x[reached], time, value) - y[reached]), y[reached]
    return {**statistics_of(distance, y), "relative": (distance / abs(y)).mean()}


def distances(run):
    """Return the entry "reference" of summary.json: a dict for each file of the section Reference."""
    result = {}
    for file, measure in zip(FILES, (surface_distance, failure_line_distance, series_distance)):
        if run.parameters.get(f"Reference/{file}"):
            if np is None:
                raise ResultsError(how_to_install("numpy"))
            data = run.reference(file)
            if data is None:
                raise ResultsError(f"There is no file {run.parameters[f'Reference/{file}']}.")
            values = measure(run, *data[:2])
            result[file[:-5].lower().replace(" ", "_")] = {
                name: value if name == "values" else float(f"{value:.12g}") for name, value in values.items()}
    return result


def text_of(run, found):
    """Return the lines about distances that scripts/run prints."""
    text, summary = "", run.summary
    if "surface" in found:
        surface = found["surface"]
        text += (f"  distance to the measured surface: mean {1e3 * surface['mean']:.3g} mm, largest {1e3 * surface['largest']:.3g} mm\n"
                 f"  run-out: {summary['front_99']:.3g} m (99.5 % of the mass), {1e3 * abs(surface['front']):.3g} mm "
                 f"{'behind' if surface['front'] < 0 else 'beyond'} the measured front; outermost point {summary['front']:.3g} m\n")
    if "failure_line" in found:
        text += f"  distance to the measured failure line: mean {1e3 * found['failure_line']['mean']:.3g} mm\n"
    if "series" in found:
        text += (f"  distance to the measured {run.parameters['Reference/Series quantity']}: "
                 f"mean {100 * found['series']['relative']:.3g} %, {found['series']['values']} values\n")
    return text


def add_to_summary(run):
    """Add the distances of a finished run to summary.json, and return the lines about them, or the reason why there are none."""
    if not run.summary:
        return ""
    try:
        found = distances(run)
    except ResultsError as error:
        return f"  no distance to measured data: {error}\n"
    if found:
        run.summary["reference"] = found
        (run.folder / "summary.json").write_text(json.dumps(run.summary, indent=2) + "\n", encoding="utf-8")
    return text_of(run, found)


def main(program):
    run_command(parser_of(program, __doc__), lambda arguments: print(*(add_to_summary(Run(folder)) for folder in arguments.folders), sep="", end=""))
