"""Maps in text files: matrices with positions of columns and rows, lists of x y z, words of headers."""

import numpy as np
import pytest

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.commands.surface import main
from ehlpetsc.surfaces.files.areal import is_map, read_map
from ehlpetsc.surfaces.files.profiles import Layout, read_profile
from ehlpetsc.surfaces.files.text import text_columns

DX, DY = 2.5e-6, 4e-6
X, Y = DX * np.arange(24), DY * np.arange(16)
Z = np.round(12e-6 + 1e-7 * np.random.default_rng(3).standard_normal((16, 24)), 11)
UM, MM = 1e6, 1e3


def matrix(corner=None, x=None, y=None, separator="\t", z=Z):
    """Heights in um below a line x, behind a column y; `corner`: above y."""
    rows = [[f"{value:.5f}" for value in row] for row in UM * z]
    if y is not None:
        rows = [[label, *row] for label, row in zip(words(y), rows, strict=True)]
    if x is not None:
        rows.insert(0, ([] if corner is None else [corner]) + words(x))
    return "\n".join(separator.join(row) for row in rows) + "\n"


def words(values):
    return [value if isinstance(value, str) else f"{value:.6g}" for value in values]


def points(x=UM * X, y=UM * Y, z=UM * Z, form="{:.4f} {:.4f} {:.5f}\n", order=1):
    every = [form.format(a, b, z[j, i]) for j, b in enumerate(y) for i, a in enumerate(x)]
    return "".join(every[::order])


