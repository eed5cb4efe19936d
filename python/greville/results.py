"""Reads the results of a run of Greville from its folder.

    import greville
    run = greville.Run("output/dam_break")
    print(run.statistics["kinetic"].max(), run.points(-1)["velocity"].shape)

Tables need the Python standard library only; their columns are arrays of numpy
where it is installed, lists otherwise. Points, grids and surfaces need numpy, and
Debian's python3-vtk9 (or vtk, or pyvista, which brings it) or python3-meshio.
All errors are ResultsError with one message.
"""
import csv
import json
import re
import sys
from numbers import Integral, Real
from pathlib import Path
from xml.etree import ElementTree

try:
    import numpy as np
except ImportError:
    np = None

# Parameters name measured data relative to their file; its copy is among the results.
PARAMETER_FOLDER = Path(__file__).resolve().parents[2] / "prm" / "simulation"
AXES = "xyz"
# The files of a run for ParaView.
SERIES = "fields.pvd"


# The Debian packages of the modules.
PACKAGES = {"numpy": "python3-numpy", "matplotlib": "python3-matplotlib", "vtkmodules": "python3-vtk9",
            "meshio": "python3-meshio", "PIL": "python3-pil", "yaml": "python3-yaml", "sympy": "python3-sympy"}


class Error(Exception):
    """The base class of errors of this package."""


class ResultsError(Error):
    """A message for the user on unreadable results and the reason."""


def how_to_install(*modules):
    """Return instructions if none of these modules is installed, and for which Python."""
    packages = " or ".join(PACKAGES[module] for module in modules)
    return (f"{' or '.join(modules)} is missing in {sys.executable}: install Debian's {packages} for /usr/bin/python3 "
            f"(sudo apt install {PACKAGES[modules[0]]}), or use this Python's own package manager.")


def pretty(unit):
    return unit.replace("^2", "²").replace("^3", "³").replace(" / ", "/")


def path_of(name):
    """Return the path with this name; refuse other types."""
    try:
        path = Path(name)
    except TypeError:
        path = None
    if path is None or "\0" in str(path):
        raise ResultsError(f"{name!r} is no name of a file or folder.")
    return path


def names_of_fields(names):
    """Return a list of names. A single name may be given without a list."""
    names = [names] if isinstance(names, str) else names
    if not hasattr(names, "__iter__") or not all(isinstance(name, str) for name in names):
        raise ResultsError(f"Fields are a list of names, not {names!r}.")
    return list(names)


def read_text(path):
    try:
        return path_of(path).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ResultsError(f"There is no file {path}.") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ResultsError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}.") from None


class Table(dict):
    """Columns by name, all of one length. Columns of words are lists."""

    def __init__(self, columns, path, units=None):
        super().__init__(columns)
        self.path, self.units = Path(path), units or {}

    def __missing__(self, name):
        raise ResultsError(f"{self.path} has no column {name}. There are: {', '.join(self)}.")

    @property
    def n_rows(self):
        return len(next(iter(self.values()), ()))

    def rows(self):
        """Yield one dict per row, like csv.DictReader."""
        return [dict(zip(self, values)) for values in zip(*self.values())]


def column_of(words):
    """Return numbers if all words are numbers or empty (NaN), else the words."""
    if words and not any(words):
        return list(words)
    try:
        numbers = [float(word) if word else float("nan") for word in words]
    except ValueError:
        return list(words)
    return numbers if np is None else np.array(numbers)


def word_in(values):
    """Return the first word of a column that is not a number; None if there is none."""
    for value in values:
        if isinstance(value, str) and value:
            try:
                float(value)
            except ValueError:
                return value
    return None


