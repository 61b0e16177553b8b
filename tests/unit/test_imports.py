"""Which room imports which, read from the source; objects change themselves alone; what a scene loads."""

import ast
import re
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from support import CASES
from support.running import PYTHON, called

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.compiled import drop_stale_code

PACKAGE = Path(__file__).parents[2] / "ehlpetsc"
GROUND = {"base"}  # every room may import it; it imports no room
MAY_IMPORT = {
    "base": "",
    "elasticity": "",
    "physics": "elasticity",
    "surfaces": "physics",
    "effects": "surfaces physics discretisation",
    "gears": "physics",
    "case": "gears surfaces physics effects elasticity",
    "results": "case surfaces physics effects",
    "discretisation": "physics elasticity",
    "nonlinear": "discretisation physics elasticity",
    "stepping": "nonlinear discretisation physics effects elasticity",
    "run": "stepping nonlinear discretisation physics effects case surfaces results",
    "analysis": "gears results physics effects elasticity",
    "post": "case results physics",
    "life": "run post effects case surfaces results physics",
    "pictures": "life analysis post gears results physics case surfaces effects elasticity",
    # what the package offers: imports when asked
    "api": "case results run pictures effects physics",
    # arguments and `main` of each command, which `__main__` starts by its name
    "commands": "api pictures life post analysis run gears case results surfaces physics",
    "__main__": "commands run",
}
MAY_IMPORT = {name: set(rooms.split()) for name, rooms in MAY_IMPORT.items()}
SOLVER = {"discretisation", "nonlinear", "stepping", "run"}
LIBRARIES = {  # who alone may load what is heavy
    "petsc4py": {"nonlinear", "run", "commands"},
    "mpi4py": {"run", "nonlinear", "life", "commands"},
    "matplotlib": {"pictures", "api"},
    "numba": {"base"},
}


