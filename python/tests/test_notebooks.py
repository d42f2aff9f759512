"""The notebooks of docs/notebooks: execution reproduces their stored outputs."""

import os

import pytest
from conftest import ROOT

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

FOLDER = ROOT / "docs" / "notebooks"

#: A reader's page; what is larger is shown as its source.
LARGEST = 500_000

ALL = sorted(path.name for path in FOLDER.glob("*.ipynb"))
#: They take long: `cargo xtask full` and `cargo xtask python` run them.
RUN = ALL if os.environ.get("PAPILIO_NOTEBOOKS") == "all" else []


@pytest.mark.parametrize("name", RUN)
def test_executed_notebook_equals_stored_outputs(name):
    notebook = nbformat.read(FOLDER / name, as_version=4)
    stood = [texts(cell) for cell in notebook.cells]
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    assert [texts(cell) for cell in notebook.cells] == stood


@pytest.mark.parametrize("name", ALL)
def test_notebook_is_complete_and_small(name):
    assert (FOLDER / name).stat().st_size < LARGEST
    code = [cell for cell in nbformat.read(FOLDER / name, as_version=4).cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert any("image/svg+xml" in output.get("data", {}) for cell in code for output in cell.outputs)


@pytest.mark.parametrize("name", ALL)
def test_notebook_has_one_title_and_sections(name):
    cells = [cell.source for cell in nbformat.read(FOLDER / name, as_version=4).cells if cell.cell_type == "markdown"]
    headings = [line for source in cells for line in source.splitlines() if line.startswith("#")]
    assert cells[0].startswith("# ") and not any(source.startswith(" ") for source in cells)
    assert all(line.startswith(("## ", "### ")) for line in headings[1:])


def test_all_notebooks_are_listed():
    listed = (FOLDER / "README.md").read_text()
    assert ALL and all(f"({name})" in listed for name in ALL)


def texts(cell):
    """Printed text, and the text of the last expression, without warnings, which contain paths of the machine."""
    found = []
    for output in cell.get("outputs", []):
        if output.get("name") != "stderr":
            found.append(output.get("text") or output.get("data", {}).get("text/plain"))
    return found
