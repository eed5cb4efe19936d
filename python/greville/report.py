"""Write report.html, a page about a run, or about several runs side by side.

    scripts/report output/dam_break              writes output/dam_break/report.html
    scripts/report output/first output/second    writes output/report.html, in the folder of both
    scripts/report output/vibrating_bar          a sweep: its runs, and their errors

The page is self-contained, so that it can be moved and sent, and needs a
browser but no network: warnings, moving points coloured by a field, energies and
their balance, momentum, iterations, Newton's method, time per part, measured or
exact values, bodies, and the parameters that are not defaults.

Needs Debian's python3-numpy, and for the points python3-vtk9 or python3-meshio.
"""
import base64
import json
import math
import os
import sys
import zlib
from pathlib import Path

from . import measured
from .case import project_file
from .command import parser_of, run_command
from .display import array_of, check_field, main_field, parts_in_range, range_of_colours, up_axis
from .results import (Error, ResultsError, Run, how_to_install, names_in, names_of_fields, np, path_of, pretty, read_table,
                      runs_in)
from .rigid import rigid_data, rigid_rows

TEMPLATE = Path(__file__).resolve().parent / "report.html"
MOST_ROWS, MOST_FRAMES, MOST_POINTS = 1000, 61, 40000
# Limit of all frames, in characters.
BUDGET = 3_000_000
# The page that explains the figures of a run, in the source tree or installation.
GUIDE = "doc/user/output.md"
# Fields that are shown after the field of main_field(), if they exist.
FIELDS = ["speed", "pressure", "von_mises", "plastic_strain", "displacement", "pore_pressure", "density"]
ABSENT = 65535


def number(value, digits=5):
    """Return a short number that JSON can hold."""
    return None if not math.isfinite(value) else float(f"{value:.{digits}g}")


def numbers(values, digits=5):
    return [number(value, digits) for value in values]


def label_of(name):
    return name.replace("_", " ").replace("von mises", "von Mises stress")


# Tables.

def chosen_rows(n):
    """Return at most MOST_ROWS rows, with the first and the last."""
    return np.unique(np.linspace(0, n - 1, min(n, MOST_ROWS)).round().astype(int))


def table_data(run):
    table = run.statistics
    rows = chosen_rows(table.n_rows)
    columns = {name: numbers(values[rows]) for name, values in table.items() if not isinstance(values, list)}
    change, work, left = run.energy_balance()
    unit = pretty(run.unit("statistics.csv", "total"))
    columns.update({"change of energy": numbers(change[rows]), "work": numbers(work[rows]), "not accounted for": numbers(left[rows])})
    units = {name: pretty(run.unit("statistics.csv", name)) for name in table}
    units.update({name: unit for name in ("change of energy", "work", "not accounted for")})
    # From the rows only; the program compares with each hundredth step.
    energy = np.max(np.abs(np.concatenate([change, work, table["kinetic"], table["strain"]])))
    return {"columns": columns, "units": units, "n": table.n_rows, "works": run.work,
            "loss": loss_data(run, -left[-1], -left[-1] / energy if energy > 0 else 0.)}


def loss_data(run, loss, share):
    """Return the numerical loss of the run with its judgement; until the run ends, the loss from its rows."""
    found = run.summary.get("energy", {})
    return {"loss": number(found.get("numerical_loss", loss)), "share": number(found.get("relative_loss", share)),
            "judgement": found.get("judgement", "until now")}


def probes_data(run):
    table = run.probes
    if table is None or table.n_rows == 0:
        return None
    rows = chosen_rows(table.n_rows)
    return {"columns": {name: numbers(values[rows]) for name, values in table.items()},
            "units": {name: pretty(run.unit("probes.csv", name)) for name in table}}


def newton_data(run):
    """Return one entry for each solved or abandoned step."""
    table = run.newton
    if table is None or table.n_rows == 0:
        return None
    begins = np.flatnonzero(table["iteration"] == 0)
    steps = []
    for first, end in zip(begins, [*begins[1:], table.n_rows]):
        own = slice(first, end)
        steps.append({"step": int(table["step"][first]), "time": number(table["time"][first]),
                      "dt": number(table["dt"][first]), "converged": bool(table["converged"][first]),
                      "relative": numbers(table["relative"][own], 3), "linear": [int(n) for n in table["linear_iterations"][own]]})
    return {"steps": steps if len(steps) <= MOST_ROWS else [steps[k] for k in chosen_rows(len(steps))], "n": len(steps)}