def module_name(path):
    """``ehlpetsc.post`` of ehlpetsc/post/__init__.py, ``ehlpetsc.post.run`` of run.py beside it."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def room(module):
    """``post`` of ehlpetsc.post.run, ``ehlpetsc`` of the package."""
    return ".".join(module.split(".")[1:2]) or module


class WithoutTypes(ast.NodeTransformer):
    """Imports for type hints alone are not loaded."""

    def visit_If(self, node):
        return None if ast.unparse(node.test) == "TYPE_CHECKING" else self.generic_visit(node)


def imports(module, source, when_loaded=False, with_hints=False):
    """Modules that a source text imports, anywhere or when it is loaded."""
    inside = module.split(".") if FILES[module].name == "__init__.py" else module.split(".")[:-1]
    found = set()
    tree = ast.parse(source) if with_hints else WithoutTypes().visit(ast.parse(source))
    for node in tree.body if when_loaded else ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = inside[: len(inside) + 1 - node.level] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            names = {alias.name for alias in node.names}
            found |= {f"{base}.{name}" if f"{base}.{name}" in FILES else base for name in names}
    return found


@cache
def imported(module):
    """What a module of ours imports; read when first asked for, as every process collects this file."""
    return imports(module, FILES[module].read_text(encoding="utf-8"))


def ours(module):
    return {name for name in imported(module) if name.split(".")[0] == "ehlpetsc"}


@cache
def named(module):
    """Modules of ours that a module imports, also for type hints."""
    source = FILES[module].read_text(encoding="utf-8")
    return {name for name in imports(module, source, with_hints=True) if name.split(".")[0] == "ehlpetsc"}


def _loads(module):
    if room(module) != "effects":
        return ours(module)
    source = FILES[module].read_text(encoding="utf-8")
    return {name for name in imports(module, source, True) if name.split(".")[0] == "ehlpetsc"}


def reached(module):
    """A module and all of ours that it imports, directly or not; effects import the solver when used."""
    seen, waiting = set(), {module}
    while waiting:
        seen |= waiting
        waiting = {name for one in waiting for name in _loads(one)} - seen
    return seen


@pytest.mark.parametrize("name", sorted(MAY_IMPORT))
def test_packages_import_allowed_packages_only(name):
    allowed = MAY_IMPORT[name] | {name} | (GROUND if name not in GROUND else set())
    wrong = [
        f"{module} imports {other}"
        for module in FILES
        if room(module) == name
        for other in sorted(named(module))
        if room(other) not in allowed
    ]
    assert wrong == []


def test_table_of_rooms_is_complete_and_imports_are_acyclic():
    try:
        tuple(TopologicalSorter({module: named(module) for module in FILES}).static_order())
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))
    assert set(MAY_IMPORT) == {room(module) for module in FILES} - {"ehlpetsc"}
    assert all(below <= set(MAY_IMPORT) for below in MAY_IMPORT.values())
    tuple(TopologicalSorter(MAY_IMPORT).static_order())
    unknown = {f"{m}: {name}" for m in FILES for name in ours(m) if name not in FILES}
    assert unknown == set()


@pytest.mark.parametrize("library", sorted(LIBRARIES))
def test_heavy_libraries_are_imported_where_allowed_only(library):
    users = [m for m in FILES if any(name.split(".")[0] == library for name in imported(m))]
    assert users and {room(module) for module in users} <= LIBRARIES[library]


@pytest.mark.parametrize("name", ["post", "analysis", "pictures", "case", "results", "gears"])
def test_reading_packages_reach_neither_solver_nor_petsc_nor_mpi(name):
    everything = set().union(*(reached(module) for module in FILES if room(module) == name))
    assert not {room(module) for module in everything} & SOLVER
    libraries = {lib.split(".")[0] for module in everything for lib in imported(module)}
    assert not libraries & {"petsc4py", "mpi4py"}


@pytest.mark.parametrize("name", ["discretisation", "nonlinear", "stepping"])
def test_heat_is_an_effect_that_the_solver_does_not_know(name):
    texts = [FILES[module].read_text(encoding="utf-8") for module in FILES if room(module) == name]
    assert re.findall(r"\w*(?:heat|temperature)\w*", "".join(texts).lower()) == []


@pytest.mark.parametrize("kind", KINDS)
def test_parts_of_a_kind_of_contact_exist(kind):
    parts = [value for value in KINDS[kind] if isinstance(value, str) and ":" in value]
    assert len(parts) == 4 + (kind == "window")  # what is beside it
    for module, name in (part.split(":") for part in parts):
        assert defines(FILES[f"ehlpetsc.{module}"].read_text(encoding="utf-8"), name), f"{module}:{name}"


ROLE = re.compile(r":(?:mod|func|class|meth|attr|data):`~?([^`]+)`")


def defines(source, name):
    """Whether a source text has a class, function, attribute or import of this name."""
    pattern = (
        rf"\b(def|class) {name}\b|^ *(self\.)?{name}(: [^=\n]*)?( =|,|$)|^ *{name}: |import [^`\n]*\b{name}\b"
    )
    return re.search(pattern, source, re.M)


def exists(target, module):
    """Whether a reference in a docstring of a module names a module of the package, or what is in one."""
    parts, is_whole = target.strip(".").split("."), target.startswith("ehlpetsc.")
    rest = {} if is_whole or target.startswith(".") else {module: parts}
    for name in FILES if not rest else ():
        place = name.split(".")
        for k in range(1, len(parts) + 1):
            if parts[:k] == (place if is_whole else place[-k:]):
                rest[name] = parts[k:]
    sources = {name: FILES[name].read_text(encoding="utf-8") for name in rest}
    return any(not names or defines(sources[name], names[0]) for name, names in rest.items())


def test_references_in_docstrings_exist():
    texts = {module: path.read_text(encoding="utf-8") for module, path in FILES.items()}
    named = [(target, m) for m, text in texts.items() for target in ROLE.findall(text)]
    assert [(target, m) for target, m in named if not exists(target, m)] == []
    assert not exists(".band.BandEntries", "ehlpetsc.discretisation.contact.model")
    assert not exists("ehlpetsc.effects.heat.half_space_conduction", "ehlpetsc.effects.heat.effect")


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


MAX_MODULES = 128
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
    unneeded = {"series", "passes", "explain", "mixed", "synthetic", "path"}
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
