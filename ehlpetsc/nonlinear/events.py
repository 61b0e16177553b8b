"""Log events and stages of the method, shown by ``-log_view``."""

from petsc4py import PETSc

RESIDUAL = PETSc.Log.Event("EHL residual")
ASSEMBLY = PETSc.Log.Event("EHL assembly")
PRODUCT = PETSc.Log.Event("EHL product")
FACTOR = PETSc.Log.Event("EHL factor")
BACK_SOLVE = PETSc.Log.Event("EHL back solve")
ROUGHNESS = PETSc.Log.Event("EHL roughness")
WRITING = PETSc.Log.Event("EHL output")
START = PETSc.Log.Stage("Steady start")
TIME_STEPS = PETSc.Log.Stage("Time steps")