def read_table(path, units=None, may_be_empty=False):
    """Return the columns of a CSV file with a header; lines with # are comments."""
    lines = [line for line in read_text(path).splitlines() if line.strip() and line[0] != "#"]
    if len(lines) < (1 if may_be_empty else 2):
        raise ResultsError(f"{path} has no rows.")
    rows = list(csv.reader(lines))
    names = [name.strip() for name in rows[0]]
    for number, row in enumerate(rows[1:], 1):
        if len(row) != len(names):
            # The last line may be incomplete in a running or killed run.
            if number == len(rows) - 1 and number > 1:
                rows.pop()
                break
            raise ResultsError(f"Row {number} of {path} has {len(row)} columns, its header {len(names)}.")
    columns = list(zip(*rows[1:])) or [()] * len(names)
    return Table({name: column_of(column) for name, column in zip(names, columns)}, path, units)


class Parameter:
    """A line of parameters.prm. default is None if the value is the default."""

    def __init__(self, value, default, unit):
        self.value, self.default, self.unit = value, default, unit


def read_parameter_text(text):
    """Return {"Section/Name": Parameter}, in the order of the text of a parameter file."""
    result, section, comment = {}, [], []
    for line in text.splitlines():
        line = line.strip()
        if line.startswith("#"):
            comment.append(line.lstrip("# "))
            continue
        content, _, remark = line.partition("#")
        content = content.strip()
        if content.startswith("subsection "):
            section.append(content[len("subsection "):].strip())
        elif content == "end" and section:
            section.pop()
        elif content.startswith("set "):
            name, _, value = content[len("set "):].partition("=")
            default = re.match(r"\s*default:(.*)", remark)
            unit = re.search(r"Unit: ([^.]*)\.", " ".join(comment))
            result["/".join(section + [name.strip()])] = Parameter(
                value.strip(), default.group(1).strip() if default else None,
                unit.group(1) if unit and unit.group(1) != "none" else "")
        comment = []
    return result


def names_in(text):
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def numbers_in(text):
    return [float(word) for word in names_in(text)]


class Fields(dict):
    """Points with their fields by name. x has the positions, one row per point, with three columns."""

    def __init__(self, x, fields, time, path, dataset):
        super().__init__(fields)
        self.x, self.time, self.path, self.dataset = x, time, path, dataset

    def __missing__(self, name):
        raise ResultsError(f"{self.path} has no field {name}. There are: {', '.join(self)}.")

    def component(self, name):
        """Return a field with one number per point: the length of a vector, or a component such as velocity_x."""
        if name == "speed" and name not in self:
            name = "velocity"
        if name not in self and isinstance(name, str) and name[-2:-1] == "_" and name[-1] in AXES \
                and name[:-2] in self and self[name[:-2]].ndim == 2:
            return self[name[:-2]][:, AXES.index(name[-1])].astype(float)
        values = self[name].astype(float)
        return np.linalg.norm(values, axis=1) if values.ndim == 2 else values

    def as_pyvista(self):
        """Return the VTK data set for pyvista, which must be installed."""
        try:
            import pyvista
        except ImportError:
            raise ResultsError(f"pyvista is missing in {sys.executable}: install it with this Python's own package manager.") from None
        if self.dataset is not None:
            return pyvista.wrap(self.dataset)
        points = pyvista.PolyData(self.x)
        for name, values in self.items():
            points[name] = values
        return points

    def save_csv(self, path):
        """Write positions and fields as a table, a row for each point, which 'Body NAME/Points file' takes."""
        from . import points_to_csv
        try:
            with open(path_of(path), "w", encoding="utf-8") as stream:
                points_to_csv.write_table(stream, self.x, self)
        except OSError as error:
            raise ResultsError(f"{path} cannot be written: {error.strerror}.") from None


def content_of(path):
    """Return the number of points of a .vtu file and the names of its fields. Refuse a truncated file, which VTK would read as one without points."""
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise ResultsError(f"{path} cannot be read: {error.strerror}.") from None
    pieces = re.findall(rb'<Piece\b[^>]*\bNumberOfPoints="(\d+)"', content)
    if b"<VTKFile" not in content[:4096] or not pieces or not content.rstrip().endswith(b"</VTKFile>"):
        raise ResultsError(f"{path} is no file of VTK, or a part of one.")
    data = re.search(rb"<PointData\b.*?</PointData>", content, re.DOTALL)
    names = re.findall(rb'<DataArray\b[^>]*\bName="([^"]*)"', data.group(0)) if data else []
    return sum(map(int, pieces)), [name.decode() for name in names]