def comparison_data(run):
    summary, result = run.summary, {}
    series = run.reference("Series file")
    if series:
        quantity = run.parameters.get("Reference/Series quantity", "")
        rows = chosen_rows(run.statistics.n_rows)
        result["series"] = {
            "measured": [numbers(series[0]), numbers(series[1])], "whose": series[2],
            "own": [numbers(run.statistics["time"][rows]), numbers(run.statistics[quantity][rows])],
            "labels": ["time, s", f"{label_of(quantity)}, {pretty(run.unit('statistics.csv', quantity))}"]}
    surface = run.reference("Surface file")
    if surface:
        result["surface"] = {"x": numbers(surface[0]), "y": numbers(surface[1]), "whose": surface[2]}
    line = run.reference("Failure line file")
    if line:
        result["failure_line"] = {"x": numbers(line[0]), "y": numbers(line[1]), "whose": line[2]}
    if "reference" not in summary:
        measured.add_to_summary(run)
    result["distances"] = summary.get("reference", {})
    result["errors"] = summary.get("errors", {})
    return result if series or surface or line or result["errors"] else None


def parameter_data(run):
    def is_same(value, default):
        try:
            return float(value) == float(default)
        except ValueError:
            return False
    return [[name, value, default, pretty(unit)] for name, value, default, unit in run.changed_parameters
            if not is_same(value, default) and not name.startswith(("Output/", "Checkpoints/")) and name != "Simulation/Name"]


def body_data(run):
    """Return names, laws, numbers of points, masses and initial extents of bodies."""
    rows = []
    points = sizes = None
    if run.has_points:
        points = run.points(0, [name for name in ("body", "density", "J", "size") if name in run.point_fields])
        sizes = run.sizes(0, points)
    for b, name in enumerate(run.bodies):
        material = run.parameters.get(f"Body {name}/Material", "")
        row = {"name": name, "material": material, "model": run.parameters.get(f"Material {material}/Model", "")}
        if points is not None and "body" in points:
            mine = points["body"].astype(int) == b
            if mine.any():
                x, half = points.x[mine][:, :run.dim], sizes[mine][:, None] / 2
                row.update(points=int(mine.sum()), extent=numbers((x + half).max(axis=0) - (x - half).min(axis=0), 4))
                if "density" in points:
                    row["mass"] = number(float((points["density"][mine] * sizes[mine]**run.dim).sum()), 4)
        rows.append(row)
    return rows


def scheme_facts(run):
    """Return mass, integrator and formulation, or a list of them per stage."""
    def of(section, mass):
        mass = run.parameters.get(section + "Scheme/Mass", "") if mass is None else mass
        return [["mass", mass], ["steps in time", run.parameters.get(section + "Scheme/Stress update", "")],
                ["formulation", run.parameters.get(section + "Scheme/Formulation", "")]]
    stages = names_in(run.parameters.get("Simulation/Stages"))
    if not stages:
        return of("", run.summary.get("mass"))
    # The summary has the choice of 'auto'; a running run has not written it yet.
    masses = run.summary.get("stages", {})
    return [[f"stage {number}: {name}", f"to {float(run.parameters[f'Stage {name}/Time/End']):.4g} s: "
             + ", ".join(f"{what} {value}" if what == "mass" else value for what, value in
                         reversed(of(f"Stage {name}/", masses.get(name))) if value)]
            for number, name in enumerate(stages, 1)]


def cost_of_point(summary):
    """Return microseconds as text."""
    speed = summary.get("point_steps_per_second")
    return f"{1e6 * summary['processes'] / speed:.3g} µs" if speed else ""


