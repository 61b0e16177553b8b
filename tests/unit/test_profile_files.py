"""Profile files as instruments write them: read, or refused with the key that settles it."""

import sys

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.case import loading as case
from ehlpetsc.surfaces.profile_files import Layout, read_profile

X, Z = np.arange(6) * 2e-6, np.array([0.0, 1e-7, -2.5e-7, 3e-7, 1.5e-7, -1e-8])


def lines(form, x=1.0, z=1.0):
    """The profile written with a format, in other units by factors."""
    return "".join(form.format(a * x, b * z) for a, b in zip(X, Z, strict=True))


def german(text):
    return text.replace(".", ",")


READABLE = {
    "comma": ("# x [m], z [m]\n" + lines("{},{}\n"), {}),
    "tab": (lines("{}\t{}\n"), {}),
    "blanks and comments": ("x z\n" + lines(" {}   {}  # p\n"), {}),
    "separators in comments": (lines("{}\t{} # p; q, r\n"), {}),
    "comma and blank": (lines("{:.7f}, {:.8f}\n"), {}),
    "semicolon at the end": (lines("{};{};\n"), {}),
    "decimal comma, semicolon": (german(lines("{:.7f};{:.8f}\n")), {}),
    "decimal comma, tab": (german(lines("{:.7f}\t{:.8e}\n")), {}),
    "decimal comma, blanks": (german(lines("{:.7f}  {:.8f}\n")), {}),
    "header lines": ("Instrument 7\nDate: 1.2.2003\nx;z\n;\n" + lines("{};{}\n"), {}),
    "header of numbers": ("4000\n0.8 2\n7\n" + lines("{}\t{}\n"), {"header_lines": 3}),
    "BOM": ("\ufeff" + lines("{},{}\n"), {}),
    "um": (lines("{},{}\n", 1e6, 1e6), {"unit": "um"}),
    "mm and um in the header": (
        "x [mm]\tz [\u00b5m]\n" + lines("{}\t{}\n", 1e3, 1e6),
        {"unit": "um", "x_unit": "mm"},
    ),
    "heights alone": (lines("{1}\n", z=1e9), {"unit": "nm", "spacing": 2e-6}),
    "heights alone, decimal comma": (
        german(lines("{1:.4f}\n", z=1e6)),
        {"unit": "um", "spacing": 2e-6, "decimal": ","},
    ),
    "several columns": (lines("1;{0};7;{1}\n"), {"columns": (2, 4)}),
    "third column alone": (lines("1,{0},{1}\n"), {"columns": (3,), "spacing": 2e-6}),
    "thousands": (lines("{0:,.1f};{1:,.3f}\n", 1e9, 1e9), {"decimal": ".", "unit": "nm"}),
}


@pytest.mark.parametrize(("text", "layout"), READABLE.values(), ids=READABLE)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_file_layouts_give_the_same_profile(tmp_path, text, layout, encoding):
    path = tmp_path / "p.txt"
    path.write_bytes(text.lstrip("\ufeff" if encoding != "utf-8" else "").encode(encoding))
    x, z, notes = read_profile(path, Layout(**layout))
    np.testing.assert_allclose(x, X, atol=1e-18)
    np.testing.assert_allclose(z, Z, atol=1e-18)
    assert notes == ()


def test_decreasing_x_is_reversed(tmp_path):
    path = tmp_path / "p.csv"
    path.write_text("".join(reversed(lines("{},{}\n").splitlines(keepends=True))))
    x, z, notes = read_profile(path)
    np.testing.assert_allclose(x, X, atol=1e-18)
    np.testing.assert_array_equal(z, Z)
    assert len(notes) == 1 and notes[0].startswith("x falls")


def test_missing_heights_are_filled_up_to_the_length_stated(tmp_path):
    x = np.arange(400) * 1e-6
    z = 1e-7 * np.sin(x / 3e-5)
    words = [f"{v:.12e}" for v in z]
    for gap, how in ((slice(50, 53), "nan"), (slice(200, 201), ""), (slice(0, 2), "---")):
        words[gap] = [how] * (gap.stop - gap.start)
    path = tmp_path / "p.csv"
    path.write_text("".join(f"{a:.7e};{word}\n" for a, word in zip(x, words, strict=True)))
    with pytest.raises(ProfileError, match="^6 .* 4e-06 m .* x = 4.9e-05; .* fill_gaps = 4e-06 "):
        read_profile(path)
    with pytest.raises(ProfileError, match="fill_gaps = 4e-06 "):
        read_profile(path, Layout(fill_gaps=3.9e-6))
    X, filled, notes = read_profile(path, Layout(fill_gaps=4.1e-6))
    assert len(X) == 398 and X[0] == 0.0  # the ends are not guessed
    np.testing.assert_allclose(filled, z[2:], atol=1e-12)
    (note,) = notes
    assert note.startswith("6 missing ") and note.endswith(" 4 um")


