"""The Jacobian as PETSc's matrices."""
