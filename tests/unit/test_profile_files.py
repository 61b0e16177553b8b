"""Profile files as instruments write them: read, or refused with the key that settles it."""

import sys

import numpy as np
import pytest

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.files.profiles import Layout, checked, read_profile

X, Z = np.arange(6) * 2e-6, np.array([0.0, 1e-7, -2.5e-7, 3e-7, 1.5e-7, -1e-8])


def lines(form, x=1.0, z=1.0):
    """The profile written with a format, in other units by factors."""
    return "".join(form.format(a * x, b * z) for a, b in zip(X, Z, strict=True))


def german(text):
    return text.replace(".", ",")


ALONE = {"unit": "um", "spacing": 2e-6}
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
    "header": ("x [mm]\tz [\u00b5m]\n" + lines("{}\t{}\n", 1e3, 1e6), {"unit": "um", "x_unit": "mm"}),
    "heights alone": (lines("{1}\n", z=1e6), ALONE),
    "heights alone, decimal comma": (german(lines("{1:.4f}\n", z=1e6)), ALONE | {"decimal": ","}),
    "several columns": (lines("1;{0};7;{1}\n"), {"columns": (2, 4)}),
    "third column alone": (lines("1,{0},{1}\n"), {"columns": (3,), "spacing": 2e-6}),
    "quoted cells": ('"x";"z"\n' + german(lines('"{:.7f}";"{:.8f}"\n')), {}),
    "quoted cells, comma": (lines('"{}","{}"\n'), {}),
    "decimal comma in quotes, comma": (german(lines('"{:.7f}"%"{:.8f}"\n')).replace("%", ","), {}),
    "bars": ("| x | z |\n|---|---|\n" + lines("| {} | {} |\n"), {}),
    "minus of a word processor": (lines("{};{}\n").replace("-1e-08", "\u22121.0e-08"), {}),
    "Fortran": (lines("{:.7e} {:.9e}\n").replace("e", "D"), {}),
    "column of words": ("n;x;z\n" + lines("peak;{};{}\n"), {}),
    "columns counted with the words": ("x,quality,z\n" + lines("{},OK,{}\n"), {"columns": (1, 3)}),
    "angstrom": ("x [um],z [A\u030a]\n" + lines("{},{}\n", 1e6, 1e10), {"x_unit": "um", "unit": "angstrom"}),
    "inches": (lines("{},{}\n", 1 / 0.0254, 1e6 / 0.0254), {"x_unit": "inch", "unit": "microinch"}),
    "mils": (lines("{},{}\n", 1e3 / 0.0254, 1e3 / 0.0254), {"unit": "mil"}),
    "heading that begins with a number": ("7,points\n" + lines("{:e},{:e}\n"), {}),
    "thousands": (lines("{0:,.1f};{1:,.3f}\n", 1e9, 1e9), {"decimal": ".", "unit": "nm"}),
}


@pytest.mark.parametrize(("text", "layout"), READABLE.values(), ids=READABLE)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_file_layouts_give_the_same_profile(tmp_path, text, layout, encoding):
    path = tmp_path / "p.txt"
    if encoding == "latin-1":
        text = text.replace("\u2212", "-").replace("A\u030a", "\u00c5")
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


def long_profile(path, left_out=(), words=()):
    """A profile whose heights are words here and there, or whose lines are left out; x and heights."""
    x = np.arange(400) * 1e-6
    z, words = 1e-7 * np.sin(x / 3e-5), dict(words)
    kept = np.setdiff1d(np.arange(400), left_out)
    path.write_text("".join(f"{x[k]:.7e};{words.get(k, f'{z[k]:.12e}')}\n" for k in kept))
    return x, z


@pytest.mark.parametrize(
    ("changes", "count", "begin"),
    [
        ({"words": {0: "---", 1: "---", 50: "nan", 51: "nan", 52: "nan", 200: ""}}, 6, 2),
        ({"left_out": [50, 51, 52, 200]}, 4, 0),  # a spline would bridge them without a warning
    ],
)
def test_missing_heights_and_lines_are_filled_up_to_the_length_stated(tmp_path, changes, count, begin):
    path = tmp_path / "p.csv"
    x, z = long_profile(path, **changes)
    with pytest.raises(ProfileError, match=f"^{count} .* 4e-06 m .* x = 4.9e-05; .* fill_gaps = 4e-06 "):
        read_profile(path)
    with pytest.raises(ProfileError, match="fill_gaps = 4e-06 "):
        read_profile(path, Layout(fill_gaps=3.9e-6))
    X, filled, (note,) = read_profile(path, Layout(fill_gaps=4.1e-6))
    np.testing.assert_allclose(X, x[begin:] - x[begin], atol=1e-15)  # the ends are not guessed
    np.testing.assert_allclose(filled, z[begin:], atol=1e-12)
    assert note.startswith(f"{count} missing ") and note.endswith(" 4 um")


