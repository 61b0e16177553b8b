"""Parts of the method by name in PETSc's log, so that ``-log_view`` reads like it."""

from petsc4py import PETSc

RESIDUAL = PETSc.Log.Event("EHL residual")
ASSEMBLY = PETSc.Log.Event("EHL assembly")
PRODUCT = PETSc.Log.Event("EHL product")
FACTOR = PETSc.Log.Event("EHL factor")
BACK_SOLVE = PETSc.Log.Event("EHL back solve")
ROUGHNESS = PETSc.Log.Event("EHL roughness")
OUTPUT = PETSc.Log.Event("EHL output")
START = PETSc.Log.Stage("Steady start")
STEPS = PETSc.Log.Stage("Time steps")
