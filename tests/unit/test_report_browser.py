"""The report in a browser without a network: slider, map, zoom, charts that share time."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from support.made_results import make_result, with_solids

from ehlpetsc.base.environment import has
from ehlpetsc.pictures import command as plot

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        BROWSER is None, reason="no browser is installed; test_report tests the text and the data of the page"
    ),
    pytest.mark.skipif(not has("plotly"), reason="Plotly, which only the report needs, is not installed"),
]
FLAGS = """headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking
disable-component-update disable-sync window-size=1200,2400 virtual-time-budget=9000 dump-dom""".split()
VISITOR = (Path(__file__).parents[1] / "data" / "report_visitor.js").read_text(encoding="utf-8")


@pytest.fixture
def found(tmp_path):
    """What a visitor sees who slides, clicks into the map and zooms, without a network."""
    path = with_solids(make_result(tmp_path / "r.h5"))
    assert plot.main([str(path), "--report"]) == 0
    page = path.with_suffix(".html")
    text = page.read_text(encoding="utf-8").replace("<head>", f"<head><script>{VISITOR}</script>")
    page.write_text(text, encoding="utf-8")
    options = [*FLAGS, f"user-data-dir={tmp_path / 'profile'}", "host-resolver-rules=MAP * ~NOTFOUND"]
    command = [BROWSER, *(f"--{option}" for option in options), page.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    (answer,) = re.findall("<output>(.*?)</output>", done.stdout)
    return json.loads(answer)


def test_slider_map_and_zoom_of_the_page(found):
    assert found["errors"] == []
    assert found["first"]["pressure"] == pytest.approx(1.4)
    assert found["first"]["when"] == "step 0, 0 µs, travel 0.00 a"
    assert found["second"]["when"].startswith("step 1, ") and found["second"]["line"] == 1.0
    assert found["second"]["pressure"] < found["first"]["pressure"]
    assert found["clicked"]["when"].startswith("step 20, ") and found["clicked"]["line"] == 20.0
    (low, high), (first, second) = found["zoomed"], found["linked"]
    assert -1.0 < low < -0.5 < 0.5 < high < 1.0  # the middle half of -1.6 to 1.4
    assert first == second and first == pytest.approx([10.0, 30.0], abs=1.0)