def facts(run):
    """Return the facts about the run at the top of the page."""
    s, table = run.summary, run.statistics
    cells = " × ".join(str(n) for n in run.grid_cells)
    result = [["points", f"{s.get('points') or int(table['points'][0]):,}"], ["grid", cells + " cells" if cells else ""],
              ["order of splines", run.parameters.get("Grid/Order", s.get("p", ""))],
              *scheme_facts(run),
              ["simulated", f"{table['time'][-1]:.4g} s"]]
    if s:
        result += [["steps", f"{s['steps']:,}"], ["wall time", f"{s['wall_time']:.3g} s"], ["processes", s["processes"]],
                   ["time per point, step and process", cost_of_point(s)],
                   ["memory of points", f"{s['bytes_per_point'] * s['points'] / 1e6:,.3g} MB"]]
        if "to" in s.get("ramp", {}):
            result.append(["factor at failure", f"{s['ramp']['factor']:.4g} ({s['ramp']['from']:.5g} to {s['ramp']['to']:.5g})"])
        loss = s.get("energy", {})
        if "relative_loss" in loss:
            judgement = loss.get("judgement", "").split(",")[0]
            result.append(["numerical loss of energy", f"{100 * loss['relative_loss']:.3g} %" + (f", {judgement}" if judgement else "")])
    return [[name, str(value)] for name, value in result if value != ""]


# Points.

def load_frames(run, frames, stride, names):
    """Return positions, values and sizes of every stride-th point of a body, in a common order; NaN for points that have left."""
    first = run.points(frames[0], [name for name in ("body", "id") if name in run.point_fields])
    keyed = "id" in first and "body" in first
    n_ids = int(first["id"].max()) + 1 if keyed and len(first.x) else 0

    def keys(points):
        return points["body"].astype(np.int64) * n_ids + points["id"].astype(np.int64)
    # Single precision cannot distinguish ids above 16.7 million.
    keyed = keyed and len(np.unique(keys(first))) == len(first.x)
    order = np.sort(keys(first))[::stride] if keyed else None
    wanted = sorted({array_of(run, name) for name in names} | ({"body", "id"} if keyed else set())
                    | {name for name in ("size", "J", "body") if name in run.point_fields})
    result = []
    for k in frames:
        points = run.points(k, wanted)
        values = np.column_stack([points.x[:, :run.dim], run.sizes(k, points)] + [points.component(name) for name in names])
        if keyed:
            mine = keys(points)
            places = np.searchsorted(order, mine)
            places[places == len(order)] = 0
            found = order[places] == mine
            row = np.full((len(order), values.shape[1]), np.nan)
            row[places[found]] = values[found]
            values = row
        else:
            values = values[::stride]
        result.append(values)
    most = max(len(values) for values in result)
    return np.array([np.vstack([values, np.full((most - len(values), values.shape[1]), np.nan)]) for values in result])


def limits_of(name, values):
    """Return the colour range of a field at all times, and whether it has two signs."""
    # It never decreases, so the last time has the whole range.
    own = values[-1] if name == "plastic_strain" else values
    low, high = (float(v) for v in np.nanpercentile(own, parts_in_range(name)))
    if name in ("speed", "displacement"):
        low = 0.
    if low < 0 < high and min(-low, high) > 0.1 * max(-low, high):
        high = max(-low, high)
        return -high, high, True
    low, high = range_of_colours(name, low, high)
    if high - low <= 1e-9 * max(abs(high), abs(low), 1e-300):
        low, high = low - 0.1 * abs(low), high + (0.1 * abs(high) or 1.)
    return low, high, False


def pack(frames, dim, lower, upper, ranges):
    """Pack two bytes per position and one per size and value, as compressed differences between frames."""
    x = np.rint((frames[:, :, :dim] - lower) / (upper - lower) * (ABSENT - 1))
    x = np.where(np.isnan(x), ABSENT, np.clip(x, 0, ABSENT - 1)).astype(np.uint16)
    x[1:] = x[1:] - x[:-1]
    parts = [np.ascontiguousarray(x[:, :, d].astype("<u2")).view(np.uint8).reshape(-1, 2).T for d in range(dim)]
    for k, (low, high) in enumerate(ranges):
        value = np.nan_to_num((frames[:, :, dim + k] - low) / (high - low))
        byte = np.rint(255 * np.clip(value, 0., 1.)).astype(np.uint8)
        byte[1:] = byte[1:] - byte[:-1]
        parts.append(byte)
    return base64.b64encode(zlib.compress(b"".join(np.ascontiguousarray(part).tobytes() for part in parts), 9)).decode()


