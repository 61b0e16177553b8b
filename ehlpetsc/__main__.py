"""``mpirun -n N python3 -m ehlpetsc CASE.toml [PETSc options]``: run a case.

Own options: -ehl_output FILE.h5, -ehl_restart FILE.h5, -ehl_set table.key=value (repeatable),
-ehl_time_limit MINUTES; ``--explain CASE.toml`` prints the scene in words. Exit status: 0 done, 1 bug,
2 bad input, 3 no convergence, 4 stopped.
"""
import sys


def split_own(argv):
    """Take the repeatable -ehl_set out of the arguments: PETSc's table keeps only the last."""
    rest, sets = [], []
    words = iter(argv)
    for word in words:
        if word == "-ehl_set":
            sets.append(next(words, ""))
        else:
            rest.append(word)
    return rest, sets


def main(argv):
    arguments, overrides = split_own(argv[1:])
    explain = "--explain" in arguments
    names = [w for w in arguments if w.endswith(".toml")]
    if len(names) != 1:
        print("ehlpetsc: name one case file, as in: python3 -m ehlpetsc CASE.toml [PETSc options]", file=sys.stderr)
        return 2
    if explain:
        from ehlpetsc.case import CaseError, load
        from ehlpetsc.explain import explain as words
        try:
            print(words(load(names[0], overrides)))
            return 0
        except CaseError as error:
            print("\n".join(error.faults), file=sys.stderr)
            return 2
    import petsc4py
    petsc4py.init([argv[0], *[w for w in arguments if w != names[0]]])
    from ehlpetsc.run import run
    return run(names[0], overrides)


def guarded(argv):
    """Run `main`; an unexpected error on one rank ends all of them, with its traceback."""
    try:
        return main(argv)
    except SystemExit:
        raise
    except BaseException:  # any other way out would leave the other ranks waiting for ever
        import traceback
        traceback.print_exc()
        sys.stderr.flush()
        if "mpi4py.MPI" in sys.modules:
            mpi = sys.modules["mpi4py.MPI"]
            if mpi.COMM_WORLD.size > 1:
                mpi.COMM_WORLD.Abort(1)
        return 1


if __name__ == "__main__":
    sys.exit(guarded(sys.argv))