NUMBERS_X, NUMBERS_Y = np.arange(1, 25), np.arange(1, 17)
BOTH = {"unit": "um", "spacing": DX, "spacing_across": DY}
MAPS = {
    "corner of words, units": ("Z unit: um\n" + matrix("y\\x [mm]", MM * X, MM * Y), {}),
    "corner of a word": (matrix("pos", UM * X, UM * Y, ";"), {"unit": "um"}),
    "corner 0": (matrix("0", MM * X, MM * Y), {"unit": "um", "x_unit": "mm"}),
    "corner of a count": (matrix("24", MM * X, MM * Y, ","), {"unit": "um", "x_unit": "mm"}),
    "corner nan": (matrix("nan", MM * X, MM * Y), BOTH),
    "corner empty": (matrix("", MM * X, MM * Y), BOTH),
    "corner empty, semicolons": (matrix("", UM * X, UM * Y, ";"), {"unit": "um"}),
    "decimal comma": (matrix("y/x", MM * X, MM * Y, ";").replace(".", ","), {"unit": "um", "x_unit": "mm"}),
    "no corner, comment": ("# " + matrix(None, UM * X, UM * Y, " "), {"unit": "um"}),
    "positions of the columns": (matrix(None, MM * X), BOTH),
    "positions of the columns behind a word": (matrix("x [mm]", MM * X), BOTH),
    "positions of the rows": (matrix(None, None, MM * Y), {"unit": "um", "spacing": DX, "x_unit": "mm"}),
    "positions of the rows, spacings": (matrix(None, None, MM * Y), BOTH),
    "numbers": (matrix("n", NUMBERS_X, NUMBERS_Y), BOTH),
    "numbers from 0": (matrix("0", NUMBERS_X - 1, NUMBERS_Y - 1), BOTH),
    "numbers of the rows": (matrix(None, None, NUMBERS_Y), BOTH),
    "names of the rows": (matrix(None, None, [f"row{k}" for k in NUMBERS_Y], ";"), BOTH),
    "falling positions": (matrix("0", UM * X[::-1], UM * Y[::-1], z=Z[::-1, ::-1]), {"unit": "um"}),
    "positions of three decimals": (matrix("y", np.round(MM * X, 3), MM * Y), BOTH | {"x_unit": "mm"}),
    "list": (points(), {"unit": "um"}),
    "list, columns first": (points(UM * Y, UM * X, UM * Z.T, "{1:.4f},{0:.4f},{2:.5f}\n"), {"unit": "um"}),
    "list, falling": (points(order=-1), {"unit": "um"}),
    "list, units": ("X[mm] Y[mm] Z[um]\n" + points(MM * X, MM * Y, form="{:.6f} {:.6f} {:.5f}\n"), {}),
    "list, empty lines": ("\n".join(points().splitlines()[k] for k in range(384)), {"unit": "um"}),
    "list of numbers": (points(np.arange(24), np.arange(16)), BOTH),
    "list named y x z": ("Y X Z\n" + points(form="{1:.4f} {0:.4f} {2:.5f}\n"), {"unit": "um"}),
    "list with other columns": ("n x y z I\n" + points(form="7 {:.4f} {:.4f} {:.5f} 255\n"), {"unit": "um"}),
    "header of sizes along and across": ("Scan size: 60 um x 64 um\nZ unit: um\n" + matrix(), {}),
    "header of steps along and across": ("Pixel size: 2500 nm x 4 um\n" + matrix(), {"unit": "um"}),
    "header of steps in one line": ("dx = 2.5 um, dy = 4 um\n" + matrix(), {"unit": "um"}),
    "header of Gwyddion": (
        f"# Channel: Height\n# Width: {24 * 2.5} µm\n# Height: {16 * 4.0} µm\n# Value units: um\n" + matrix(),
        {},
    ),
    "header of steps": ("X step: 2.5 um\nY step: 4 um\nZ unit: um\n" + matrix(), {}),
    "header of spacings in brackets": ("dx [mm] = 0.0025\ndy [mm] = 0.004\nheight [um]\n" + matrix(), {}),
    "header of a pixel size": ("Pixel size X;2,5 um\nPixel size Y;4,0 um\n" + matrix(), {"unit": "um"}),
    "cell size without unit": (
        "ncols 24\nnrows 16\ncellsize x 2.5\ncellsize y 4\n" + matrix(separator=" "),
        {"unit": "um", "x_unit": "um"},
    ),
    "header of a diameter and a height of the part": (
        "d = 50 mm\nHeight: 40 mm\nPixel size: 2.5 um x 4 um\nDelta = 3 nm\n" + matrix(),
        {"unit": "um"},
    ),
    "header of a diameter and a width": (
        "D: 50 mm\nWidth: 60 um\nY range: 64 um\n" + matrix(),
        {"unit": "um"},
    ),
    "header of a range of heights": (
        "Width: 60 um\nHeight = 0.3 um\nUnit Z: um\n" + matrix(),
        {"spacing_across": DY},
    ),
    "header of a resolution beside steps": (
        "Resolution: 5 nm\ndx = 2.5 um\ndy = 4 um\nHeights in um\n" + matrix(),
        {},
    ),
    "header of a resolution": ("X Resolution: 2.5 um\nDelta Y: 4 um\n" + matrix(), {"unit": "um"}),
    "unit behind its word": ("Unit X: mm\nUnit Z\tum\n" + matrix("y", MM * X, MM * Y), {}),
    "units of axes": ("X axis unit: mm; Z in um\n" + matrix("y", MM * X, MM * Y), {"unit": "um"}),
    "positions of the rows in m": (matrix(None, None, Y), {"unit": "um", "spacing": DX}),
    "positions of both in m": (matrix("y", X, Y), {"unit": "um", "spacing": DX}),
    "no positions": (matrix(), BOTH),
    "every other line empty": (matrix().replace("\n", "\n\n"), BOTH),
}


@pytest.mark.parametrize(("text", "layout"), MAPS.values(), ids=MAPS)
def test_layouts_give_the_same_map(tmp_path, text, layout):
    path = tmp_path / "map.txt"
    path.write_text(text)
    assert is_map(path, Layout(**layout))
    z, dx, dy, _ = read_map(path, Layout(**layout))
    np.testing.assert_allclose(z, Z, rtol=0, atol=1e-15)
    assert (dx, dy) == pytest.approx((DX, DY), rel=1e-3)


