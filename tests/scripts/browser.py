#!/usr/bin/python3
"""The report in a browser: tests/scripts/browser.py [BUILD_FOLDER]

Runs prm/simulation/dam_break.prm, bouncing_ball_3d.prm and rolling_ball_3d.prm, which
has a rigid body, on coarse grids, and cooks_membrane.prm in three steps, writes their reports and one of two runs, and opens each in headless
Chromium, light and dark, wide and narrow: no script may fail, all charts have to be
there, points have to be drawn, and nothing may be wider than the window. Takes
two minutes; it is not among the tests of ctest. Pictures go to output/browser.

Needs Debian's chromium, python3-numpy, python3-vtk9 and python3-pil.
"""
import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = Path("output/browser")
CHROMIUM = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--enable-logging=stderr"]
DARK = "--blink-settings=preferredColorScheme=0"
# What follows the shipped file.
CASES = {
    "dam_break": "subsection Grid\n  set Cells = 40, 20\nend\n",
    "dam_break_finer": "subsection Grid\n  set Cells = 60, 30\nend\n",
    "bouncing_ball_3d": "subsection Time\n  set End = 0.1\nend\nsubsection Scheme\n  set Mass = lumped\nend\n",
    "cooks_membrane": "subsection Time\n  set End = 0.3\nend\n",
    "rolling_ball_3d": "subsection Grid\n  set Cells = 8, 8, 4\nend\nsubsection Time\n  set Maximum steps = 20\nend\n",
}
# Reports: runs, charts at least, colours of points that have to be in the picture.
REPORTS = {"dam_break": (["dam_break"], 6), "bouncing_ball_3d": (["bouncing_ball_3d"], 5), "cooks_membrane": (["cooks_membrane"], 7), "rolling_ball_3d": (["rolling_ball_3d"], 5),
           "two_runs": (["dam_break", "dam_break_finer"], 9)}


def calculate(program, name):
    file = ROOT / "prm/simulation" / (name.removesuffix("_finer") + ".prm")
    reference = ROOT / "prm/simulation/reference"
    text = file.read_text().replace("reference/", f"{reference}/") + CASES[name]
    text += f"subsection Output\n  set Directory = {FOLDER / name}\n  set Earlier results = remove\nend\n"
    (FOLDER / f"{name}.prm").write_text(text)
    subprocess.run([program, FOLDER / f"{name}.prm"], check=True, stdout=subprocess.DEVNULL)


def browse(browser, page, *options):
    """What Chromium prints of a page."""
    with tempfile.TemporaryDirectory() as profile:
        result = subprocess.run([browser, *CHROMIUM, f"--user-data-dir={profile}", "--virtual-time-budget=15000", *options,
                                 page.resolve().as_uri()], capture_output=True, text=True, timeout=180)
    return result.stdout, [line for line in result.stderr.splitlines() if ":CONSOLE" in line]


def check_page(browser, page, n_charts, width, is_dark):
    """Messages of what is wrong."""
    from PIL import Image
    wrong = []
    image = FOLDER / f"{page.stem}_{width}{'_dark' if is_dark else ''}.png"
    image.unlink(missing_ok=True)
    options = [f"--window-size={width},1800"] + ([DARK] if is_dark else [])
    dom, console = browse(browser, page, "--dump-dom", *options)
    wrong += [f"console: {line}" for line in console]
    if 'data-ready="true"' not in dom:
        wrong.append("the points have not been drawn")
    charts = len(re.findall(r'<svg[^>]*role="img"', dom))
    if charts < n_charts:
        wrong.append(f"{charts} charts, not {n_charts}")
    overflow = re.search(r'data-overflow="(-?\d+)"', dom)
    if not overflow or int(overflow.group(1)) > 0:
        wrong.append(f"wider than the window by {overflow.group(1) if overflow else 'an unknown number of'} pixels")
    browse(browser, page, f"--screenshot={image.resolve()}", *options)
    if not image.exists():
        return wrong + ["no screenshot"]
    # Dark or light, with many colours, which are those of points.
    small = Image.open(image).convert("RGB")
    back = sum(small.getpixel((2, small.height // 2)))
    if (back < 200) != is_dark:
        wrong.append(f"its background is not {'dark' if is_dark else 'light'}")
    colours = small.getcolors(1 << 24)
    vivid = sum(1 for count, (r, g, b) in colours if max(r, g, b) - min(r, g, b) > 60)
    if vivid < 100:
        wrong.append(f"{vivid} colours")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", type=Path, default=ROOT / "build", metavar="BUILD_FOLDER")
    program = parser.parse_args().build.resolve() / "greville"
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if not browser:
        sys.exit("There is no chromium: install Debian's chromium (sudo apt install chromium).")
    if not program.exists():
        sys.exit(f"There is no program {program}: give the folder of the build.")
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in CASES:
        calculate(program, name)
    n_wrong = 0
    for name, (runs, n_charts) in REPORTS.items():
        page = FOLDER / f"{name}.html"
        subprocess.run([ROOT / "scripts/report", *(FOLDER / run for run in runs), "--output", page], check=True, stdout=subprocess.DEVNULL)
        if page.stat().st_size > 4e6:
            print(f"FAILED: {page} has {page.stat().st_size} bytes")
            n_wrong += 1
        for width, is_dark in ((1200, False), (1200, True), (500, False)):
            wrong = check_page(browser, page, n_charts, width, is_dark)
            n_wrong += len(wrong)
            print(*[f"FAILED: {page}, {width} pixels: {text}" for text in wrong] or [f"{page}, {width} pixels{', dark' if is_dark else ''}: good"],
                  sep="\n", flush=True)
    sys.exit(n_wrong > 0)


main()
