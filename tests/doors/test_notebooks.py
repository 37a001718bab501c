"""What stands at the end of a notebook's cell is shown: bakes as pictures, shapes as tables."""

import pytest
from conftest import PATIENCE
from house import ROOT

CELLS = (
    "import meshdepict as md\nball = md.samples.golf_ball(400, dimples=12)\nball",
    "baked = md.bake(ball, 'lambert')\nbaked",
    "md.scale_space(ball, scales=1)",
    "md.bake_volume(md.samples.ct_phantom((16, 16, 16)), 'lambert')",
    "md.methods()",
    "md.methods('lambert')",
    "baked.plot(jupyter_backend='static', window_size=(80, 60))",
)
SHOWN = (
    "text/html", "image/png", "text/html", "image/png", "text/html", "text/html", "image/png",
)  # fmt: skip


@pytest.mark.slow
def test_a_notebook_shows_what_there_is(tmp_path):
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    manual = nbformat.read(ROOT / "docs" / "howto" / "inscription.ipynb", as_version=4)
    first = [cell for cell in manual.cells if cell.cell_type == "code"]
    shown = (None, "text/html", "image/png", "image/png", "text/html")
    notebook.cells = [*first, *notebook.cells]
    nbclient.NotebookClient(
        notebook, timeout=PATIENCE, kernel_name="python3",
        resources={"metadata": {"path": tmp_path}},
    ).execute()  # fmt: skip
    for cell, kind in zip(notebook.cells, (*shown, *SHOWN), strict=True):
        if kind is None:
            assert not cell.outputs
            continue
        data = next(output["data"] for output in cell.outputs if "data" in output)
        assert kind in data, cell.source
        assert not [output for output in cell.outputs if output.get("name") == "stderr"]
