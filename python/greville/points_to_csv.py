"""Write the points of a file of VTK (.vtu, .vtp, .pvtu, .pvtp or .vtk) and their arrays
as a table that 'Body NAME/Points file' takes. Columns are x, y, z and the arrays at
points; an array with several components becomes as many columns: NAME_x, NAME_y, NAME_z of
three, NAME_xx, NAME_yy, NAME_zz, NAME_xy, NAME_yz, NAME_xz of six, NAME_xx, NAME_xy,
... of nine. Points shared by cells are written once. Needs Debian's python3-vtk9.
"""
import argparse
import sys
from pathlib import Path

from .command import run_command
from .results import ResultsError, how_to_install

ENDINGS = {3: ["x", "y", "z"], 6: ["xx", "yy", "zz", "xy", "yz", "xz"],
           9: [a + b for a in "xyz" for b in "xyz"]}
XML = (".vtu", ".vtp", ".pvtu", ".pvtp")


def read(file):
    """Return the data set of a file; messages of VTK on a damaged file become errors."""
    try:
        from vtkmodules.vtkCommonCore import vtkLogger
        from vtkmodules.vtkIOLegacy import vtkGenericDataObjectReader
        from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader
    except ImportError:
        raise ResultsError(how_to_install("vtkmodules")) from None
    ending = Path(file).suffix.lower()
    if ending not in XML + (".vtk",):
        raise ResultsError(f"<{file}> ends with <{ending}>, none of {', '.join(XML)}, .vtk.")
    if not Path(file).is_file():
        raise ResultsError(f"there is no file <{file}>.")
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    reader = vtkXMLGenericDataObjectReader() if ending in XML else vtkGenericDataObjectReader()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(True))
    reader.SetFileName(file)
    reader.Update()
    data = reader.GetOutput()
    if errors or data is None or not hasattr(data, "GetPointData") or not data.GetNumberOfPoints():
        raise ResultsError(f"VTK finds no points in <{file}>.")
    return data


def columns_of(name, values):
    """Return the columns of an array of n or n x m numbers."""
    if values.ndim == 1:
        return [(name, values)]
    m = values.shape[1]
    endings = ENDINGS[3][:m] if m <= 3 else ENDINGS.get(m, [str(k) for k in range(m)])
    return [(f"{name}_{ending}", values[:, k]) for k, ending in enumerate(endings)]


def main(program=None):
    parser = argparse.ArgumentParser(prog=program, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", metavar="FILE", help="points; the table goes to the standard output")
    run_command(parser, lambda arguments: write(arguments.file))


def write_table(stream, x, arrays):
    """Write columns of positions and of arrays by name to a stream."""
    import numpy as np
    columns = [("xyz"[d], x[:, d]) for d in range(3)]
    for name, values in arrays.items():
        columns += columns_of(name, values)
    print(",".join(name for name, _ in columns), file=stream)
    np.savetxt(stream, np.column_stack([values.astype(float) for _, values in columns]), "%.9g", ",")


def write(file):
    data = read(file)
    from vtkmodules.util.numpy_support import vtk_to_numpy
    arrays = data.GetPointData()
    given = [arrays.GetArray(k) for k in range(arrays.GetNumberOfArrays())]
    # Arrays of strings have no columns.
    return write_table(sys.stdout, vtk_to_numpy(data.GetPoints().GetData()),
                       {array.GetName(): vtk_to_numpy(array) for array in given if array is not None})