def test_more_than_half_of_the_lines_omitted_is_refused(tmp_path):
    long_profile(tmp_path / "p.csv", left_out=np.arange(60, 399))
    with pytest.raises(ProfileError, match="1e-06 m apart, .* 0.00034 m .* x = 5.9e-05; .* half"):
        read_profile(tmp_path / "p.csv", Layout(fill_gaps=1.0))


@pytest.mark.parametrize(
    "marker", ["", "nan", "NaN", "-nan(ind)", "1.#QNAN", "#N/A", "n/a", "BAD", "*****", "---"]
)
@pytest.mark.parametrize("separator", [";", ","])
def test_markers_of_a_missing_height(tmp_path, marker, separator):
    path = tmp_path / "p.csv"
    path.write_text("".join(f"{k}e-6{separator}{marker if k == 4 else k % 3}\n" for k in range(9)))
    with pytest.raises(ProfileError, match="^1 heights missing, the longest gap 2e-06 m behind x = 3e-06; "):
        read_profile(path)


@pytest.mark.parametrize("x", [np.r_[0, 100:120, 220], np.cumsum(1.0 + np.arange(400) % 3)])
def test_uneven_spacing_is_no_gap(tmp_path, x):
    path = tmp_path / "p.csv"
    path.write_text("".join(f"{1e-6 * place:.7e};{1e-7 * np.sin(place):.9e}\n" for place in x))
    X, _, notes = read_profile(path)
    np.testing.assert_allclose(X, 1e-6 * (x - x[0]), atol=1e-15)
    assert notes == ()


