"""Objects change themselves alone: no assignment to an attribute of another object, read from the source."""

import ast
from pathlib import Path

import pytest

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


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_no_attribute_of_another_object_is_set(path):
    assert foreign_assignments(path.read_text(encoding="utf-8")) == []


def test_foreign_assignment_is_found():
    assert foreign_assignments("def f(solver):\n    solver.limited = True\n") == [(2, "solver.limited")]
    assert foreign_assignments("def f(self):\n    self.solver.watch = 1\n") == [(2, "self.solver.watch")]
    assert foreign_assignments("def f():\n    made = Thing()\n    made.x = 1\n    self.y = 2\n") == []
