"""results.py PROJECT PROGRAM: what scripts read from a small implicit run.

Exit status 77 where numpy is missing; points are compared where VTK or meshio is.
"""
import base64
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

PROJECT, PROGRAM = Path(sys.argv[1]), sys.argv[2]
sys.path.insert(0, str(PROJECT / "python"))
sys.dont_write_bytecode = True
from greville import ResultsError, Run, display, read_table, results

try:
    import numpy as np
except ImportError:
    print("numpy is missing")
    sys.exit(77)

CASE = """
subsection Simulation
  set Bodies    = block, other
  set Materials = solid
end
subsection Grid
  set Upper corner = 2, 1
  set Cells        = 16, 8
end
subsection Time
  set End  = 0.04
  set Step = 0.01
end
subsection Scheme
  set Stress update = newmark
end
subsection Material solid
  set Model          = neo-hookean
  set Density        = 2
  set Young modulus = 100
end
subsection Body block
  set Material = solid
  set Shape    = box(0.25, 0.25, 0.75, 0.75)
  set Velocity = 0.5; 0
end
subsection Body other
  set Material = solid
  set Shape    = box(1.25, 0.25, 1.75, 0.75)
end
subsection Loads
  set Gravity = 0; -1
end
subsection Walls
  set Bottom = sliding
end
subsection Output
  set Fields every = 0.02
  set Probes       = 0.5, 0.5
end
"""
failed = 0


def check(what, holds):
    global failed
    if not holds:
        failed += 1
        print(f"FAILED: {what}")


def message_of(action):
    try:
        action()
    except ResultsError as error:
        return str(error)
    return ""


def has(module):
    try:
        __import__(module)
        return True
    except ImportError:
        return False


def has_vtk():
    return has("vtkmodules.vtkIOXML")


def can_read_points():
    return has_vtk() or has("meshio")


def check_tables(run):
    check("bodies", run.bodies == ["block", "other"] and run.dim == 2)
    check("columns", abs(run.statistics["mass"] - 1.).max() < 1e-12 and run.statistics.n_rows == 5)
    check("units", run.unit("statistics.csv", "kinetic") == "J / m" and run.unit("points", "J") == ""
          and run.unit("points", "velocity") == "m / s")
    check("probes", run.probes["x0"][-1] > run.probes["x0"][0])
    check("Newton's method", run.newton["converged"].min() == 1 and run.newton["step"].max() == 4)
    check("summary", run.summary["points"] == 128 and run.summary["steps"] == 4)
    check("parameters", ("Grid/Cells", "16, 8", "16, 16", "") in run.changed_parameters and run.walls["Bottom"] == "sliding")
    change, work, left = run.energy_balance()
    check("balance of energy", work[-1] > 0 and abs(left[-1]) < 1e-3 * work[-1] and abs(change[-1] - work[-1] - left[-1]) < 1e-14)
    check("message about a column", "has no column foo. There are: time, dt," in message_of(lambda: run.statistics["foo"]))
    check("message about a folder", message_of(lambda: Run("nowhere")) == "There is no folder nowhere.")
    results.np, numpy = None, results.np
    message = message_of(lambda: run.points(0))
    results.np = numpy
    check(f"message about numpy: {message}", f"numpy is missing in {sys.executable}: install Debian's python3-numpy" in message)
    check("scale of plastic strains", display.range_of_colours("plastic_strain", 0., 1e-4) == (0., 0.01)
          and display.range_of_colours("plastic_strain", 0., 0.5) == (0., 0.5)
          and display.range_of_colours("pressure", -1., -0.5) == (-1., -0.5))
    check("message about results", "has no results of a simulation" in message_of(lambda: Run(PROJECT)))
    # A run that is killed leaves a line that is not whole.
    (run.folder / "cut.csv").write_text("a,b\n1,2\n3")
    check("a cut line", list(read_table(run.folder / "cut.csv")["b"]) == [2.])
    (run.folder / "cut.csv").write_text("a,b\n1\n3,4\n")
    check("a wrong line", "has 1 columns, its header 2" in message_of(lambda: read_table(run.folder / "cut.csv")))


