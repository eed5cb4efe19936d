"""Runs Greville, and reads and draws its results.

    import greville
    case = greville.Case("slope.prm")
    case.set("Material clay/Cohesion", 12e3)
    run = case.run(processes=2)
    print(run.statistics["kinetic"].max(), run.points(-1)["velocity"].shape)
    run.plot()
"""
from .case import Case, RunFailed, build_umat, program, project_file
from .results import Error, ResultsError, Run, Series, Table, how_to_install, read_fields, read_table
from .sweeps import Sweep, sweep

__all__ = ["Case", "Error", "ResultsError", "Run", "RunFailed", "Series", "Sweep", "Table", "build_umat", "how_to_install",
           "program", "project_file", "read_fields", "read_table", "sweep"]
