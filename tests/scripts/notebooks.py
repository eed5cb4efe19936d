"""notebooks.py PROJECT PROGRAM: execute each notebook of doc/notebooks in a new folder; --keep FOLDER keeps them with their outputs."""
import os
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

project, program = Path(sys.argv[1]), sys.argv[2]
os.environ.update(GREVILLE=program, PYTHONPATH=str(project / "python"), PYTHONDONTWRITEBYTECODE="1",
                  PYDEVD_DISABLE_FILE_VALIDATION="1")
failed = 0
for file in sorted((project / "doc" / "notebooks").glob("*.ipynb")):
    notebook = nbformat.read(file, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        try:
            NotebookClient(notebook, timeout=280, kernel_name="python3", resources={"metadata": {"path": folder}}).execute()
            print(f"{file.name}: {sum(cell.cell_type == 'code' for cell in notebook.cells)} cells")
        except CellExecutionError as error:
            failed += 1
            print(f"FAILED: {file.name}: {error}")
    if "--keep" in sys.argv:
        nbformat.write(notebook, Path(sys.argv[sys.argv.index("--keep") + 1]) / file.name)
sys.exit(failed > 0)
