"""The notebook runs and prints what is stored in it; ``python3 tests/unit/test_notebook.py`` stores it."""

import base64
import contextlib
import io
import json
import os
import sys
import tomllib
from pathlib import Path

import matplotlib
import pytest

ROOT = Path(__file__).resolve().parents[2]

NOTEBOOK = ROOT / "cases" / "first_steps.ipynb"
DPI = 40  # of the pictures stored
MOST_BYTES = 180_000


def run(cells):
    """Outputs of the code cells, run in one namespace in the folder of the notebook."""
    matplotlib.use("Agg")
    from matplotlib import pyplot

    namespace = {}
    for number, cell in enumerate(cells, 1):
        pyplot.close("all")
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("".join(cell["source"]), f"cell {number}", "exec"), namespace)
        outputs = []
        if printed.getvalue():
            text = printed.getvalue().splitlines(keepends=True)
            outputs.append({"output_type": "stream", "name": "stdout", "text": text})
        for figure in map(pyplot.figure, pyplot.get_fignums()):
            picture = io.BytesIO()
            figure.savefig(picture, dpi=DPI, metadata={"Software": None})
            data = {"image/png": base64.b64encode(picture.getvalue()).decode() + "\n"}
            outputs.append({"output_type": "display_data", "data": data, "metadata": {}})
        yield outputs


def code_cells(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def printed(outputs):
    return "".join("".join(output["text"]) for output in outputs if output["output_type"] == "stream")


@pytest.mark.slow
def test_notebook_prints_its_stored_outputs(monkeypatch):
    monkeypatch.chdir(NOTEBOOK.parent)
    cells = code_cells(json.loads(NOTEBOOK.read_text(encoding="utf-8")))
    pictures = 0
    for cell, outputs in zip(cells, run(cells), strict=True):
        assert printed(outputs) == printed(cell["outputs"])
        kinds = [output["output_type"] for output in outputs]
        assert kinds == [output["output_type"] for output in cell["outputs"]]
        pictures += kinds.count("display_data")
    assert pictures >= 4


def test_first_cell_installs_the_extra_of_binaries_where_the_program_is_missing(monkeypatch, tmp_path):
    cell = code_cells(json.loads(NOTEBOOK.read_text(encoding="utf-8")))[0]
    calls = []
    (tmp_path / "cases").mkdir()
    monkeypatch.chdir(tmp_path / "cases")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setattr("subprocess.run", lambda words, check: calls.append(words[1:]))
    assert list(run([cell])) == [[]]
    assert calls == [["-m", "pip", "install", "--quiet", "..[wheel]"]]
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert any(name.startswith("dolfinx-solver-real") for name in extras["optional-dependencies"]["wheel"])
    assert Path.cwd() == tmp_path / "cases"


def test_notebook_is_small_and_in_the_current_format():
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
    assert NOTEBOOK.stat().st_size < MOST_BYTES


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    os.chdir(NOTEBOOK.parent)
    stored = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    for count, (cell, found) in enumerate(zip(code_cells(stored), run(code_cells(stored)), strict=True), 1):
        cell["outputs"], cell["execution_count"] = found, count
        print(printed(found))
    NOTEBOOK.write_text(json.dumps(stored, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
