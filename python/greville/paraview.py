"""Open a run in ParaView with one command.

    scripts/paraview output/dam_break        writes output/dam_break/files/view.py
    paraview --script=output/dam_break/files/view.py

view.py is a script for ParaView 5.10 or later: points as boxes (3D: spheres) of
their size, coloured by their bodies with a legend of names, or by a field over all
times, with the walls of the grid, surfaces as dark points with arrows for loads, rigid
bodies, and the time. It works in a moved folder if it is run by
pvpython, which also writes a picture of the last time:

    pvpython output/dam_break/files/view.py last.png

Needs only Python. The results need the field size, which 'Output/Fields' has by
default.
"""
from .command import parser_of, run_command
from .display import array_of, check_field, main_field, up_axis
from .results import ResultsError, Run, names_in_series

SCRIPT = '''# Written by scripts/paraview of Greville:
#   paraview --script={path}
#   pvpython {path} picture.png
import os
import sys

from paraview.simple import *

# What is shown: a field of points, and of a vector 'Magnitude', 'X', 'Y' or 'Z'.
FIELD, COMPONENT = {field!r}, {component!r}
FOLDER = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) if "__file__" in globals() else {folder!r}
UNITS = {units!r}
BODIES, RIGID = {bodies!r}, {rigid!r}
LOWER, UPPER = {lower!r}, {upper!r}   # of the grid, m
NAMES = {names!r}   # in fields.pvd
IS_3D, UP = {is_3d!r}, {up!r}
COLOURS, GREY = {colours!r}, [0.7 if IS_3D else 0.35] * 3

paraview.simple._DisableFirstRenderCameraReset()
view = GetActiveViewOrCreate("RenderView")
# On white, so that the texts are dark.
view.UseColorPaletteForBackground = 0
view.Background = [1., 1., 1.]
view.OrientationAxesVisibility = int(IS_3D)

run = PVDReader(registrationName="fields", FileName=os.path.join(FOLDER, "fields.pvd"))

def part(name):
    """Return the source of a name in fields.pvd: a block, or the whole."""
    if NAMES == [name]:
        return run
    return ExtractBlock(registrationName=name, Input=run, Selectors=["/Root/" + name])

points = part("points")
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToLast()

# The edge of a point's cube, or square, is the field size.
glyphs = Glyph(registrationName="sizes", Input=points, GlyphType="Sphere" if IS_3D else "Box")
glyphs.GlyphMode = "All Points"
glyphs.OrientationArray = ["POINTS", "No orientation array"]
glyphs.ScaleArray = ["POINTS", "size"]
glyphs.ScaleFactor = 1.25   # Without gaps.
if IS_3D:
    glyphs.GlyphType.ThetaResolution = glyphs.GlyphType.PhiResolution = 8
else:
    glyphs.GlyphType.ZLength = 0.01
display = Show(glyphs, view)
Hide(points, view)
if not IS_3D:
    display.Ambient, display.Diffuse = 1., 0.

def colour_by(field, component="Magnitude"):
    """Colour the points by another field, also from ParaView's Python shell."""
    array = points.PointData[field]
    is_vector = array is not None and array.GetNumberOfComponents() > 1
    ColorBy(display, ("POINTS", field, component) if is_vector else ("POINTS", field))
    table = GetColorTransferFunction(field)
    if field == "body":
        table.InterpretValuesAsCategories = 1
        table.Annotations = [text for k, name in enumerate(BODIES + RIGID) for text in (str(k), name)]
        table.IndexedColors = [c for k in range(len(BODIES)) for c in COLOURS[k % len(COLOURS)]] + GREY * len(RIGID)
    else:
        display.RescaleTransferFunctionToDataRangeOverTime()
        table.ApplyPreset("Viridis (matplotlib)", True)
    bar = GetScalarBar(table, view)
    bar.Title = field.replace("_", " ") + (", " + UNITS[field] if UNITS.get(field) else "")
    bar.ComponentTitle = "" if component == "Magnitude" or not is_vector else component
    bar.TitleColor = bar.LabelColor = [0.1, 0.1, 0.1]
    display.SetScalarBarVisibility(view, True)
    HideUnusedScalarBars(view)
    Render()

walls = Box(registrationName="grid of the run")
walls.XLength, walls.YLength, walls.ZLength = (max(b - a, 1e-9) for a, b in zip(LOWER, UPPER))
walls.Center = [(a + b) / 2 for a, b in zip(LOWER, UPPER)]
outline = Show(walls, view)
outline.SetRepresentationType("Wireframe" if not IS_3D else "Outline")
outline.AmbientColor = outline.DiffuseColor = [0.4, 0.4, 0.4]

def show(source, colour):
    """Show a source in one colour, in 2D in front of the points."""
    shown = Show(source, view)
    shown.ColorArrayName = ["POINTS", ""]
    shown.AmbientColor = shown.DiffuseColor = colour
    shown.Position = [0., 0., 0. if IS_3D else 0.01]
    shown.LineWidth = 2.
    return shown

for name in {surfaces!r}:
    surface = part(name)
    dots = show(surface, [0.15] * 3)
    dots.SetRepresentationType("Points")
    dots.PointSize = 4
    dots.Visibility = int(not IS_3D)   # In 3D, the points hide most of them.
    loads = Glyph(registrationName="loads of " + name, Input=surface, GlyphType="Arrow")
    loads.OrientationArray = ["POINTS", "load"]
    loads.ScaleArray = ["POINTS", "load"]
    largest = surface.PointData["load"].GetRange(-1)[1] if surface.PointData["load"] else 0.
    loads.ScaleFactor = 0.1 * max(b - a for a, b in zip(LOWER, UPPER)) / largest if largest > 0 else 0.
    show(loads, [0.6, 0., 0.])

for name in RIGID:
    show(part("rigid_" + name), GREY)

clock = AnnotateTimeFilter(registrationName="time", Input=points)
clock.Format = "t = {{time:.4g}} s"
label = Show(clock, view)
label.Color = [0.1, 0.1, 0.1]
label.FontSize = 16
label.WindowLocation = "Upper Center"

middle = [(a + b) / 2 for a, b in zip(LOWER, UPPER)]
size = max(b - a for a, b in zip(LOWER, UPPER))
up = [float(k == UP) for k in range(3)]
if IS_3D:
    # From the outside, a bit from above.
    aside = [1. if k == (UP + 2) % 3 else 0.6 if k != UP else 0.5 for k in range(3)]
    view.CameraPosition = [m + 3. * size * a for m, a in zip(middle, aside)]
else:
    view.InteractionMode = "2D"
    view.CameraPosition = [middle[0], middle[1], 10. * size]
    up = [0., 1., 0.]
view.CameraFocalPoint, view.CameraViewUp = middle, up
ResetCamera(view)
colour_by(FIELD, COMPONENT)
SetActiveSource(points)

if sys.argv[-1].endswith(".png"):
    view.ViewSize = [1400, 800]
    ResetCamera(view)
    SaveScreenshot(sys.argv[-1], view, ImageResolution=[1400, 800])
    print(sys.argv[-1])
'''