def test_positions_are_noted_and_points_missing_in_a_list_counted(tmp_path):
    (tmp_path / "map.txt").write_text(matrix("0", MM * X, MM * Y))
    notes = read_map(tmp_path / "map.txt", Layout(unit="um", x_unit="mm")).notes
    expected = (
        "first line: positions of the columns, 2.5 um apart",
        "first column: positions of the rows, 4 um apart",
    )
    assert notes == expected
    (tmp_path / "map.txt").write_text(matrix("n", NUMBERS_X, NUMBERS_Y))
    notes = read_map(tmp_path / "map.txt", Layout(**BOTH)).notes
    lines, rows = "first line: numbers of the columns", "first column: numbers of the rows"
    assert notes == (f"{lines}, left out", f"{rows}, left out")
    lines = points().splitlines(keepends=True)
    (tmp_path / "map.xyz").write_text("".join(lines[:50] + lines[51:]))
    with pytest.raises(ProfileError, match="^1 heights missing, the widest gap "):
        read_map(tmp_path / "map.xyz", Layout(unit="um"))


PLANE = 1e-2 * X + 2e-3 * Y[:, np.newaxis]
SMOOTH = np.cos(X / 4e-5) * np.cos(Y[:, np.newaxis] / 4e-5) * 1e-6
TILTED = PLANE + 0.1 * (Z - Z.mean())


@pytest.mark.parametrize("z", [PLANE, SMOOTH, TILTED, SMOOTH[:6, :5], TILTED[:4, :4]])
@pytest.mark.parametrize("suffix", [".txt", ".npy"])
def test_heights_that_rise_are_no_positions(tmp_path, z, suffix):
    path = tmp_path / f"map{suffix}"
    np.savetxt(path, z, fmt="%.12e") if suffix == ".txt" else np.save(path, z)
    found = read_map(path, Layout(spacing=DX))
    np.testing.assert_allclose(found.z, z, rtol=1e-11)
    assert found.notes == ()


def test_random_heights_are_no_positions_and_those_of_a_binary_matrix_are_read(tmp_path):
    random, path = np.random.default_rng(0), tmp_path / "map.npy"
    for shape in ((8, 5), (5, 8), (6, 6), (30, 40)):
        for _ in range(100):
            np.save(path, random.standard_normal(shape) * 1e-7)
            assert read_map(path, Layout(spacing=DX)).z.shape == shape
    np.save(tmp_path / "map.npy", np.vstack([MM * X, UM * Z]))
    found = read_map(tmp_path / "map.npy", Layout(**BOTH))
    np.testing.assert_allclose(found.z, Z, atol=1e-15)


DIMPLES = -1e-6 * np.exp(-((np.arange(24) - 11.3) ** 2 + (np.arange(16)[:, None] - 7.4) ** 2) / 25.0)
RISING = 1e-6 * np.sin(np.arange(16)[:, None] / 12.0) * (1.0 + 0.3 * np.cos(np.arange(24)))  # from 0 on


@pytest.mark.parametrize("unit", [1e-6, 1e-9])
@pytest.mark.parametrize("first", [0, 1])
def test_numbers_beside_a_smooth_map_are_left_out(tmp_path, unit, first):
    numbers = [axis - 1 + first for axis in (NUMBERS_X, NUMBERS_Y)]
    body = DIMPLES / unit
    np.savetxt(tmp_path / "rows.txt", np.column_stack([numbers[1], body]), fmt="%.9g")
    np.savetxt(tmp_path / "columns.txt", np.vstack([numbers[0], body]), fmt="%.9g")
    for name in ("rows.txt", "columns.txt"):
        found = read_map(tmp_path / name, Layout(unit="um" if unit == 1e-6 else "nm", spacing=DX))
        np.testing.assert_allclose(found.z, DIMPLES, rtol=0, atol=1e-14)
        assert found.notes == (
            f"first {'column' if 'rows' in name else 'line'}: numbers of the {name[:-4]}, left out",
        )


@pytest.mark.parametrize("height", ["um", "nm"])
def test_positions_in_metres_above_heights_that_begin_at_0_are_no_heights(tmp_path, height):
    body = {"um": 1e6, "nm": 1e9}[height] * RISING
    np.savetxt(tmp_path / "map.txt", np.vstack([X, body]), fmt="%.9g")
    found = read_map(tmp_path / "map.txt", Layout(unit=height, spacing=DX))
    np.testing.assert_allclose(found.z, RISING, rtol=0, atol=1e-14)
    assert found.notes == ("first line: positions of the columns, 2.5 um apart",)


