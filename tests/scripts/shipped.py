"""shipped.py PROJECT [NAME...]: scripts/run on each shipped parameter file, template and example, or on those of these names.

All are cut to two steps on coarse grids, and have to end with pictures, an animation, a report and a script for
ParaView, without a note.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

PROJECT, NAMES = Path(sys.argv[1]), sys.argv[2:]
CELLS = dict(line.split(" ", 1) for line in (PROJECT / "tests/small_cells.txt").read_text().splitlines() if line[0] != "#")
SWEEP = ["Cells", "Orders", "Formulations", "Masses", "Parameter", "Values"]
LEFT = ["picture.png", "animation.gif", "report.html", "files/view.py", "summary.json"]


def run(file, folder):
    """scripts/run on a file, cut short."""
    settings = ["Time/Maximum steps=2", f"Output/Directory={folder}", *(f"Sweep/{name}=" for name in SWEEP)]
    if file.stem in CELLS:
        settings.append(f"Grid/Cells={CELLS[file.stem]}")
    words = [word for setting in settings for word in ("--set", setting)]
    return subprocess.run([PROJECT / "scripts/run", *words, file], capture_output=True, text=True, stdin=subprocess.DEVNULL)


def wrong_with(file, folder):
    done = run(file, folder)
    wrong = [f"exit status {done.returncode}"] * (done.returncode != 0)
    wrong += [line for line in done.stdout.splitlines() if line.startswith(("== note", "  no distance"))]
    wrong += [done.stderr.strip()] * ("scripts/" in done.stderr or "Traceback" in done.stderr)
    return wrong + [f"no {name}" for name in LEFT if not (folder / name).is_file()]


def wrong_with_note(folder):
    """A picture that cannot be written is a note, and the rest is there."""
    (folder / "picture.png").mkdir(parents=True)
    done = run(PROJECT / "prm/simulation/dam_break.prm", folder)
    good = done.returncode == 0 and "== note: not all pictures are drawn\n" in done.stdout \
        and done.stderr.strip() == f"scripts/picture: {folder}/picture.png: Is a directory." and (folder / "report.html").is_file()
    return [] if good else [f"exit status {done.returncode}: {done.stdout[-300:]}{done.stderr}"]


def main():
    files = [file for part in ("prm/simulation/*.prm", "prm/templates/*.prm", "doc/user/examples/*.prm", "examples/*/*.prm")
             for file in sorted(PROJECT.glob(part)) if not NAMES or file.stem in NAMES]
    failed = 0
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            wrong = wrong_with(file, Path(folder) / "results")
        failed += bool(wrong)
        for text in wrong:
            print(f"FAILED: {file.relative_to(PROJECT)}: {text}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for text in wrong_with_note(Path(folder) / "results"):
            failed += 1
            print(f"FAILED: a picture that cannot be written: {text}")
    print(f"{len(files)} files")
    sys.exit(failed > 0 or not files)


main()
