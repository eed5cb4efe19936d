"""python.py PROJECT PROGRAM [all]: a case and its results by the Python package; with "all" also formats, messages, sweeps, pictures and element tests."""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

PROJECT, PROGRAM = Path(sys.argv[1]), sys.argv[2]
os.environ["GREVILLE"] = PROGRAM
sys.path.insert(0, str(PROJECT / "python"))
sys.dont_write_bytecode = True
import greville
from greville.case import as_prm, as_text

SECTIONS = {
    "Simulation": {"Bodies": ["block"], "Materials": "solid"},
    "Grid": {"Upper corner": [2, 1], "Cells": [16, 8]},
    "Time/End": 0.1,
    "Material solid": {"Model": "neo-hookean", "Density": 2, "Young modulus": 100},
    "Body block": {"Material": "solid", "Shape": "box(0.25, 0.25, 0.75, 0.75)", "Velocity": [["0.5"], [0]]},
    "Output": {"Fields every": 0.05},
}
YAML = """
Simulation: {Bodies: [block], Materials: solid}
Grid:
  Upper corner: [2, 1]
  Cells: [16, 8]
Time/End: 0.1
Material solid: {Model: neo-hookean, Density: 2, Young modulus: 100}
Body block:
  Material: solid
  Shape: box(0.25, 0.25, 0.75, 0.75)
  Velocity: 0.5; 0
Output: {Fields every: 0.05}
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
    except greville.Error as error:
        return str(error)
    return ""


def check_case():
    case = greville.Case(SECTIONS)
    lines = []
    run = case.run(processes=2, progress=lambda part, line: lines.append((part, line)))
    check(f"progress: {lines}", lines[-1][0] == 1. and ", t = 0.1 of 0.1 s" in lines[-1][1])
    check("what the program prints", "1 process(es)" not in run.output and "2 process(es)" in run.output and ".case_" not in run.output)
    check("the folder", run.folder == Path("output/case") and not list(Path().glob(".case_*")))
    check("points at a time", abs(run.points(0.05).time - 0.05) < 0.01 and len(run.points(-1)["velocity"]) == 64)
    check("velocity", abs(run.points(0.)["velocity"][:, 0] - 0.5).max() < 1e-6)
    return case


def check_formats(case):
    Path("block.json").write_text(json.dumps(SECTIONS))
    Path("block.yaml").write_text(YAML)
    Path("block.prm").write_text(as_prm(SECTIONS))
    first, *others = [greville.Case(name).set("Simulation/Name", "case").parameters for name in ("block.json", "block.yaml", "block.prm")]
    check("the same by all ways", first == others[0] == others[1])
    for name in ("saved.json", "saved.yaml", "saved.prm"):
        greville.Case("block.prm").set("Simulation/Name", "case").save(name)
        check(f"a case that is saved as {name}", greville.Case(name).set("Simulation/Name", "case").parameters == first)
    check("parameters", first["Body block/Velocity"] == "0.5; 0" and first["Grid/Order"] == "2")
    check("check", "critical step" in case.check())
    Path("merged.yaml").write_text("a: &one {x: 1}\nb: {<<: *one, x: 2}\n")
    check("YAML that merges sections", greville.Case("merged.yaml").tree == {"a": {"x": 1}, "b": {"x": 2}})
    import numpy
    check("values of numpy", [as_text(value) for value in (numpy.bool_(True), numpy.array([True, False]), numpy.float64(0.5), numpy.int64(3))]
          == ["true", "true, false", "0.5", "3"])


def check_version():
    text = (PROJECT / "python/pyproject.toml").read_text()
    version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout.split()[1].rstrip(",")
    check(f"the version of the package is that of the program, {version}", f'version = "{version}"' in text)


def check_errors(case):
    for what, text, action in [
            ("a name", "there is no parameter 'Cels'. Did you mean <Cells>?", lambda: case.copy().set("Grid/Cels", 3).run()),
            ("a value on two processes", "has to be a number above zero.", lambda: case.copy().set("Material solid/Density", -3).run(2)),
            ("a step", "is above the critical step", lambda: case.copy().set("Time/Step", 1).set("Output/Directory", "bad").run()),
            ("a file", "There is no file nowhere.prm.", lambda: greville.Case("nowhere.prm")),
            ("a value that is missing", "The parameter <End> has no value.", lambda: greville.Case({"Time": {"End": None}}).check()),
            ("a number of processes", "processes has to be a whole number above zero, not -1.", lambda: case.run(-1)),
            ("a text for it", "processes has to be a whole number above zero, not '2'.", lambda: case.run("2")),
            ("processes of a run of a sweep", "processes_per_run has to be a whole number above zero, not 0.",
             lambda: greville.sweep(case, "Time/Step", [0.1], 2, 0)),
            ("no value", "The parameter <Time/End> has no value.", lambda: case.copy().set("Time/End", None)),
            ("a time", "is a whole number, or a float in s, not 'last'.", lambda: greville.Run("output/case").points("last")),
            ("a time of nothing", "is a whole number, or a float in s, not nan.",
             lambda: greville.Run("output/case").points(float("nan"))),
            ("a file that is none", "None is no name of a file or folder.", lambda: greville.Case(None)),
            ("values of a sweep", "The values of a sweep are a list, not '12'.",
             lambda: greville.sweep(case, "Time/Step", "12")),
            ("a character", "which has characters that no file can have.", lambda: case.copy().set("Time/End", "1\0")),
            ("a page", "nowhere/page.html cannot be written: No such file or directory.",
             lambda: greville.Run("output/case").report(output="nowhere/page.html", no_points=True)),
            ("a template", "there is no template <slop>", lambda: greville.Case.new("slop"))]:
        message = message_of(action)
        check(f"message about {what}: {message}", text in message and "\n" not in message)
    Path("bad.json").write_text("{")
    Path("bad.yaml").write_text("a: [")
    Path("twice.json").write_text('{"Time": {"End": 1, "End": 2}}')
    Path("twice.yaml").write_text("Time: {End: 1, Start: 0, End: 2}")
    for name in ("twice.json", "twice.yaml"):
        check(name, message_of(lambda: greville.Case(name)) == f"{name} has <End> twice in one section.")
    check("bad JSON", "bad.json is no JSON" in message_of(lambda: greville.Case("bad.json")))
    check("bad YAML", "bad.yaml is no YAML" in message_of(lambda: greville.Case("bad.yaml")))


def check_sweep(case):
    study = greville.sweep(case, "Time/Step", [0.005, 0.0025, 1], processes=2)
    check(f"a run of a sweep that fails: {study.message}", "is above the critical step" in study.message and study.runs[2] is None)
    check("steps of a sweep", [run.summary["steps"] for _, run in study if run] == [20, 40])
    check("a report of a sweep", study.report(no_points=True) == study.folder / "report.html")
    message = message_of(lambda: greville.Run(study.folder))
    check(f"a sweep is no run: {message}", message.endswith("has the results of a sweep, which greville.Sweep reads."))
    check("the table of a sweep", abs(study.table["time"][:2] - 0.1).max() < 1e-12)
    orders = greville.sweep(case.copy().set("Sweep/Orders", [1, 2]).set("Output/Directory", "orders"))
    check("the section Sweep of a case", list(orders.table["p"]) == [1, 2] and len(orders) == 2 and not orders.message)


def check_pictures():
    run = greville.Run("output/case")
    picture = run.plot(0.1, field="velocity_x", mesh=True)
    check("a picture for notebooks", picture._repr_png_()[:4] == b"\x89PNG")
    check("a report", run.report(no_points=True).stat().st_size > 10000)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_version()
        case = check_case()
        if sys.argv[3:] == ["all"]:
            check_formats(case)
            check_pictures()
            check_errors(case)
            check_sweep(case)
            table = case.copy().set("Element test/Strain", 0.01).set("Element test/Initial stress", 0).set("Output/Directory", "test").element_test("oedometer")
            check("an element test", abs(table["strain_axial"][-1] - 0.01) < 1e-12 and table["stress_axial"][-1] > 0)
        os.chdir("/")
    sys.exit(failed > 0)


main()