@pytest.mark.parametrize("word", ["inf", "-inf", "Infinity", "0.1x", "12.1 um", "?"])
def test_a_first_line_with_a_word_is_no_heading(tmp_path, word):
    lines = matrix(separator=" " if "um" not in word else ";").splitlines()
    separator = ";" if "um" in word else " "
    cells = lines[0].split(separator)
    lines[0] = separator.join([*cells[:3], word, *cells[4:]])
    (tmp_path / "map.txt").write_text("\n".join(lines))
    with pytest.raises(
        ProfileError, match=r"^(row 1, column 4 is not a height|line 1: .* is not a number; )"
    ):
        read_map(tmp_path / "map.txt", Layout(**BOTH))
    x = "\n".join(f"{k} {v:.5f}" for k, v in enumerate(UM * Z[0]))
    (tmp_path / "p.txt").write_text(x.replace(x.split()[1], "inf", 1))
    with pytest.raises(ProfileError, match="^point 1 is not a number"):
        read_profile(tmp_path / "p.txt", Layout(unit="um"))


TWO, POSITIONED = matrix() + "\n" + matrix(), matrix("y", MM * X, MM * Y)
UM_UNIT = {"unit": "um"}
UNEQUAL = "^its first line rises or falls as positions do, but at unequal steps; "
MISPLACED = "^the {} of its heights holds positions or numbers; "
REFUSED = {
    "positions in the last column": (
        "".join(f"{line}\t{y:.6g}\n" for line, y in zip(matrix().splitlines(), UM * Y, strict=True)),
        BOTH,
        MISPLACED.format("last column"),
    ),
    "positions in the last line": (matrix() + "\t".join(words(UM * X)), BOTH, MISPLACED.format("last line")),
    "numbers above positions": (
        "\t".join(words(NUMBERS_X)) + "\n" + matrix(x=UM * X),
        BOTH,
        MISPLACED.format("first line"),
    ),
    "second block": (TWO, BOTH, "^line 18: a second block behind an empty line; .* header_lines = 17 "),
    "second block with a heading": (matrix() + "\nIntensity\n" + matrix(), BOTH, "^line 18: a second block "),
    "narrower second block": (matrix() + "\n\n" + matrix(z=Z[:, :9]), BOTH, "^line 19: a second block "),
    "second block with positions": (POSITIONED + "\n" + POSITIONED, BOTH, "^line 19: a second block "),
    "another spacing": (
        matrix("y [mm]", MM * X, MM * Y),
        {"unit": "um", "spacing": 5e-6},
        r"^spacing = 5e-06 m, by its positions 2\.5e-06 m; allowed: the same; ",
    ),
    "spacing, no unit": (POSITIONED, UM_UNIT | {"spacing": 7e-6}, "^spacing = 7e-06 m, by its positions "),
    "another spacing in the header": (
        "dx: 2.5 um\n" + matrix(),
        {"unit": "um", "spacing": 5e-6},
        r"^spacing = 5e-06 m, by its header 2\.5e-06 m; ",
    ),
    "a width beside another spacing": (
        "Pixel size: 2 um\nWidth: 1 mm\n" + matrix(),
        {"unit": "um"},
        r"^its header gives 2 and 41\.67 um as the distance of its points; allowed: one of them; ",
    ),
    "two spacings in the header": (
        "dx = 2.5 um\nX step: 25 um\n" + matrix(),
        {"unit": "um"},
        r"^its header gives 2\.5 and 25 um as ",
    ),
    "positions at unequal steps": (
        matrix("y", UM * X**1.3 * 50, UM * Y),
        {"unit": "um"},
        "^its first line holds positions that are not equally spaced; ",
    ),
    "numbers at unequal steps": (matrix(None, UM * X**1.3 * 50), BOTH, UNEQUAL),
    "unit of positions": (matrix("[inch]", MM * X, MM * Y), UM_UNIT, "^its header names inch; write x_unit"),
    "unit of heights": (matrix("x [mm]", MM * X, MM * Y), {}, "^its header names mm; write unit"),
    "units alone in a line": (
        "x y z\nmm mm um\n" + points(MM * X, MM * Y),
        {},
        "^its header names mm and um; write",
    ),
    "numbers without spacing": (matrix("n", NUMBERS_X, NUMBERS_Y), UM_UNIT, "^a matrix .* needs spacing = "),
    "heights without spacing": (matrix(), UM_UNIT, "^a matrix of heights needs spacing = "),
    "x_unit without positions": (matrix(), BOTH | {"x_unit": "mm"}, "^x_unit: of x, not of spacing, "),
    "a point twice": (points() + "0 0 12.1\n", {"unit": "um"}, "^x y z: a point is in it twice; "),
}