def read_with_vtk(path, names):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    selection = reader.GetPointDataArraySelection()
    selection.DisableAllArrays()
    for name in names:
        selection.EnableArray(name)
    reader.Update()
    vtkObject.SetGlobalWarningDisplay(shown)
    grid = reader.GetOutput()
    if not grid.GetNumberOfPoints():
        return np.zeros((0, 3)), {name: np.zeros(0) for name in names}, grid
    arrays = {name: grid.GetPointData().GetArray(name) for name in names}
    for name, array in arrays.items():
        if array is None or array.GetNumberOfTuples() != grid.GetNumberOfPoints():
            raise ResultsError(f"The field {name} of {path} cannot be read: the file is damaged.")
    return (vtk_to_numpy(grid.GetPoints().GetData()), {name: vtk_to_numpy(array) for name, array in arrays.items()}, grid)


def read_with_meshio(path, names):
    import meshio
    try:
        mesh = meshio.read(path)
    except Exception as error:   # Many types of exceptions occur.
        raise ResultsError(f"{path} cannot be read: {error}.") from None
    return mesh.points, {name: mesh.point_data[name] for name in names}, mesh


def read_fields(path, names=None, time=None):
    """Return the Fields of a .vtu file: all, or only these names."""
    if np is None:
        raise ResultsError("Fields cannot be read: " + how_to_install("numpy"))
    n_points, available = content_of(path)
    names = None if names is None else names_of_fields(names)
    for name in names or ():
        if name not in available:
            raise ResultsError(f"{path} has no field {name}. There are: {', '.join(available)}.")
    names = available if names is None else list(dict.fromkeys(names))
    try:
        x, fields, dataset = read_with_vtk(path, names)
    except ImportError:
        try:
            # meshio cannot read a file without points.
            x, fields, dataset = read_with_meshio(path, names) if n_points else (np.zeros((0, 3)), {name: np.zeros(0) for name in names}, None)
        except ImportError:
            raise ResultsError("Fields cannot be read: " + how_to_install("vtkmodules", "meshio")) from None
    if len(x) != n_points:
        raise ResultsError(f"{path} has {n_points} points, of which {len(x)} can be read: the file is damaged.")
    return Fields(x.astype(float), fields, time, Path(path), dataset)


def names_in_series(folder):
    """Return the names in a run's .pvd file for ParaView, in alphabetic order."""
    path = Path(folder) / SERIES
    return sorted(set(re.findall(r'\bname="([^"]*)"', read_text(path)))) if path.exists() else []


class Series:
    """The times and files of a name in a .pvd file. series(k) returns the Fields at the kth time, series(0.5) at the time nearest to 0.5 s."""

    def __init__(self, path, name):
        self.path = Path(path)
        try:
            sets = [entry for entry in ElementTree.fromstring(read_text(path)).iter("DataSet") if entry.get("name") == name]
        except ElementTree.ParseError as error:
            raise ResultsError(f"{path} is no file of ParaView: {error}.") from None
        if not sets:
            raise ResultsError(f"{path} has no times of {name}.")
        self.files = [self.path.parent / entry.get("file", "") for entry in sets]
        try:
            times = [float(entry.get("timestep", "")) for entry in sets]
        except ValueError as error:
            raise ResultsError(f"{path} is no file of ParaView: a time of it is not a number: {error}.") from None
        self.times = times if np is None else np.array(times)

    def __len__(self):
        return len(self.files)

    @property
    def names(self):
        """Return the names of the fields in the first file."""
        return content_of(self.files[0])[1]

    def place_of(self, k):
        """Return the index of the time nearest to a float, or k itself."""
        if not isinstance(k, Real) or isinstance(k, bool) or k != k:
            raise ResultsError(f"A time of {self.path} is a whole number, or a float in s, not {k!r}.")
        if not isinstance(k, Integral):
            return min(range(len(self)), key=lambda i: abs(self.times[i] - k))
        if not -len(self) <= k < len(self):
            raise ResultsError(f"{self.path} has {len(self)} times, and no number {k}.")
        return k

    def at(self, time):
        """Return the Fields nearest to a time in s."""
        return self(float(time) if isinstance(time, Real) and not isinstance(time, bool) else time)

    def __call__(self, k, names=None):
        k = self.place_of(k)
        return read_fields(self.files[k], names, self.times[k])


