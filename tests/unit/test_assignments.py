"""Objects change themselves alone, a scene loads what it needs, compiled code is that of the sources."""

import ast
from pathlib import Path

from support import CASES
from support.running import PYTHON, called

from ehlpetsc.base.compiled import drop_stale_code

PACKAGE = Path(__file__).parents[2] / "ehlpetsc"
FOREIGN = {"sys"}  # a module with settings of its own
LIBRARY = {"swmr_mode", "writeable", "initialize"}  # settings of h5py, numpy and mpi4py


def foreign_assignments(source):
    """Line and text of every assignment to an attribute of an object that the function does not make."""
    found = []
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef | ast.Module):
            continue
        body = list(_own_nodes(function))
        made = {"self", "cls"} | {name for node in body for name in _made_here(node)}
        for node in body:
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
                root = node.value
                while isinstance(root, ast.Attribute | ast.Call):
                    root = root.value if isinstance(root, ast.Attribute) else root.func
                name = root.id if isinstance(root, ast.Name) else ast.unparse(root)
                direct = isinstance(node.value, ast.Name) and name in made
                if not direct and name not in FOREIGN and node.attr not in LIBRARY:
                    found.append((node.lineno, ast.unparse(node)))
    return found


def _own_nodes(function):
    for node in ast.iter_child_nodes(function):
        if not isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node
            yield from _own_nodes(node)


def _made_here(node):
    """Names bound to what a constructor, or a copy, gives."""
    if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
        called = ast.unparse(node.value.func).rpartition(".")[2]
        if called[:1].isupper() or called in ("copy", "cls"):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))


def test_no_attribute_of_another_object_is_set():
    found = {path: foreign_assignments(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
    assert {path: lines for path, lines in found.items() if lines} == {}


MAX_MODULES = 109
CODE = """
import sys
from ehlpetsc.__main__ import main
status = main(sys.argv[1:])
print(status, *sorted(name for name in sys.modules if name.startswith("ehlpetsc")), sep="\\n")
"""


def test_smooth_dry_contact_loads_few_modules(tmp_path):
    words = [CASES / "dry_hertz.toml", "--set", "mesh.points_per_half_width=20"]
    done = called([PYTHON, "-c", CODE, *words], tmp_path)
    status, *modules = done.stdout[done.stdout.rindex("wall=") :].split("\n")[1:-1]
    assert status == "0", done.stderr
    assert len(modules) <= MAX_MODULES
    rooms = {name.split(".")[1] for name in modules if "." in name}
    assert not rooms & {"post", "life", "analysis", "pictures"}
    unneeded = {"series", "passes", "explain", "gauss_seidel", "mixed", "synthetic", "path"}
    assert not {name.rpartition(".")[2] for name in modules} & unneeded


def compiled_code_of(package, name):
    kept = package / "room" / "__pycache__" / f"{name}.f-1.nbi"
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_bytes(b"code")
    return kept


def test_compiled_code_of_changed_imported_and_moved_sources_is_removed(tmp_path):
    package = tmp_path / "package"
    room = package / "room"
    law, other = compiled_code_of(package, "law"), compiled_code_of(package, "other")
    (room / "base.py").write_text("C = 1\n")
    (room / "law.py").write_text("from package.room.base import C\ndef f(): return C\n")
    (room / "other.py").write_text("def f(): return 1\n")
    drop_stale_code(package)
    assert not law.exists() and not other.exists()  # of unknown sources
    law, other = compiled_code_of(package, "law"), compiled_code_of(package, "other")
    drop_stale_code(package)
    assert law.exists() and other.exists()
    (room / "base.py").write_text("C = 25\n")  # imported by law alone
    drop_stale_code(package)
    assert not law.exists() and other.exists()
    (room / "other.py").rename(room / "moved.py")
    drop_stale_code(package)
    assert not other.exists()
