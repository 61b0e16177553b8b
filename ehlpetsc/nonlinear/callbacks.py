"""Python functions that PETSc calls: their lifetime, errors in them, a call that petsc4py lacks."""

import ctypes
import traceback
import weakref
from collections.abc import Callable

from petsc4py import PETSc


def release_frames(error: BaseException) -> None:
    """Clear the frames of the callbacks that an exception left, with their references to PETSc's objects.

    Kept alive by a traceback until Python ends, such an object would be destroyed by PetscFinalize, too late.
    """
    traceback.clear_frames(error.__traceback__)


def set_function_domain_error(snes: PETSc.SNES) -> None:
    """Report x outside the domain of the function (SNESSetFunctionDomainError, which petsc4py lacks)."""
    ctypes.CDLL(PETSc.__file__).SNESSetFunctionDomainError(ctypes.c_void_p(snes.handle))


def weakly(method: Callable) -> Callable:
    """Function that calls a bound method without keeping its object alive."""
    method = weakref.WeakMethod(method)
    return lambda *arguments: method()(*arguments)