def has_points(folder):
    """Return whether a run has written points to a folder."""
    return (Path(folder) / SERIES).exists()


class Run:
    """The results of a run. Files are read on demand.

    parameters              {"Section/Name": value}
    changed_parameters      [(name, value, default, unit)] of parameters that are not defaults
    bodies                  the names of bodies, in the order of the field 'body'
    statistics, probes      Tables
    newton                  a Table: iterations of Newton's method; None with explicit steps
    summary                 summary.json as a dict; empty for a running or failed run
    messages                [(kind, text)], where kind is Warning, Error or Note
    unit(file, column)      of units.csv, such as unit("points", "velocity")
    times                   times of the points
    points(k), grid(k), surface(k)   Fields at the kth time, or nearest to a float in s; names=[...] reads only these
    rigid_bodies            the names of rigid bodies that have been written
    plot(k)                 a Picture of the points at the kth time, which notebooks show
    report()                writes report.html, and returns its path
    rigid(name, time)       facets of a rigid body at a time: corners (facet, corner, xyz), and their Fields
    """

    def __init__(self, folder):
        self.folder = path_of(folder)
        if not self.folder.is_dir():
            raise ResultsError(f"{folder} is not a folder." if self.folder.exists() else f"There is no folder {folder}.")
        if not (self.folder / "statistics.csv").exists() and not has_points(self.folder):
            raise ResultsError(f"{folder} has the results of a sweep, which greville.Sweep reads." if (self.folder / "sweep.csv").exists()
                               else f"{folder} has no results of a simulation: no statistics.csv or {SERIES}.")
        self.name = self.folder.resolve().name
        self._known = {}

    def _once(self, name, read):
        if name not in self._known:
            self._known[name] = read()
        return self._known[name]

    def _table(self, name, may_be_missing=False, may_be_empty=False):
        path = self.folder / name
        if may_be_missing and not path.exists():
            return None
        units = {column: unit for (file, column), unit in self.units.items() if file == name}

        def read():
            table = read_table(path, units, may_be_empty)
            for column, values in table.items():
                word = word_in(values) if isinstance(values, list) else None
                if word:
                    raise ResultsError(f"{path} is damaged: its column {column} has <{word}>, which is not a number.")
            return table
        return self._once(name, read)

    @property
    def title(self):
        return self.name.replace("_", " ")

    @property
    def parameter_lines(self):
        def read():
            # Files of the run, or of its sweep.
            paths = (self.folder / "parameters.prm", self.folder.resolve().parent / "parameters.prm")
            path = next((path for path in paths if path.exists()), None)
            if path is None:
                return {}
            lines = read_parameter_text(read_text(path))
            if not lines:
                raise ResultsError(f"{path} has no parameters.")
            return lines
        return self._once("parameters", read)

    @property
    def parameters(self):
        return {name: line.value for name, line in self.parameter_lines.items()}

    @property
    def changed_parameters(self):
        return [(name, line.value, line.default, line.unit) for name, line in self.parameter_lines.items()
                if line.default is not None]

    @property
    def units(self):
        path = self.folder / "files/units.csv"

        def read():
            if not path.exists():
                return {}
            table = read_table(path)
            return {(file, column): unit for file, column, unit in zip(table["file"], table["column"], table["unit"])}
        return self._once("units", read)

    def unit(self, file, column):
        """Return the unit in the form printed beside a number; empty without unit."""
        unit = self.units.get((file, column), "")
        return "" if unit == "1" else unit

    @property
    def dim(self):
        if "Simulation/Dimension" in self.parameters:
            return self._numbers("Simulation/Dimension", int)[0]
        return 3 if "center_z" in self.statistics else 2

    @property
    def bodies(self):
        return names_in(self.parameters.get("Simulation/Bodies"))

    def _numbers(self, name, kind=float):
        """Return the numbers of a parameter; empty if it is missing."""
        try:
            return [kind(word) for word in names_in(self.parameters.get(name))]
        except ValueError:
            raise ResultsError(f"The parameters of {self.folder} are damaged: '{name}' is <{self.parameters[name]}>, "
                               "which is not a number.") from None

    @property
    def grid_box(self):
        """Return two corners of the grid, or None if parameters are missing."""
        corners = [self._numbers(f"Grid/{name} corner") for name in ("Lower", "Upper")]
        return corners if all(corners) else None

    @property
    def grid_cells(self):
        return self._numbers("Grid/Cells", int)

    def grid_edges(self, d):
        """Return the edges of the cells in direction d; of a refined grid those of level 0."""
        lower, upper = self.grid_box
        return np.array(self._numbers(f"Grid/Knots {'xyz'[d]}")) if self.parameters.get(f"Grid/Knots {'xyz'[d]}") else \
            np.linspace(lower[d], upper[d], self.grid_cells[d] + 1)

    def cell_boxes(self, k):
        """Return two corners of each cell with points of a refined grid at the kth time; none for other grids."""
        if not self.parameters.get("Grid/Refinement") or "grid" not in names_in_series(self.folder):
            return np.zeros((0, 2, self.dim))
        # Cells are patches of as many nodes.
        nodes = self.grid(k, []).x[:, :self.dim].reshape(-1, (int(self.parameters["Grid/Order"]) + 1)**self.dim, self.dim)
        return np.stack([nodes.min(axis=1), nodes.max(axis=1)], axis=1)

    @property
    def walls(self):
        """Return the type of each wall: {"Left": "free", ...}."""
        names = ("Left", "Right", "Bottom", "Top", "Back", "Front")[:2 * self.dim]
        return {name: self.parameters.get(f"Walls/{name}", "free") for name in names}

    @property
    def statistics(self):
        return self._table("statistics.csv")

    @property
    def probes(self):
        return self._table("probes.csv", may_be_missing=True, may_be_empty=True)

    @property
    def newton(self):
        return self._table("newton.csv", may_be_missing=True, may_be_empty=True)

    @property
    def summary(self):
        path = self.folder / "summary.json"

        def read():
            try:
                summary = json.loads(read_text(path)) if path.exists() else {}
            except json.JSONDecodeError as error:
                raise ResultsError(f"{path} is no JSON: {error}.") from None
            if not isinstance(summary, dict):
                raise ResultsError(f"{path} is no summary of a run.")
            return summary
        return self._once("summary", read)

    @property
    def messages(self):
        path = self.folder / "messages.log"
        lines = read_text(path).splitlines() if path.exists() else []
        return [tuple(line.split(": ", 1)) for line in lines if ": " in line]

    def series(self, name):
        """Return the Series of points, grid, surface, or grid_BODY, surface_BODY if bodies have their own grids."""
        return self._once(f"{name} of {SERIES}", lambda: Series(self.folder / SERIES, name))

    @property
    def surfaces(self):
        """Return the names of written series of surfaces."""
        return [name for name in names_in_series(self.folder) if name == "surface" or name.startswith("surface_")]

    @property
    def has_points(self):
        return has_points(self.folder)

    @property
    def times(self):
        return self.series("points").times

    @property
    def point_fields(self):
        return self.series("points").names

    def points(self, k, names=None):
        return self.series("points")(k, names)

    def plot(self, k=-1, **options):
        """Return a Picture of the points at the kth time, or nearest to a time in s; options: field, magnify, mesh, rigid_bodies, up ('x', 'y', 'z')."""
        from . import pictures
        return pictures.picture_of(self, self.series("points").place_of(k), **options)

    def report(self, **options):
        """Write report.html, and return its path; options: field (a list), no_points, output, up ('x', 'y', 'z')."""
        from . import report
        return report.write([self.folder], **options)

    def grid(self, k, names=None, body=None):
        return self.series("grid" + (f"_{body}" if body else ""))(k, names)

    def surface(self, k, names=None, body=None):
        return self.series("surface" + (f"_{body}" if body else ""))(k, names)

    @property
    def rigid_bodies(self):
        return [name for name in names_in(self.parameters.get("Simulation/Rigid bodies"))
                if f"rigid_{name}" in names_in_series(self.folder)]

    def rigid(self, name, time):
        fields = self.series(f"rigid_{name}").at(time)
        return fields.x.reshape(-1, self.dim, 3), fields

    def sizes(self, k=None, points=None):
        """Return the edges of cubes (2D: squares) with the volumes of the points, m, at the kth time or of given points."""
        if "size" in self.point_fields:
            return (points if points is not None and "size" in points else self.points(k, ["size"]))["size"].astype(float)
        first = self._once("volumes", self._estimate_volumes)
        known = [name for name in ("J", "body") if name in self.point_fields]
        if points is None or not set(known) <= set(points):
            points = self.points(k, known)
        body = points["body"].astype(int) if "body" in points else np.zeros(len(points.x), int)
        return (first[body] * np.clip(points["J"] if "J" in points else 1., 0.3, 3.))**(1. / self.dim)

    def _estimate_volumes(self):
        """Estimate the volumes of bodies from distance and mass of points, for results without the field size."""
        # Without these fields, all points belong to one body.
        points = self.points(0, [name for name in ("J", "body", "density") if name in self.point_fields])
        body = points["body"].astype(int) if "body" in points else np.zeros(len(points.x), int)
        volumes = np.ones(body.max(initial=0) + 1)
        for b in np.unique(body):
            mine = points.x[body == b]
            sample = mine[np.linspace(0, len(mine) - 1, 200).astype(int)] if len(mine) > 1 else []
            squares = [np.partition(((mine - s)**2).sum(axis=1), 1)[1] for s in sample] or [1e-4]
            volumes[b] = np.median(squares)**(self.dim / 2)
        if (self.folder / "statistics.csv").exists() and {"J", "density"} <= set(points):
            volumes *= self.statistics["mass"][0] / np.sum(points["density"] * volumes[body] * points["J"])
        return volumes

    def reference(self, name):
        """Return the measured data of the parameter Reference/NAME: (x, y, whose), or None.

        name is 'Surface file' or 'Series file'; x and y are the first two columns.
        """
        text = self.parameters.get("Reference/" + name)
        if not text:
            return None
        folders = (self.folder, PARAMETER_FOLDER, Path.cwd())
        path = next((folder / text for folder in folders if (folder / text).exists()), None)
        if path is None:
            return None
        table = read_table(path)
        if len(table) != 2 or any(word_in(values) for values in table.values()):
            raise ResultsError(f"{path} of the parameter 'Reference/{name}' has not two columns of numbers.")
        x, y = table.values()
        author = re.search(r"^#\s*(.{1,60}?\(\d{4}\))", read_text(path), re.MULTILINE)
        return x, y, author.group(1) if author else path.stem.replace("_", " ")

    @property
    def work(self):
        """Return the nonzero columns of work in statistics.csv."""
        return [name for name in self.statistics if name.startswith("work_") and any(w != 0 for w in self.statistics[name])]

    def energy_balance(self):
        """Return (change of energy, work, residual) over time.

        The energy is kinetic + strain + dissipation; gravity counts as work. The residual is negative if
        transfers, the filter or friction have taken energy without counting it.
        """
        if np is None:
            raise ResultsError("There is no balance of energy: " + how_to_install("numpy"))
        table = self.statistics
        energy = table["kinetic"] + table["strain"] + table["dissipation"]
        work = sum((table[name] for name in self.work), np.zeros(len(energy)))
        change = energy - energy[0]
        return change, work, change - work


def runs_in(folder):
    """Return the run folders below the folder of a sweep, in numerical order."""
    return sorted((path.parent for path in Path(folder).glob("*/statistics.csv")),
                  key=lambda run: [int(t) if t.isdigit() else t for t in re.split(r"(\d+)", run.name)])