def check_points(run):
    points = run.points(-1)
    check("times", len(run.times) == 3 and abs(points.time - 0.04) < 1e-12)
    check("positions and displacements", abs((points.x - points["displacement"])[:, 1] - points.x[:, 1]).max() > 0
          and points.x.shape == (128, 3))
    check("mass of points", abs((points["density"] * run.sizes(-1, points)**2).sum() - 1.) < 1e-5)
    check("components", abs(points.component("velocity_y")).max() <= points.component("speed").max() + 1e-9)
    check("message about a field", "has no field foo. There are: " in message_of(lambda: run.points(0, ["foo"])))
    check("grid", "mass" in run.grid(-1, ["mass"]))


def check_pandas_and_xarray(run):
    """Execute the last block of the page about Python, which reads into pandas and xarray."""
    if not (has("pandas") and has("xarray")):
        print("without pandas or xarray: python3-pandas and python3-xarray are not installed")
        return
    found = {"run": run}
    exec((PROJECT / "doc/user/python.md").read_text().split("```python\n")[-1].split("```")[0], found)
    statistics, points = found["statistics"], found["points"]
    check("pandas", statistics.index[-1] == run.statistics["time"][-1] and statistics["kinetic"].iloc[-1] == run.statistics["kinetic"][-1])
    check("xarray", dict(points.sizes) == {"point": 128, "axis": 3} and abs(points["velocity"] - run.points(-1)["velocity"]).max() == 0)


