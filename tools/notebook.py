"""Run the cells of a notebook and write their outputs into it: ``python tools/notebook.py docs/study.ipynb``."""

import ast
import base64
import io
import json
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from PIL import Image

# Size of the figures, points per inch, and number of their colours, which keep the file small.
DPI, COLOURS = 72, 64


def outputs(cells: list[dict[str, Any]], *, draw: bool = True) -> list[list[dict[str, Any]]]:
    """Return the outputs of the cells of code, run one after the other; without drawing, figures are empty."""
    names: dict[str, Any] = {}
    return [_outputs("".join(cell["source"]), names, number, draw) for number, cell in enumerate(cells, start=1)]


def _outputs(source: str, names: dict[str, Any], number: int, draw: bool) -> list[dict[str, Any]]:
    """Return what a cell prints, and the value of its last line where that is an expression."""
    body = ast.parse(source).body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with redirect_stdout(printed):
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    found: list[dict[str, Any]] = []
    if text := printed.getvalue():
        found.append({"output_type": "stream", "name": "stdout", "text": text})
    if isinstance(value, Figure):
        data = {"image/png": _png(value) if draw else "", "text/plain": "<Figure>"}
        found.append(_result(data, number))
    elif value is not None:
        found.append(_result({"text/html": value._repr_html_(), "text/plain": repr(value)}, number))
    return found


def _result(data: dict[str, str], number: int) -> dict[str, Any]:
    return {"output_type": "execute_result", "execution_count": number, "metadata": {}, "data": data}


def _png(figure: Figure) -> str:
    drawn, small = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png", dpi=DPI)
    Image.open(drawn).convert("RGB").quantize(COLOURS, Image.Quantize.FASTOCTREE).save(small, "png", optimize=True)
    return base64.b64encode(small.getvalue()).decode()


if __name__ == "__main__":
    path = Path(sys.argv[1])
    notebook = json.loads(path.read_text(encoding="utf-8"))
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for number, (cell, found) in enumerate(zip(code, outputs(code), strict=True), start=1):
        cell |= {"execution_count": number, "outputs": found}
    path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
