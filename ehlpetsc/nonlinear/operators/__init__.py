"""The Jacobian as PETSc's matrices: of two unknowns a node and, as a variational inequality, of three."""