REFUSED = {
    "several columns": (lines("1;{0};{1}\n"), {}, r"^3 columns; .*columns = \[1, 2\]"),
    "heights alone": (lines("{1}\n"), {}, "^heights alone .*spacing"),
    "comma": (german(lines("{1:.9f}\n")), {"spacing": 1e-6}, r'spacing .* columns = \[2\] .* decimal = "," '),
    "both signs": (lines("{0:,.1f};{1:,.3f}\n", 1e9, 1e9), {}, r'decimal = "," or decimal = "\."'),
    "no such column": (lines("{},{}\n"), {"columns": (1, 3)}, r"^columns = \[1, 3\]: .* 2$"),
    "units": ("x [mm];z [um]\n" + lines("{};{}\n"), {}, 'mm and um, .* unit = "um" .* x_unit = "mm"'),
    "angstrom in the header": (
        "Lateral (um),Total Profile (\u00c5)\n" + lines("{},{}\n"),
        {},
        '^its header names um and angstrom, .* unit = "angstrom" .* x_unit = "um"$',
    ),
    "angstrom of two signs": ("x;z [A\u030a]\n" + lines("{};{}\n"), {}, 'unit = "angstrom" for the heights$'),
    "mil": ("x/mil;z/\u00b5in\n" + lines("{};{}\n"), {}, 'unit = "microinch" .* x_unit = "mil"$'),
    "inch in a quoted header": ('"x (in)","z"\n' + lines("{},{}\n"), {}, 'unit = "inch" for the heights$'),
    "word": ("x;z\n" + lines("{};{}\n") + "1;0.12 um\n", {}, '^line 8: "0.12 um" is not a number; '),
    "word in the first cell": ("x;z\n0;0.12 um\n" + lines("{};{}\n"), {}, '^line 2: "0.12 um" .* = 2$'),
    "word after a comma": (lines("{},{}\n") + "1,0.12 um\n", {}, '^line 7: "0.12 um" is not a number; '),
    "unit in every cell": (lines("{};{} um\n"), {"spacing": 1e-6}, '^line 1: "0.0 um" is not a number; '),
    "lost exponent": (lines("{} {}\n") + "1 1.0-107\n", {}, '^line 7: "1.0-107" is not a number; '),
    "x": ("n;x;z\n" + lines("a;{};{}\n"), {"columns": (1, 3)}, r"no numbers in column 1; .* \[2, 3\]"),
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


def test_other_formats_are_read_by_surface_topography(tmp_path, monkeypatch):
    class Topography:
        dim, unit, pixel_size = 2, "m", (1e-6, 2e-6)

        def to_unit(self, unit):
            assert unit == "m"
            return self

        def heights(self):
            return 0.1e-6 * np.arange(6)[:, None] + 1e-6 * np.arange(3)

    package = type(sys)("SurfaceTopography")
    package.read_topography = lambda path: Topography()
    monkeypatch.setitem(sys.modules, "SurfaceTopography", package)
    path = tmp_path / "p.sur"
    path.write_bytes(b"")
    x, z, _ = read_profile(path)
    np.testing.assert_allclose(x, np.arange(6) * 1e-6)
    np.testing.assert_allclose(z, 0.1 * x + 1e-6)  # the middle one of three traces


def wave(count=400):
    x = 0.5e-6 * np.arange(count)
    return x, 1e-6 * (5.0 + 0.3 * np.sin(x / 7e-6) + 0.1 * np.sin(x / 1.1e-6))


@pytest.mark.parametrize(
    ("value", "shown"), [(9999.0, "9999"), (-9999.0, "-9999"), (0.0, "0"), (1e38, "1e.38")]
)
@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_repeated_no_data_values_are_missing_heights(tmp_path, value, shown, tilt):
    x, z = wave()
    z = z + tilt * (x - x.mean())
    written = 1e6 * z
    written[[50, 51, 52, 200]] = value
    path = tmp_path / "p.csv"
    path.write_text("".join(f"{1e6 * a:.7e};{b:.12e}\n" for a, b in zip(x, written, strict=True)))
    message = f"^4 heights missing, 4 of them the value {shown} far .* fill_gaps = 2e-06"
    with pytest.raises(ProfileError, match=message):
        read_profile(path, Layout(unit="um"))
    _, filled, notes = read_profile(path, Layout(unit="um", fill_gaps=2.1e-6))
    np.testing.assert_allclose(filled, z, atol=3e-8)
    assert len(notes) == 1 and "4 of them the value" in notes[0]


@pytest.mark.parametrize("kind", ["quantised", "square", "ridge", "dimples"])
def test_repeated_heights_that_join_their_neighbours_are_no_missing_ones(kind):
    x, z = wave()
    z = {
        "quantised": np.round(z, 8),
        "square": np.where(np.sin(x / 7e-6) > 0, 1e-6, 0.0),
        "dimples": np.where(np.arange(400) % 40 < 25, 0.0, z - 1e-5),
        "ridge": np.maximum(0.0, 1e-6 - np.abs(x - 1e-4) * 0.01),
    }[kind]
    _, checked_z, notes = checked(x, z, Layout())
    np.testing.assert_array_equal(checked_z, z)
    assert notes == ()


def with_spikes():
    """Heights with noise, without and with three spikes of one to four points."""
    x, z = wave()
    z = z + 5e-9 * np.random.default_rng(1).standard_normal(z.size)
    faulty = z.copy()
    faulty[60] += 4e-6
    faulty[150:152] -= 3e-6
    faulty[300:304] += 5e-6
    return x, z, faulty


def test_spikes_are_noted_and_bridged_and_none_is_beside_a_drop_out():
    x, z, faulty = with_spikes()
    _, same, (note,) = checked(x, faulty, Layout())
    np.testing.assert_array_equal(same, faulty)
    assert note == "spikes: 3 with 7 points in all, the first at x = 30 um; bridge_spikes = true bridges them"
    _, bridged, (note,) = checked(x, faulty, Layout(bridge_spikes=True))
    np.testing.assert_allclose(bridged, z, atol=2e-7)
    assert note.endswith("x = 30 um, bridged")
    x, z, _ = with_spikes()
    z[100:120] = np.nan
    _, _, notes = checked(x, z, Layout(fill_gaps=2e-5))
    assert len(notes) == 1 and notes[0].startswith("20 missing")


@pytest.mark.parametrize("kind", ["drop-out", "clipped"])
def test_held_heights_are_noted(kind):
    x, z = wave()
    if kind == "drop-out":
        z[100:130], found = z[99], "31, from x = 49.5 um on, "
    else:
        z, found = np.minimum(z, 5.32e-6), "21, from x = 8 um on, "
    _, same, (note,) = checked(x, z, Layout())
    np.testing.assert_array_equal(same, z)
    assert note.startswith(f"equal heights in a row: {found}")


def test_map_of_heights_is_no_profile(tmp_path):
    """Nor a trace of its few lines; one line of it in a file is."""
    heights = 1e-7 * np.random.default_rng(2).standard_normal((21, 400)).cumsum(axis=1)
    path = tmp_path / "map.csv"
    np.savetxt(path, heights, delimiter=",")
    for layout in (Layout(), Layout(columns=(1, 2)), Layout(columns=(5,), spacing=1e-6)):
        with pytest.raises(ProfileError, match="^400 columns in 21 lines .*: a map of heights, .*spacing"):
            read_profile(path, layout)
    np.savetxt(path, heights[10:11], delimiter=",")
    x, z, _ = read_profile(path, Layout(spacing=1e-6))
    np.testing.assert_allclose(x, 1e-6 * np.arange(400), atol=1e-15)
    np.testing.assert_allclose(z, heights[10])


def softgauges():
    """The same profile in um and mm in every format of metrology institutes."""
    data = "\n".join(f"{round(1e12 * z)}" for z in Z)
    end = "EOR\n0 9\nEOR\nEOF\n"
    sdf = "NumPoints = 6\nNumProfiles = {}\nXscale = 2e-6\nYscale = 1\nZscale = 1e-12\nDataType = 7\n*\n"
    prf = (
        "1 2\nFLANK 0.0 PRF\nCX M 6.0e+00 MM 1.0e+000 D\nCZ M 6.0e+00 UM 1.000000e-006 L\nEOR\n"
        f"STYLUS_RADIUS 2.0 UM\nSPACING CX 2.0e-003\nEOR\n{data}\n{end}"
    )
    axes = "CX I 6 mm 1.0 D 2.0E-003\nCZ A 6 um 1.0E-006 D\n"
    smd = f"ISO 5436-2-2000\0a.smd\nPRF 0 a\n{axes}\x03DATE\n\x03\n{data}\n\x03\n5\n\x03"
    rows = f"{'1 ' * 6}\n{data}\n{'2 ' * 6}\n*\n"
    return {
        "flank.prf": prf,
        "flank.smd": smd.replace("CX I", "CX\0I"),
        "profile.sdf": f"aBCR-1.0\nManufacID = X\n{sdf.format(1)}{data}\n*\n",
        "map.SDF": f"aISO-1.0\nManufacID = X\n{sdf.format(3)}{rows}",
    }


@pytest.mark.parametrize("name", softgauges())
def test_softgauges_have_spacing_and_scale_in_their_header(tmp_path, name):
    path = tmp_path / name
    path.write_text(softgauges()[name].replace("\n", "\r\n"))
    x, z, notes = read_profile(path)
    np.testing.assert_allclose(x, X, atol=1e-18)
    np.testing.assert_allclose(z, Z, atol=1e-18)
    assert notes == ()
    with pytest.raises(ProfileError, match="^spacing: .* includes it; leave it out$"):
        read_profile(path, Layout(spacing=1e-6))


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("flank.prf", "CZ M 6.0", "CZ M 7.0", "^SMD: 6 heights, CZ = 7 in its header; "),
        ("flank.prf", "SPACING CX 2.0e-003\n", "", "^SMD: x without spacing; "),
        ("flank.prf", "UM 1.000000e-006", "KM 1", "^SMD: unit KM of CZ; allowed: m, mm, um, nm$"),
        ("flank.prf", "-250000", "-25o000", '^SMD: "-25o000" is not a number; '),
        ("flank.prf", "-250000", "BAD", "^1 heights missing, .* x = 2e-06; "),
        ("flank.smd", "\x03", "", "^SMD: fewer than 3 records; "),
        ("profile.sdf", "Zscale", "Zskale", "^SDF: Zscale is missing; "),
        ("map.SDF", "NumPoints = 6", "NumPoints = 5", "^SDF: 18 heights, NumPoints NumProfiles = 15 "),
    ],
)
def test_damaged_softgauge_is_refused(tmp_path, name, old, new, message):
    path = tmp_path / name
    path.write_text(softgauges()[name].replace(old, new))
    with pytest.raises(ProfileError, match=message):
        read_profile(path)
