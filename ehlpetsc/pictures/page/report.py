"""Self-contained HTML page of one result."""

import html
import json
from importlib import import_module
from importlib.resources import files

from ehlpetsc.environment import has
from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.page.report_data import report_data
from ehlpetsc.results.atomic_write import atomic_write

PAGE_FILES = {"style": "report.css", "script": "report.js"}


def _plotly():
    """Script of the Python package plotly."""
    if not has("plotly"):
        raise OutputError("the report is drawn by plotly; type: sudo apt-get install python3-plotly")
    return import_module("plotly.offline").get_plotlyjs()


def save_report(result, path):
    """Write the page.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result
    path : pathlib.Path
    """
    plotly = _plotly()
    data = report_data(result)
    page = files("ehlpetsc.pictures.page")
    text = page.joinpath("report.html").read_text(encoding="utf-8")
    for name, file in PAGE_FILES.items():
        text = text.replace("{{" + name + "}}", page.joinpath(file).read_text(encoding="utf-8"))
    rows = "".join(f"<tr><th>{html.escape(k)}</th><td>{html.escape(v)}</td></tr>" for k, v in data["facts"])
    for name, value in (("title", data["title"]), ("case", data["case"])):
        text = text.replace("{{" + name + "}}", html.escape(value))
    text = text.replace("{{facts}}", rows)
    # only "<" can end a script element
    text = text.replace("{{data}}", json.dumps(data, allow_nan=False).replace("<", "\\u003c"))
    text = text.replace("{{plotly}}", plotly)
    atomic_write(path, text.encode())
