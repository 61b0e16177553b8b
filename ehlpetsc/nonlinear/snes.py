"""Creation and destruction of PETSc's SNES objects."""

import ctypes
import traceback
import weakref

from petsc4py import PETSc

from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear.option_checks import refusal

REASONS = {v: k for k, v in vars(PETSc.SNES.ConvergedReason).items() if isinstance(v, int)}


def owned(owner, *objects):
    """List of PETSc's objects, destroyed with their owner or before Python ends, in reverse order.

    Destroyed by PetscFinalize they would call Python objects that no longer exist.
    """
    petsc_objects = list(objects)
    weakref.finalize(owner, _destroy, petsc_objects)
    return petsc_objects


def _destroy(petsc_objects):
    while petsc_objects:
        petsc_objects.pop().destroy()


def release_frames(error: BaseException) -> None:
    """Clear the frames of the callbacks that an exception left, with their references to PETSc's objects.

    Kept alive by a traceback until Python ends, such an object would be destroyed by PetscFinalize, too late.
    """
    traceback.clear_frames(error.__traceback__)


def create(comm, kind, f, function, pre_check, user_options):
    """Create a SNES of a type, or of the user's ``-snes_type``.

    Parameters
    ----------
    comm : petsc4py.PETSc.Comm
    kind : str
    f : petsc4py.PETSc.Vec
        Vector of the residual.
    function, pre_check : bound method
        Residual function and pre-check of the line search; SNES does not keep their object alive.
    user_options : dict of str to str
        Options of the user.

    Raises
    ------
    UsageError
        PETSc refuses an option, or the type is not supported.
    """
    snes = PETSc.SNES().create(comm)
    try:
        snes.setType(kind)
        snes.setFunction(weakly(function), f)
        snes.setFromOptions()
        if snes.getType() == "vinewtonssls":
            raise UsageError(
                "-snes_type vinewtonssls needs the whole deflection in an assembled matrix; "
                "allowed: vinewtonrsls, and types without bounds where nothing touches"
            )
    except (PETSc.Error, UsageError) as error:
        snes.destroy()
        if isinstance(error, PETSc.Error):
            raise_refusal(error, user_options)
        raise
    snes.setLineSearchPreCheck(weakly(pre_check))
    return snes


def raise_refusal(error, user_options):
    """Raise an error of PETSc, as a `UsageError` where an option of the user can be its cause."""
    message = refusal(error, user_options)
    if message is None:
        raise error
    raise UsageError(message) from None


def set_function_domain_error(snes):
    """Report x outside the domain of the function (SNESSetFunctionDomainError, which petsc4py lacks)."""
    ctypes.CDLL(PETSc.__file__).SNESSetFunctionDomainError(ctypes.c_void_p(snes.handle))


def weakly(method):
    """Function that calls a bound method without keeping its object alive."""
    method = weakref.WeakMethod(method)
    return lambda *arguments: method()(*arguments)
