"""A result as one page: its content, that it needs nothing else, and what a browser shows."""

import base64
import html.parser
import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from plotly.offline import get_plotlyjs
from support.browser import BROWSER, visited
from support.made_results import make_result, with_solids

from ehlpetsc.commands import plot
from ehlpetsc.pictures import report
from ehlpetsc.pictures.frames.choice import frame_to_show
from ehlpetsc.results.means import Totals
from ehlpetsc.results.reader import read_result

PLACES = {"film_thickness": "values", "contact_pressure": "solids"}  # of fields on the page


def unpacked(text, kind="<f4"):
    return np.frombuffer(base64.b64decode(text), dtype=kind)


class Page(html.parser.HTMLParser):
    """Elements and attributes of a page, and the text of its scripts."""

    def __init__(self, text):
        super().__init__()
        self.attributes, self.open, self.texts = [], [None], {}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.open.append((tag, dict(attrs).get("id")))
        self.attributes += [(tag, *pair) for pair in attrs]

    def handle_data(self, data):
        self.texts[self.open[-1]] = self.texts.get(self.open[-1], "") + data


@pytest.fixture
def page(tmp_path, capsys):
    def made(path):
        assert plot.main([str(path), "--report"]) == 0
        found = Page(path.with_suffix(".html").read_text(encoding="utf-8"))
        return found, json.loads(found.texts["script", "data"])

    return made


def test_words_of_the_template_in_a_title_stay_text(tmp_path, page):
    """Inserted again wherever they stood, they made the page a hundred times as large."""
    path = make_result(tmp_path / "r.h5", title="{{data}} {{plotly}} {{title}}")
    found, data = page(path)
    assert data["title"] == "{{data}} {{plotly}} {{title}}" == found.texts["title", None].strip()
    assert path.with_suffix(".html").stat().st_size < 2 * len(get_plotlyjs())


def test_report_contains_fields_and_needs_no_network(tmp_path, page):
    path = with_solids(make_result(tmp_path / "r.h5", title="a <b> & </script>"))
    found, data = page(path)
    assert not [a for a in found.attributes if a[1] in ("src", "href", "srcset", "action")]
    text = path.with_suffix(".html").read_text(encoding="utf-8")
    ours = text.replace(get_plotlyjs(), "")
    assert not re.search(r"https?://|@import|url[(]|fetch[(]|XMLHttpRequest|WebSocket", ours)
    assert data["title"] == "a <b> & </script>" and ours.count("</script>") == 3
    frames = data["frames"]
    x = unpacked(frames["x"])
    with read_result(path) as r:
        part = np.isin(np.float32(r.x / r.attrs["a"]), x)
        for name, factor in (("pressure", 1e-9), ("film_thickness", 1e6), ("contact_pressure", 1e-9)):
            shown = unpacked(frames[PLACES.get(name, name)]).reshape(-1, x.size)
            np.testing.assert_allclose(shown, factor * r[name][:][:, part], rtol=1e-6)
        touching = unpacked(frames["contact"], "u1").reshape(-1, x.size)
        np.testing.assert_array_equal(touching, r["in_contact"][:][:, part])
        contacts = next(f for f in data["steps"]["figures"] if f["name"] == "nodes in contact")
        np.testing.assert_array_equal(unpacked(contacts["y"]), r.steps("contacts")[1:])
        assert frames["step"][frames["first"]] == r.step[frame_to_show(r)]
        facts, means = dict(data["facts"]), Totals.of_result(r).means
        assert facts["friction coefficient, mean"] == f"{means['friction_coefficient']:.4g}"
        assert facts["maximum pressure"] == f"{1e-9 * r.steps('p_max').max():.4g} GPa"
        assert " contact, u = " in facts["contact"] and facts["contact"].endswith(", oil 5 mPa s")
    names = [figure["name"] for figure in data["steps"]["figures"]]
    assert data["damage"] is None and "maximum pressure [GPa]" in names
    assert "share of the load on the solids" in names
    assert "time step [µs]" not in names  # what does not change is left out


def test_thinned_fields_keep_their_peaks(tmp_path, page, monkeypatch):
    monkeypatch.setattr(report, "PAGE_NODES", 40)
    monkeypatch.setattr(report, "PAGE_ROWS", 9)
    path = make_result(tmp_path / "r.h5", nodes=321)
    _, data = page(path)
    with read_result(path) as r:
        assert unpacked(data["frames"]["pressure"]).max() == pytest.approx(1e-9 * r["pressure"][:].max())
        highest = next(f for f in data["steps"]["figures"] if f["name"].startswith("maximum pressure"))
        assert len(unpacked(highest["y"])) == 8  # 40 steps in bins of 5: at most 9
        assert unpacked(highest["y"]).max() == pytest.approx(1e-9 * r.steps("p_max")[1:].max())


def test_report_shows_damage_in_decades(tmp_path, page):
    path = make_result(tmp_path / "r.h5", nodes=41, steps=3)
    with h5py.File(path) as result, h5py.File(tmp_path / "r.post.h5", "w") as file:
        file.attrs.update(a=2.0, case=result.attrs["case"])
        group = file.create_group("damage")
        group["s"], group["z_over_a"] = [1.0, 2.0, 4.0], [0.0, 0.5]
        group["2"] = [[1e-3, 0.0, 1e-5], [np.nan, 1e-7, 1e-8]]
    _, data = page(path)
    assert data["damage"]["depths"] == [0.0, 0.5] and list(data["damage"]["surfaces"]) == ["2"]
    np.testing.assert_allclose(unpacked(data["damage"]["s"]), [0.5, 1.0, 2.0])
    rows = [unpacked(row) for row in data["damage"]["surfaces"]["2"]]
    np.testing.assert_allclose(rows, [[-3, np.nan, -5], [np.nan, -7, -8]], rtol=1e-6)


VISITOR = (Path(__file__).parents[1] / "data" / "report_visitor.js").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="no browser is installed; the other tests read text and data")
def test_slider_map_and_zoom_of_the_page(tmp_path, page):
    path = with_solids(make_result(tmp_path / "r.h5"))
    page(path)
    found = visited(path.with_suffix(".html"), VISITOR)
    assert found["errors"] == []
    assert found["first"]["pressure"] == pytest.approx(1.4)
    assert found["first"]["when"] == "step 0, 0 µs, travel 0.00 a"
    assert found["second"]["when"].startswith("step 1, ") and found["second"]["line"] == 1.0
    assert found["second"]["pressure"] < found["first"]["pressure"]
    assert found["clicked"]["when"].startswith("step 20, ") and found["clicked"]["line"] == 20.0
    (low, high), (first, second) = found["zoomed"], found["linked"]
    assert -1.0 < low < -0.5 < 0.5 < high < 1.0  # the middle half of -1.6 to 1.4
    assert first == second and first == pytest.approx([10.0, 30.0], abs=1.0)