def script_of(run, field, up):
    available = run.point_fields
    field = field or ("body" if len(run.bodies) > 1 and "body" in available else main_field(run)) or "size"
    if "size" not in available:
        raise ResultsError(f"{run.folder} has no field size, which glyphs need: 'Output/Fields' has to name it. "
                           f"There are: {', '.join(available)}.")
    check_field(run, field)
    name = array_of(run, field)
    component = "Magnitude" if field in ("speed", name) else field[-1].upper()
    if not run.grid_box:
        raise ResultsError(f"{run.folder} has no parameters.prm with the corners of the grid.")
    lower, upper = (corner + [0.] * (3 - run.dim) for corner in run.grid_box)
    up = up_axis(run, up) if run.dim == 3 else 1
    folder = run.folder.resolve()
    return SCRIPT.format(path=folder / "files/view.py", field=name, component=component, folder=str(folder),
                         units={name: run.unit("points", name) for name in available if run.unit("points", name)},
                         bodies=run.bodies, lower=lower, upper=upper, is_3d=run.dim == 3, up=up,
                         names=names_in_series(folder), surfaces=run.surfaces, rigid=run.rigid_bodies,
                         colours=[[0., .447, .698], [.835, .369, 0.], [0., .62, .451], [.8, .475, .655], [.902, .624, 0.], [.337, .706, .914]])


def main(program=None):
    parser = parser_of(program, __doc__)
    parser.add_argument("--field", metavar="NAME",
                        help="colour of points: speed, a field of points, or a component such as velocity_x. "
                             "Default: the bodies if there are several, else the field of scripts/picture")
    parser.add_argument("--up", choices=["x", "y", "z"], help="vertical axis in 3D, as for scripts/picture")
    run_command(parser, write)


def write(arguments):
    for folder in arguments.folders:
        file = folder / "files/view.py"
        text = script_of(Run(folder), arguments.field, arguments.up)
        try:
            file.write_text(text, encoding="utf-8")
        except OSError as error:
            raise ResultsError(f"{file} cannot be written: {error.strerror}.") from None
        print(f"paraview --script={file}")
