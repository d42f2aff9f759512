"""Executes docs/notebooks again, in place; run it with the environment of the package's tests.

What goes to stderr is left out: warnings name files of the machine that they were raised on.
"""

import sys
from pathlib import Path

import nbclient
import nbformat

FOLDER = Path(__file__).parents[2] / "docs" / "notebooks"


def execute(path: Path) -> None:
    """Executes a notebook and writes it back."""
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(FOLDER)}}).execute()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
            cell.metadata.pop("execution", None)  # times of execution
    nbformat.write(notebook, path)


if __name__ == "__main__":
    for one in map(Path, sys.argv[1:]) if sys.argv[1:] else sorted(FOLDER.glob("*.ipynb")):
        execute(one)
