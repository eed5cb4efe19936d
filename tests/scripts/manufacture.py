#!/usr/bin/python3
"""What scripts/manufacture derives: tests/scripts/manufacture.py ROOT [all]

Body forces and tractions beside those of differences of the laws as numpy has them, for
motions in plane strain, axisymmetry and 3D; and the shipped files with an exact solution,
whose forces are those that it derives. Without all: one motion and two files.
"""
import importlib.machinery
import importlib.util
import math
import random
import sys
import tempfile
from pathlib import Path

ROOT = Path(sys.argv[1])
try:
    import numpy as np
    import sympy  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
loader = importlib.machinery.SourceFileLoader("manufacture", str(ROOT / "scripts/manufacture"))
manufacture = importlib.util.module_from_spec(importlib.util.spec_from_loader("manufacture", loader))
loader.exec_module(manufacture)

DENSITY, YOUNG, POISSON = 1.3, 7.0, 0.28
PLANE = "0.2 * sin(X + t) * Y; f"
MOTIONS = {"plane strain": (2, PLANE), "axisymmetric": (2, "0.2 * sin(X + t) * X * Y; f"),
           "3D, z alone": (3, PLANE + "; 0.1 * Z * sin(t + Z)"), "3D": (3, PLANE + "; 0.1 * X * Y * Z * sin(t + Z)")}
FORMULAS = {"f": "0.15 * cos(Y * t) * X^2"}
SHIPPED = ["vortex", "twisting_disk", "twisting_cylinder_3d", "mms_1d", "axis_aligned_mms_2d", "axis_aligned_mms_3d"]


def problem_of(motion, law):
    dim, displacement = MOTIONS[motion]
    with tempfile.NamedTemporaryFile("w", suffix=".prm") as file:
        file.write(f"""subsection Simulation
  set Dimension = {dim}
  set Bodies = body
end
subsection Grid
  set Geometry = {"axisymmetric" if motion == "axisymmetric" else "plane strain"}
end
subsection Formulas
  set f = {FORMULAS["f"]}
end
subsection Body body
  set Material = solid
end
subsection Material solid
  set Model         = {law}
  set Density       = {DENSITY}
  set Young modulus = {YOUNG}
  set Poisson ratio = {POISSON}
end
subsection Exact solution
  set Displacement = {displacement}
end
""")
        file.flush()
        return manufacture.Problem(Path(file.name))


def stress(F, law):
    """The first Piola-Kirchhoff stress."""
    lam, mu = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / 2 / (1 + POISSON)
    b = F @ F.T
    if law == "neo-hookean":
        strain = b - np.eye(3)
    else:
        values, vectors = np.linalg.eigh(b)
        strain = vectors * np.log(values) @ vectors.T
    return (lam * math.log(np.linalg.det(F)) * np.eye(3) + mu * strain) @ np.linalg.inv(F).T


def check_motion(motion, law, n_nodes):
    """The largest differences of the body force and of the traction, relative to the largest values."""
    problem = problem_of(motion, law)
    dim, displacement = MOTIONS[motion]
    normal = "; ".join(["0.6", "0.8", "0.5"][:dim])
    sections = manufacture.sections_of(problem, n_nodes, normal)
    texts = FORMULAS | {name: text for section, name, text in sections if section == "Formulas"}

    def derived(section, name, place):
        text = next(text for its_section, its_name, text in sections if (its_section, its_name) == (section, name))
        return np.array(manufacture.Numbers(texts, place).vector(text))

    def place_of(X, t):
        return dict(zip("XYZ", X)) | {"t": t}

    def u(X, t):
        return np.array(manufacture.Numbers(FORMULAS, place_of(X, t)).vector(displacement))

    def slope(f, X, k, h=2e-3):
        e = h * np.eye(dim)[k]
        return (8 * (f(X + e) - f(X - e)) - (f(X + 2 * e) - f(X - 2 * e))) / (12 * h)

    def P(X, t):
        F = np.eye(3)
        for k in range(dim):
            F[:dim, k] += slope(lambda place: u(place, t), X, k)
        if problem.is_axisymmetric:
            F[2, 2] = 1 + u(X, t)[0] / X[0]
        return stress(F, law)

    differences, sizes = [], []
    generator = random.Random(3)
    for _ in range(3):
        X, t = np.array([generator.uniform(0.3, 1) for _ in range(dim)]), generator.uniform(0, 1)
        stress_here = P(X, t)
        div = sum(slope(lambda place, k=k: P(place, t)[:dim, k], X, k) for k in range(dim))
        if problem.is_axisymmetric:
            div += np.array([stress_here[0, 0] - stress_here[2, 2], stress_here[1, 0]]) / X[0]
        h = 1e-3
        acceleration = (16 * (u(X, t + h) + u(X, t - h)) - u(X, t + 2 * h) - u(X, t - 2 * h) - 30 * u(X, t)) / (12 * h * h)
        N = np.array([0.6, 0.8, 0.5][:dim])
        for expected, names in ((acceleration - div / DENSITY, ("Loads", "Body force")),
                                (stress_here[:dim, :dim] @ N, ("Surface load NAME", "Traction"))):
            differences.append(abs(derived(*names, place_of(X, t)) - expected).max())
            sizes.append(abs(expected).max())
    return max(differences) / max(sizes)


def main():
    everything = sys.argv[-1] == "all"
    failures = []
    for law in ("neo-hookean", "linear-elastic"):
        for motion in MOTIONS:
            if not everything and (motion, law) != ("axisymmetric", "linear-elastic"):
                continue
            error = check_motion(motion, law, 8)
            print(f"{motion}, {law}: {error:.1e}")
            if not error < 1e-9:
                failures.append((motion, law))
    for name in SHIPPED if everything else SHIPPED[:2]:
        problem = manufacture.Problem(ROOT / f"prm/simulation/{name}.prm")
        manufacture.check(problem, manufacture.sections_of(problem, 0, None))
    # A function that has no derivative, and a material that is not known.
    for setting, part in (("abs(X)", "<abs(X)>"), ("q", "<q>")):
        problem = problem_of("plane strain", "neo-hookean")
        try:
            problem.formulas.read(setting)
            failures.append(setting)
        except manufacture.ResultsError as error:
            if part not in str(error):
                failures.append((setting, str(error)))
    try:
        problem_of("plane strain", "von-mises")
        failures.append("von-mises")
    except manufacture.ResultsError:
        pass
    if failures:
        sys.exit(f"wrong: {failures}")


main()