def frames_data(run, budget, chosen, up):
    if not run.has_points:
        return None
    available = run.point_fields
    names = [*chosen, main_field(run)] + [name for name in FIELDS if name in available or name == "speed" and "velocity" in available]
    if len(run.bodies) > 1 and "body" in available:
        names.append("body")
    names = list(dict.fromkeys(name for name in names if name))
    if not names:
        raise ResultsError("the points have no field, as 'Output/Fields' wants it.")
    times, dim = run.times, run.dim
    frames = [int(k) for k in np.unique(np.linspace(0, len(times) - 1, min(len(times), MOST_FRAMES)).round())]
    stride = -(-len(run.points(0, []).x) // MOST_POINTS)
    data = load_frames(run, frames, stride, names)
    while True:
        # Omit uniform fields.
        kept = [k for k in range(len(names)) if np.nanmax(data[:, :, dim + 1 + k]) > np.nanmin(data[:, :, dim + 1 + k])] or [0]
        lower, upper = np.nanmin(data[:, :, :dim], axis=(0, 1)), np.nanmax(data[:, :, :dim], axis=(0, 1))
        width = np.where(upper > lower, upper - lower, 1.)
        largest = np.nanmax(data[:, :, dim]) or 1.
        fields = []
        for k in kept:
            low, high, has_signs = limits_of(names[k], data[:, :, dim + 1 + k])
            if names[k] == "body":
                low, high, has_signs = 0., 255., False
            fields.append({"name": names[k], "label": label_of(names[k]), "unit": pretty(run.unit("points", array_of(run, names[k]))),
                           "low": low, "high": high, "diverging": has_signs, "bodies": names[k] == "body"})
        columns = data[:, :, [*range(dim + 1), *(dim + 1 + k for k in kept)]]
        text = pack(columns, dim, lower, lower + width, [(0., largest)] + [(field["low"], field["high"]) for field in fields])
        if len(text) <= budget or len(frames) <= 2 and data.shape[1] <= 1000:
            break
        # Halve the number of frames or of points.
        if len(frames) > 21 or data.shape[1] <= 4000:
            keep = sorted({*range(0, len(frames), 2), len(frames) - 1})
            frames, data = [frames[k] for k in keep], data[keep]
        else:
            data, stride = data[:, ::2], stride * 2
    rigid, view = rigid_data(run, times[frames], lower, lower + width)
    return {"times": numbers(times[frames], 6), "n": int(data.shape[1]), "dim": dim, "lower": numbers(lower, 9),
            "upper": numbers(lower + width, 9), "size": number(largest * stride**(1. / dim)), "fields": fields, "data": text,
            "up": up_axis(run, up) if dim == 3 else 1, "rigid": rigid, "view": [numbers(end, 6) for end in view],
            "box": run.grid_box, "bounded": run.parameters.get("Scheme/Formulation") != "total Lagrangian", "walls": run.walls, "all_times": len(times), "stride": stride}


# The page.

def run_data(run, budget, fields, has_points, up):
    kinds = [kind for kind, _ in run.messages]
    state = "failed" if kinds[-1:] == ["Error"] and not run.summary else "finished" if run.summary else "unfinished"
    if kinds[-1:] == ["Error"] and run.summary:
        state = "stopped"
    summary = run.summary
    parts = list(summary.get("parts", {}).items())
    if parts:
        parts.append(("output, other", summary["wall_time"] - sum(seconds for _, seconds in parts)))
    try:
        frames = frames_data(run, budget, fields, up) if has_points else None
    except ResultsError as error:
        print(f"no moving points: {error}", file=sys.stderr)
        frames = None
    try:
        bodies, rigid = body_data(run), rigid_rows(run)
    except ResultsError:
        bodies, rigid = [{"name": name} for name in run.bodies], []
    return {"name": run.name, "title": run.title, "folder": str(run.folder), "dim": run.dim, "state": state,
            "facts": facts(run), "bodies": bodies, "rigid_bodies": rigid, "messages": run.messages, "parameters": parameter_data(run),
            "all_parameters": [[name, line.value, pretty(line.unit)] for name, line in run.parameter_lines.items()],
            "table": table_data(run), "probes": probes_data(run), "newton": newton_data(run),
            "parts": [[name, number(seconds, 4)] for name, seconds in parts], "comparison": comparison_data(run), "frames": frames,
            "mass_unit": pretty(run.unit("statistics.csv", "mass"))}


def sweep_data(folder):
    """Return the errors of the runs of a sweep, one line for each kind."""
    table = read_table(folder / "convergence.csv")
    kinds = list(zip(table["formulation"], table["mass"], table["p"].astype(int)))
    lines = []
    for kind in dict.fromkeys(kinds):
        mine = sorted((k for k in range(len(kinds)) if kinds[k] == kind), key=lambda k: table["cells"][k])
        lines.append({"name": f"{kind[0]}, {kind[1]}, p = {kind[2]}", "cells": numbers(table["cells"][mine]),
                      "errors": numbers(table["error_l2"][mine], 4), "orders": numbers(table["order"][mine], 3)})
    return lines


def guide():
    """Return the address of the guide's page that explains the figures, if it is on this machine."""
    try:
        return project_file(GUIDE).resolve().as_uri()
    except Error:
        return ""


def main(program=None):
    parser = parser_of(program, __doc__, "results of a run, or of a sweep")
    parser.add_argument("--field", action="append", default=[], metavar="NAME",
                        help="also show this field of points, such as J or velocity_x, before the others; may be repeated")
    parser.add_argument("--up", choices=["x", "y", "z"], help="vertical axis in 3D, as for scripts/picture")
    parser.add_argument("--no-points", action="store_true", help="leave out the moving points, for a smaller file")
    parser.add_argument("--output", type=Path, metavar="FILE", help="output file (default: report.html in the folder of the results)")
    run_command(parser, lambda arguments: print(write(**vars(arguments))))


def write(folders, field=(), no_points=False, output=None, up=None):
    """Write the page, and return its name."""
    if np is None:
        raise ResultsError(how_to_install("numpy"))
    field = names_of_fields(field)
    n_given, sweep = len(folders), None
    place = folders[0] if len(folders) == 1 else Path(os.path.commonpath([folder.resolve().parent for folder in folders]))
    if len(folders) == 1 and place.is_dir() and not (place / "statistics.csv").exists():
        folders = runs_in(place)
        if not folders:
            raise ResultsError(f"{place} has no results of a simulation: no statistics.csv, and none in folders below.")
        if (place / "convergence.csv").exists():
            sweep = sweep_data(place)
        if len(folders) > 8:
            print(f"the last 8 of {len(folders)} runs are shown", file=sys.stderr)
            folders = folders[-8:]
    runs = [Run(folder) for folder in folders]
    if not no_points:
        for run in runs:
            for name in field:
                check_field(run, name)
    names = [run.name for run in runs]
    data = {"runs": [run_data(run, BUDGET // len(runs), field, not no_points, up) for run in runs], "sweep": sweep,
            "guide": guide(),
            "title": place.resolve().name.replace("_", " ") if len(runs) > 1 and n_given == 1
            else " and ".join(run.title for run in runs)}
    # Folders distinguish runs of the same name.
    for entry, run in zip(data["runs"], runs):
        if names.count(run.name) > 1:
            entry["title"] = f"{run.folder.resolve().parent.name}/{run.name}"
    text = json.dumps(data, separators=(",", ":"), allow_nan=False, ensure_ascii=False).replace("</", "<\\/")
    title = data["title"].replace("&", "&amp;").replace("<", "&lt;")
    page = TEMPLATE.read_text(encoding="utf-8").replace("@TITLE@", title).replace('"@DATA@"', text, 1)
    file = path_of(output or place / "report.html")
    try:
        file.write_text(page, encoding="utf-8")
    except OSError as error:
        raise ResultsError(f"{file} cannot be written: {error.strerror}.") from None
    return file

