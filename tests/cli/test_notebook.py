"""The notebook of the documentation runs and prints what it shows."""

import json

import pytest

from tests.helpers.cases import SCENARIOS
from tools.notebook import outputs

pytestmark = pytest.mark.slow

NOTEBOOK = SCENARIOS.parent / "docs" / "study.ipynb"
# The file stays small enough to be read in a browser.


@pytest.mark.usefixtures("folder")
def test_the_cells_print_what_they_show_in_an_empty_folder():
    cells = [cell for cell in json.loads(NOTEBOOK.read_text())["cells"] if cell["cell_type"] == "code"]
    shown = [cell["outputs"] for cell in cells]
    pictures = [output["data"] for found in shown for output in found if "image/png" in output.get("data", {})]
    assert len(pictures) >= 5
    assert all(picture["image/png"] for picture in pictures)
    for picture in pictures:
        picture["image/png"] = ""
    assert outputs(cells, draw=False) == shown, "make docs writes the outputs"
