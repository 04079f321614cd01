"""The notebook of the documentation runs and prints what it shows."""

import io
import json
from contextlib import redirect_stdout
from typing import Any

import pytest

from tests.helpers.cases import SCENARIOS

NOTEBOOK = json.loads((SCENARIOS.parent / "docs" / "study.ipynb").read_text())


def test_the_cells_print_what_they_show(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(SCENARIOS.parent / "docs")
    names: dict[str, Any] = {}
    for cell in NOTEBOOK["cells"]:
        if cell["cell_type"] == "code":
            printed = io.StringIO()
            with redirect_stdout(printed):
                exec("".join(cell["source"]), names)
            assert printed.getvalue() == "".join(output["text"] for output in cell["outputs"])