@pytest.mark.parametrize(("text", "layout", "message"), REFUSED.values(), ids=REFUSED)
def test_refused_map_names_the_cause(tmp_path, text, layout, message):
    path = tmp_path / "map.txt"
    path.write_text(text)
    with pytest.raises(ProfileError, match=message) as caught:
        assert is_map(path, Layout(**layout)) or "heights without" in message
        read_map(path, Layout(**layout))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "header",
    ["X in mm, Z in um", "Unit X: mm\nUnit Z: um", "Z unit = um", "X\tZ\nmm\tum", '"x";"z"\n"mm";"um"'],
)
def test_a_unit_in_the_words_above_a_profile_is_asked_for(tmp_path, header):
    lines = [f"{x:.5f}\t{z:.5f}" for x, z in zip(MM * X, UM * Z[0], strict=True)]
    (tmp_path / "p.txt").write_text("\n".join([header, *lines]))
    with pytest.raises(ProfileError, match='^its header names .*um.*; write unit = "um" for the heights'):
        read_profile(tmp_path / "p.txt", Layout())
    x, z, _ = read_profile(tmp_path / "p.txt", Layout(unit="um", x_unit="mm"))
    np.testing.assert_allclose((x[-1], z[-1]), (X[-1], Z[0, -1]), rtol=1e-9)


NO_PROFILES = {
    "list": (points(), Layout()),
    "list with units": ("X[um] Y[um] Z[um]\n" + points(), Layout()),
    "heights of a list": (points(), Layout(columns=(3,), spacing=1e-6)),
    "x and z of a list": (points(), Layout(columns=(1, 3))),
    "matrix with words": (matrix("y", MM * X, MM * Y), Layout()),
    "matrix with units": (matrix("y [mm]", MM * X, MM * Y), Layout(unit="um")),
    "matrix with a corner number": (matrix("0", MM * X, MM * Y), Layout()),
    "matrix with numbers": (matrix("0", NUMBERS_X, NUMBERS_Y), Layout()),
}


@pytest.mark.parametrize(("text", "layout"), NO_PROFILES.values(), ids=NO_PROFILES)
def test_a_map_is_no_profile(tmp_path, text, layout):
    (tmp_path / "map.xyz").write_text(text)
    with pytest.raises(ProfileError, match="a map of heights, not a profile; points and strips read it, "):
        read_profile(tmp_path / "map.xyz", layout)


def test_profiles_beside_each_other_are_no_map_and_two_blocks_refused(tmp_path):
    path = tmp_path / "p.txt"
    np.savetxt(path, np.column_stack([UM * X, UM * Z[:4].T]), header="x [um] 1 2 3 4")
    assert not is_map(path, Layout(unit="um"))
    x, z, _ = read_profile(path, Layout(unit="um", columns=(1, 3)))
    np.testing.assert_allclose(z, Z[1], rtol=1e-12)
    (tmp_path / "p.txt").write_text("1\n2\n3\n4\n\n1\n2\n3\n")
    with pytest.raises(ProfileError, match="^line 6: a second block behind an empty line; "):
        text_columns(tmp_path / "p.txt")


def test_the_command_reads_a_map_with_its_positions(tmp_path, capsys):
    (tmp_path / "map.txt").write_text("Z unit: um\n" + matrix("y\\x [mm]", MM * X, MM * Y))
    assert main([str(tmp_path / "map.txt"), "--no-picture", "--set", "level=false"]) == 0
    size, *rest = capsys.readouterr().out.splitlines()
    sq = next(line for line in rest if line.startswith("Sq "))
    assert size.endswith("map.txt: 0.0575 x 0.06 mm, 24 x 16 points 2.5 um and 4 um apart")
    assert float(sq.split()[1]) == pytest.approx(UM * Z.std(), abs=1e-4)