def check_damage(run, has_points):
    """Files that are not whole, or not those of a run, are answered by a message."""
    folder = run.folder.parent / "damaged"
    half = lambda text: text[:len(text) // 2]
    cases = [("statistics.csv", lambda text: text.replace(b"0.01,", b"0 .01,", 1), lambda run: run.statistics,
              "which is not a number"),
             ("parameters.prm", lambda text: b"hello", lambda run: run.parameters, "parameters.prm has no parameters."),
             ("parameters.prm", lambda text: text.replace(b"Dimension", b"Dimension = x #", 1), lambda run: run.dim,
              "'Simulation/Dimension' is <x>, which is not a number."),
             ("summary.json", lambda text: b"[1]", lambda run: run.summary, "is no summary of a run."),
             ("fields.pvd", lambda text: text.replace(b'timestep="0.0', b'timestep="o.0'), lambda run: run.times,
              "a time of it is not a number")]
    if has_points:
        piece = "files/points_0002.vtu"
        cases += [(piece, half, lambda run: run.points(-1), f"{piece} is no file of VTK, or a part of one."),
                  (piece, lambda text: b"", lambda run: run.points(-1), f"{piece} is no file of VTK, or a part of one."),
                  (piece, lambda text: text.replace(b'="128"', b'="129"'), lambda run: run.points(-1), "damaged"),
                  (piece, lambda text: b"<html></html>", lambda run: run.points(-1), f"{piece} is no file of VTK, or a part of one.")]
    for name, damage, action, text in cases:
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(run.folder, folder)
        (folder / name).write_bytes(damage((folder / name).read_bytes()))
        message = message_of(lambda: action(Run(folder)))
        check(f"{name} that is damaged: {message}", text in message)


def check_report(run, has_points):
    command = [sys.executable, "-B", PROJECT / "scripts" / "report", run.folder]
    result = subprocess.run(command, capture_output=True, text=True)
    check(f"report: {result.stderr}", result.returncode == 0)
    page = (run.folder / "report.html").read_text()
    check("no network", not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", page))
    data = json.loads(re.search(r"^const DATA = (.*);$", page, re.MULTILINE).group(1))["runs"][0]
    check("state and bodies", data["state"] == "finished" and [body["name"] for body in data["bodies"]] == run.bodies)
    check("Newton's method in the report", len(data["newton"]["steps"]) == 4)
    check("parameters in the report", ["Time/Step", "0.01", "", "s"] in data["parameters"])
    if not has_points:
        check("no points without a reader", data["frames"] is None)
        return
    frames = data["frames"]
    check("fields of the report", [field["name"] for field in frames["fields"]][:2] == ["speed", "pressure"]
          and frames["fields"][-1]["name"] == "body")
    raw = np.frombuffer(zlib.decompress(base64.b64decode(frames["data"])), np.uint8)
    shape = (len(frames["times"]), frames["n"])
    n = shape[0] * shape[1]
    for d in range(2):
        low, high = raw[2 * d * n:(2 * d + 1) * n].astype(np.uint16), raw[(2 * d + 1) * n:(2 * d + 2) * n].astype(np.uint16)
        x = np.cumsum((low | high << 8).reshape(shape), axis=0, dtype=np.uint16)
        x = frames["lower"][d] + (frames["upper"][d] - frames["lower"][d]) * x / 65534
        for k in range(shape[0]):
            points = run.points(k, [])
            check("positions in the report", abs(np.sort(x[k]) - np.sort(points.x[:, d])).max() < 1e-4)


def report_of(folder, case, settings, options=("--no-points",)):
    """The runs of the report of a run of the case with other parameters."""
    sets = [word for setting in settings for word in ("--set", setting)]
    program = [PROJECT / "scripts/sweep"] if any(setting.startswith("Sweep/") for setting in settings) else [PROGRAM]
    result = subprocess.run([*program, case, *sets, "--set", f"Output/Directory={folder}"], capture_output=True, text=True,
                            env={**os.environ, "GREVILLE": str(PROGRAM)})
    check(f"the run: {result.stderr}", result.returncode == 0)
    result = subprocess.run([sys.executable, "-B", PROJECT / "scripts" / "report", *options, folder], capture_output=True, text=True)
    check(f"report: {result.stderr}", result.returncode == 0)
    page = (folder / "report.html").read_text()
    return json.loads(re.search(r"^const DATA = (.*);$", page, re.MULTILINE).group(1))["runs"]


def check_points_to_csv():
    """The four points that VTK has written, raw and as vertices of polygons."""
    expected = [[0.3, 0.2, 0, 0.1, 1, 2, 0, 0, 1, -2, 3, 0.5, 0, 0], [1, 1.5, 0, 0.2, 3, 4, 0, 1, 2, -2, 3, 0.5, 0, 0],
                [0, 0, 0, 0.3, 5, 6, 0, 1, 3, -2, 3, 0.5, 0, 0], [0.5, 0.75, 0, 0.4, 7, 8, 0, 0, 4, -2, 3, 0.5, 0, 0]]
    for name in ("points.vtu", "points.vtp"):
        result = subprocess.run([PROJECT / "scripts/points_to_csv", Path(__file__).parent / name], capture_output=True, text=True)
        header, *rows = result.stdout.splitlines()
        check(f"columns of {name}", header == "x,y,z,volume,velocity_x,velocity_y,velocity_z,body,stress_xx,stress_yy,stress_zz,"
              "stress_xy,stress_yz,stress_xz")
        check(f"numbers of {name}", [[float(word) for word in row.split(",")] for row in rows] == expected)
    result = subprocess.run([PROJECT / "scripts/points_to_csv", __file__], capture_output=True, text=True)
    check("a file that is none of VTK", result.returncode == 1 and "ends with <.py>, none of .vtu" in result.stderr)


def check_drawing(place, case):
    """What --check --draw writes, with a load, a rigid body and probes, and its picture."""
    from greville.set_up import probes_of
    points, boxes = probes_of("0.5, 0.5; box(0, 0, 1, 1); ball(0, 0, 1); 1, 2", 2)
    check("probes", sorted(points) == [0, 3] and list(boxes) == [1] and boxes[1].tolist() == [[0, 0], [1, 1]])
    folder = place / "drawing"
    sets = [word for setting in ("Body block/Placement=fitted", "Simulation/Surface loads=push", "Surface load push/Body=block", "Surface load push/Kind=traction",
                                 "Surface load push/Traction=-1; 0", "Output/Probes=0.5, 0.5; box(1.3, 0.3, 1.5, 0.5)",
                                 "Simulation/Rigid bodies=floor", "Rigid body floor/Shape=half_space(0, 1, 0.1)",
                                 "Simulation/Contacts=ground", "Contact ground/Bodies=block, floor")
            for word in ("--set", setting)]
    result = subprocess.run([PROGRAM, case, *sets, "--check", "--draw", folder], capture_output=True, text=True)
    check(f"--check --draw: {result.stderr}", result.returncode == 0 and any(Run(folder).surfaces) and Run(folder).rigid_bodies == ["floor"])
    drawn = subprocess.run([sys.executable, "-B", PROJECT / "scripts/picture", folder], capture_output=True, text=True)
    check(f"picture.png: {drawn.stderr}", drawn.returncode == 0 and (folder / "picture.png").is_file() and not (folder / "animation.gif").exists())


def check_scripts(place, case):
    """Pictures, the report, the script for ParaView and a table of points; few entries in the folder."""
    folder = place / "scripts"
    result = subprocess.run([PROGRAM, case, "--set", f"Output/Directory={folder}"], capture_output=True, text=True)
    check(f"a run: {result.stderr}", result.returncode == 0)
    for words in (["picture", folder], ["report", folder], ["paraview", folder], ["points_to_csv", folder / "files/points_0001.vtu"]):
        done = subprocess.run([sys.executable, "-B", PROJECT / "scripts" / words[0], *words[1:]], capture_output=True, text=True)
        check(f"{words[0]}: {done.stderr}", done.returncode == 0)
        if words[0] == "picture":
            check_film(folder)
    check("a table of them", done.stdout.startswith("x,y,z,") and done.stdout.count("\n") == 129)
    check("view.py reads the blocks of fields.pvd", "NAMES = ['grid', 'points']" in (folder / "files/view.py").read_text())
    Run(folder).points(-1).save_csv(folder / "last.csv")
    check("save_csv", abs(read_table(folder / "last.csv")["x"] - Run(folder).points(-1).x[:, 0]).max() < 1e-8)


def check_film(folder):
    """animation.mp4, where ffmpeg is installed: the frames at the times of animation.gif, in an even number of pixels."""
    from PIL import Image
    frames = sorted((folder / "files/frames").glob("frame_*.png"))
    film, still = folder / "animation.mp4", Image.open(folder / "animation.gif")
    check("frames of animation.gif", still.n_frames == len(frames) == 3)
    if not shutil.which("ffmpeg"):
        check("no film without ffmpeg", not film.exists())
        return
    found = subprocess.run(["ffprobe", "-loglevel", "error", "-select_streams", "v", "-show_entries", "stream=codec_name,width,height,duration,pix_fmt",
                            "-of", "json", film], capture_output=True, text=True)
    stream = json.loads(found.stdout or "{}").get("streams", [{}])[0]
    width, height = (size + size % 2 for size in Image.open(frames[0]).size)
    check(f"the film: {found.stderr}{stream}", stream.get("codec_name") == "h264" and stream["pix_fmt"] == "yuv420p"
          and (stream["width"], stream["height"]) == (width, height))
    # Three frames of 0.4 s, and 1.5 s of the last one.
    check(f"its length: {stream}", abs(float(stream.get("duration", 0)) - 2.7) < 0.1)
    # One that cannot be made is no reason to fail, and none of before is left.
    program = folder / "programs"
    program.mkdir()
    (program / "ffmpeg").write_text("#!/bin/sh\necho no film today >&2\nexit 1\n")
    (program / "ffmpeg").chmod(0o755)
    environment = dict(os.environ, PATH=f"{program}:{os.environ['PATH']}")
    done = subprocess.run([sys.executable, "-B", PROJECT / "scripts/picture", folder], capture_output=True, text=True, env=environment)
    check(f"without a film: {done.stderr}", done.returncode == 0 and "no animation.mp4: ffmpeg says: no film today" in done.stderr and not film.exists())


RIGID = ["Simulation/Rigid bodies=floor, disc", "Rigid body floor/Shape=half_space(0, 1, 0.1)", "Rigid body disc/Shape=ball(1, 0.7, 0.1)",
         "Rigid body disc/Velocity=1; -1", "Rigid body disc/Rotation=10 * t", "Simulation/Contacts=ground, side", "Contact ground/Bodies=block, floor", "Contact side/Bodies=block, disc"]


def check_rigid_bodies(place, case):
    """The report has rigid bodies where they are, and one figure for the loss of energy."""
    folder = place / "rigid"
    data = report_of(folder, case, [*RIGID, "Walls/Bottom=free"], [])[0]
    run, frames = Run(folder), data["frames"]
    check(f"rigid bodies: {data['rigid_bodies']}", data["rigid_bodies"][0] == {"name": "floor", "model": "rigid"}
          and data["rigid_bodies"][1]["name"] == "disc" and abs(data["rigid_bodies"][1]["extent"][0] - 0.2) < 2e-3)
    check(f"the view has room for them: {frames['view']}", frames["view"][0][1] < 0.2 and abs(frames["view"][1][1] - run.rigid("disc", 0.04)[0][:, :, 1].max()) < 1e-4)
    for body in frames["rigid"]:
        raw = np.frombuffer(zlib.decompress(base64.b64decode(body["data"])), np.uint16)
        shape = body["shapes"][0]
        x = np.array(shape["low"]) + np.array(shape["width"]) * raw[:2 * shape["n"]].reshape(-1, 2) / 65535
        check(f"one shape of {body['name']}, closed lines", len(body["shapes"]) == 1 and sum(shape["loops"]) == shape["n"])
        for frame, time in zip(body["frames"], run.times):
            expected = run.rigid(body["name"], time)[0][:, 0, :2]
            moved = x @ np.array(frame[1:5]).reshape(2, 2).T + frame[5:]
            gap = np.linalg.norm(moved[:, None] - expected, axis=2)
            check(f"{body['name']} at {time} s", max(gap.min(axis=0).max(), gap.min(axis=1).max()) < 1e-3)
    energy = run.summary["energy"]
    found = [fact for fact in data["facts"] if "loss" in fact[0]]
    check(f"one figure for the loss: {found}, {data['table']['loss']}", len(found) == 1 and data["table"]["loss"]["judgement"] == energy["judgement"]
          and found[0][1].startswith(f"{100 * energy['relative_loss']:.3g} %, {energy['judgement'].split(',')[0]}")
          and abs(data["table"]["loss"]["share"] - energy["relative_loss"]) <= 1e-4 * abs(energy["relative_loss"]))


def check_choices(place, case):
    """What pictures show of runs that write other fields, or begin before zero, and which axis is upright."""
    from types import SimpleNamespace

    class Points:
        has_points, dim = True, 3

        def __init__(self, extents=(1., 1., 1.), **parameters):
            self.parameters = {f"{name.replace('_', ' ')}/Gravity": value for name, value in parameters.items()}
            self.points = lambda k, names: SimpleNamespace(x=np.array([np.zeros(3), extents]))
    for expected, run, up in [(2, Points(Loads="0; 0; -9.81"), None), (0, Points(Loads="-9.81; 0; 0"), None), (1, Points(), None),
                              (2, Points(**{"Stage settle/Loads": "0; -1; -10 * t"}), None), (0, Points(Loads="0; 0; -9.81"), "x"),
                              (2, Points(extents=(1., 0.9, 0.1)), None), (0, Points(extents=(0.1, 1., 0.9)), None)]:
        check(f"the axis {expected} is upright: {run.parameters}", display.up_axis(run, up) == expected)
    check("no such axis", "is x, y or z, not <up>" in message_of(lambda: display.up_axis(Points(), "up")))
    for fields, expected in [("displacement, von_mises", "displacement"), ("body", "body"), ("", None)]:
        folder = place / ("fields_" + (fields[:4] or "none"))
        sets = ["Time/Start=-0.3", "Time/End=-0.2", "Time/Maximum steps=2", f"Output/Fields={fields}"]
        report_of(folder, case, sets, [])
        check(f"the main field of <{fields}>", display.main_field(Run(folder)) == expected)
        drawn = subprocess.run([sys.executable, "-B", PROJECT / "scripts/picture", folder], capture_output=True, text=True)
        check(f"pictures of <{fields}>: {drawn.stderr}", drawn.returncode == 0 and not drawn.stderr and (folder / "animation.gif").is_file())


def check_facts(place, case):
    """Reports of sweeps and of stages say what each of them did."""
    sweep = report_of(place / "sweep", case, ["Sweep/Cells=8, 16", "Sweep/Orders=1, 2", "Sweep/Masses=lumped, consistent",
                                              "Scheme/Stress update=USL", "Time/Step=0.005"])
    facts = [dict(run["facts"]) for run in sweep]
    check(f"a sweep: {facts}", [(fact["grid"], fact["order of splines"], fact["mass"]) for fact in facts] == [
        (f"{n} × {n // 2} cells", str(p), mass) for mass in ("consistent", "lumped") for p in (1, 2) for n in (8, 16)])
    again = subprocess.run([PROGRAM, "consistent_p1_8/parameters.prm", "--resume"], cwd=place / "sweep", capture_output=True, text=True)
    check(f"a run of a sweep goes on alone: {again.stderr}", again.returncode == 0)
    stages = report_of(place / "stages", case, [
        "Simulation/Stages=implicit, explicit", "Stage implicit/Time/End=0.02", "Stage explicit/Time/End=0.04",
        "Stage explicit/Scheme/Stress update=MUSL", "Stage explicit/Scheme/Mass=lumped"])
    facts = dict(stages[0]["facts"])
    check(f"stages: {facts}", facts.get("stage 1: implicit") == "to 0.02 s: updated Lagrangian, newmark, mass consistent"
          and facts.get("stage 2: explicit") == "to 0.04 s: updated Lagrangian, MUSL, mass lumped"
          and not {"mass", "steps in time", "formulation"} & set(facts))


def check_factor_of_safety(place):
    """The ramp of the example on a coarse grid, and its picture."""
    folder = place / "slope"
    sets = [word for setting in ("Grid/Cells=44, 13", "Body slope/Points per direction=2", "Stage reduction/Time/Step=0.2",
                                 "Stage weight/Time/Step=0.5", f"Output/Directory={folder}") for word in ("--set", setting)]
    result = subprocess.run([PROGRAM, PROJECT / "doc/user/examples/factor_of_safety.prm", *sets], capture_output=True, text=True)
    found = re.search(r"factor at failure: ([\d.]+) \(equilibrium at", result.stdout)
    check(f"factor of safety: {result.stdout}{result.stderr}", result.returncode == 0 and found and 1.5 < float(found.group(1)) < 1.75)
    drawn = subprocess.run([sys.executable, "-B", PROJECT / "scripts/picture", folder], capture_output=True, text=True)
    check(f"failure.png: {drawn.stderr}", drawn.returncode == 0 and (folder / "failure.png").is_file())


def main():
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "case.prm").write_text(CASE)
        result = subprocess.run([PROGRAM, "case.prm"], cwd=name, capture_output=True, text=True)
        check(f"the run: {result.stderr}", result.returncode == 0)
        run = Run(Path(name) / "output" / "case")
        has_points = can_read_points()
        check_tables(run)
        if has_points:
            check_points(run)
            check_pandas_and_xarray(run)
        check_damage(run, has_points)
        check_report(run, has_points)
        result = subprocess.run([sys.executable, "-B", PROJECT / "scripts" / "paraview", run.folder], capture_output=True, text=True)
        check(f"paraview: {result.stderr}", result.returncode == 0)
        compile((run.folder / "files/view.py").read_text(), "view.py", "exec")
        if has_vtk():
            check_points_to_csv()
        if has_vtk() and has("matplotlib") and has("PIL"):
            check_drawing(Path(name), Path(name) / "case.prm")
            check_scripts(Path(name), Path(name) / "case.prm")
            check_choices(Path(name), Path(name) / "case.prm")
        if has_points:
            check_rigid_bodies(Path(name), Path(name) / "case.prm")
        check_facts(Path(name), Path(name) / "case.prm")
        if has_points:
            check_factor_of_safety(Path(name))
    print("with points" if has_points else "without points: neither VTK nor meshio is there")
    sys.exit(failed > 0)


main()
