"""Compilation of loops over nodes and samples by numba, cached on disk between runs.

The solver requires numba. Post-processing works without numba: the functions then run as Python code, slowly,
with bitwise equal results.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import time as clock
from collections.abc import Callable, Container, Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.errors import CaseError

if TYPE_CHECKING:
    from llvmlite.ir import IRBuilder, Value
    from numba.core.base import BaseContext
    from numba.core.typing import Context, Signature
    from numba.types import Type

os.environ.setdefault(
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1"
)  # no colour codes at the end of the output
# full optimisation takes a third more time to compile, and the code is as fast
os.environ.setdefault("NUMBA_OPT", "1")
try:
    import numba
    from llvmlite import ir
    from numba.core import cgutils
    from numba.extending import intrinsic
    from numba.np.unsafe.ndarray import to_fixed_tuple

    COMPILED = True
except ImportError:
    COMPILED = False
# type of indices that are not negative, with which loops take half the time
unsigned = np.uint64 if COMPILED and not numba.config.DISABLE_JIT else int
ZERO: Any = np.int64(0)  # argument of compiled functions, which numba would compile again for a literal 0


def drop_stale_code(package: Path) -> None:
    """Remove numba's cached code of modules that have changed, or import a changed module of the package.

    numba notices a change of the file of a function, not of the files of functions that it calls, nor that a
    module has moved.
    """
    stamp = package / "__pycache__" / "compiled.json"
    with contextlib.suppress(OSError):  # read-only, or a module is removed at the same time
        files = {str(path.relative_to(package)): path.stat() for path in package.rglob("*.py")}
        state = repr(sorted((name, status.st_size, status.st_mtime_ns) for name, status in files.items()))
        kept = json.loads(stamp.read_text()) if stamp.exists() else {}
        if kept.get("state") == state:
            return
        digests = _digests_with_imports(package, files)
        for path in package.rglob("__pycache__/*.nb[ic]"):
            name = str(path.parent.parent.relative_to(package) / path.name.split(".")[0]) + ".py"
            if name not in digests or digests[name] != kept.get("digests", {}).get(name):
                path.unlink(missing_ok=True)
        temporary = stamp.with_suffix(f".{os.getpid()}")
        temporary.parent.mkdir(exist_ok=True)
        temporary.write_text(json.dumps({"state": state, "digests": digests}))
        temporary.replace(stamp)


def _digests_with_imports(package: Path, files: Iterable[str]) -> dict[str, str]:
    """Digest of each file with all files of the package that it imports, directly or not."""
    texts = {name: (package / name).read_text() for name in files}
    imported = {name: _imported_files(text, package.name, texts) for name, text in texts.items()}
    digests = {}
    for name in texts:
        reached, queue = {name}, [name]
        while queue:
            new = imported[queue.pop()] - reached
            reached |= new
            queue += new
        contents = "\0".join(text for file in sorted(reached) for text in (file, texts[file]))
        digests[name] = hashlib.sha256(contents.encode()).hexdigest()
    return digests


def _imported_files(text: str, package: str, files: Container[str]) -> set[str]:
    """Files of the package that a text imports by its absolute name."""
    found = set()
    for module, names in re.findall(rf"^from {package}\b([\w.]*) import (\([^)]*\)|.*)", text, re.MULTILINE):
        folder = module.strip(".").replace(".", "/")
        inner = [f"{folder}/{name}".strip("/") for name in re.findall(r"\w+", names)]
        found |= {f"{folder}.py", f"{folder}/__init__.py".strip("/"), *(f"{name}.py" for name in inner)}
    return {name for name in found if name in files}


if COMPILED:
    drop_stale_code(Path(__file__).parents[1])


COMPILING = "note: compiling for this processor and this version, once: half a minute to a minute"
MIN_COMPILATION = 1.0  # s: shorter ones are not announced


def announce_compilation(show: Callable[[str], None]) -> None:
    """Call `show` with a note once if functions are compiled, rather than loaded from the cache."""
    if not COMPILED:
        return
    from numba.core import event

    class Announcement(event.Listener):
        depth, spent, begun, is_shown = 0, 0.0, 0.0, False

        def on_start(self, event: object) -> None:
            now = clock.monotonic()
            self.begun = now if self.depth == 0 else self.begun
            self.depth += 1
            if not self.is_shown and self.spent + now - self.begun > MIN_COMPILATION:
                self.is_shown = True
                show(COMPILING)

        def on_end(self, event: object) -> None:
            self.depth -= 1
            if self.depth == 0:
                self.spent += clock.monotonic() - self.begun

    event.register("numba:compile", Announcement())


def compiled(function: Callable | None = None, **options: object) -> Any:
    """Compile `function` at its first call, once for all runs if the code can be cached.

    Division by zero is infinity as in numpy; with ``error_model="python"`` it is an error as in Python.
    Other options are numba's.
    """
    if function is None:
        return lambda function: compiled(function, **options)
    if not COMPILED:
        return function
    options = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True} | options
    try:
        return numba.njit(**options)(function)
    except RuntimeError:  # neither the package's directory nor the user's can be written to
        return numba.njit(**(options | {"cache": False}))(function)


def inlined(function: Callable, **options: object) -> Any:
    """Compile a small function of a law into its callers.

    A call from compiled code hands over the law's constants one by one, which takes as long as the law.
    """
    return compiled(function, forceinline=True, **options)


OF_NUMBA = "Failed in ", "Internal error at "  # begins of lines before the reason of an error
_KEPT: list[Any] = []  # compiled laws of the user, which must outlive their addresses


@cache
def address_of(law: Callable, count: int, state: int) -> int:
    """Address, for `call_at`, of a law of one or two `state` variables and `count` constants, compiled.

    Raises `CaseError` for a law that cannot be compiled.
    """
    function, real = numba.njit(error_model="numpy")(law), numba.float64
    pointer = numba.types.CPointer(real)
    if state == 1:

        def call(p: float, T: float, constants: Value, found: Value) -> None:
            values, given = numba.carray(found, 3), to_fixed_tuple(numba.carray(constants, count), count)
            values[0], values[1] = function(p, *given)

    else:

        def call(p: float, T: float, constants: Value, found: Value) -> None:
            values, given = numba.carray(found, 3), to_fixed_tuple(numba.carray(constants, count), count)
            values[0], values[1], values[2] = function(p, T, *given)

    try:
        _KEPT.append(numba.cfunc(numba.void(real, real, pointer, pointer))(call))
    except numba.core.errors.NumbaError as error:
        lines = (line for line in str(error).splitlines() if not line.startswith(OF_NUMBA))
        place = f"{Path(law.__code__.co_filename).name}, line {law.__code__.co_firstlineno}"
        allowed = f"{state + count} arguments, {state + 1} returned numbers, numpy and arithmetic alone"
        reason = f"cannot be compiled: {next(lines, '')}; allowed: {allowed}"
        raise CaseError([f"law {law.__name__} ({place}): {reason}"]) from None
    return _KEPT[-1].address


def call_at(address: int, p: float, T: float, constants: tuple) -> tuple:
    """Results of a law at an address; only compiled loops have it."""
    raise NotImplementedError


if COMPILED:

    @intrinsic
    def call_at(
        typing: Context, address: Type, p: Type, T: Type, constants: Type
    ) -> tuple[Signature, Callable]:
        """Three results of the function at an address, of two numbers and a tuple of constants."""

        def code(
            context: BaseContext, builder: IRBuilder, signature: Signature, arguments: list[Value]
        ) -> Value:
            address, p, T, constants = arguments
            real = ir.DoubleType()
            given = cgutils.alloca_once_value(builder, constants)
            found = cgutils.alloca_once(builder, ir.ArrayType(real, 3))
            kind = ir.FunctionType(ir.VoidType(), [real, real, given.type, found.type])
            builder.call(builder.inttoptr(address, kind.as_pointer()), [p, T, given, found])
            return builder.load(found)

        results = numba.types.UniTuple(numba.float64, 3)
        return results(numba.int64, numba.float64, numba.float64, constants), code

    @intrinsic
    def call_allgather(
        typing: Context,
        function: Type,
        send: Type,
        number: Type,
        received: Type,
        count: Type,
        communicator: Type,
    ) -> tuple[Signature, Callable]:
        """``function(send, count, number, received, count, number, communicator)`` of C in compiled loops."""

        def code(
            context: BaseContext, builder: IRBuilder, signature: Signature, arguments: list[Value]
        ) -> Value:
            function, send, number, received, count, communicator = arguments
            word, integer = ir.IntType(64), ir.IntType(32)
            kind = ir.FunctionType(integer, [word, integer, word, word, integer, word, word])
            call, count = builder.inttoptr(function, kind.as_pointer()), builder.trunc(count, integer)
            return builder.call(call, [send, count, number, received, count, number, communicator])

        return numba.types.int32(*[numba.types.int64] * 6), code
