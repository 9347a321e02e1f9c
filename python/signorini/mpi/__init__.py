"""One model over the ranks of MPI, with PETSc and MUMPS: ``mpiexec -n N signorini solve FILE --engine petsc``."""
