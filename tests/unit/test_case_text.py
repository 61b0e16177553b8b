"""Case files that are text of another kind than meant: nul, endless keys, byte order marks, dotted tables."""

import itertools
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError
from ehlpetsc.surfaces.measured.text_columns import text_columns

CASE = (Path(__file__).parents[2] / "cases" / "table1_smooth.toml").read_text()
MARK = "\ufeff"


def faults(tmp_path, text, overrides=()):
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(CaseError) as error:
        load(path, overrides)
    assert all(len(fault) < 1000 and "\n" not in fault for fault in error.value.faults)
    return " ".join(error.value.faults)


@pytest.mark.parametrize("sign", ["\\u0000", "\\u0007", "\\n", "\\u007f"])
def test_control_characters_in_a_title_are_refused(tmp_path, sign):
    assert "title = " in faults(tmp_path, CASE.replace('title = "', f'title = "{sign}', 1))


def test_control_characters_in_options_are_refused(tmp_path):
    assert "petsc = " in faults(tmp_path, CASE + '\n[petsc]\nsnes_atol = "1\\u00003"\n')


@pytest.mark.parametrize("where", ["top", "table", "heading", "spaced"])
def test_deeply_nested_keys_are_refused_quickly(tmp_path, where):
    chain = ".".join(["a"] * 20_000)
    text = {
        "top": f"{chain} = 1\n{CASE}",
        "table": CASE.replace("[contact]", f"[contact]\n{chain} = 1", 1),
        "heading": f"{CASE}\n[{chain}]\nb = 1\n",
        "spaced": f"{chain.replace('.', ' . ')} = 1\n{CASE}",
    }[where]
    assert "more than 50" in faults(tmp_path, text)
    assert "allowed: table.key=value" in faults(tmp_path, CASE, [f"{chain}=1"])


def test_key_of_megabytes_is_refused_in_one_line(tmp_path):
    assert "unknown" in faults(tmp_path, f"{'a' * 10_000_000} = 1\n{CASE}")


def test_long_arrays_and_dotted_comments_are_accepted(tmp_path):
    path = tmp_path / "case.toml"
    heights = ",\n".join("0." + "1" * 5 for _ in range(300))
    rows = f'\n[surface.2]\nspacing = 1e-6\nunit = "um"\nz = [\n{heights}\n]\n[time]\ntravel = 1.0\n'
    path.write_text("# " + "." * 500 + "\n# 1.2.3.4 and so on ...\n" + CASE + rows)
    assert len(load(path).surface.body_2.z) == 300


def test_byte_order_mark_of_a_case_is_ignored(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(MARK + CASE)
    assert load(path).text == CASE


@pytest.mark.parametrize("rest", ["", "# \xb5m\n"])
@pytest.mark.parametrize("marks", [1, 2])
def test_byte_order_mark_of_a_profile_keeps_its_first_point(tmp_path, rest, marks):
    path = tmp_path / "profile.csv"
    text = "".join(f"{k}e-6,{k % 3}e-7\n" for k in range(20))
    coding = "latin-1" if rest else "utf-8"
    path.write_bytes(MARK.encode() * (1 if rest else marks) + (text + rest).encode(coding))
    columns, _ = text_columns(path)
    assert columns.shape == (2, 20)


TABLES = {
    "plain": "[contact]\nradius = 0.0191\nload = 527e3\n",
    "dotted": "contact.radius = 0.0191\ncontact.load = 527e3\n",
    "inline": "contact = { radius = 0.0191, load = 527e3 }\n",
}
MORE = {
    "dotted": "contact.youngs_modulus = [2e11, 2e11]\ncontact.poisson_ratio = [0.3, 0.3]\n",
    "plain": "youngs_modulus = [2e11, 2e11]\npoisson_ratio = [0.3, 0.3]\n",
}
MESHES = {
    "plain": "[mesh]\ninlet = -2.5\noutlet = 1.5\npoints_per_half_width = 50\n",
    "dotted": "mesh.inlet = -2.5\nmesh.outlet = 1.5\nmesh.points_per_half_width = 50\n",
    "inline": "mesh = { inlet = -2.5, outlet = 1.5, points_per_half_width = 50 }\n",
    "quoted": '["mesh"]\n"inlet" = -2.5\noutlet = 1.5\npoints_per_half_width = 50\n',
}
WAVES = {
    "none": "",
    "table": '[surface.2.synthetic]\nkind = "sine"\namplitude = 1e-7\nwavelength = 1e-4\n',
    "above": '[surface]\n2.synthetic.kind = "sine"\n2.synthetic.amplitude = 1e-7\n'
    "2.synthetic.wavelength = 1e-4\n",
    "inline": '[surface.2]\nsynthetic = { kind = "sine", amplitude = 1e-7, wavelength = 1e-4 }\n',
}
SETS = (
    "contact.load=4e5",
    "mesh.points_per_half_width=40",
    "contact.boundary_friction=0.1",
    "output.every=3",
    "surface.2.synthetic={kind='sine',amplitude=2e-7,wavelength=1e-4}",
    "surface.2.scale=2.0",
    "petsc.snes_atol=1e-9",
)


def layouts():
    """Texts of one case whose tables stand in every mixture of ways."""
    for (c, contact), mesh, wave in itertools.product(TABLES.items(), MESHES.items(), WAVES.items()):
        if c == "inline":
            contact = contact.replace(" }", ", youngs_modulus = [2e11, 2e11], poisson_ratio = [0.3, 0.3] }")
        else:
            contact += MORE[c]
        top = [t for t in (contact, mesh[1]) if not t.startswith("[")]
        below = [t for t in (contact, mesh[1], wave[1]) if t.startswith("[")]
        for order in itertools.permutations(below):
            yield 'title = "t"\n' + "".join([*top, *order])


@pytest.mark.slow
def test_stored_case_equals_the_run_case_in_any_layout(tmp_path):
    path, count = tmp_path / "case.toml", 0
    for text in layouts():
        path.write_text(text)
        for some in (SETS[:1], SETS[3:4], SETS[:4], SETS[2:], SETS[4:]):
            case = load(path, [one for one in some if "scale" not in one or "surface.2" in text])
            stored = tmp_path / "stored.toml"
            stored.write_text(case.text)
            assert load(stored).as_dict() == case.as_dict(), (text, some)
            assert tomllib.loads(case.text)
            count += 1
    assert count > 400


def test_numpy_warnings_are_hidden():
    """They are for developers: python3 -W default shows them."""
    code = "import sys; import numpy; from ehlpetsc import __main__ as command\n"
    code += "command._start = lambda words: numpy.log(numpy.zeros(1)) is None\n"
    code += "sys.exit(command.main([]))"
    warnings_shown = {}
    for words in ((), ("-W", "default")):
        done = subprocess.run(
            [sys.executable, *words, "-c", code], capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0
        warnings_shown[words] = done.stderr
    assert warnings_shown[()] == "" and "by zero" in warnings_shown["-W", "default"]