def test_omitted_lines_are_missing_heights(tmp_path):
    """The spline would bridge them without a warning, and the spacing printed would be a mean."""
    x = np.arange(400) * 1e-6
    z = 1e-7 * np.sin(x / 3e-5)
    path = tmp_path / "p.csv"

    def write(left_out):
        kept = np.setdiff1d(np.arange(400), left_out)
        path.write_text("".join(f"{x[k]:.7e};{z[k]:.12e}\n" for k in kept))

    write([50, 51, 52, 200])
    message = "^4 .* 4e-06 m .* x = 4.9e-05; .* fill_gaps = 4e-06 "
    with pytest.raises(ProfileError, match=message):
        read_profile(path)
    X, filled, notes = read_profile(path, Layout(fill_gaps=4.1e-6))
    np.testing.assert_allclose(X, x, atol=1e-15)
    np.testing.assert_allclose(filled, z, atol=1e-12)
    (note,) = notes
    assert note.startswith("4 missing ") and note.endswith(" 4 um")
    write(np.arange(60, 399))
    message = "1e-06 m apart, .* 0.00034 m .* x = 5.9e-05; .* half"
    with pytest.raises(ProfileError, match=message):
        read_profile(path, Layout(fill_gaps=1.0))


@pytest.mark.parametrize("x", [np.r_[0, 100:120, 220], np.cumsum(1.0 + np.arange(400) % 3)])
def test_uneven_spacing_is_no_gap(tmp_path, x):
    """A shape made by hand, and one whose spacing varies all along."""
    path = tmp_path / "p.csv"
    path.write_text("".join(f"{1e-6 * place:.7e};{1e-7 * np.sin(place):.9e}\n" for place in x))
    X, _, notes = read_profile(path)
    np.testing.assert_allclose(X, 1e-6 * (x - x[0]), atol=1e-15)
    assert notes == ()


REFUSED = {
    "several columns": (lines("1;{0};{1}\n"), {}, r"^3 columns; .*columns = \[1, 2\]"),
    "heights alone": (lines("{1}\n"), {}, "^heights alone .*spacing"),
    "decimal or separator": (
        german(lines("{1:.9f}\n")),
        {"spacing": 1e-6},
        r'spacing .* columns = \[2\] .* decimal = "," ',
    ),
    "both signs": (lines("{0:,.1f};{1:,.3f}\n", 1e9, 1e9), {}, r'decimal = "," or decimal = "\."'),
    "no such column": (lines("{},{}\n"), {"columns": (1, 3)}, r"^columns = \[1, 3\]: .* 2$"),
    "unit in the header": (
        "x [mm];z [um]\n" + lines("{};{}\n"),
        {},
        'mm and um, .* unit = "um" .* x_unit = "mm"',
    ),
    "header of numbers": ("4000\n" + lines("{},{}\n"), {}, "^line 1: 1 numbers, .* 2; .* header_lines = 1 "),
    "text in it": (lines("{},{}\n") + "end\n", {}, "^line 1: 2 numbers, the last line has 1; .*header_lines"),
    "no numbers": ("a\nb\n", {}, "^0 points"),
    "no x": (lines("{},{}\n") + "nan,1e-7\n", {}, r"^point 7 .* 1e\+06 m;"),
    "twice": (lines("{:.1e},{}\n") + "1e-05,0\n", {}, "^x = 1e-05 follows x = 1e-05; .*spacing"),
}


@pytest.mark.parametrize(("text", "layout", "message"), REFUSED.values(), ids=REFUSED)
def test_refused_profile_names_the_layout_key(tmp_path, text, layout, message):
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(ProfileError, match=message) as caught:
        read_profile(path, Layout(**layout))
    assert "\n" not in str(caught.value)


def measured(tmp_path, x=1.0, z=1.0):
    """A measured profile in another unit beside a case."""
    table = np.loadtxt(CASES / "profiles" / "alicona_meander_profile.csv", delimiter=",")
    np.savetxt(tmp_path / "p.csv", table * (x, z), delimiter=",")
    text = (CASES / "table1_smooth.toml").read_text() + "\n[surface.2]\nfile = 'p.csv'\n"
    (tmp_path / "c.toml").write_text(text)
    return tmp_path / "c.toml"


@pytest.mark.parametrize(
    ("x", "z", "keys", "message"),
    [
        (1e3, 1e3, (), "points 500 um apart .* 336 um: .* another unit"),
        (1, 1e6, (), r"Rq 1\.98e\+05 um .* another unit"),
    ],
)
def test_implausible_profile_is_refused(tmp_path, x, z, keys, message):
    path = measured(tmp_path, x, z)
    with pytest.raises(CaseError, match=message) as caught:
        case.load(path, [f"surface.2.{key}" for key in keys])
    (fault,) = caught.value.faults
    assert "surface.2.file" in fault


def test_other_formats_are_read_by_surface_topography(tmp_path, monkeypatch):
    class Topography:
        dim = 2

        def to_unit(self, unit):
            assert unit == "m"
            return self

        def positions_and_heights(self):
            x, y = np.meshgrid(np.arange(6) * 1e-6, np.arange(3) * 1e-6, indexing="ij")
            return x, y, 0.1 * x + y

    package = type(sys)("SurfaceTopography")
    package.read_topography = lambda path: Topography()
    monkeypatch.setitem(sys.modules, "SurfaceTopography", package)
    path = tmp_path / "p.sur"
    path.write_bytes(b"")
    x, z, _ = read_profile(path)
    np.testing.assert_allclose(x, np.arange(6) * 1e-6)
    np.testing.assert_allclose(z, 0.1 * x + 1e-6)  # the middle one of three traces
